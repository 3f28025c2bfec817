//! Matte scattering as a reciprocal expansion in Zernike functions \[KoenderinkVanDoorn1998\].
//!
//! The hemisphere is mapped onto the unit disk with equal areas, `rho = sqrt(2) sin(theta / 2)`. An isotropic, bilateral and
//! reciprocal BSDF is a sum over azimuthal orders l and radial orders n <= n' (both of l's parity) of
//! `a (R_n^l(rho_i) R_n'^l(rho_s) + R_n'^l(rho_i) R_n^l(rho_s)) cos(l dphi)`; 14 coefficients up to order 4, 30 up to 6. They
//! are linear in the readings: one least-squares solution, no starting point.

use gonio_geom::DVec3;

/// Highest order that is offered.
pub(crate) const HIGHEST: usize = 8;

/// Relative size of what is added to the diagonal of the normal matrix: terms that the incidences do not tell apart stay small.
const RIDGE: f64 = 1e-7;

/// Smallest value, as a share of the mean of the readings: an expansion may leave what was read far behind.
const LEAST: f64 = 0.1;

/// Radial polynomials `R_n^l` for n up to [`HIGHEST`], by `n`, then `l`.
type Radial = [[f64; HIGHEST + 1]; HIGHEST + 1];

/// One term: azimuthal order, radial orders.
type Term = (usize, usize, usize);

/// Coefficients of every term up to an order.
#[derive(Clone, Debug)]
pub(crate) struct Expansion {
    pub(crate) order: usize,
    terms: Vec<Term>,
    coefficients: Vec<f64>,
    least: f64,
}

impl Expansion {
    /// The expansion up to `order` (at most [`HIGHEST`]) closest to readings, each an incidence, a direction on the upper
    /// hemisphere, the BSDF and a weight, by weighted least squares; `None` when they do not determine it.
    pub(crate) fn fit(
        order: usize,
        readings: impl Iterator<Item = (DVec3, DVec3, f64, f64)>,
    ) -> Option<Self> {
        let order = order.min(HIGHEST);
        let terms = terms(order);
        let n = terms.len();
        let (mut normal, mut right) = (vec![0.0; n * n], vec![0.0; n]);
        let (mut row, mut light, mut total) = (vec![0.0; n], 0.0, 0.0);
        for (i, s, f, w) in readings {
            values(&terms, order, i, s, &mut row);
            for a in 0..n {
                for b in 0..=a {
                    normal[a * n + b] += w * row[a] * row[b];
                }
                right[a] += w * row[a] * f;
            }
            light += w * f;
            total += w;
        }
        let trace: f64 = (0..n).map(|a| normal[a * n + a]).sum();
        for a in 0..n {
            normal[a * n + a] += RIDGE * trace / n as f64;
        }
        Some(Expansion {
            order,
            coefficients: solve(normal, right)?,
            terms,
            least: LEAST * (light / total).max(0.0),
        })
    }

    /// The BSDF at a pair of directions on the upper hemisphere, 1/sr; not below a tenth of the mean reading.
    pub(crate) fn eval(&self, i: DVec3, s: DVec3) -> f64 {
        let (cosines, at_i, at_s) = parts(self.order, i, s);
        let sum: f64 = self
            .terms
            .iter()
            .zip(&self.coefficients)
            .map(|(&term, a)| a * value(term, &cosines, &at_i, &at_s))
            .sum();
        sum.max(self.least)
    }
}

/// Every term up to `order`.
fn terms(order: usize) -> Vec<Term> {
    let radial = |l: usize| (l..=order).step_by(2);
    (0..=order)
        .flat_map(|l| radial(l).flat_map(move |n| (n..=order).step_by(2).map(move |m| (l, n, m))))
        .collect()
}

fn value((l, n, m): Term, cosines: &[f64; HIGHEST + 1], i: &Radial, s: &Radial) -> f64 {
    (i[n][l] * s[m][l] + i[m][l] * s[n][l]) * cosines[l]
}

fn values(terms: &[Term], order: usize, i: DVec3, s: DVec3, out: &mut [f64]) {
    let (cosines, at_i, at_s) = parts(order, i, s);
    for (out, &term) in out.iter_mut().zip(terms) {
        *out = value(term, &cosines, &at_i, &at_s);
    }
}

/// Cosines of multiples of the relative azimuth, and the radial polynomials of both directions.
fn parts(order: usize, i: DVec3, s: DVec3) -> ([f64; HIGHEST + 1], Radial, Radial) {
    let sines = i.x.hypot(i.y) * s.x.hypot(s.y);
    let cosine = if sines > 1e-12 {
        ((i.x * s.x + i.y * s.y) / sines).clamp(-1.0, 1.0)
    } else {
        1.0
    };
    let mut cosines = [1.0; HIGHEST + 1];
    cosines[1] = cosine;
    for l in 2..=order {
        cosines[l] = 2.0 * cosine * cosines[l - 1] - cosines[l - 2];
    }
    (cosines, radial(order, i.z), radial(order, s.z))
}

/// Radial polynomials at a direction of cosine `z`, by the recurrence `R_n^l = rho (R_(n-1)^(l-1) + R_(n-1)^(l+1)) - R_(n-2)^l`
/// \[Shakibaei2013\].
fn radial(order: usize, z: f64) -> Radial {
    let rho = (1.0 - z.clamp(0.0, 1.0)).sqrt();
    let mut r = [[0.0; HIGHEST + 1]; HIGHEST + 1];
    r[0][0] = 1.0;
    for n in 1..=order {
        for l in (n % 2..=n).step_by(2) {
            let below = if l == 0 { r[n - 1][1] } else { r[n - 1][l - 1] };
            let above = if l < HIGHEST { r[n - 1][l + 1] } else { 0.0 };
            let before = if n >= 2 { r[n - 2][l] } else { 0.0 };
            r[n][l] = rho * (below + above) - before;
        }
    }
    r
}

/// Solves for a symmetric positive matrix given by its lower triangle, by rows.
fn solve(mut a: Vec<f64>, mut b: Vec<f64>) -> Option<Vec<f64>> {
    let n = b.len();
    for i in 0..n {
        for j in 0..=i {
            let done: f64 = (0..j).map(|k| a[i * n + k] * a[j * n + k]).sum();
            let sum = a[i * n + j] - done;
            if i == j {
                if sum.is_nan() || sum <= 0.0 {
                    return None;
                }
                a[i * n + i] = sum.sqrt();
            } else {
                a[i * n + j] = sum / a[j * n + j];
            }
        }
    }
    for i in 0..n {
        let done: f64 = (0..i).map(|k| a[i * n + k] * b[k]).sum();
        b[i] = (b[i] - done) / a[i * n + i];
    }
    for i in (0..n).rev() {
        let done: f64 = (i + 1..n).map(|k| a[k * n + i] * b[k]).sum();
        b[i] = (b[i] - done) / a[i * n + i];
    }
    b.iter().all(|x| x.is_finite()).then_some(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_geom::Direction;

    /// Incidences of 0 to 75 degrees with readings up to 80.
    fn pairs() -> Vec<(DVec3, DVec3)> {
        let at = |t: f64, p: f64| Direction::from_degrees(t, p).vec();
        let mut out = Vec::new();
        for theta_i in [0.0, 15.0, 30.0, 45.0, 60.0, 75.0] {
            for theta_s in 0..17 {
                for phi in 0..12 {
                    let theta_s = 5.0 * f64::from(theta_s);
                    out.push((at(theta_i, 180.0), at(theta_s, 30.0 * f64::from(phi))));
                }
            }
        }
        out
    }

    #[test]
    fn the_recurrence_gives_the_known_polynomials() {
        // rho = 0.6: cos theta = 1 - rho^2.
        let (r, p) = (radial(6, 1.0 - 0.36), 0.6f64);
        for (found, known) in [
            (r[1][1], p),
            (r[2][0], 2.0 * p * p - 1.0),
            (r[3][1], 3.0 * p.powi(3) - 2.0 * p),
            (r[4][0], 6.0 * p.powi(4) - 6.0 * p * p + 1.0),
            (r[4][2], 4.0 * p.powi(4) - 3.0 * p * p),
            (r[6][0], 20.0 * p.powi(6) - 30.0 * p.powi(4) + 12.0 * p * p - 1.0),
        ] {
            assert!((found - known).abs() < 1e-14, "{found} {known}");
        }
    }

    #[test]
    fn the_number_of_terms_is_that_of_the_literature() {
        assert_eq!([2, 4, 6].map(|n| terms(n).len()), [5, 14, 30]);
    }

    #[test]
    fn a_reciprocal_matte_sample_comes_back_and_exchange_changes_nothing() {
        let truth = |i: DVec3, s: DVec3| 0.3 * (1.0 - 0.2 * (i.z * s.z).sqrt()) + 0.02 * (1.0 + i.dot(s));
        let readings = || pairs().into_iter().map(|(i, s)| (i, s, truth(i, s), s.z));
        let found = Expansion::fit(6, readings()).unwrap();
        for theta_i in [7.0, 37.0, 52.0] {
            for (theta_s, phi) in [(10.0, 20.0), (40.0, 100.0), (70.0, 0.0)] {
                let i = Direction::from_degrees(theta_i, 180.0).vec();
                let s = Direction::from_degrees(theta_s, phi).vec();
                assert!((found.eval(i, s) / truth(i, s) - 1.0).abs() < 0.01);
                assert!((found.eval(i, s) - found.eval(s, i)).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn an_expansion_of_readings_around_one_direction_never_falls_below_a_tenth() {
        let spike = |s: DVec3| (-(1.0 - s.z) / 0.01).exp();
        let found = Expansion::fit(4, pairs().into_iter().map(|(i, s)| (i, s, spike(s), s.z))).unwrap();
        for (i, s) in pairs() {
            assert!(found.eval(i, s) >= found.least && found.least > 0.0);
        }
    }
}
