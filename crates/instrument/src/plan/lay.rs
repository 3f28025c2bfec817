//! Lines over a hemisphere and over its lobes.

use std::f64::consts::TAU;

use gonio_geom::{DVec3, Direction, Side};
use rand::{Rng, RngExt};

use super::lobe::Lobe;

/// How densely a hemisphere is read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Design {
    /// Pitch away from lobes, radians, across and along rings.
    pub(super) base: f64,
    /// One a lobe.
    pub(super) lobes: Vec<Pitch>,
}

/// Pitches over a lobe in units of its widths: `peak` at its top, growing evenly to `flank` one width from it and on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pitch {
    pub(super) peak: f64,
    pub(super) flank: f64,
    /// Largest ratio of the pitches along and across a ridge, on the sphere.
    pub(super) stretch: f64,
}

impl Pitch {
    /// Pitch at a distance from the top, in widths.
    fn at(&self, distance: f64) -> f64 {
        self.peak + (self.flank - self.peak).max(0.0) * distance
    }

    /// Distance in widths at which the pitch across reaches `base`, at most the lobe's extent.
    fn end(&self, lobe: &Lobe, base: f64) -> f64 {
        let start = base / lobe.width[1] - self.peak;
        let growth = (self.flank - self.peak).max(0.0);
        if start <= 0.0 {
            0.0
        } else if growth * lobe.extent <= start {
            lobe.extent
        } else {
            start / growth
        }
    }
}

/// Limits of the readings of a hemisphere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    pub(super) side: Side,
    pub(super) theta_max: f64,
    /// The direction about which the detector shades the beam and the half angle, where it does.
    pub(super) shadow: Option<(Direction, f64)>,
}

impl Limits {
    fn hold(&self, d: Direction) -> bool {
        d.side() == self.side
            && d.cos_theta().abs() >= self.theta_max.cos()
            && self.shadow.is_none_or(|(at, half)| d.angle_to(at) > half)
    }
}

/// The directions of a design in the order they are read: rings from the pole to the horizon, then each lobe line by line, to
/// and fro. Where patterns overlap the finer one counts.
pub(super) fn directions(
    design: &Design,
    lobes: &[Lobe],
    limits: &Limits,
    rng: &mut impl Rng,
) -> Vec<Direction> {
    let ends: Vec<f64> = lobes
        .iter()
        .zip(&design.lobes)
        .map(|(l, p)| p.end(l, design.base))
        .collect();
    // Pitch on the sphere that pattern `k` has at `d`, where it reaches it.
    let pitch = |k: usize, d: Direction| {
        let distance = lobes[k].distance(d);
        (distance < ends[k]).then(|| design.lobes[k].at(distance) * lobes[k].width[1])
    };
    let mut path = Vec::new();
    rings(design.base, limits, rng, &mut path);
    path.retain(|d| limits.hold(*d) && (0..lobes.len()).all(|k| pitch(k, *d).is_none()));
    for (k, lobe) in lobes.iter().enumerate() {
        let mut own = lines(lobe, &design.lobes[k], ends[k], design.base, rng);
        own.retain(|d| {
            limits.hold(*d) && {
                let here = pitch(k, *d).unwrap_or(design.base);
                let finer = |j: usize| pitch(j, *d).is_some_and(|p| p < here || (p == here && j < k));
                !(0..lobes.len()).any(|j| j != k && finer(j))
            }
        });
        path.extend(own);
    }
    path
}

/// Rings of constant polar angle, evenly spaced by at most `pitch` in both directions, each from a random start.
fn rings(pitch: f64, limits: &Limits, rng: &mut impl Rng, path: &mut Vec<Direction>) {
    let count = (limits.theta_max / pitch).ceil().max(1.0);
    let across = limits.theta_max / count;
    for k in 0..count as usize {
        let (sin, cos) = ((k as f64 + 0.5) * across).sin_cos();
        let n = (TAU * sin / pitch).ceil().max(3.0);
        let start: f64 = rng.random_range(0.0..TAU);
        for j in 0..n as usize {
            let (s, c) = (start + TAU * j as f64 / n).sin_cos();
            path.push(Direction::from_unit(DVec3::new(
                sin * c,
                sin * s,
                cos * limits.side.sign(),
            )));
        }
    }
}

/// Lines across the longer axis of a lobe out to `end` widths, one after the other, to and fro.
fn lines(lobe: &Lobe, pitch: &Pitch, end: f64, base: f64, rng: &mut impl Rng) -> Vec<Direction> {
    let mut out = Vec::new();
    if end <= 0.0 {
        return out;
    }
    // Steps along the ridge, in units of those across it.
    let share = |at: f64| {
        let short = pitch.at(at) * lobe.width[1];
        let long = pitch.at(at) * lobe.width[0];
        (short * pitch.stretch).min(base.max(short)).min(long) / long
    };
    let phase: f64 = rng.random_range(0.0..1.0);
    let positions = steps(phase, end, |a| pitch.at(a) * share(a));
    let shift: f64 = rng.random_range(0.0..1.0);
    for (k, &a) in positions.iter().enumerate() {
        let half = (end * end - a * a).max(0.0).sqrt();
        // Neighbouring lines read half a step apart.
        let start = (shift + 0.5 * (k % 2) as f64).fract();
        let mut line: Vec<Direction> = steps(start, half, |b| pitch.at(a.hypot(b)))
            .into_iter()
            .filter_map(|b| lobe.direction(a, b))
            .collect();
        if k % 2 == 1 {
            line.reverse();
        }
        out.append(&mut line);
    }
    out
}

/// Positions from `-end` to `end` whose distance is `pitch(abs(position))`; the one next to zero lies `phase - 1/2` of a
/// pitch from it.
fn steps(phase: f64, end: f64, pitch: impl Fn(f64) -> f64) -> Vec<f64> {
    let first = (phase - 0.5) * pitch(0.0);
    let mut below = Vec::new();
    let mut x = first - pitch(first.abs());
    while x >= -end {
        below.push(x);
        x -= pitch(x.abs());
    }
    below.reverse();
    let mut x = first;
    while x <= end {
        below.push(x);
        x += pitch(x.abs());
    }
    below
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    fn limits() -> Limits {
        Limits {
            side: Side::Front,
            theta_max: 1.5,
            shadow: None,
        }
    }

    #[test]
    fn a_lobe_is_read_as_densely_as_asked_and_the_base_outside_of_it() {
        let lobe = Lobe::round(Direction::from_degrees(40.0, 180.0), 0.1, 3.0);
        let design = Design {
            base: 0.15,
            lobes: vec![Pitch {
                peak: 0.2,
                flank: 0.5,
                stretch: 6.0,
            }],
        };
        let mut rng = Pcg64::seed_from_u64(3);
        let path = directions(&design, std::slice::from_ref(&lobe), &limits(), &mut rng);
        let top = path.iter().filter(|d| lobe.distance(**d) < 0.3).count() as f64;
        // Pitch at the mean distance of .2 widths: .26.
        let expected = std::f64::consts::PI * 0.3 * 0.3 / (0.26 * 0.26);
        assert!((top / expected - 1.0).abs() < 0.35, "{top} {expected}");
        let far = path.iter().filter(|d| lobe.distance(**d) > 3.0).count() as f64;
        let omega = TAU * (1.0 - 1.5_f64.cos()) - std::f64::consts::PI * 0.09;
        assert!((far * 0.15 * 0.15 / omega - 1.0).abs() < 0.15, "{far}");
    }

    #[test]
    fn a_lobe_wider_than_the_base_pitch_needs_no_lines() {
        let lobe = Lobe::round(Direction::NORMAL, 0.8, 1.5);
        let pitch = Pitch {
            peak: 0.3,
            flank: 0.7,
            stretch: 6.0,
        };
        assert_eq!(pitch.end(&lobe, 0.15), 0.0);
    }
}
