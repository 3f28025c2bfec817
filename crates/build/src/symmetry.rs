//! Which symmetry a measurement shows: isotropic or not, mirror-symmetric about the plane of incidence or not.

use gonio_geom::{Angles, Component, DVec3, Side};
use gonio_scan::Slice;
use rayon::prelude::*;

use crate::images::{Image, Images};
use crate::plane::Point;
use crate::readings::{Readings, turn_to_pi};
use crate::slice_surface::SliceSurface;

/// Incidences closer than this are one (radians): 0.05 degrees.
pub(crate) const SAME_DIRECTION: f64 = 0.05 * std::f64::consts::PI / 180.0;

/// Incidences whose polar angles differ less are compared or averaged when isotropic (radians): 0.3 degrees.
pub(crate) const SAME_THETA: f64 = 0.3 * std::f64::consts::PI / 180.0;

/// Two slices that differ by less than this (relative L1) count as equal.
const EQUAL: f64 = 0.05;

/// A hemisphere half with less than this share of the other's measured solid angle was not measured.
const HALF_SHARE: f64 = 0.2;

/// Every so manyth reading is compared with its image, in at most so many slices.
const COMPARED: usize = 5;
const MOST_COMPARED: usize = 4;

/// What the builder is to assume about azimuth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SymmetryChoice {
    /// Decided from the data.
    #[default]
    Auto,
    /// Only `phi_s - phi_i` matters.
    Isotropic,
    /// Incidences are interpolated over both angles.
    Anisotropic,
}

/// Slices of one direction of incidence.
#[derive(Clone, Debug)]
pub(crate) struct Incidence<'a> {
    pub(crate) angles: Angles,
    pub(crate) slices: Vec<&'a Slice>,
}

impl<'a> Incidence<'a> {
    /// Slices grouped by direction of incidence, in order of polar angle from the normal of their side.
    pub(crate) fn group(slices: &[&'a Slice], side: Side) -> Vec<Self> {
        let mut out: Vec<Incidence<'a>> = Vec::new();
        for &slice in slices {
            let direction = slice.incidence.direction();
            if direction.side() != side {
                continue;
            }
            let same = |g: &&mut Incidence<'a>| {
                let d = g.angles.direction();
                // At the normal the holder's azimuth still turns the slice.
                d.angle_to(direction) < SAME_DIRECTION
                    && (g.angles.phi == slice.incidence.phi || direction.vec().z.abs() < 1.0 - 1e-6)
            };
            match out.iter_mut().find(same) {
                Some(group) => group.slices.push(slice),
                None => out.push(Incidence {
                    angles: slice.incidence,
                    slices: vec![slice],
                }),
            }
        }
        out.sort_by(|a, b| polar(a.angles).total_cmp(&polar(b.angles)));
        out
    }

    /// Its readings of one component in the local frame; rotated to azimuth pi when `isotropic`.
    pub(crate) fn readings(&self, component: Component, isotropic: bool) -> Readings {
        let side = component.scattered_side(self.angles.direction().side());
        let turn = if isotropic { turn_to_pi(self.angles) } else { 0.0 };
        Readings::collect(&self.slices, side, turn)
    }
}

/// Polar angle from the normal of the side of incidence.
pub(crate) fn polar(angles: Angles) -> f64 {
    angles.theta.min(std::f64::consts::PI - angles.theta)
}

/// What was decided about azimuth, and why.
#[derive(Clone, Debug)]
pub(crate) struct Azimuth {
    pub(crate) isotropic: bool,
    pub(crate) note: Option<String>,
}

/// Decides whether only `phi_s - phi_i` matters. One plane of incidence: assumed. Several: slices of the same polar
/// angle are compared after rotation.
pub(crate) fn decide(slices: &[&Slice], choice: SymmetryChoice) -> Azimuth {
    let settled = |isotropic| Azimuth {
        isotropic,
        note: None,
    };
    match choice {
        SymmetryChoice::Isotropic => return settled(true),
        SymmetryChoice::Anisotropic => return settled(false),
        SymmetryChoice::Auto => {}
    }
    let groups: Vec<Incidence<'_>> = Side::BOTH
        .into_iter()
        .flat_map(|side| Incidence::group(slices, side))
        .collect();
    if Side::BOTH.into_iter().all(|side| one_plane(&groups, side)) {
        return Azimuth {
            isotropic: true,
            note: Some("isotropy assumed: one plane of incidence was measured".into()),
        };
    }
    let mut mismatch = Vec::new();
    for (k, a) in groups.iter().enumerate() {
        let b = groups[k + 1..].iter().find(|b| {
            (b.angles.theta - a.angles.theta).abs() < SAME_THETA
                && (b.angles.phi - a.angles.phi).abs() > SAME_DIRECTION
        });
        for component in [Component::Reflection, Component::Transmission] {
            if let Some(difference) = b.and_then(|b| rotated_difference(a, b, component)) {
                mismatch.push(difference);
            }
        }
    }
    if mismatch.is_empty() {
        return Azimuth {
            isotropic: false,
            note: Some("several azimuths of incidence but no polar angle twice: taken as anisotropic".into()),
        };
    }
    let mean = mismatch.iter().sum::<f64>() / mismatch.len() as f64;
    let isotropic = mean <= EQUAL;
    Azimuth {
        isotropic,
        note: Some(format!(
            "slices of the same theta_i differ by {:.1} % (mean relative L1) after rotation: {}",
            100.0 * mean,
            if isotropic { "isotropic" } else { "anisotropic" }
        )),
    }
}

/// Tilt of the sample up to which incidences of one plane of the instrument stay one plane, radians (3 degrees).
const TILT: f64 = 3.0 * std::f64::consts::PI / 180.0;

/// Whether the incidences on `side` lie in one plane through the normal, or beside it by no more than a tilted sample
/// brings about: then they stand at many azimuths, all of them near the plane.
fn one_plane(groups: &[Incidence<'_>], side: Side) -> bool {
    let off_normal: Vec<Angles> = groups
        .iter()
        .map(|g| g.angles)
        .filter(|a| a.direction().side() == side && polar(*a) > SAME_THETA)
        .collect();
    // Axis of the directions' projections on the sample: azimuths half a turn apart are one.
    let (s, c) = off_normal.iter().fold((0.0, 0.0), |(s, c), a| {
        let w = a.theta.sin().powi(2);
        (s + w * (2.0 * a.phi).sin(), c + w * (2.0 * a.phi).cos())
    });
    let axis = 0.5 * f64::atan2(s, c);
    off_normal.iter().all(|a| {
        let beside = (a.phi - axis).sin();
        beside.abs() < SAME_THETA.sin() || (a.theta.sin() * beside).abs() < TILT.sin()
    })
}

fn rotated_difference(a: &Incidence<'_>, b: &Incidence<'_>, component: Component) -> Option<f64> {
    let surface = |g: &Incidence<'_>| SliceSurface::new(&g.readings(component, true), true);
    let (a, b) = (surface(a)?, surface(b)?);
    difference(&a, 1, |p| b.measured(p).then(|| b.value(p)))
}

/// Relative L1 difference, over the projected solid angle of every `step`th reading of `surface`, to what `other` says.
fn difference(surface: &SliceSurface, step: usize, other: impl Fn(Point) -> Option<f64>) -> Option<f64> {
    let omega = surface.solid_angles();
    let (mut apart, mut size) = (0.0, 0.0);
    for (&p, w) in surface.points().iter().zip(omega).step_by(step) {
        let Some(image) = other(p) else { continue };
        let value = surface.value(p);
        let weight = w * crate::plane::from_plane(p).z;
        apart += weight * (value - image).abs();
        size += weight * 0.5 * (value.abs() + image.abs());
    }
    (size > 0.0).then(|| apart / size)
}

/// Whether the halves of a slice on both sides of the plane of incidence agree; `None` when only one was measured.
pub(crate) fn mirror_symmetric(surface: &SliceSurface) -> Option<bool> {
    let image = |p: Point| [p[0], -p[1]];
    difference(surface, 1, |p| {
        surface.measured(image(p)).then(|| surface.value(image(p)))
    })
    .map(|d| d <= EQUAL)
}

/// The images under which slices with axes agree: the incidence of a slice mirrored or turned must have been measured, and
/// the readings there agree as well as `allowed` or [`EQUAL`]. With the mean difference of the images that are kept.
pub(crate) fn images(slices: &[(DVec3, &SliceSurface)], allowed: f64) -> (Images, f64) {
    let mut worst: f64 = 0.0;
    let mut shown = |image: Image| {
        let pairs = slices.iter().flat_map(|&(i, a)| {
            let there = image.of(i);
            let same = move |other: &&(DVec3, &SliceSurface)| (other.0 - there).length() < SAME_THETA;
            slices.iter().find(same).map(|&(_, b)| (a, b))
        });
        let compared: Vec<(&SliceSurface, &SliceSurface)> = pairs.take(MOST_COMPARED).collect();
        let differences: Vec<f64> = compared
            .into_par_iter()
            .filter_map(|(a, b)| {
                difference(a, COMPARED, |p| {
                    let q = image.of_point(p);
                    b.measured(q).then(|| b.value(q))
                })
            })
            .collect();
        let mean = differences.iter().sum::<f64>() / differences.len().max(1) as f64;
        let agree = !differences.is_empty() && mean <= EQUAL.max(allowed);
        if agree {
            worst = worst.max(mean);
        }
        agree
    };
    let found = [Image::FLIP_X, Image::FLIP_Y, Image::HALF_TURN].map(&mut shown);
    (Images::of(found[0], found[1], found[2]), worst)
}

/// Whether readings lie on one side of the plane of incidence only.
pub(crate) fn half_measured(surface: &SliceSurface) -> bool {
    let (mut left, mut right) = (0.0, 0.0);
    for (p, w) in surface.points().iter().zip(surface.solid_angles()) {
        if p[1] > 1e-6 {
            left += w;
        } else if p[1] < -1e-6 {
            right += w;
        }
    }
    f64::min(left, right) < HALF_SHARE * f64::max(left, right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_geom::Direction;

    fn decided(incidences: &[(f64, f64)], tilt: f64) -> Azimuth {
        let slices: Vec<Slice> = incidences
            .iter()
            .map(|&(theta, phi)| {
                let d = Direction::from_degrees(theta, phi).vec();
                let (s, c) = tilt.to_radians().sin_cos();
                let tilted = DVec3::new(d.x, c * d.y - s * d.z, s * d.y + c * d.z);
                Slice {
                    incidence: Direction::from_unit(tilted).angles(),
                    channel: gonio_bsdf::Channel::Photopic,
                    theta_s: Vec::new(),
                    phi_s: Vec::new(),
                    dsf: Vec::new(),
                    u_dsf: Vec::new(),
                    omega: Vec::new(),
                    flags: Vec::new(),
                    u_common: 0.0,
                    integrals: Vec::new(),
                }
            })
            .collect();
        decide(&slices.iter().collect::<Vec<_>>(), SymmetryChoice::Auto)
    }

    #[test]
    fn a_tilted_sample_measured_in_one_plane_is_not_taken_for_one_measured_at_many_azimuths() {
        let plane: Vec<(f64, f64)> = [0.0, 5.0, 10.0, 30.0, 60.0].map(|t| (t, 40.0)).to_vec();
        for tilt in [0.0, 0.4, -2.5] {
            assert!(decided(&plane, tilt).isotropic, "{tilt}");
        }
        let crossed = [(10.0, 0.0), (30.0, 0.0), (60.0, 90.0)];
        assert!(!decided(&crossed, 0.0).isotropic);
        assert!(!decided(&[(60.0, 0.0), (60.0, 10.0), (30.0, 0.0)], 0.0).isotropic);
    }
}
