//! Finding the lobes of a slice: from the highest point moments under a Gaussian window that follows them.

use gonio_geom::DVec3;
use rayon::prelude::*;

use super::{Lobe, Symmetric};

/// Points of the hemisphere, evenly spread over projected solid angle.
const POINTS: usize = 9000;

/// Most lobes of a slice.
const MOST: usize = 3;

/// A lobe lower than this fraction of the highest one is not followed.
const LOWEST: f64 = 0.04;

/// Standard deviation of the first window, and the least and largest of a lobe; direction cosines.
const WINDOW: f64 = 0.05;
const NARROWEST: f64 = 4.5e-3;
const WIDEST: f64 = 0.15;

/// Steps of the window.
const STEPS: usize = 25;

/// A lobe takes what lies within this many standard deviations of it away from the next ones.
const REACH: f64 = 4.0;

/// The lobes of the BSDF `value` over a diffuse `level`, highest first.
pub(crate) fn find(value: impl Fn(DVec3) -> f64 + Sync, level: f64) -> Vec<Lobe> {
    let golden = std::f64::consts::PI * (1.0 + 5f64.sqrt());
    let points: Vec<[f64; 2]> = (0..POINTS)
        .map(|k| {
            let r = ((k as f64 + 0.5) / POINTS as f64 * 0.9993).sqrt();
            let (s, c) = (golden * k as f64).sin_cos();
            [r * c, r * s]
        })
        .collect();
    let mut rest: Vec<f64> = points
        .par_iter()
        .map(|p| {
            let z = (1.0 - p[0] * p[0] - p[1] * p[1]).max(0.0).sqrt();
            (value(DVec3::new(p[0], p[1], z)) - level).max(0.0)
        })
        .collect();
    let mut found: Vec<Lobe> = Vec::new();
    while found.len() < MOST {
        let Some(top) = (0..POINTS).max_by(|&a, &b| rest[a].total_cmp(&rest[b])) else {
            break;
        };
        let highest = found.first().map_or(0.0, |l| l.height);
        if rest[top] <= 0.0 || rest[top] < LOWEST * highest {
            break;
        }
        let lobe = follow(&points, &rest, points[top]);
        for (p, r) in points.iter().zip(&mut rest) {
            let d = [p[0] - lobe.centre[0], p[1] - lobe.centre[1]];
            if lobe.covariance.inverse_form(d) < REACH * REACH {
                *r = 0.0;
            }
        }
        // The point itself goes too, so that a spike cannot be found again.
        rest[top] = 0.0;
        found.push(lobe);
    }
    found
}

/// The lobe about `start`: under a Gaussian window of its own covariance a Gaussian has half of it.
fn follow(points: &[[f64; 2]], rest: &[f64], start: [f64; 2]) -> Lobe {
    let mut lobe = Lobe {
        centre: start,
        covariance: Symmetric::diagonal(WINDOW * WINDOW),
        height: 1.0,
    };
    for _ in 0..STEPS {
        let (mut sum, mut x, mut y) = (0.0, 0.0, 0.0);
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for (p, r) in points.iter().zip(rest) {
            let g = if *r > 0.0 { lobe.value(*p) * r } else { 0.0 };
            if g > 0.0 {
                let d = [p[0] - lobe.centre[0], p[1] - lobe.centre[1]];
                sum += g;
                x += g * d[0];
                y += g * d[1];
                xx += g * d[0] * d[0];
                xy += g * d[0] * d[1];
                yy += g * d[1] * d[1];
            }
        }
        if sum <= 0.0 {
            break;
        }
        (x, y) = (x / sum, y / sum);
        lobe.centre = [lobe.centre[0] + x, lobe.centre[1] + y];
        lobe.covariance = Symmetric {
            xx: 2.0 * (xx / sum - x * x) + 1e-6,
            xy: 2.0 * (xy / sum - x * y),
            yy: 2.0 * (yy / sum - y * y) + 1e-6,
        }
        .clamped(NARROWEST * NARROWEST, WIDEST * WIDEST);
    }
    let (mut top, mut bottom) = (0.0, 0.0);
    for (p, r) in points.iter().zip(rest) {
        let g = lobe.value(*p);
        top += g * r;
        bottom += g * g;
    }
    lobe.height = if bottom > 0.0 { top / bottom } else { 0.0 };
    lobe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_lobes_come_back_with_centre_width_and_height() {
        let truth = [
            Lobe {
                centre: [0.3, 0.1],
                covariance: Symmetric {
                    xx: 0.0025,
                    xy: 0.0005,
                    yy: 0.0016,
                },
                height: 5.0,
            },
            Lobe {
                centre: [-0.4, -0.2],
                covariance: Symmetric::diagonal(0.0036),
                height: 2.0,
            },
        ];
        let level = 0.1;
        let value = |s: DVec3| level + truth.iter().map(|l| l.value([s.x, s.y])).sum::<f64>();
        let found = find(value, level);
        assert_eq!(found.len(), 2);
        for (a, b) in found.iter().zip(&truth) {
            assert!((a.centre[0] - b.centre[0]).hypot(a.centre[1] - b.centre[1]) < 0.002);
            assert!((a.height / b.height - 1.0).abs() < 0.03, "{}", a.height);
            assert!((a.covariance.xx / b.covariance.xx - 1.0).abs() < 0.05);
            assert!((a.mass() / b.mass() - 1.0).abs() < 0.05);
        }
    }
}
