//! Light that leaves unscattered: the peak in the mirror or through direction that is as narrow as the beam itself.
//!
//! No reading tells how narrow such a peak is, so it is no BSDF: it is taken out of the readings and becomes the ideal
//! part of the model, a share of the light over incidence [ASTME2387]. What the readings resolve stays in the BSDF.

mod beam_shape;
mod peak;

use std::f64::consts::FRAC_PI_2;

use gonio_bsdf::FourComponents;
use gonio_fit::profile::Profile;
use gonio_geom::{Angles, Component, DVec3, Side};
use gonio_scan::{Resolution, Slice, u_beside_resolution};
use rayon::prelude::*;

use self::beam_shape::BeamShape;
use self::peak::Found;
use crate::images::Symmetry;
use crate::layout::Layout;
use crate::pile::local_incidence;
use crate::symmetry::{SAME_THETA, polar};

/// Fewest incidences with a peak.
const LEAST_INCIDENCES: usize = 2;

/// The unscattered light of one incidence and component.
#[derive(Clone, Debug, PartialEq)]
pub struct DirectPeak {
    /// Direction of incidence.
    pub incidence: Angles,
    /// Reflection (mirror direction) or transmission (through direction).
    pub component: Component,
    /// Share of the incident light; 0 where no peak was found.
    pub share: f64,
    /// Standard uncertainty of the share, calibration apart.
    pub u_share: f64,
    /// Width of the peak over that of the beam.
    pub width: f64,
    /// Angle between the peak and the mirror or through direction, radians.
    pub offset: f64,
    /// Solid angle of the beam as the instrument sees it, sr: the peak is narrower than the readings can tell.
    pub solid_angle: f64,
}

/// The slices without their peaks, and the peaks.
pub(crate) struct Separated {
    pub(crate) slices: Vec<Slice>,
    pub(crate) peaks: FourComponents<Vec<DirectPeak>>,
    pub(crate) notes: Vec<String>,
}

/// Takes peaks as narrow as the beam of `profile` out of `slices`, where at least two incidences of a component have one.
/// `resolution` is what `u_dsf` was stated with: a peak is compared with the beam's own image.
pub(crate) fn separate(slices: &[&Slice], profile: &Profile, resolution: Option<&Resolution>) -> Separated {
    let beam = BeamShape::new(profile);
    let sharp: Vec<Slice> = slices
        .par_iter()
        .map(|slice| Slice {
            u_dsf: resolution.map_or_else(|| slice.u_dsf.clone(), |r| u_beside_resolution(slice, r)),
            ..(*slice).clone()
        })
        .collect();
    let mut out = Separated {
        slices: slices.iter().map(|s| (*s).clone()).collect(),
        peaks: FourComponents::default(),
        notes: Vec::new(),
    };
    for (side, component) in FourComponents::<()>::KEYS {
        let own: Vec<usize> = (0..slices.len())
            .filter(|&k| slices[k].incidence.direction().side() == side)
            .collect();
        let found: Vec<(usize, Found)> = own
            .into_par_iter()
            .map(|k| (k, peak::find(&sharp[k], component, &beam)))
            .collect();
        let count = found.iter().filter(|f| matches!(f.1, Found::Peak(_))).count();
        if count < LEAST_INCIDENCES {
            continue;
        }
        let mut peaks = Vec::new();
        for (k, found) in found {
            let incidence = slices[k].incidence;
            let mut file = |share, u_share, width, offset| {
                peaks.push(DirectPeak {
                    incidence,
                    component,
                    share,
                    u_share,
                    width,
                    offset,
                    solid_angle: beam.solid_angle(),
                });
            };
            match found {
                Found::Peak(peak) => {
                    file(peak.share, peak.u_share, peak.scale, peak.offset);
                    take_out(&mut out.slices[k], &peak.readings);
                }
                Found::Nothing => file(0.0, 0.0, 1.0, 0.0),
                Found::Unread => {
                    let (theta, phi) = incidence.to_degrees();
                    out.notes.push(format!(
                        "{side} {component}, theta_i {theta:.1}, phi_i {phi:.1} deg: too few readings about the {} direction to \
                         tell whether light passes unscattered",
                        straight(component)
                    ));
                }
            }
        }
        let (least, most) = peaks.iter().fold((f64::INFINITY, 0.0f64), |(a, b), p| {
            (a.min(p.share), b.max(p.share))
        });
        out.notes.push(format!(
            "{side} {component}: at {count} incidences a peak in the {} direction is as narrow as the beam: {:.2} to {:.2} % of the \
             light is taken as unscattered, an ideal part apart from the BSDF",
            straight(component),
            100.0 * least,
            100.0 * most
        ));
        out.peaks.set(side, component, Some(peaks));
    }
    out
}

fn straight(component: Component) -> &'static str {
    match component {
        Component::Reflection => "mirror",
        Component::Transmission => "through",
    }
}

/// Puts what is left in place of the readings that a peak touches.
fn take_out(slice: &mut Slice, readings: &[(usize, f64, f64)]) {
    for &(j, dsf, u) in readings {
        slice.dsf[j] = dsf;
        slice.u_dsf[j] = u.hypot(slice.u_common * dsf);
    }
}

/// The unscattered share of one side and component over incidence.
#[derive(Clone, Debug)]
pub(crate) struct Direct {
    component: Component,
    layout: Layout,
    shares: Vec<f64>,
}

impl Direct {
    /// Interpolates between `peaks`, at least one, and their images under `symmetry`.
    pub(crate) fn new(peaks: &[DirectPeak], symmetry: Symmetry) -> Self {
        let isotropic = symmetry == Symmetry::Isotropic;
        let mut order: Vec<&DirectPeak> = peaks.iter().collect();
        order.sort_by(|a, b| polar(a.incidence).total_cmp(&polar(b.incidence)));
        // One entry an incidence; isotropic ones of the same polar angle are averaged.
        let mut groups: Vec<(DVec3, f64, f64)> = Vec::new();
        for peak in order {
            let theta = polar(peak.incidence);
            let direction = local_incidence(peak.incidence, isotropic);
            let same = |g: &&mut (DVec3, f64, f64)| {
                let apart = g.0.dot(direction).clamp(-1.0, 1.0).acos();
                if isotropic {
                    (g.0.z.clamp(-1.0, 1.0).acos() - theta).abs() < SAME_THETA
                } else {
                    apart < SAME_THETA
                }
            };
            match groups.iter_mut().find(same) {
                Some(group) => {
                    group.1 += peak.share;
                    group.2 += 1.0;
                }
                None => groups.push((direction, peak.share, 1.0)),
            }
        }
        let directions: Vec<DVec3> = groups.iter().map(|g| g.0).collect();
        Direct {
            component: peaks[0].component,
            layout: Layout::new(&directions, symmetry),
            shares: groups.iter().map(|g| g.1 / g.2).collect(),
        }
    }

    /// The share for a local incidence: interpolated between those measured; past them that of the edge, in transmission
    /// falling to 0 at grazing incidence with the angle.
    pub(crate) fn share(&self, i: DVec3) -> f64 {
        let (i, _) = self.layout.frame(i, DVec3::Z);
        let near = self.layout.near(i);
        let share = match self.layout.stencil(i) {
            Some((theta, stencil)) => {
                let at = |k: crate::cubic::Knot| self.shares[k.node.node];
                stencil.interpolate(
                    theta,
                    stencil.before.map(at),
                    stencil.between.map(at),
                    stencil.after.map(at),
                )
            }
            None => near.iter().map(|k| k.weight * self.shares[k.node]).sum(),
        };
        let past = self.layout.past(i);
        let left = FRAC_PI_2 - i.x.hypot(i.y).atan2(i.z);
        let fade = match self.component {
            Component::Transmission if past > 0.0 => (left / (left + past)).clamp(0.0, 1.0),
            _ => 1.0,
        };
        (share * fade).clamp(0.0, 1.0)
    }
}

/// The shares of one side, reflected and passed, together.
pub(crate) fn both(direct: &FourComponents<Direct>, side: Side, i: DVec3) -> f64 {
    [Component::Reflection, Component::Transmission]
        .into_iter()
        .filter_map(|c| direct.get(side, c))
        .map(|d| d.share(i))
        .sum()
}
