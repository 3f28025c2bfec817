//! A peak of unscattered light, much narrower than what is around it: what passes between threads or is mirrored by a
//! polished coat. Its amplitude may change a hundredfold between incidences, while its shape stays; so it is taken out of the
//! readings and interpolated on its own.

use gonio_geom::DVec3;

use crate::pile::Pile;
use crate::plane::{from_plane, to_plane};
use crate::readings::Readings;
use crate::slice_surface::SliceSurface;

/// The ring about the peak whose median is its surroundings, radians.
const AROUND: (f64, f64) = (4.0 * DEGREE, 6.0 * DEGREE);

/// A narrow peak has nearly all of its light within the first of these angles, and what there is of it within the second.
const NARROW: f64 = 2.0 * DEGREE;
const WHOLE: f64 = 4.0 * DEGREE;
const CONTAINED: f64 = 0.97;

/// How far the highest reading is above the surroundings.
const ABOVE: f64 = 30.0;

/// Readings that a peak has at least.
const LEAST: usize = 30;

/// Least share of the incident light of a peak, and of incidences that show it.
const LIGHT: f64 = 1e-3;
const SHOWN: f64 = 0.25;

/// The peak ends where the readings of a ring exceed the surroundings by less than this factor; with a margin.
const ENDS: f64 = 1.5;
const RING: f64 = 0.1 * DEGREE;
const MARGIN: f64 = 1.3;

/// Readings without light about the peak: within this factor of its radius those that were read, a few beyond.
const ZEROS: f64 = 3.0;
const FAR_ZEROS: usize = 400;

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// A reading about the mirror (through) direction.
struct Near {
    angle: f64,
    bsdf: f64,
    /// Projected solid angle.
    omega: f64,
}

fn mirror(i: DVec3) -> DVec3 {
    DVec3::new(-i.x, -i.y, i.z)
}

/// Angle from the mirror direction, radians; exact when small.
fn angle(s: DVec3, mirror: DVec3) -> f64 {
    2.0 * (0.5 * (s - mirror).length()).min(1.0).asin()
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The radius that holds the narrow peaks of the piles, radians; `None` when too few of them have one.
pub(crate) fn radius(piles: &[Pile<'_>], directions: &[DVec3]) -> Option<f64> {
    let found: Vec<f64> = piles
        .iter()
        .zip(directions)
        .filter_map(|(pile, &i)| match (&pile.surfaces[..], &pile.readings[..]) {
            ([surface], [readings]) => own_radius(surface, readings, mirror(i)),
            _ => None,
        })
        .collect();
    let enough = found.len() as f64 >= SHOWN * piles.len() as f64;
    found.into_iter().reduce(f64::max).filter(|_| enough)
}

fn own_radius(surface: &SliceSurface, readings: &Readings, mirror: DVec3) -> Option<f64> {
    let omega = surface.solid_angles();
    let mut near: Vec<Near> = (0..readings.len())
        .map(|j| (from_plane(readings.points[j]), j))
        .filter(|(s, _)| angle(*s, mirror) < AROUND.1)
        .map(|(s, j)| Near {
            angle: angle(s, mirror),
            bsdf: readings.value[j],
            omega: omega[j] * s.z,
        })
        .collect();
    near.sort_unstable_by(|a, b| a.angle.total_cmp(&b.angle));
    let between = |low: f64, high: f64| near.iter().filter(move |n| n.angle >= low && n.angle < high);
    let level = median(between(AROUND.0, AROUND.1).map(|n| n.bsdf).collect())?.max(0.0);
    let light = |to: f64| -> f64 { between(0.0, to).map(|n| n.omega * (n.bsdf - level)).sum() };
    let highest = between(0.0, NARROW).map(|n| n.bsdf).fold(0.0, f64::max);
    let narrow = light(NARROW) >= CONTAINED * light(WHOLE) && light(NARROW) >= LIGHT;
    if !narrow || highest < ABOVE * level || between(0.0, NARROW).count() < LEAST {
        return None;
    }
    let mut from = 0.0;
    while from < NARROW {
        let ring = median(between(from, from + RING).map(|n| n.bsdf).collect());
        if from > 0.0 && ring.is_some_and(|r| r < ENDS * level) {
            break;
        }
        from += RING;
    }
    Some(MARGIN * (from + 0.5 * RING))
}

/// The piles without the readings within `radius` of the mirror direction, and the same incidences with nothing but these,
/// among zeros. `None` when a surface is left with too few.
pub(crate) fn split<'a>(
    piles: &[Pile<'a>],
    directions: &[DVec3],
    radius: f64,
) -> Option<(Vec<Pile<'a>>, Vec<Pile<'a>>)> {
    let golden = std::f64::consts::PI * (1.0 + 5f64.sqrt());
    let (mut rest, mut within) = (Vec::new(), Vec::new());
    for (pile, &i) in piles.iter().zip(directions) {
        let ([readings], m) = (&pile.readings[..], mirror(i)) else {
            return None;
        };
        let (mut outer, mut inner) = (Readings::default(), Readings::default());
        for j in 0..readings.len() {
            let p = readings.points[j];
            let apart = angle(from_plane(p), m);
            if apart < radius {
                inner.push(p, readings.value[j], readings.sigma[j]);
            } else {
                outer.push(p, readings.value[j], readings.sigma[j]);
                if apart < ZEROS * radius {
                    inner.push(p, 0.0, 0.0);
                }
            }
        }
        for k in 0..FAR_ZEROS {
            let z = 0.02 + 0.98 * (k as f64 + 0.5) / FAR_ZEROS as f64;
            let (s, c) = (golden * k as f64).sin_cos();
            let r = (1.0 - z * z).sqrt();
            let d = DVec3::new(r * c, r * s, z);
            if angle(d, m) > ZEROS * radius {
                inner.push(to_plane(d), 0.0, 0.0);
            }
        }
        rest.push(pile.with(outer)?);
        within.push(pile.with(inner)?);
    }
    Some((rest, within))
}

/// The readings of the second piles of [`split`] less what the `rest` says there.
pub(crate) fn above<'a>(
    piles: Vec<Pile<'a>>,
    rest: impl Iterator<Item = impl Fn(DVec3) -> f64>,
) -> Vec<Pile<'a>> {
    piles
        .into_iter()
        .zip(rest)
        .map(|(mut pile, rest)| {
            for readings in &mut pile.readings {
                for j in 0..readings.len() {
                    // Zeros were put there.
                    if readings.sigma[j] > 0.0 || readings.value[j] != 0.0 {
                        readings.value[j] -= rest(from_plane(readings.points[j]));
                    }
                }
            }
            pile
        })
        .collect()
}
