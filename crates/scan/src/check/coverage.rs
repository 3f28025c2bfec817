//! How much of each scanned hemisphere was seen.

use std::f64::consts::{FRAC_PI_2, TAU};

use gonio_geom::{DVec3, Direction, Side};

use crate::field::even_spacing;
use crate::nearest::DirectionIndex;
use crate::verdict::graded;
use crate::{HemisphericalIntegral, Level, Slice, Verdict};

use super::name;

const ID: &str = "coverage";
const TITLE: &str = "Hemisphere covered";
/// Extrapolated percentage of a hemispherical integral that warns, and fails.
const EXTRAPOLATED: [f64; 2] = [2.0, 20.0];
/// Uncovered percentage of the projected solid angle that warns, and fails.
const UNCOVERED: [f64; 2] = [3.0, 30.0];
/// Azimuths at which the grazing gap is looked for.
const AZIMUTHS: u32 = 72;
/// Directions that probe a hemisphere, of equal projected solid angle each.
const PROBES: usize = 2000;
/// A direction within this angle of a reading is covered, radians (5 degrees), or within twice the even spacing of
/// the readings where that is wider.
const NEAR: f64 = 0.087_266_462_599_716_47;

/// One scanned hemisphere of a slice. Shares in percent.
struct Scanned {
    /// Of the hemispherical integral; `None` where there is none.
    extrapolated: Option<f64>,
    uncovered: f64,
    gap: f64,
    place: String,
}

impl Scanned {
    fn level(&self) -> Level {
        let of_integral = self
            .extrapolated
            .map_or(Level::Warn, |e| graded(e, EXTRAPOLATED[0], EXTRAPOLATED[1]));
        of_integral.max(graded(self.uncovered, UNCOVERED[0], UNCOVERED[1]))
    }

    fn value(&self) -> f64 {
        self.extrapolated.unwrap_or(self.uncovered)
    }
}

/// The worst scanned hemisphere, by the extrapolated share of its integral and by the share of the projected solid
/// angle without a reading near it; with the gap of the azimuth that was scanned least far.
pub(super) fn check(slices: &[Slice]) -> Verdict {
    let worst = slices
        .iter()
        .flat_map(|slice| Side::BOTH.map(|side| scanned(slice, side)))
        .flatten()
        .max_by(|a, b| {
            let by_value = a.value().total_cmp(&b.value());
            a.level()
                .cmp(&b.level())
                .then(by_value)
                .then(a.gap.total_cmp(&b.gap))
        });
    let Some(worst) = worst else {
        return Verdict::not_applicable(ID, TITLE, "No hemisphere was scanned with 20 readings or more.");
    };
    let level = worst.level();
    let integral = match worst.extrapolated {
        Some(e) => format!("At most {e:.1} % of a hemispherical integral is extrapolated"),
        None => "The readings cover too little of the hemisphere for an integral".to_owned(),
    };
    let mut sentence = format!(
        "{integral}, {:.1} % of the projected solid angle has no reading near it, and the azimuth scanned least far \
         ends {:.0} deg above the sample plane ({}).",
        worst.uncovered,
        worst.gap.to_degrees().ceil(),
        worst.place
    );
    if level != Level::Pass {
        sentence.push_str(match worst.extrapolated {
            Some(_) => " Extend the path there, or quote the integral with its extrapolated share.",
            None => " Scan more azimuths for DHR or DHT; single directions are not affected.",
        });
    }
    Verdict {
        id: ID,
        title: TITLE,
        level,
        value: Some(worst.value()),
        unit: "%",
        sentence,
    }
}

fn scanned(slice: &Slice, side: Side) -> Option<Scanned> {
    let points: Vec<DVec3> = (0..slice.len())
        .filter(|&j| slice.flags[j].usable() && slice.direction(j).side() == side)
        .map(|j| slice.direction(j).vec())
        .collect();
    // A hemisphere with a few stray readings of the other side's rim was not scanned.
    if points.len() < 20 || points.len() * 20 < slice.len() {
        return None;
    }
    let near = NEAR.max(2.0 * even_spacing(points.len()));
    let index = DirectionIndex::new(points.clone());
    let missed = probes(side)
        .filter(|&d| index.nearest(d.vec(), near).is_none())
        .count();
    // Of nothing there is no share.
    let share = |h: &HemisphericalIntegral| {
        let share = 100.0 * (h.extrapolated / h.value).abs();
        if share.is_finite() { share } else { 0.0 }
    };
    Some(Scanned {
        extrapolated: slice.integral(side).map(share),
        uncovered: 100.0 * missed as f64 / PROBES as f64,
        gap: widest_gap(&points, &index, near, side),
        place: format!("{}, {side} side", name(slice)),
    })
}

/// Directions of one hemisphere, cosine-distributed on a spiral.
fn probes(side: Side) -> impl Iterator<Item = Direction> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..PROBES).map(move |i| {
        let sine = ((i as f64 + 0.5) / PROBES as f64).sqrt();
        let d = Direction::from_spherical(sine.asin(), golden * i as f64);
        if side == Side::Front { d } else { d.flipped() }
    })
}

/// Angle between the sample plane and the reading met first on the way up from it, at the azimuth where that angle is
/// largest. Readings within `near` of the way are met.
fn widest_gap(points: &[DVec3], index: &DirectionIndex, near: f64, side: Side) -> f64 {
    let first = |azimuth: u32| {
        let phi = TAU * f64::from(azimuth) / f64::from(AZIMUTHS);
        (0..90).find_map(|elevation| {
            let d = Direction::from_spherical(FRAC_PI_2 - f64::from(elevation).to_radians(), phi);
            let d = if side == Side::Front { d } else { d.flipped() };
            let (j, _) = index.nearest(d.vec(), near)?;
            Some(points[j].z.abs().min(1.0).asin())
        })
    };
    (0..AZIMUTHS)
        .map(|a| first(a).unwrap_or(FRAC_PI_2))
        .fold(0.0, f64::max)
}
