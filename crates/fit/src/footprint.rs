//! What becomes of the beam's profile in light that an interface refracts.

use gonio_geom::{DVec3, Direction};

use crate::profile::{Node, Profile};

/// Cosine below which refracted light leaves at grazing, where the beam's footprint has no linear image.
const LEAST_COSINE: f64 = 0.05;

/// How the rule about one direction is oriented and stretched.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Footprint {
    /// As the detector sees the bare beam: light that is reflected, or passes straight on, keeps the beam's divergence.
    Round,
    /// Narrower by these factors in the plane of incidence, whose horizontal direction is given, and across it.
    Narrowed {
        horizontal: DVec3,
        along: f64,
        across: f64,
    },
}

impl Footprint {
    /// The footprint of `profile` in light that an interface refracts: its through direction moves less than the
    /// incident one where it enters the denser medium, by `cos theta_i / (n cos theta_t)` in the plane of incidence and by
    /// `1 / n` across it, `n = sin theta_i / sin theta_t` (Snell's law). This narrows the part of the second moment that
    /// the beam's divergence makes; the receiver aperture's stays. A beam focused on the detector turns towards it by
    /// `s / r` where it meets the sample `s` off its axis; a mirror, or a sheet that does not refract, makes this good, and
    /// refracted light misses by `s / r` times `cos theta_t / cos theta_i - cos theta_i / (n cos theta_t)` and `1 - 1 / n`.
    ///
    /// Round without the receiver's share, at `n = 1` and past the critical angle. `index_ratio` is that of the medium
    /// behind the sample to that in front.
    pub(crate) fn refracted(profile: &Profile, wi: Direction, index_ratio: f64) -> Self {
        let Some(receiver) = profile.receiver_share else {
            return Footprint::Round;
        };
        let v = wi.vec();
        let n = if v.z < 0.0 { 1.0 / index_ratio } else { index_ratio };
        let sin2 = (1.0 - v.z * v.z).max(0.0);
        let cos_t = (1.0 - sin2 / (n * n)).sqrt();
        if n == 1.0 || cos_t.is_nan() || cos_t.min(v.z.abs()) < LEAST_COSINE {
            return Footprint::Round;
        }
        let cos_i = v.z.abs();
        let scale = |moved: f64, stretched: f64| {
            let missed = stretched - moved;
            (receiver + (1.0 - receiver) * moved * moved + profile.spot_share * missed * missed).sqrt()
        };
        Footprint::Narrowed {
            horizontal: DVec3::new(v.x, v.y, 0.0).try_normalize().unwrap_or(DVec3::X),
            along: scale(cos_i / (n * cos_t), cos_t / cos_i),
            across: scale(1.0 / n, 1.0),
        }
    }

    /// The direction of `node` about `centre`.
    pub(crate) fn offset(&self, centre: Direction, node: &Node) -> Direction {
        let v = centre.vec();
        let (sp, cp) = node.psi.sin_cos();
        let round = || (v.any_orthonormal_pair(), 1.0, 1.0);
        let ((a, b), along, across) = match *self {
            Footprint::Round => round(),
            Footprint::Narrowed {
                horizontal,
                along,
                across,
            } => match (horizontal - v * v.dot(horizontal)).try_normalize() {
                Some(a) => ((a, v.cross(a)), along, across),
                None => round(),
            },
        };
        let (x, y) = (along * cp, across * sp);
        let radius = x.hypot(y);
        if radius == 0.0 {
            return centre;
        }
        let (sin, cos) = (node.gamma * radius).sin_cos();
        Direction::new(v * cos + (a * x + b * y) * (sin / radius)).unwrap_or(centre)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: f64 = 1.5;
    const THETA_I: f64 = 0.9;

    /// Where light from `wi` leaves to through a smooth interface of index `N` (Snell's law in vectors).
    fn refracted(wi: DVec3) -> DVec3 {
        let v = -wi;
        let cos_t = (1.0 - (1.0 - v.z * v.z) / (N * N)).sqrt();
        DVec3::new(v.x / N, v.y / N, -cos_t)
    }

    /// Mean squares of offsets from `centre` in the plane of incidence (y = 0) and across it.
    fn moments(centre: DVec3, all: impl Iterator<Item = (DVec3, f64)>) -> (f64, f64) {
        let along = centre.cross(DVec3::Y);
        all.fold((0.0, 0.0), |(a, b), (w, weight)| {
            let d = w - centre;
            (a + weight * d.dot(along).powi(2), b + weight * d.y.powi(2))
        })
    }

    fn profile(receiver_share: f64, spot_share: f64) -> Profile {
        let mut profile = Profile::gaussian(0.01).unwrap();
        profile.receiver_share = Some(receiver_share);
        profile.spot_share = spot_share;
        profile
    }

    fn of(profile: &Profile) -> (f64, f64) {
        let wi = Direction::from_spherical(THETA_I, 0.0);
        let centre = Direction::new(refracted(wi.vec())).unwrap();
        let footprint = Footprint::refracted(profile, wi, N);
        let nodes = profile.rule(3).iter();
        moments(
            centre.vec(),
            nodes.map(|n| (footprint.offset(centre, n).vec(), n.weight)),
        )
    }

    #[test]
    fn a_divergent_beam_has_the_moments_of_its_refracted_rays() {
        let beam = profile(0.0, 0.0);
        let wi = Direction::from_spherical(THETA_I, 0.0);
        let rays = beam
            .rule(3)
            .iter()
            .map(|n| (refracted(Footprint::Round.offset(wi, n).vec()), n.weight));
        let truth = moments(refracted(wi.vec()), rays);
        let found = of(&beam);
        assert!((found.0 / truth.0 - 1.0).abs() < 2e-3, "{found:?} {truth:?}");
        assert!((found.1 / truth.1 - 1.0).abs() < 2e-3, "{found:?} {truth:?}");
    }

    #[test]
    fn the_receiver_aperture_keeps_its_width() {
        let beam = profile(1.0, 0.0);
        let (along, across) = of(&beam);
        let half = 0.5 * beam.second_moment;
        assert!((along / half - 1.0).abs() < 1e-3 && (across / half - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_spot_adds_the_angles_by_which_refracted_rays_miss_the_focus() {
        // Rays towards one point of the detector sphere from points `s` off the axis; where the refracted ones go to,
        // against where the detector sees them from.
        let (radius, distance) = (0.01, 1.0);
        let wi = Direction::from_spherical(THETA_I, 0.0).vec();
        let (through, aim) = (-wi, refracted(wi) * distance);
        let rays = (0..360).map(|k| {
            let (sin, cos) = f64::from(k).to_radians().sin_cos();
            // Half the mean square of a disk is that of a ring of radius / sqrt 2.
            let cross = radius / 2.0_f64.sqrt() * (cos * wi.cross(DVec3::Y) + sin * DVec3::Y);
            let x = cross - through * (cross.z / through.z);
            let ray = (through * distance - x).normalize();
            let seen = (aim - x).normalize();
            (refracted(wi) + seen - refracted(-ray), 1.0 / 360.0)
        });
        let truth = moments(refracted(wi), rays);
        let beam = profile(0.0, 0.0);
        let spot = 0.5 * radius * radius / beam.second_moment;
        let (still, moved) = (of(&beam), of(&profile(0.0, spot)));
        let added = (moved.0 - still.0, moved.1 - still.1);
        assert!((added.0 / truth.0 - 1.0).abs() < 2e-2, "{added:?} {truth:?}");
        assert!((added.1 / truth.1 - 1.0).abs() < 2e-2, "{added:?} {truth:?}");
    }

    #[test]
    fn without_refraction_and_past_the_critical_angle_the_footprint_is_round() {
        let wi = Direction::from_spherical(1.2, 0.0);
        for n in [1.0, 0.7] {
            let footprint = Footprint::refracted(&profile(0.3, 0.1), wi, n);
            assert!(matches!(footprint, Footprint::Round), "{n}");
        }
    }
}
