//! RADIANCE's approximation of Fresnel's law for smooth plastic, metal and trans.

use std::str::FromStr;

use crate::BsdfError;

/// The release of RADIANCE whose constants a model takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Release {
    /// 6.0 and before.
    V6_0,
    /// 6.1.
    #[default]
    V6_1,
}

impl Release {
    /// What is taken off the exponential. That of 6.1 makes the approximation zero at normal incidence.
    fn offset(self) -> f64 {
        match self {
            Release::V6_0 => 0.002_029_430_64,
            Release::V6_1 => 0.002_879_899_16,
        }
    }

    /// `exp(-5.85 cos) - k`: the share that a smooth surface reflects at an angle of cosine `cos` in `[0, 1]` of what
    /// it would let in at normal incidence [Radiance, rt/normal.c]. `k` is .00287989916 in release 6.1 and .00202943064
    /// before. A rough surface has none of it.
    pub fn fresnel(self, cos: f64) -> f64 {
        (-5.85 * cos).exp() - self.offset()
    }
}

impl FromStr for Release {
    type Err = BsdfError;

    /// `6.0` or `6.1`.
    fn from_str(s: &str) -> Result<Self, Self::Err> {
        match s {
            "6.0" => Ok(Release::V6_0),
            "6.1" => Ok(Release::V6_1),
            _ => Err(BsdfError::Domain {
                field: "release",
                found: format!("{s:?}"),
                allowed: "6.0, 6.1".into(),
            }),
        }
    }
}

/// Roughness up to which a surface is smooth.
pub(super) const SMOOTH: f64 = 1e-3;
/// Specularity from which on a smooth surface follows Fresnel's law.
const THRESHOLD: f64 = 0.017_999;

/// Specularity of a smooth surface and what Fresnel's law makes of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interface {
    specularity: f64,
    release: Release,
}

impl Interface {
    pub(super) fn new(specularity: f64, release: Release) -> Self {
        Interface { specularity, release }
    }

    /// The approximation at `cos`; 0 below the threshold.
    pub(super) fn fresnel(&self, cos: f64) -> f64 {
        if self.specularity >= THRESHOLD {
            self.release.fresnel(cos)
        } else {
            0.0
        }
    }

    /// Share reflected at `cos` by a surface that reflects the share `color * specularity` at normal incidence.
    pub(super) fn reflected(&self, color: f64, cos: f64) -> f64 {
        let f = self.fresnel(cos);
        f + color * self.specularity * (1.0 - f)
    }

    /// Share that enters at `cos`, whatever the colour.
    pub(super) fn entering(&self, cos: f64) -> f64 {
        (1.0 - self.specularity) * (1.0 - self.fresnel(cos))
    }

    /// Whether Fresnel's law plays a part.
    pub(super) fn has_fresnel(&self) -> bool {
        self.specularity >= THRESHOLD
    }
}
