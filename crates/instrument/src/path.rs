//! Where the detector reads.

use std::f64::consts::{PI, TAU};

use gonio_geom::{Component, Direction, Side};
use rand::{Rng, RngExt};

use crate::InstrumentError;
use crate::error::in_range;

/// A patch of rings around the mirror or the unbent direction whose pitch grows with the distance from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Radius, radians, `(0, pi/2]`.
    pub radius: f64,
    /// Pitch between rings at the centre, radians, `>= 0.0002`.
    pub pitch: f64,
    /// Growth of the pitch per unit distance from the centre, `[0, 1]`.
    pub growth: f64,
    /// Pitch along a ring as a share of the pitch between rings, `[0.1, 2]`.
    pub along: f64,
}

impl Default for Patch {
    /// 25 degrees wide, .2 degrees at the centre growing by .04, six tenths of that along the rings.
    fn default() -> Self {
        Patch {
            radius: 25.0_f64.to_radians(),
            pitch: 0.2_f64.to_radians(),
            growth: 0.04,
            along: 0.6,
        }
    }
}

/// Rings of constant `theta_s` over a hemisphere, refined around the mirror and unbent directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetectorPath {
    /// Pitch between rings, radians, `[0.001, 0.5]`.
    pub pitch_across: f64,
    /// Pitch along rings, radians, `[0.001, 0.5]`.
    pub pitch_along: f64,
    /// Polar angle from the hemisphere's pole that no reading passes, radians, `(0, pi/2)`.
    pub theta_max: f64,
    /// The refined patch, if any.
    pub patch: Option<Patch>,
    /// Standard deviation of a ring's polar position as a share of the pitch, `[0, 0.3]`. Along the ring readings are
    /// taken at even steps from a random start. Recorded directions include it.
    pub jitter: f64,
}

impl Default for DetectorPath {
    /// Rings 3 degrees apart, .5 degrees along, up to 89 degrees, the default patch, jitter of .02.
    fn default() -> Self {
        DetectorPath {
            pitch_across: 3.0_f64.to_radians(),
            pitch_along: 0.5_f64.to_radians(),
            theta_max: 89.0_f64.to_radians(),
            patch: Some(Patch::default()),
            jitter: 0.02,
        }
    }
}

impl DetectorPath {
    pub(crate) fn check(&self) -> Result<(), InstrumentError> {
        in_range("pitch_across", self.pitch_across, 0.001, 0.5, " rad")?;
        in_range("pitch_along", self.pitch_along, 0.001, 0.5, " rad")?;
        in_range("theta_max", self.theta_max, 0.1, 0.5 * PI - 1e-4, " rad")?;
        in_range("jitter", self.jitter, 0.0, 0.3, "")?;
        if let Some(p) = self.patch {
            in_range("patch radius", p.radius, 1e-3, 0.5 * PI, " rad")?;
            in_range("patch pitch", p.pitch, 2e-4, 0.5, " rad")?;
            in_range("patch growth", p.growth, 0.0, 1.0, "")?;
            in_range("patch along", p.along, 0.1, 2.0, "")?;
        }
        Ok(())
    }

    /// The directions read for incidence `wi` over the hemisphere of `component`, in the order of the path: rings from
    /// the pole to the horizon, then the patch from its centre outwards. Directions within `shadow` of `wi` are left
    /// out: there the detector stands in the beam.
    pub(crate) fn directions(
        &self,
        wi: Direction,
        component: Component,
        shadow: f64,
        rng: &mut impl Rng,
    ) -> Vec<Direction> {
        let side = component.scattered_side(wi.side());
        let mut path = Vec::new();
        // Rings lie on half pitches so that none degenerates at the pole.
        let rings = (self.theta_max / self.pitch_across + 0.5).floor() as usize;
        for k in 0..rings {
            let theta = (k as f64 + 0.5 + self.wobble(rng)) * self.pitch_across;
            let pole = Direction::from_unit(gonio_geom::DVec3::Z * side.sign());
            self.ring(pole, theta, self.pitch_along, side, rng, &mut path);
        }
        if let Some(patch) = self.patch {
            let centre = match component {
                Component::Reflection => wi.mirror(),
                Component::Transmission => wi.through(),
            };
            let mut gamma = 0.5 * patch.pitch;
            while gamma <= patch.radius {
                let pitch = patch.pitch + patch.growth * gamma;
                let at = gamma + self.wobble(rng) * pitch;
                self.ring(centre, at, pitch * patch.along, side, rng, &mut path);
                gamma += pitch;
            }
        }
        path.retain(|d| component == Component::Transmission || d.angle_to(wi) > shadow);
        path
    }

    /// Displacement of a ring in units of the pitch, within three standard deviations.
    fn wobble(&self, rng: &mut impl Rng) -> f64 {
        self.jitter * rng.sample::<f64, _>(rand_distr::StandardNormal).clamp(-3.0, 3.0)
    }

    /// Adds the readable directions at angle `gamma` from `centre`, evenly spaced by about `step` from a random start.
    fn ring(
        &self,
        centre: Direction,
        gamma: f64,
        step: f64,
        side: Side,
        rng: &mut impl Rng,
        path: &mut Vec<Direction>,
    ) {
        let n = (TAU * gamma.sin() / step).round().max(4.0) as usize;
        let start = rng.random_range(0.0..TAU);
        let c = centre.vec();
        let (a, b) = c.any_orthonormal_pair();
        let lowest = self.theta_max.cos();
        for k in 0..n {
            let (s, cos) = (start + TAU * k as f64 / n as f64).sin_cos();
            let v = gamma.cos() * c + gamma.sin() * (cos * a + s * b);
            if v.z * side.sign() >= lowest {
                path.extend(Direction::new(v));
            }
        }
    }
}

/// Raster over the beam without sample: square pitch `pitch` out to `half` in both axes of the tangent plane at
/// `centre`, rows in turn, the whole grid at a random phase.
pub(crate) fn beam_raster(centre: Direction, half: f64, pitch: f64, rng: &mut impl Rng) -> Vec<Direction> {
    let (a, b) = centre.vec().any_orthonormal_pair();
    let n = (half / pitch).ceil() as i64;
    let (x0, y0): (f64, f64) = (rng.random_range(-0.5..0.5), rng.random_range(-0.5..0.5));
    let mut out = Vec::with_capacity(((2 * n + 1) * (2 * n + 1)) as usize);
    for i in -n..=n {
        for j in -n..=n {
            let (x, y) = ((j as f64 + x0) * pitch, (i as f64 + y0) * pitch);
            out.extend(Direction::new(centre.vec() + x * a + y * b));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_pcg::Pcg64Mcg;

    #[test]
    fn the_path_keeps_to_its_hemisphere_and_out_of_the_shadow() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let wi = Direction::from_degrees(75.0, 30.0);
        let shadow = 0.05;
        for component in [Component::Reflection, Component::Transmission] {
            let path = DetectorPath::default();
            let read = path.directions(wi, component, shadow, &mut rng);
            let side = component.scattered_side(Side::Front);
            assert!(read.iter().all(|d| d.side() == side));
            assert!(read.iter().all(|d| d.cos_theta().abs() >= path.theta_max.cos()));
            let near = read.iter().filter(|d| d.angle_to(wi) <= shadow).count();
            assert_eq!(near, 0);
        }
    }

    #[test]
    fn the_patch_is_as_dense_as_stated_around_the_mirror_direction() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let wi = Direction::from_degrees(40.0, 0.0);
        let read = DetectorPath::default().directions(wi, Component::Reflection, 0.05, &mut rng);
        let radius = 1.0_f64.to_radians();
        let inside = read.iter().filter(|d| d.angle_to(wi.mirror()) < radius).count() as f64;
        // Rings at .1, .304, .516, .737, .966 degrees, each with a pitch along of six tenths of its pitch across; the
        // coarse rings add at most five.
        let pitch = [0.204, 0.212_16, 0.220_6, 0.229_5, 0.238_6];
        let gamma = [0.1, 0.304, 0.516, 0.737, 0.966];
        let expected: f64 = pitch
            .iter()
            .zip(gamma)
            .map(|(p, g): (&f64, f64)| (TAU * g / (0.6 * p)).round().max(4.0))
            .sum();
        assert!(
            (expected..=expected + 5.0).contains(&inside),
            "{inside} readings, {expected}"
        );
    }
}
