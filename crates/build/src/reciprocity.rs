//! Whether the slices agree with one another under exchange of source and receiver, and prediction past the measured
//! incidences by it: light from a grazing direction into a steep one is light from the steep direction into the grazing
//! one, which was read \[Nicodemus1977\].

use std::f64::consts::TAU;

use gonio_geom::DVec3;

use crate::node::Node;

/// Relative L1 difference of exchanged readings up to which a sample counts as reciprocal.
pub(crate) const RECIPROCAL: f64 = 0.05;

/// Angle past the measured incidences from which exchange outweighs the parametric base: 2 degrees.
const REACH: f64 = 2.0 * std::f64::consts::PI / 180.0;

/// Relative azimuths at which isotropic slices are compared.
const AZIMUTHS: usize = 36;

/// Relative L1 difference of exchanged values, over all pairs of incidences whose exchange both slices hold, weighted by
/// the light they stand for; `None` when there is no such pair.
pub(crate) fn score(nodes: &[&Node], isotropic: bool) -> Option<f64> {
    let (mut apart, mut size) = (0.0, 0.0);
    for (n, a) in nodes.iter().enumerate() {
        for b in &nodes[n + 1..] {
            let azimuths = if isotropic { AZIMUTHS } else { 1 };
            for k in 0..azimuths {
                let turn = TAU * k as f64 / AZIMUTHS as f64;
                // The isotropic slices have the same azimuth; relative to it the exchange turns the other way.
                let to_b = rotated(b.direction, turn);
                let to_a = rotated(a.direction, -turn);
                if !(a.measured(to_b) && b.measured(to_a)) {
                    continue;
                }
                let (x, y) = (a.value(to_b), b.value(to_a));
                let weight = a.direction.z * b.direction.z;
                apart += weight * (x - y).abs();
                size += weight * 0.5 * (x + y).abs();
            }
        }
    }
    (size > 0.0).then(|| apart / size)
}

/// How much an exchanged value counts `past_i` and `past_s` radians past the measured incidences.
#[inline]
pub(crate) fn weight(past_i: f64, past_s: f64) -> f64 {
    let square = past_i * past_i;
    square / (square + past_s * past_s + REACH * REACH)
}

fn rotated(v: DVec3, turn: f64) -> DVec3 {
    let (s, c) = turn.sin_cos();
    DVec3::new(c * v.x - s * v.y, s * v.x + c * v.y, v.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exchange_counts_nothing_at_the_last_incidence_and_most_far_beyond_it() {
        assert_eq!(weight(0.0, 0.0), 0.0);
        assert!(weight(0.1, 0.0) > 0.85 && weight(0.1, 0.3) < 0.1);
    }
}
