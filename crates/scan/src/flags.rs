//! What is known about a single reading beside its value.

use std::ops::{BitOr, BitOrAssign};

/// Flags of one reading. A flagged reading keeps its value; nothing is clipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags(u16);

impl Flags {
    /// Nothing to say.
    pub const NONE: Flags = Flags(0);
    /// Negative after the dark was subtracted.
    pub const NEGATIVE: Flags = Flags(1);
    /// Below the noise floor (less than two standard uncertainties of the noise).
    pub const BELOW_NOISE: Flags = Flags(1 << 1);
    /// An exact zero among positive neighbours: a sentinel, not a reading.
    pub const SENTINEL: Flags = Flags(1 << 2);
    /// No data (NaN in the file).
    pub const NO_DATA: Flags = Flags(1 << 3);
    /// The detector shades the beam (retro direction).
    pub const SHADOW: Flags = Flags(1 << 4);
    /// Within half a detector aperture of the sample plane.
    pub const HORIZON: Flags = Flags(1 << 5);
    /// At or above the detector's saturation.
    pub const SATURATED: Flags = Flags(1 << 6);
    /// The same direction was read more than once in this scan.
    pub const REPEATED: Flags = Flags(1 << 7);

    /// Flags that take a reading out of integrals and fits.
    pub const UNUSABLE: Flags =
        Flags(Self::SENTINEL.0 | Self::NO_DATA.0 | Self::SHADOW.0 | Self::SATURATED.0);

    /// Every flag with the name files and Python use.
    pub const NAMES: [(Flags, &'static str); 8] = [
        (Self::NEGATIVE, "negative"),
        (Self::BELOW_NOISE, "below_noise"),
        (Self::SENTINEL, "sentinel"),
        (Self::NO_DATA, "no_data"),
        (Self::SHADOW, "shadow"),
        (Self::HORIZON, "horizon"),
        (Self::SATURATED, "saturated"),
        (Self::REPEATED, "repeated"),
    ];

    /// The bits, as stored in files.
    pub fn bits(self) -> u16 {
        self.0
    }

    /// Flags from stored bits; unknown bits are dropped.
    pub fn from_bits(bits: u16) -> Self {
        Flags(bits & 0xff)
    }

    /// Whether any of `other` is set.
    pub fn intersects(self, other: Flags) -> bool {
        self.0 & other.0 != 0
    }

    /// Whether the reading may enter integrals and fits.
    pub fn usable(self) -> bool {
        !self.intersects(Self::UNUSABLE)
    }
}

impl BitOr for Flags {
    type Output = Flags;
    fn bitor(self, other: Flags) -> Flags {
        Flags(self.0 | other.0)
    }
}

impl BitOrAssign for Flags {
    fn bitor_assign(&mut self, other: Flags) {
        self.0 |= other.0;
    }
}
