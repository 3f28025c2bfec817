//! Cubic interpolation over the polar angle of incidence, limited so that it invents no extremum.
//!
//! Between two incidences the cubic through both values has the slopes of [FritschButland1984]: the weighted harmonic
//! mean of the secants on both sides, 0 where these disagree in sign. So every value lies between those of the two
//! incidences, and noise is not amplified.

use crate::images::Image;
use crate::layout::{NORMAL, Neighbour};

/// A measured incidence on the axis of polar angles; those seen from the other side of the normal are negative.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Knot {
    pub(crate) node: Neighbour,
    pub(crate) theta: f64,
}

/// The incidences around a query: the two it lies between, and the next ones on either side where there are any.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stencil {
    pub(crate) before: Option<Knot>,
    pub(crate) between: [Knot; 2],
    pub(crate) after: Option<Knot>,
}

impl Stencil {
    /// The stencil of polar angle `theta` (radians) in ascending `thetas`; `None` past the last one, or when there is
    /// no incidence but the two.
    pub(crate) fn new(thetas: &[f64], theta: f64) -> Option<Self> {
        let straight = |k: usize| {
            thetas.get(k).map(|&theta| Knot {
                node: Neighbour::whole(k, Image::SAME),
                theta,
            })
        };
        // knot number m of those on the other side of the normal, outwards
        let first = usize::from(*thetas.first()? < NORMAL);
        let turned = |m: usize| {
            thetas.get(first + m).map(|&theta| Knot {
                node: Neighbour::whole(first + m, Image::HALF_TURN),
                theta: -theta,
            })
        };
        let above = thetas.partition_point(|t| *t <= theta);
        let (before, low) = match above {
            0 => (turned(1), turned(0)?),
            1 => (turned(0), straight(0)?),
            k => (straight(k - 2), straight(k - 1)?),
        };
        let (high, after) = (straight(above)?, straight(above + 1));
        (before.is_some() || after.is_some()).then_some(Stencil {
            before,
            between: [low, high],
            after,
        })
    }

    /// The value at polar angle `theta` from those at the knots, in the order before (if any), between, after (if any).
    pub(crate) fn interpolate(
        &self,
        theta: f64,
        before: Option<f64>,
        between: [f64; 2],
        after: Option<f64>,
    ) -> f64 {
        let [low, high] = self.between;
        let width = high.theta - low.theta;
        let secant = (between[1] - between[0]) / width;
        let outer = |knot: Option<Knot>, value: Option<f64>, end: Knot, at: f64| {
            let (knot, value) = (knot?, value?);
            let apart = knot.theta - end.theta;
            Some((apart.abs(), (value - at) / apart))
        };
        let left = outer(self.before, before, low, between[0]);
        let right = outer(self.after, after, high, between[1]);
        let here = (width, secant);
        let a = left.map_or_else(|| end_slope(here, right), |l| inner_slope(l, here));
        let b = right.map_or_else(|| end_slope(here, left), |r| inner_slope(r, here));
        let t = (theta - low.theta) / width;
        let u = 1.0 - t;
        let line = u * between[0] + t * between[1];
        line + t * u * width * (u * (a - secant) - t * (b - secant))
    }
}

/// Slope at a knot between two intervals, each (width, secant).
fn inner_slope((h0, d0): (f64, f64), (h1, d1): (f64, f64)) -> f64 {
    if d0 * d1 <= 0.0 {
        return 0.0;
    }
    let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
    (w0 + w1) / (w0 / d0 + w1 / d1)
}

/// Slope at an end knot: of the parabola through three values, limited to keep the curve monotone.
fn end_slope((h, d): (f64, f64), next: Option<(f64, f64)>) -> f64 {
    let Some((h1, d1)) = next else { return d };
    let slope = ((2.0 * h + h1) * d - h * d1) / (h + h1);
    if slope * d <= 0.0 {
        0.0
    } else if d * d1 <= 0.0 && slope.abs() > 3.0 * d.abs() {
        3.0 * d
    } else {
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const THETAS: [f64; 4] = [0.2, 0.5, 0.7, 1.2];

    fn along(thetas: &[f64], theta: f64, value: impl Fn(f64) -> f64) -> f64 {
        let s = Stencil::new(thetas, theta).unwrap();
        let at = |k: Knot| value(k.theta);
        s.interpolate(theta, s.before.map(at), s.between.map(at), s.after.map(at))
    }

    #[test]
    fn the_stencil_continues_on_the_other_side_of_the_normal() {
        let about = |thetas: &[f64], theta| {
            let s = Stencil::new(thetas, theta).unwrap();
            let knots = [s.before, Some(s.between[0]), Some(s.between[1]), s.after];
            knots.map(|k| k.map(|k| (k.node.node, k.node.image == Image::HALF_TURN, k.theta)))
        };
        let (t0, t1, t2) = (THETAS[0], THETAS[1], THETAS[2]);
        let below = [(1, true, -t1), (0, true, -t0), (0, false, t0), (1, false, t1)];
        assert_eq!(about(&THETAS, 0.1), below.map(Some));
        let first = [(0, true, -t0), (0, false, t0), (1, false, t1), (2, false, t2)];
        assert_eq!(about(&THETAS, 0.3), first.map(Some));
        let normal = [(1, true, -0.4), (0, false, 0.0), (1, false, 0.4), (2, false, 0.9)];
        assert_eq!(about(&[0.0, 0.4, 0.9], 0.1), normal.map(Some));
        assert!(
            about(&THETAS, 0.9)[3].is_none(),
            "nothing past the last incidence"
        );
        assert!(Stencil::new(&THETAS, 1.2).is_none() && Stencil::new(&[0.3], 0.1).is_none());
    }

    #[test]
    fn measured_incidences_come_back_and_straight_lines_stay_straight() {
        for theta in [0.01, 0.2, 0.3, 0.5, 0.6, 0.7, 1.0, 1.19] {
            assert!((along(&THETAS, theta, |t| 3.0 - 2.0 * t) - (3.0 - 2.0 * theta)).abs() < 1e-12);
        }
        let wave = |t: f64| (5.0 * t).sin();
        for theta in &THETAS[..3] {
            assert!((along(&THETAS, *theta, wave) - wave(*theta)).abs() < 1e-12);
            assert!((along(&THETAS, *theta - 1e-9, wave) - wave(*theta)).abs() < 1e-7);
        }
    }

    #[test]
    fn a_rise_towards_grazing_is_followed_better_than_by_a_line() {
        let rise = |t: f64| 1.0 + t * t * t;
        let grid: Vec<f64> = (0..6).map(|k| 0.25 * f64::from(k)).collect();
        for k in 1..4 {
            let theta = grid[k] + 0.125;
            let line = 0.5 * (rise(grid[k]) + rise(grid[k + 1]));
            let apart = (along(&grid, theta, rise) - rise(theta)).abs();
            assert!(apart < 0.25 * (line - rise(theta)).abs(), "{theta}: {apart}");
        }
    }

    #[test]
    fn no_value_leaves_the_range_of_the_two_incidences_it_lies_between() {
        // a lobe that passes by: every kind of kink, and values next to 0
        for phase in 0..40 {
            let spike = |t: f64| (-((t - 0.03 * f64::from(phase)) / 0.1).powi(2)).exp() + 1e-6;
            for step in 0..240 {
                let theta = 0.005 * f64::from(step);
                let s = Stencil::new(&THETAS, theta).unwrap();
                let [a, b] = s.between.map(|k| spike(k.theta));
                let value = along(&THETAS, theta, spike);
                assert!(
                    value >= a.min(b) - 1e-12 && value <= a.max(b) + 1e-12,
                    "{phase} {theta}"
                );
            }
        }
    }
}
