//! The error a model states at any incidence: that of its slices, and that of interpolating between them.
//!
//! The first comes from readings held out of the slices, the second from incidences left out of the model. An
//! incidence left out stands in a gap twice as wide as those of the model. Real materials may have kinks: where there are enough
//! incidences of an isotropic sample, gaps twice as wide again tell how errors fall with the gap. No incidence can be left out in
//! the middle of its last gap, where errors grow fastest: at least half that of extrapolating from its inner end is stated there.
//! On smooth materials linear interpolation errs with the square of the gap, limited cubics and local quadratics with about its
//! cube, extrapolation with the distance over the cosine.

use gonio_geom::DVec3;
use rayon::prelude::*;

use crate::across::{Candidate, Order};
use crate::hold_out::SliceError;
use crate::images::Symmetry;
use crate::incidence::SAME_INCIDENCE;
use crate::layout::Layout;
use crate::leave_one_out::{Fold, Held, LooError};
use crate::slice_surface::Coverage;

/// Exponent of the squared spread that errors go with.
const LINEAR: f64 = 1.0;
const HIGHER: f64 = 1.5;

/// Least exponent, that of errors in proportion to the gap; taken for isotropic samples whose incidences are too few to
/// tell.
const LEAST_POWER: f64 = 0.5;

/// Share of the error of extrapolation that is stated in the middle of the last gap, at least.
const LAST_GAP: f64 = 0.5;

/// Least share of the error of an incidence left out that is put down to interpolation, however large the errors of the
/// slices are.
const LEAST_SHARE: f64 = 0.3;

/// Distance below which errors of incidences left out count alike, radians.
const NEAR: f64 = 0.02;

/// Cosine below which incidences count alike.
const LEAST_COSINE: f64 = 0.02;

/// What a model states about its error at one incidence; relative L1 of the DSF, `sum w |f' - f| / sum w f`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatedError {
    /// Noise and interpolation between the readings of the slices, and how far repeats of one incidence differ beyond their noise.
    pub slice: f64,
    /// Interpolation between incidences, or extrapolation; `None` where no incidence could be left out to tell.
    pub incidence: Option<f64>,
    /// How the incidence is known: measured, between measured ones, or beyond them.
    pub coverage: Coverage,
    /// Share of the scattered light that goes where no readings stand: past the last of them towards the horizon, into holes. Its
    /// error is not known, and not in the others.
    pub extrapolated: f64,
}

impl StatedError {
    /// Both together; the slice part alone where the other is not known.
    pub fn total(&self) -> f64 {
        self.slice.hypot(self.incidence.unwrap_or(0.0))
    }
}

/// The errors of one side and component.
#[derive(Clone, Debug)]
pub(crate) struct PartErrors {
    /// Relative to the light of each incidence; those of a peak in units of the incident light.
    slices: Vec<SliceError>,
    /// Share of the incident light of each incidence.
    light: Vec<f64>,
    /// The same of what goes where no readings stand.
    outside: Vec<f64>,
    /// The errors of a peak that is added.
    peak: Option<Box<PartErrors>>,
    power: f64,
    /// Incidence left out, and error of interpolation over the power of the spread.
    within: Vec<(DVec3, f64)>,
    /// Error of extrapolation over its [`distance`].
    beyond: Option<f64>,
    /// The last two polar angles of an isotropic sample, radians.
    last_gap: Option<[f64; 2]>,
}

impl PartErrors {
    /// From the errors of the slices and of the folds, `within` those of interior incidences by `candidate`, `wider` those
    /// in gaps twice as wide; with the
    /// units of relative errors, the share of light of every incidence, and whether the units are that share (`absolute`).
    pub(crate) fn new(
        all: &[Held],
        slices: Vec<SliceError>,
        symmetry: Symmetry,
        candidate: Candidate,
        folds: &[Fold],
        (units, light, absolute): (&[f64], Vec<f64>, bool),
        (within, wider, beyond): (&[LooError], &[(Fold, LooError)], &[LooError]),
    ) -> Self {
        // The amplitude of a peak changes by decades within a gap: no power of the gap goes with that.
        let most = if candidate.order == Order::Linear || absolute {
            LINEAR
        } else {
            HIGHER
        };
        let slices: Vec<SliceError> = slices.iter().zip(units).map(|(e, u)| e.times(*u)).collect();
        // What the incidences between add to the errors of the slices.
        let added = |fold: &Fold, error: &LooError| {
            let directions: Vec<DVec3> = fold.kept.iter().map(|&k| all[k].node.direction).collect();
            let kept: Vec<SliceError> = fold.kept.iter().map(|&k| slices[k]).collect();
            let layout = Layout::new(&directions, symmetry);
            let i = all[fold.left_out].node.direction;
            let known = slice_part(&layout, &kept, i).hypot(slices[fold.left_out].total());
            let own = error.rel_l1_smooth * units[fold.left_out];
            let own = (own * own - known * known)
                .max((LEAST_SHARE * own).powi(2))
                .sqrt();
            (own, layout, i)
        };
        let interior = || folds.iter().filter(|f| !f.beyond).zip(within);
        let mut powers: Vec<f64> = wider
            .iter()
            .filter_map(|(fold, error)| {
                let (narrow, found) = interior().find(|(f, _)| f.left_out == fold.left_out)?;
                let ((far, wide, i), (near, close, _)) = (added(fold, error), added(narrow, found));
                let spreads = wide.spread(i) / close.spread(i);
                Some((far / near.max(f64::MIN_POSITIVE)).ln() / spreads.ln())
            })
            .filter(|p| p.is_finite())
            .collect();
        powers.sort_unstable_by(f64::total_cmp);
        let power = match powers.get(powers.len() / 2) {
            _ if absolute => most,
            Some(p) => p.clamp(LEAST_POWER, most),
            None if symmetry.is_isotropic() => LEAST_POWER,
            None => most,
        };
        let inside = interior()
            .map(|(fold, error)| {
                let (own, layout, i) = added(fold, error);
                (i, own / gap(&layout, i, power).max(gap_of(NEAR * NEAR, power)))
            })
            .collect();
        let past = folds
            .iter()
            .filter(|f| f.beyond)
            .zip(beyond)
            .map(|(fold, error)| {
                let (own, layout, i) = added(fold, error);
                own / distance(&layout, i).max(NEAR)
            });
        let beyond = past.reduce(f64::max);
        let last_gap = symmetry.is_isotropic().then(|| {
            let mut thetas = all.iter().map(|h| polar(h.node.direction));
            let last = thetas.next_back();
            Some([thetas.next_back()?, last?])
        });
        let outside = if absolute {
            vec![0.0; all.len()]
        } else {
            all.par_iter().map(|h| h.node.extrapolated_light()).collect()
        };
        PartErrors {
            slices,
            light,
            outside,
            peak: None,
            power,
            within: inside,
            beyond,
            last_gap: last_gap.flatten(),
        }
    }

    /// Error of the slices around `i` between their readings alone; relative L1.
    pub(crate) fn gap(&self, layout: &Layout, i: DVec3) -> f64 {
        let (i, _) = layout.frame(i, DVec3::Z);
        let near = layout.near(i);
        near.iter().map(|k| k.weight * self.slices[k.node].gap).sum()
    }

    /// Share of the incident light of each incidence.
    pub(crate) fn light(&self) -> &[f64] {
        &self.light
    }

    /// Adds those of a peak.
    pub(crate) fn add_peak(&mut self, peak: PartErrors) {
        self.peak = Some(Box::new(peak));
    }

    /// The error at local incidence `i` of a model whose incidences lie as `layout` says.
    pub(crate) fn at(&self, layout: &Layout, i: DVec3) -> StatedError {
        let rest = self.own(layout, i);
        let Some(peak) = &self.peak else { return rest };
        let (i, _) = layout.frame(i, DVec3::Z);
        let light = |of: &PartErrors| -> f64 {
            let near = layout.near(i);
            near.iter()
                .map(|k| k.weight * of.light[k.node])
                .sum::<f64>()
                .max(f64::MIN_POSITIVE)
        };
        let (main, narrow) = (light(self), peak.own(layout, i));
        let all = main + light(peak);
        let both = |a: f64, b: f64| (a * main).hypot(b) / all;
        StatedError {
            extrapolated: rest.extrapolated * main / all,
            coverage: rest.coverage,
            slice: both(rest.slice, narrow.slice),
            incidence: match (rest.incidence, narrow.incidence) {
                (Some(a), Some(b)) => Some(both(a, b)),
                _ => None,
            },
        }
    }

    /// [`PartErrors::at`] without the peak.
    fn own(&self, layout: &Layout, i: DVec3) -> StatedError {
        let (i, _) = layout.frame(i, DVec3::Z);
        let past = distance(layout, i);
        let incidence = if past > 0.0 {
            self.beyond.map(|b| b * past)
        } else {
            let (mut sum, mut total) = (0.0, 0.0);
            for (at, coefficient) in &self.within {
                let apart = at.dot(i).clamp(-1.0, 1.0).acos();
                let weight = 1.0 / (apart * apart + NEAR * NEAR);
                sum += weight * coefficient;
                total += weight;
            }
            let least = self.in_last_gap(i);
            (total > 0.0).then(|| (sum / total * gap(layout, i, self.power)).max(least))
        };
        let near = layout.near(i);
        let mean = |of: &[f64]| -> f64 { near.iter().map(|k| k.weight * of[k.node]).sum() };
        let (outside, light) = (mean(&self.outside), mean(&self.light));
        StatedError {
            slice: slice_part(layout, &self.slices, i),
            incidence,
            coverage: if layout.distance(i) <= SAME_INCIDENCE {
                Coverage::Measured
            } else if near.inside {
                Coverage::Interpolated
            } else {
                Coverage::Extrapolated
            },
            extrapolated: outside / (outside + light).max(f64::MIN_POSITIVE),
        }
    }
}

/// The power of the square distance of `i` to its neighbours that errors go with. What a local quadratic leaves changes
/// with the cosine of incidence to that power too.
fn gap(layout: &Layout, i: DVec3, power: f64) -> f64 {
    let gap = gap_of(layout.spread(i), power);
    if layout.placed().is_empty() || power == LINEAR {
        return gap;
    }
    gap / i.z.max(LEAST_COSINE).powf(power)
}

fn gap_of(spread: f64, power: f64) -> f64 {
    spread.max(0.0).powf(power)
}

impl PartErrors {
    /// Least error between the last two incidences of an isotropic sample; 0 at both and elsewhere.
    fn in_last_gap(&self, i: DVec3) -> f64 {
        let (Some([low, high]), Some(beyond)) = (self.last_gap, self.beyond) else {
            return 0.0;
        };
        let theta = polar(i);
        if theta <= low || theta >= high {
            return 0.0;
        }
        let t = (theta - low) / (high - low);
        let extrapolated = beyond * (theta - low) / i.z.max(LEAST_COSINE);
        LAST_GAP * 4.0 * t * (1.0 - t) * extrapolated
    }
}

/// Polar angle of a local direction, radians.
fn polar(v: DVec3) -> f64 {
    v.x.hypot(v.y).atan2(v.z)
}

/// How far `i` lies past the measured incidences. Towards grazing incidence scattering changes with the cosine: a step from
/// 70 to 80 degrees counts as much as one from 80 to 85.
fn distance(layout: &Layout, i: DVec3) -> f64 {
    layout.past(i) / i.z.max(LEAST_COSINE)
}

/// Error of the slices around `i`: their noise is independent, gaps between readings err alike, and other samples differ alike.
fn slice_part(layout: &Layout, slices: &[SliceError], i: DVec3) -> f64 {
    let (mut noise, mut gap, mut repeats) = (0.0, 0.0, 0.0);
    for k in layout.near(i).iter() {
        noise += (k.weight * slices[k.node].noise).powi(2);
        gap += k.weight * slices[k.node].gap;
        repeats += k.weight * slices[k.node].repeats;
    }
    noise.sqrt().hypot(gap).hypot(repeats)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_geom::Direction;

    #[test]
    fn the_error_vanishes_at_measured_incidences_and_grows_between_and_beyond_them() {
        let at = |t: f64| Direction::from_degrees(t, 180.0).vec();
        let layout = Layout::new(&[at(10.0), at(30.0), at(50.0)], Symmetry::Isotropic);
        let slice = SliceError {
            noise: 0.01,
            gap: 0.0,
            repeats: 0.0,
        };
        let errors = PartErrors {
            slices: vec![slice; 3],
            light: vec![0.9; 3],
            outside: vec![0.1; 3],
            peak: None,
            power: LINEAR,
            within: vec![(at(30.0), 0.5)],
            beyond: Some(0.2),
            last_gap: Some([30f64.to_radians(), 50f64.to_radians()]),
        };
        let stated = |t: f64| errors.at(&layout, at(t));
        assert!(stated(30.0).incidence.unwrap() < 1e-12 && (stated(30.0).slice - 0.01).abs() < 1e-12);
        assert_eq!(stated(30.0).coverage, Coverage::Measured);
        assert_eq!(stated(20.0).coverage, Coverage::Interpolated);
        assert_eq!(stated(60.0).coverage, Coverage::Extrapolated);
        assert!((stated(20.0).extrapolated - 0.1).abs() < 1e-12);
        let middle = stated(20.0);
        assert!((middle.incidence.unwrap() - 0.5 * 10f64.to_radians().powi(2)).abs() < 1e-9);
        let half_extrapolated = 0.5 * 0.2 * 10f64.to_radians() / 40f64.to_radians().cos();
        assert!(
            (stated(40.0).incidence.unwrap() - half_extrapolated).abs() < 1e-9,
            "last gap"
        );
        assert!(
            (middle.slice - 0.01 / 2f64.sqrt()).abs() < 1e-12,
            "independent noise averages"
        );
        let past = 10f64.to_radians() / 60f64.to_radians().cos();
        assert!((stated(60.0).incidence.unwrap() - 0.2 * past).abs() < 1e-9);
    }
}
