//! The symmetry of the sample, found from the data.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::field::Field;
use crate::{Level, Slice, Verdict};
use gonio_geom::Angles;

use super::{NORMAL, channels, incidences, main_azimuth, one_azimuth};

const ID: &str = "symmetry";
const TITLE: &str = "Symmetry of the sample";
/// Mean relative difference (percent) up to which a symmetry holds, beyond what noise explains.
const LIMIT: f64 = 3.0;
/// Readings of a slice that are compared, at most.
const READINGS: usize = 4000;
/// Angles of incidence and azimuths that count as equal, radians.
const SAME: f64 = 5e-3;

/// A mean relative difference in percent with the part that noise explains.
#[derive(Clone, Copy)]
struct Score {
    difference: f64,
    noise: f64,
}

impl Score {
    fn holds(&self) -> bool {
        self.difference <= LIMIT.max(1.5 * self.noise)
    }
}

/// Names the highest symmetry the data show: rotation about the normal (isotropic), mirror planes through x and y
/// (quadrilateral), one of them (bilateral), or none. Mirror planes are tested on slices that the plane maps onto
/// one another, rotation on slices of one polar angle at other azimuths and on normal incidence.
pub(super) fn check(slices: &[Slice], aligned: bool) -> Verdict {
    let Some(&channel) = channels(slices).first() else {
        return Verdict::not_applicable(ID, TITLE, "No slice.");
    };
    let of: Vec<&Slice> = slices
        .iter()
        .filter(|s| s.channel == channel && s.len() >= 20)
        .collect();
    let fields: Vec<Field<'_>> = of.iter().map(|s| Field::new(s)).collect();
    let score = |map: &dyn Fn(Angles) -> Angles| worst(&of, &fields, map);
    let turned = |by: f64| move |a: Angles| Angles::canonical(a.theta, a.phi + by);
    let mut rotation: Option<Score> = None;
    let at = incidences(of.iter().copied());
    let main = main_azimuth(&at);
    let mut turns: Vec<f64> = [FRAC_PI_2, 0.25 * PI].to_vec();
    turns.extend(at.iter().filter(|a| a.theta > NORMAL).map(|a| a.phi - main));
    for by in turns.into_iter().filter(|by| by.abs() > SAME) {
        rotation = worse(rotation, score(&turned(by)));
    }
    let plane = score(&|a| Angles::canonical(a.theta, 2.0 * main - a.phi));
    let mirror_x = score(&|a| Angles::canonical(a.theta, -a.phi));
    let mirror_y = score(&|a| Angles::canonical(a.theta, PI - a.phi));
    let several = !one_azimuth(&at);
    let holds = |s: &Option<Score>| s.as_ref().is_some_and(Score::holds);
    let (level, value, what) = if holds(&rotation) && holds(&plane) {
        let value = worse(rotation, plane);
        let what = if several {
            "The sample is isotropic: rotation about the normal changes nothing"
        } else {
            "The sample is isotropic as far as one azimuth of incidence can tell: symmetric about the plane of \
             incidence, and under rotation at normal incidence"
        };
        (Level::Pass, value, what)
    } else if holds(&plane) && !several {
        (
            Level::Pass,
            plane,
            "The sample is symmetric about the plane of incidence; other azimuths of incidence would tell an isotropic \
             sample from one with a single mirror plane",
        )
    } else if holds(&mirror_x) && holds(&mirror_y) {
        (
            Level::Pass,
            worse(mirror_x, mirror_y),
            "The sample is quadrilateral: mirror planes through x and y",
        )
    } else if let Some(score) = [mirror_x, mirror_y, plane].into_iter().find(holds) {
        (Level::Pass, score, "The sample is bilateral: one mirror plane")
    } else if plane.is_none() && mirror_x.is_none() && rotation.is_none() {
        return Verdict::not_applicable(
            ID,
            TITLE,
            "No two directions to compare: scan both sides of the plane of incidence.",
        );
    } else {
        let best = [rotation, plane, mirror_x, mirror_y]
            .into_iter()
            .flatten()
            .filter(|s| !s.holds())
            .min_by(|a, b| a.difference.total_cmp(&b.difference));
        (
            Level::Warn,
            best,
            if aligned {
                "No symmetry found although the tilt was corrected: measure more azimuths of incidence and export rank 4"
            } else {
                "No symmetry found: a tilted sample shows up like this (process it with --align), else measure more \
                 azimuths of incidence and export rank 4"
            },
        )
    };
    let value = value.map(|s| s.difference);
    Verdict {
        id: ID,
        title: TITLE,
        level,
        value,
        unit: if value.is_some() { "%" } else { "" },
        sentence: format!(
            "{what}{}.",
            value.map_or(String::new(), |v| format!(" (mean difference {v:.1} %)"))
        ),
    }
}

fn worse(a: Option<Score>, b: Option<Score>) -> Option<Score> {
    match (a, b) {
        (Some(x), Some(y)) => Some(if x.difference > y.difference { x } else { y }),
        (x, y) => x.or(y),
    }
}

/// The worst score over the slices whose incidence `map` sends to that of a measured slice; `None` without any.
fn worst(slices: &[&Slice], fields: &[Field<'_>], map: &dyn Fn(Angles) -> Angles) -> Option<Score> {
    let mut out = None;
    for s in slices {
        let image = map(s.incidence).direction();
        let partner = slices
            .iter()
            .position(|t| t.incidence.direction().angle_to(image) < SAME);
        let Some(partner) = partner else { continue };
        let same = std::ptr::eq(*s, slices[partner]);
        out = worse(out, compare(s, &fields[partner], same, map));
    }
    out
}

/// `sum |f - f'| Omega_perp / sum f Omega_perp` of a slice and its image, in percent.
///
/// Where the image is of the slice itself (`same`), readings that map onto themselves tell nothing and are left out.
fn compare(slice: &Slice, image: &Field<'_>, same: bool, map: &dyn Fn(Angles) -> Angles) -> Option<Score> {
    let (mut difference, mut noise, mut sum, mut n) = (0.0, 0.0, 0.0, 0);
    for j in (0..slice.len()).step_by((slice.len() / READINGS).max(1)) {
        if !slice.flags[j].usable() {
            continue;
        }
        let to = map(Angles {
            theta: slice.theta_s[j],
            phi: slice.phi_s[j],
        });
        if same && to.direction().angle_to(slice.direction(j)) < SAME {
            continue;
        }
        let Some(other) = image.at(to.direction()) else {
            continue;
        };
        let cos = slice.theta_s[j].cos().abs();
        let (d, e) = (slice.dsf[j], other.f * cos);
        difference += (d - e).abs() * slice.omega[j];
        // The mean absolute value of a normal variable is 0.8 standard deviations.
        noise += 0.8 * slice.u_independent(j).hypot(other.u() * cos) * slice.omega[j];
        sum += 0.5 * (d + e) * slice.omega[j];
        n += 1;
    }
    (n >= 10 && sum > 0.0).then(|| Score {
        difference: 100.0 * difference / sum,
        noise: 100.0 * noise / sum,
    })
}
