//! Where the detector reads.

use std::f64::consts::{PI, TAU};

use gonio_geom::{Component, DVec3, Direction, Side};
use rand::{Rng, RngExt};

use crate::error::in_range;
use crate::region::{PathTable, Prescan, Region};
use crate::{InstrumentError, Patch};

/// Rings of constant `theta_s` over a hemisphere (or lines in half planes), refined around the mirror and unbent directions
/// and in further regions; or a table of directions.
#[derive(Clone, Debug, PartialEq)]
pub struct DetectorPath {
    /// Pitch between rings, radians, `[0.001, 0.5]`.
    pub pitch_across: f64,
    /// Pitch along rings, radians, `[0.001, 0.5]`.
    pub pitch_along: f64,
    /// Polar angle from the hemisphere's pole that no reading passes, radians, `(0, pi/2)`.
    pub theta_max: f64,
    /// Azimuths of half planes relative to that of incidence, radians: lines from the pole to the horizon in place of rings.
    /// Empty: rings.
    pub planes: Vec<f64>,
    /// The refined patch around the mirror and unbent directions, if any.
    pub patch: Option<Patch>,
    /// Standard deviation of a ring's polar position as a share of the pitch, `[0, 0.3]`. Along the ring readings are
    /// taken at even steps from a random start. Recorded directions include it.
    pub jitter: f64,
    /// Further refined regions, read after the patch in this order.
    pub regions: Vec<Region>,
    /// A fast scan that finds peaks and gives them regions.
    pub prescan: Option<Prescan>,
    /// Directions in place of all of the above; `theta_max` and the shadow still hold.
    pub table: Option<PathTable>,
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
            planes: Vec::new(),
            regions: Vec::new(),
            prescan: None,
            table: None,
        }
    }
}

impl DetectorPath {
    pub(crate) fn check(&self) -> Result<(), InstrumentError> {
        in_range("pitch_across", self.pitch_across, 0.001, 0.5, " rad")?;
        in_range("pitch_along", self.pitch_along, 0.001, 0.5, " rad")?;
        in_range("theta_max", self.theta_max, 0.1, 0.5 * PI - 1e-4, " rad")?;
        in_range("jitter", self.jitter, 0.0, 0.3, "")?;
        for azimuth in &self.planes {
            in_range("azimuth of a plane", *azimuth, -TAU, TAU, " rad")?;
        }
        let regions = self.regions.iter().map(|r| &r.patch);
        regions.chain(&self.patch).try_for_each(Patch::check)?;
        self.prescan.iter().try_for_each(Prescan::check)
    }

    /// The directions read for incidence `wi` over the hemisphere of `component`, in the order of the path: rings from
    /// the pole to the horizon (or half planes in turn), then the patch from its centre outwards, then the regions and after
    /// them those of `found`. Directions within `shadow` of `wi` are left out: there the detector stands in the beam.
    pub fn directions(
        &self,
        wi: Direction,
        component: Component,
        shadow: f64,
        found: &[Region],
        rng: &mut impl Rng,
    ) -> Vec<Direction> {
        let side = component.scattered_side(wi.side());
        let mut path = match &self.table {
            Some(table) => self.tabulated(table, wi, side),
            None => self.base(wi, side, rng),
        };
        if self.table.is_none() {
            let patch = self.patch.iter().map(|&patch| {
                let centre = match component {
                    Component::Reflection => wi.mirror(),
                    Component::Transmission => wi.through(),
                };
                (centre, patch)
            });
            let regions = self
                .regions
                .iter()
                .filter_map(|r| Some((r.around.centre(wi, component)?, r.patch)));
            for (centre, patch) in patch.chain(regions) {
                self.rings(centre, patch, side, rng, &mut path);
            }
        }
        for (centre, patch) in found
            .iter()
            .filter_map(|r| Some((r.around.centre(wi, component)?, r.patch)))
        {
            self.rings(centre, patch, side, rng, &mut path);
        }
        path.retain(|d| component == Component::Transmission || d.angle_to(wi) > shadow);
        path
    }

    /// Centres and radii of the regions for incidence `wi` over the hemisphere of `component`.
    pub(crate) fn refined(&self, wi: Direction, component: Component) -> Vec<(Direction, f64)> {
        let patch = self.patch.iter().map(|p| match component {
            Component::Reflection => (wi.mirror(), p.radius),
            Component::Transmission => (wi.through(), p.radius),
        });
        let regions = self
            .regions
            .iter()
            .filter_map(|r| Some((r.around.centre(wi, component)?, r.patch.radius)));
        patch.chain(regions).collect()
    }

    fn tabulated(&self, table: &PathTable, wi: Direction, side: Side) -> Vec<Direction> {
        let lowest = self.theta_max.cos() - 1e-12;
        let held = |d: &&Direction| d.cos_theta() * side.sign() >= lowest;
        table
            .of(wi)
            .unwrap_or_default()
            .iter()
            .filter(held)
            .copied()
            .collect()
    }

    /// Rings about the pole, or lines in half planes.
    fn base(&self, wi: Direction, side: Side, rng: &mut impl Rng) -> Vec<Direction> {
        let mut path = Vec::new();
        let pole = Direction::from_unit(DVec3::Z * side.sign());
        if self.planes.is_empty() {
            // Rings lie on half pitches so that none degenerates at the pole.
            let rings = (self.theta_max / self.pitch_across + 0.5).floor() as usize;
            for k in 0..rings {
                let theta = (k as f64 + 0.5 + self.wobble(rng)) * self.pitch_across;
                self.ring(pole, theta, self.pitch_along, side, rng, &mut path);
            }
            return path;
        }
        for azimuth in &self.planes {
            let (s, c) = (wi.phi() + azimuth).sin_cos();
            let start: f64 = rng.random_range(0.0..1.0);
            let steps = (self.theta_max / self.pitch_along - start).floor().max(0.0) as usize;
            for k in 0..=steps {
                let (sin, cos) = ((start + k as f64) * self.pitch_along).sin_cos();
                path.extend(Direction::new(DVec3::new(sin * c, sin * s, cos * side.sign())));
            }
        }
        path
    }

    /// A graded patch about `centre`.
    fn rings(
        &self,
        centre: Direction,
        patch: Patch,
        side: Side,
        rng: &mut impl Rng,
        path: &mut Vec<Direction>,
    ) {
        let mut gamma = 0.5 * patch.pitch;
        while gamma <= patch.radius {
            let pitch = patch.pitch + patch.growth * gamma;
            let at = gamma + self.wobble(rng) * pitch;
            self.ring(centre, at, pitch * patch.along, side, rng, path);
            gamma += pitch;
        }
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
            let read = path.directions(wi, component, shadow, &[], &mut rng);
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
        let read = DetectorPath::default().directions(wi, Component::Reflection, 0.05, &[], &mut rng);
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
