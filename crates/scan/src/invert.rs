//! Inverse of a small matrix.

/// Inverse by Gauss–Jordan with pivoting; `None` when singular.
pub(crate) fn invert<const N: usize>(mut a: [[f64; N]; N]) -> Option<[[f64; N]; N]> {
    let mut b: [[f64; N]; N] = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j)));
    // Columns of very different size (1, x, x^2) need no scaling with pivoting by rows, but a relative threshold.
    let scale: [f64; N] = std::array::from_fn(|i| a[i][i].abs());
    for k in 0..N {
        let pivot = (k..N).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))?;
        if a[pivot][k].abs() <= 1e-13 * scale[k] || a[pivot][k] == 0.0 {
            return None;
        }
        a.swap(k, pivot);
        b.swap(k, pivot);
        let p = a[k][k];
        for j in 0..N {
            a[k][j] /= p;
            b[k][j] /= p;
        }
        for i in (0..N).filter(|&i| i != k) {
            let f = a[i][k];
            for j in 0..N {
                a[i][j] -= f * a[k][j];
                b[i][j] -= f * b[k][j];
            }
        }
    }
    Some(b)
}
