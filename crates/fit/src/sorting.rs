//! What becomes of the readings of a slice: part of the fit, or left out for a reason.

use std::collections::BTreeMap;

use gonio_bsdf::analytic::Pairs;
use gonio_geom::{Angles, Component};
use gonio_scan::{Flags, Slice};

use crate::selection::{Reason, Selection};

/// The readings of one slice, sorted.
#[derive(Default)]
pub(crate) struct Sorted {
    /// Directions of all readings; `None` when the incidence lies in the sample plane.
    pub(crate) pairs: Option<Pairs>,
    /// Positions of those that take part: reflection, transmission.
    pub(crate) kept: [Vec<u32>; 2],
    /// How many were left out for what.
    pub(crate) left_out: BTreeMap<Reason, usize>,
    /// Usable readings in components that are not wanted: reflection, transmission.
    pub(crate) others: [usize; 2],
}

/// Position of a component in pairs of two.
pub(crate) fn slot(component: Component) -> usize {
    match component {
        Component::Reflection => 0,
        Component::Transmission => 1,
    }
}

/// The components by their slots.
pub(crate) const COMPONENTS: [Component; 2] = [Component::Reflection, Component::Transmission];

/// Whether light of this incidence shines along the sample instead of on it.
pub(crate) fn is_grazing(incidence: Angles) -> bool {
    incidence.direction().cos_theta().abs() < 1e-6
}

/// Sorts the readings of `slice`; `described` are the components, by their slots, that the model scatters into.
pub(crate) fn sort(slice: &Slice, selection: &Selection, described: [bool; 2]) -> Sorted {
    let mut sorted = Sorted::default();
    if is_grazing(slice.incidence) {
        sorted.left_out.insert(Reason::Incidence, slice.len());
        return sorted;
    }
    let pairs = Pairs::from_spherical(slice.incidence.direction(), &slice.theta_s, &slice.phi_s);
    let view = pairs.view(0..pairs.len());
    let ([ix, iy, iz], [x, y, z]) = (view.incidence(), view.scattered());
    let lowest = selection.max_theta_s.cos() - 1e-12;
    // Squared distance of two unit vectors that are `retro_radius` apart.
    let near = (2.0 * (0.5 * selection.retro_radius).sin()).powi(2);
    let wanted = COMPONENTS.map(|c| described[slot(c)] && selection.component.is_none_or(|s| s == c));
    let unusable = Flags::UNUSABLE | Flags::HORIZON;
    for kept in &mut sorted.kept {
        kept.reserve(slice.len());
    }
    for j in 0..slice.len() {
        let at = usize::from(z[j] <= 0.0);
        let apart = (x[j] - ix).powi(2) + (y[j] - iy).powi(2) + (z[j] - iz).powi(2);
        let ordinary = slice.dsf[j].is_finite()
            & !slice.flags[j].intersects(unusable)
            & (z[j].abs() >= lowest)
            & (apart >= near)
            & wanted[at];
        if ordinary {
            sorted.kept[at].push(j as u32);
            continue;
        }
        let reason = if !slice.dsf[j].is_finite() || !z[j].is_finite() || !x[j].is_finite() {
            Reason::NoData
        } else if let Some(reason) = Reason::of_flags(slice.flags[j]) {
            reason
        } else if z[j].abs() < lowest {
            Reason::Grazing
        } else if apart < near {
            Reason::Retro
        } else {
            sorted.others[at] += 1;
            Reason::Component
        };
        *sorted.left_out.entry(reason).or_insert(0) += 1;
    }
    sorted.pairs = Some(pairs);
    sorted
}
