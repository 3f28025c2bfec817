//! Moving least squares with parabolas or cubics over the nearest points \[LancasterSalkauskas1981\].

use crate::linear::solve;
use crate::plane::Point;

use super::Weights;

/// Points that take part in a parabola and in a cubic.
const NEAREST: usize = 12;
const NEAREST_CUBIC: usize = 18;

/// Coefficients of a parabola and of a cubic.
const TERMS: usize = 6;
const TERMS_CUBIC: usize = 10;

/// Largest sum of absolute weights: beyond it noise and model errors are amplified too much.
const LARGEST: f64 = 3.5;

/// Weights at `p` that reproduce every parabola through `points`; `None` with fewer than twelve of them, or where they
/// would amplify errors.
pub(crate) fn quadratic(points: &[Point], p: Point) -> Option<Weights> {
    let mut weights = Weights::NONE;
    for (k, w) in polynomial::<TERMS, NEAREST>(points, p)? {
        weights.add(k, w);
    }
    Some(weights)
}

/// Weights at `p` that reproduce every cubic through `points`; `None` with fewer than eighteen of them, or where they would
/// amplify errors.
pub(crate) fn cubic(points: &[Point], p: Point) -> Option<[(usize, f64); NEAREST_CUBIC]> {
    polynomial::<TERMS_CUBIC, NEAREST_CUBIC>(points, p)
}

/// The first monomials of an offset, by order.
pub(crate) fn monomials<const N: usize>(x: f64, y: f64) -> [f64; N] {
    let all = [
        1.0,
        x,
        y,
        x * x,
        y * y,
        x * y,
        x * x * x,
        y * y * y,
        x * x * y,
        x * y * y,
    ];
    std::array::from_fn(|k| all[k])
}

/// Weights of the `NEAREST` points that reproduce every polynomial of `TERMS` terms.
fn polynomial<const TERMS: usize, const NEAREST: usize>(
    points: &[Point],
    p: Point,
) -> Option<[(usize, f64); NEAREST]> {
    let mut nearest = [(f64::INFINITY, 0usize); NEAREST];
    if points.len() < NEAREST {
        return None;
    }
    for (k, q) in points.iter().enumerate() {
        let d2 = (q[0] - p[0]).powi(2) + (q[1] - p[1]).powi(2);
        if d2 < nearest[NEAREST - 1].0 {
            let at = nearest.partition_point(|n| n.0 <= d2);
            nearest[at..].rotate_right(1);
            nearest[at] = (d2, k);
        }
    }
    let reach = 1.001 * nearest[NEAREST - 1].0.sqrt();
    let mut rows = [[0.0; TERMS]; NEAREST];
    let mut importance = [0.0; NEAREST];
    let mut normal = [[0.0; TERMS]; TERMS];
    for (m, (d2, k)) in nearest.iter().enumerate() {
        let (x, y) = ((points[*k][0] - p[0]) / reach, (points[*k][1] - p[1]) / reach);
        rows[m] = monomials(x, y);
        let d = d2.sqrt() / reach;
        let tricube = (1.0 - d * d * d).powi(3);
        // Infinite at a point: there the weights are that point's alone.
        importance[m] = tricube / (d * d + 1e-7);
        for a in 0..TERMS {
            for b in 0..=a {
                normal[a][b] += importance[m] * rows[m][a] * rows[m][b];
            }
        }
    }
    let mut first = [0.0; TERMS];
    first[0] = 1.0;
    let solution = solve(normal, first)?;
    let mut weights = [(0, 0.0); NEAREST];
    let (mut sum, mut size) = (0.0, 0.0);
    for (m, (_, k)) in nearest.iter().enumerate() {
        let w = importance[m] * rows[m].iter().zip(&solution).map(|(a, b)| a * b).sum::<f64>();
        weights[m] = (*k, w);
        sum += w;
        size += w.abs();
    }
    (size <= LARGEST && (sum - 1.0).abs() < 1e-6).then_some(weights)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{grid, queries};
    use super::*;

    #[test]
    fn parabolas_are_reproduced_where_the_weights_are_tame() {
        let points = grid();
        let f = |p: Point| 1.0 - p[0] + 0.5 * p[1] + 2.0 * p[0] * p[0] - p[0] * p[1] + 0.3 * p[1] * p[1];
        let mut answered = 0;
        for p in queries() {
            let Some(w) = quadratic(&points, p) else { continue };
            answered += 1;
            let value: f64 = w.as_slice().iter().map(|(k, w)| w * f(points[*k])).sum();
            assert!((value - f(p)).abs() < 1e-6, "{p:?}: {value} {}", f(p));
            assert!(w.as_slice().iter().map(|w| w.1.abs()).sum::<f64>() <= LARGEST);
        }
        assert!(answered > 40, "{answered}");
    }

    #[test]
    fn cubics_are_reproduced_where_the_weights_are_tame() {
        let points = grid();
        let f = |p: Point| 0.2 + p[0] * p[1] - p[1] * p[1] + 2.0 * p[0].powi(3) - p[0] * p[1] * p[1];
        let mut answered = 0;
        for p in queries() {
            let Some(w) = cubic(&points, p) else { continue };
            answered += 1;
            let value: f64 = w.iter().map(|(k, w)| w * f(points[*k])).sum();
            assert!((value - f(p)).abs() < 1e-6, "{p:?}: {value} {}", f(p));
        }
        assert!(answered > 40, "{answered}");
        assert!(cubic(&points[..17], [0.0, 0.1]).is_none());
    }

    #[test]
    fn a_point_answers_alone_where_it_lies_and_outside_there_is_no_answer() {
        let points = grid();
        let w = quadratic(&points, points[30]).unwrap();
        let own = w.as_slice().iter().find(|w| w.0 == 30).unwrap().1;
        assert!((own - 1.0).abs() < 1e-4, "{own}");
        assert!(
            quadratic(&points, [1.6, 0.0]).is_none(),
            "extrapolation amplifies errors"
        );
        assert!(quadratic(&points[..8], [0.0, 0.1]).is_none());
    }
}
