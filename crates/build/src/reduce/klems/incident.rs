//! Averages over incident patches, a ring at a time.

use std::f64::consts::PI;

use gonio_bsdf::klems::{Ring, Role};
use gonio_geom::quadrature::gauss_legendre;

use super::Filling;
use super::azimuth::{BINS, Classes, spread};
use super::rule::in_cosine;

/// The entries of some incident patches, each `[exit patch]`, and what they cost.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    pub(super) rows: Vec<Vec<f64>>,
    pub(super) evaluations: u64,
    pub(super) unsettled: usize,
}

impl Filling<'_> {
    /// The rows of incident ring `a`.
    pub(super) fn ring(&self, a: usize) -> Rows {
        let basis = &self.options.basis;
        let ring = &basis.rings()[a];
        if self.one.model.properties().isotropic {
            return self.isotropic_ring(ring);
        }
        let mut out = Rows::default();
        let rule = gauss_legendre(self.options.incident_points);
        // a whole turn is best covered by equal steps
        let turn: Vec<(f64, f64)> = if ring.n_phi == 1 {
            let n = 4 * self.options.incident_points;
            (0..n)
                .map(|k| ((k as f64 + 0.5) / n as f64, 1.0 / n as f64))
                .collect()
        } else {
            rule.clone()
        };
        for j in 0..ring.n_phi {
            let mut row = vec![0.0; basis.len()];
            for (t, wt) in &rule {
                let (u, wu) = in_cosine(ring, *t);
                for (v, wv) in &turn {
                    let wi = basis.point(ring.first + j, Role::Incident, self.side, u, *v);
                    self.exit(wi, &mut out, |o, _, value| row[o] += wt * wu * wv * value);
                }
            }
            out.rows.push(row);
        }
        out
    }

    /// The rows of a ring of an isotropic model: azimuth differences are collected once and spread over the pairs of
    /// patches that see them.
    fn isotropic_ring(&self, ring: &Ring) -> Rows {
        let basis = &self.options.basis;
        let mut out = Rows::default();
        // sums over bins of the azimuth from the mirror azimuth, for each exit ring
        let mut bins = vec![vec![0.0; BINS]; basis.rings().len()];
        // the whole accuracy of a patch goes into the polar angle
        for (t, weight) in gauss_legendre(4 * self.options.incident_points) {
            let (u, wu) = in_cosine(ring, t);
            let weight = weight * wu;
            let wi = basis.point(ring.first, Role::Incident, self.side, u, 0.5);
            // patch 0 is seen from azimuth 180 degrees, so its mirror azimuth is 0
            self.exit(wi, &mut out, |o, v, value| {
                let rb = basis.ring(o);
                let place = |v: f64| ((o - rb.first) as f64 - 0.5 + v) / rb.n_phi as f64 * BINS as f64;
                spread(
                    &mut bins[basis.ring_index(o)],
                    place(v[0]),
                    place(v[1]),
                    weight * value,
                );
            });
        }
        out.rows = vec![vec![0.0; basis.len()]; ring.n_phi];
        for (rb, bins) in basis.rings().iter().zip(&bins) {
            let classes = Classes::new(ring, rb);
            let mut values = vec![0.0; classes.period];
            for (k, sum) in bins.iter().enumerate() {
                if *sum > 0.0 {
                    let azimuth = 2.0 * PI * (k as f64 + 0.5) / BINS as f64;
                    classes.around(azimuth, |turn, kernel| values[turn] += sum * kernel);
                }
            }
            let width = 2.0 * PI / rb.n_phi as f64;
            for (j, row) in out.rows.iter_mut().enumerate() {
                for k in 0..rb.n_phi {
                    row[rb.first + k] = values[classes.turn(j, k)] * width;
                }
            }
        }
        out
    }
}
