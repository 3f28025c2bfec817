//! How much of each scanned hemisphere was seen.

use std::f64::consts::{FRAC_PI_2, TAU};

use gonio_geom::{DVec3, Direction, Side};

use crate::field::even_spacing;
use crate::nearest::DirectionIndex;
use crate::verdict::graded;
use crate::{Level, Slice, Verdict};

use super::name;

const ID: &str = "coverage";
const TITLE: &str = "Hemisphere covered";
/// Uncovered percentage of the projected solid angle that warns, and fails.
const WARN: f64 = 3.0;
const FAIL: f64 = 30.0;
/// Directions that probe a hemisphere, of equal projected solid angle each.
const PROBES: usize = 2000;
/// A direction within this angle of a reading is covered, radians (5 degrees), or within twice the even spacing of
/// the readings where that is wider.
const NEAR: f64 = 0.087_266_462_599_716_47;

/// Worst uncovered share of the projected solid angle, with the grazing gap and the widest hole.
pub(super) fn check(slices: &[Slice]) -> Verdict {
    let mut worst: Option<(f64, f64, String)> = None;
    for slice in slices {
        for side in Side::BOTH {
            let points: Vec<DVec3> = (0..slice.len())
                .filter(|&j| slice.flags[j].usable() && slice.direction(j).side() == side)
                .map(|j| slice.direction(j).vec())
                .collect();
            // A hemisphere with a few stray readings of the other side's rim was not scanned.
            if points.len() < 20 || points.len() * 20 < slice.len() {
                continue;
            }
            let near = NEAR.max(2.0 * even_spacing(points.len()));
            let grazing = grazing_gap(&points);
            let index = DirectionIndex::new(points);
            let missed = probes(side)
                .filter(|&d| index.nearest(d.vec(), near).is_none())
                .count();
            let share = 100.0 * missed as f64 / PROBES as f64;
            if worst.as_ref().is_none_or(|w| (share, grazing) > (w.0, w.1)) {
                worst = Some((share, grazing, format!("{}, {side} side", name(slice))));
            }
        }
    }
    let Some((value, grazing, place)) = worst else {
        return Verdict::not_applicable(ID, TITLE, "No hemisphere was scanned with 20 readings or more.");
    };
    let level = graded(value, WARN, FAIL);
    let covered = if value == 0.0 {
        "Every direction has a reading near it".to_owned()
    } else {
        format!("At most {value:.2} % of the projected solid angle has no reading near it")
    };
    let mut sentence = format!(
        "{covered}; the scan ends {:.1} deg above the sample plane or closer ({place}).",
        grazing.to_degrees()
    );
    if level != Level::Pass {
        sentence.push_str(
            " Integrals extrapolate there: extend the path, or quote them with the extrapolated share.",
        );
    }
    Verdict {
        id: ID,
        title: TITLE,
        level,
        value: Some(value),
        unit: "%",
        sentence,
    }
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

/// Angle between the sample plane and the most grazing reading, of the worst of twelve azimuth sectors that hold any.
fn grazing_gap(points: &[DVec3]) -> f64 {
    let mut reach = [None::<f64>; 12];
    for p in points {
        let sector = ((p.y.atan2(p.x).rem_euclid(TAU) / TAU * 12.0) as usize).min(11);
        let elevation = p.z.abs().min(1.0).asin();
        reach[sector] = Some(reach[sector].map_or(elevation, |e: f64| e.min(elevation)));
    }
    reach.iter().flatten().copied().fold(0.0, f64::max).min(FRAC_PI_2)
}
