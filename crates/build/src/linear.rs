//! Small symmetric systems.

/// Solves `a x = b` for a positive matrix given by its lower triangle, by Cholesky's method; `None` when it is (nearly)
/// singular.
pub(crate) fn solve<const N: usize>(mut a: [[f64; N]; N], b: [f64; N]) -> Option<[f64; N]> {
    for i in 0..N {
        let diagonal = a[i][i];
        for j in 0..=i {
            let done: f64 = (0..j).map(|k| a[i][k] * a[j][k]).sum();
            let left = a[i][j] - done;
            if i == j {
                if left.is_nan() || left <= 1e-11 * diagonal {
                    return None;
                }
                a[i][i] = left.sqrt();
            } else {
                a[i][j] = left / a[j][j];
            }
        }
    }
    let mut x = b;
    for i in 0..N {
        let done: f64 = (0..i).map(|k| a[i][k] * x[k]).sum();
        x[i] = (x[i] - done) / a[i][i];
    }
    for i in (0..N).rev() {
        let done: f64 = (i + 1..N).map(|k| a[k][i] * x[k]).sum();
        x[i] = (x[i] - done) / a[i][i];
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_positive_system_is_solved_and_a_singular_one_refused() {
        let a = [[4.0, 0.0, 0.0], [1.0, 3.0, 0.0], [0.5, -1.0, 2.0]];
        let x = [1.0, -2.0, 0.5];
        let full = |i: usize, j: usize| if i >= j { a[i][j] } else { a[j][i] };
        let b = std::array::from_fn(|i| (0..3).map(|j| full(i, j) * x[j]).sum());
        let found = solve(a, b).unwrap();
        assert!((0..3).all(|k| (found[k] - x[k]).abs() < 1e-12));
        assert!(solve([[1.0, 0.0], [1.0, 1.0]], [1.0, 1.0]).is_none());
    }
}
