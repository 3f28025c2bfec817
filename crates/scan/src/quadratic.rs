//! A quadratic through values at points of a plane.

use crate::invert::invert;

/// `constant + slope . x + x . curvature x / 2` about the origin of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Quadratic {
    pub(crate) constant: f64,
    pub(crate) slope: [f64; 2],
    /// Second derivatives along the first axis, mixed, along the second.
    pub(crate) curvature: [f64; 3],
}

/// A quadratic with what the values it is laid through say of its own uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fitted {
    pub(crate) quadratic: Quadratic,
    /// Weighted sum of squared residuals over the degrees of freedom, one at least.
    pub(crate) residual: f64,
    /// Inverse of the normal equations in places over `scale`.
    inverse: [[f64; 6]; 6],
    scale: f64,
}

fn terms([x, y]: [f64; 2]) -> [f64; 6] {
    [1.0, x, y, 0.5 * x * x, x * y, 0.5 * y * y]
}

impl Fitted {
    /// The least-squares quadratic through rows of place, value and weight; `None` where they do not determine it.
    pub(crate) fn through(rows: impl Iterator<Item = ([f64; 2], f64, f64)> + Clone) -> Option<Fitted> {
        let scale = rows.clone().map(|(x, _, _)| x[0].hypot(x[1])).fold(0.0, f64::max);
        if scale <= 0.0 {
            return None;
        }
        let (mut normal, mut right) = ([[0.0; 6]; 6], [0.0; 6]);
        for ([x, y], value, weight) in rows.clone() {
            let row = terms([x / scale, y / scale]);
            for i in 0..6 {
                right[i] += weight * row[i] * value;
                for j in 0..6 {
                    normal[i][j] += weight * row[i] * row[j];
                }
            }
        }
        let inverse = invert(normal)?;
        let c: [f64; 6] = std::array::from_fn(|i| (0..6).map(|j| inverse[i][j] * right[j]).sum());
        let second = |k: usize| c[k] / (scale * scale);
        let quadratic = Quadratic {
            constant: c[0],
            slope: [c[1] / scale, c[2] / scale],
            curvature: [second(3), second(4), second(5)],
        };
        let freedom = rows.clone().count().saturating_sub(6).max(1) as f64;
        let squares: f64 = rows
            .map(|(x, value, weight)| weight * (value - quadratic.at(x)).powi(2))
            .sum();
        Some(Fitted {
            quadratic,
            residual: squares / freedom,
            inverse,
            scale,
        })
    }

    /// Standard uncertainty of the rise of the quadratic from the origin to a place, from the residuals.
    pub(crate) fn u_rise(&self, [x, y]: [f64; 2]) -> f64 {
        let mut g = terms([x / self.scale, y / self.scale]);
        g[0] = 0.0;
        let of = |i: usize| g[i] * (0..6).map(|j| self.inverse[i][j] * g[j]).sum::<f64>();
        (self.residual * (0..6).map(of).sum::<f64>()).max(0.0).sqrt()
    }
}

impl Quadratic {
    /// The least-squares quadratic through rows of place, value and weight; `None` where they do not determine it.
    pub(crate) fn through(rows: impl Iterator<Item = ([f64; 2], f64, f64)> + Clone) -> Option<Quadratic> {
        Some(Fitted::through(rows)?.quadratic)
    }

    /// Place of the maximum; `None` for a quadratic without one.
    pub(crate) fn top(&self) -> Option<[f64; 2]> {
        let [xx, xy, yy] = self.curvature;
        let determinant = xx * yy - xy * xy;
        if xx + yy >= 0.0 || determinant <= 0.0 {
            return None;
        }
        let [gx, gy] = self.slope;
        Some([
            (xy * gy - yy * gx) / determinant,
            (xy * gx - xx * gy) / determinant,
        ])
    }

    /// The value at a place.
    pub(crate) fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let [xx, xy, yy] = self.curvature;
        self.constant + self.slope[0] * x + self.slope[1] * y + 0.5 * (xx * x * x + yy * y * y) + xy * x * y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quadratic_is_found_again_with_its_top() {
        let f =
            |x: f64, y: f64| 3.0 - 2.0 * (x - 0.1).powi(2) - (y + 0.2).powi(2) + 0.5 * (x - 0.1) * (y + 0.2);
        let places = (0..12).map(|k| {
            let (s, c) = (2.4 * f64::from(k)).sin_cos();
            let r = 0.1 * f64::from(k).sqrt();
            [r * c, r * s]
        });
        let found = Quadratic::through(places.map(|[x, y]| ([x, y], f(x, y), 1.0))).unwrap();
        let top = found.top().unwrap();
        assert!(
            (top[0] - 0.1).abs() < 1e-9 && (top[1] + 0.2).abs() < 1e-9,
            "{top:?}"
        );
        assert!((found.at(top) - 3.0).abs() < 1e-9);
    }
}
