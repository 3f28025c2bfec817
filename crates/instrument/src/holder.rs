//! The sample holder: how large the sample is and how well it is mounted.

use gonio_geom::{Angles, DVec3, Direction};

use crate::InstrumentError;
use crate::error::in_range;

/// Outline of the sample in its own plane, centred on the mark.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Outline {
    /// Larger than any spot.
    #[default]
    Unbounded,
    /// A round sample, or a round sampling aperture in front of it.
    Disk {
        /// Diameter, metres, `[1e-4, 10]`.
        diameter: f64,
    },
    /// A rectangle.
    Rectangle {
        /// Extent along x, metres, `[1e-4, 10]`.
        width: f64,
        /// Extent along y, metres, `[1e-4, 10]`.
        height: f64,
    },
}

impl Outline {
    fn holds(self, x: f64, y: f64) -> bool {
        match self {
            Outline::Unbounded => true,
            Outline::Disk { diameter } => x.hypot(y) <= 0.5 * diameter,
            Outline::Rectangle { width, height } => x.abs() <= 0.5 * width && y.abs() <= 0.5 * height,
        }
    }
}

/// The holder. It turns the sample about the vertical and the horizontal axis, so that every incidence is reached; what it
/// does not do perfectly is stated here. Light beside the sample meets a black frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Holder {
    /// Outline of the sample.
    pub outline: Outline,
    /// Whether the spot may pass the outline: without it such an incidence is an error.
    pub overfill: bool,
    /// Turn of the sample about its x and y axis against what is recorded, radians, `[-0.2, 0.2]` each.
    pub tilt: [f64; 2],
    /// Height of the sample's surface above the axes of rotation along its normal, metres, `[-0.05, 0.05]`.
    pub offset: f64,
    /// Radius about the centre that the holder needs, metres, `[0, 10]`; the detector stays outside.
    pub radius: f64,
}

impl Default for Holder {
    /// An unbounded sample, perfectly mounted on a holder of 40 mm.
    fn default() -> Self {
        Holder {
            outline: Outline::Unbounded,
            overfill: false,
            tilt: [0.0; 2],
            offset: 0.0,
            radius: 0.04,
        }
    }
}

impl Holder {
    pub(crate) fn check(&self, distance: f64) -> Result<(), InstrumentError> {
        match self.outline {
            Outline::Unbounded => {}
            Outline::Disk { diameter } => in_range("sample_diameter", diameter, 1e-4, 10.0, " m")?,
            Outline::Rectangle { width, height } => {
                in_range("sample_width", width, 1e-4, 10.0, " m")?;
                in_range("sample_height", height, 1e-4, 10.0, " m")?;
            }
        }
        in_range("tilt_x", self.tilt[0], -0.2, 0.2, " rad")?;
        in_range("tilt_y", self.tilt[1], -0.2, 0.2, " rad")?;
        in_range("offset", self.offset, -0.05, 0.05, " m")?;
        in_range("holder_radius", self.radius, 0.0, 10.0, " m")?;
        if distance > self.radius {
            return Ok(());
        }
        Err(InstrumentError::Domain {
            field: "distance",
            found: format!("{distance} m, inside the sample holder"),
            allowed: format!("more than holder_radius, {} m", self.radius),
        })
    }

    /// A direction of the holder's frame, as recorded, in the frame of the sample as it is mounted.
    pub(crate) fn to_sample(self, d: Direction) -> Direction {
        if self.tilt == [0.0; 2] {
            return d;
        }
        let ([sx, sy], [cx, cy]) = (self.tilt.map(f64::sin), self.tilt.map(f64::cos));
        // The sample turned by +tilt sees the world turned back: about y, then about x.
        let v = d.vec();
        let v = DVec3::new(cy * v.x - sy * v.z, v.y, sy * v.x + cy * v.z);
        let v = DVec3::new(v.x, cx * v.y + sx * v.z, -sx * v.y + cx * v.z);
        Direction::from_unit(v)
    }

    /// Where the middle of the sample's surface lies in the sample's frame whose origin is the crossing of the axes.
    pub(crate) fn surface(self) -> DVec3 {
        self.offset * self.to_sample(Direction::NORMAL).vec()
    }

    /// Whether `x` of the sample plane, origin as in [`Holder::surface`], lies on the sample.
    pub(crate) fn holds(self, x: DVec3) -> bool {
        let at = x - self.surface();
        self.outline.holds(at.x, at.y)
    }

    /// # Errors
    /// [`InstrumentError::Domain`] where a spot of `diameter` passes the outline at `incidence` and may not.
    pub(crate) fn check_spot(&self, diameter: f64, incidence: Angles) -> Result<(), InstrumentError> {
        if self.overfill || self.outline == Outline::Unbounded {
            return Ok(());
        }
        let through = self.to_sample(incidence.direction()).vec();
        let (a, b) = through.any_orthonormal_pair();
        let rim = (0..64).map(|k| std::f64::consts::TAU * f64::from(k) / 64.0);
        let fits = rim.into_iter().all(|t| {
            let cross = 0.5 * diameter * (t.cos() * a + t.sin() * b);
            let x = cross + through * ((self.surface().z - cross.z) / through.z);
            self.holds(x)
        });
        if fits {
            return Ok(());
        }
        let (theta, phi) = incidence.to_degrees();
        Err(InstrumentError::Domain {
            field: "sample size",
            found: format!(
                "a sample smaller than the spot of {} mm at theta_i = {theta} degrees, phi_i = {phi} degrees",
                1e3 * diameter
            ),
            allowed: "a sample that holds the whole spot, or overfill = true".into(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilt_moves_the_mirror_direction_by_twice_itself() {
        let holder = Holder {
            tilt: [0.0, 0.01],
            ..Holder::default()
        };
        let normal = holder.to_sample(Direction::NORMAL);
        let mirror = holder.to_sample(Direction::from_spherical(0.02, 0.0));
        // Recorded mirror direction of normal incidence on a sample turned towards +x.
        assert!(normal.mirror().angle_to(mirror) < 1e-12);
    }

    #[test]
    fn a_spot_grows_past_a_sample_with_the_angle_of_incidence() {
        let holder = Holder {
            outline: Outline::Disk { diameter: 0.025 },
            ..Holder::default()
        };
        assert!(holder.check_spot(0.01, Angles::from_degrees(66.0, 20.0)).is_ok());
        let error = holder
            .check_spot(0.01, Angles::from_degrees(67.0, 20.0))
            .unwrap_err();
        assert!(
            error
                .to_string()
                .contains("sample smaller than the spot of 10 mm"),
            "{error}"
        );
        let consented = Holder {
            overfill: true,
            ..holder
        };
        assert!(
            consented
                .check_spot(0.01, Angles::from_degrees(80.0, 20.0))
                .is_ok()
        );
    }
}
