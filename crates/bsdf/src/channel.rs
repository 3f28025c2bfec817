//! Spectral channels by name.

use std::fmt;
use std::str::FromStr;

use crate::BsdfError;

/// A named spectral channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Channel {
    /// V(lambda)-weighted.
    Photopic,
    /// Weighted with the solar spectrum.
    Solar,
    /// Radiance red.
    Red,
    /// Radiance green.
    Green,
    /// Radiance blue.
    Blue,
    /// Centre wavelength in nm.
    Wavelength(f64),
}

impl fmt::Display for Channel {
    /// `photopic`, `solar`, `red`, `green`, `blue` or the wavelength as in `532nm`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Channel::Photopic => f.write_str("photopic"),
            Channel::Solar => f.write_str("solar"),
            Channel::Red => f.write_str("red"),
            Channel::Green => f.write_str("green"),
            Channel::Blue => f.write_str("blue"),
            Channel::Wavelength(nm) => write!(f, "{nm}nm"),
        }
    }
}

impl FromStr for Channel {
    type Err = BsdfError;

    /// The inverse of `Display`; a space before `nm` and a bare number of nanometres are accepted too.
    fn from_str(s: &str) -> Result<Self, Self::Err> {
        let text = s.trim().to_ascii_lowercase();
        match text.as_str() {
            "photopic" => return Ok(Channel::Photopic),
            "solar" => return Ok(Channel::Solar),
            "red" => return Ok(Channel::Red),
            "green" => return Ok(Channel::Green),
            "blue" => return Ok(Channel::Blue),
            _ => {}
        }
        match text.strip_suffix("nm").unwrap_or(&text).trim().parse::<f64>() {
            Ok(nm) if nm.is_finite() && (100.0..=100_000.0).contains(&nm) => Ok(Channel::Wavelength(nm)),
            _ => Err(BsdfError::Domain {
                field: "channel",
                found: format!("{s:?}"),
                allowed:
                    "photopic, solar, red, green, blue, or a wavelength of 100 to 100000 nm such as 532nm"
                        .into(),
            }),
        }
    }
}
