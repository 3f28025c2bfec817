//! Azimuth differences of an isotropic model: collected in bins, spread over the pairs of patches that see them.

use std::f64::consts::PI;

use gonio_bsdf::klems::Ring;

/// Bins of azimuth of the isotropic reduction: a quarter of a degree.
pub(super) const BINS: usize = 1440;

/// Adds `value` to the bins from `from` to `to` (in bins, any turn), by their share.
pub(super) fn spread(bins: &mut [f64], from: f64, to: f64, value: f64) {
    let n = bins.len() as f64;
    let per_bin = value / (to - from);
    let mut at = from;
    while at < to {
        let next = (at + 1e-9).floor() + 1.0;
        let end = next.min(to);
        let bin = (at + 1e-9).floor().rem_euclid(n) as usize;
        bins[bin.min(bins.len() - 1)] += per_bin * (end - at).max(0.0);
        at = next;
    }
}

/// Pairs of patches of two rings that differ by a rotation: classes of equal azimuth difference, in steps of a turn
/// over `period`.
pub(super) struct Classes {
    pub(super) period: usize,
    of_incident: usize,
    of_exit: usize,
    /// Widths of the two patches in azimuth, radians.
    widths: (f64, f64),
}

impl Classes {
    pub(super) fn new(incident: &Ring, exit: &Ring) -> Self {
        let (na, nb) = (incident.n_phi, exit.n_phi);
        Classes {
            period: na * nb / gcd(na, nb),
            of_incident: na,
            of_exit: nb,
            widths: (2.0 * PI / na as f64, 2.0 * PI / nb as f64),
        }
    }

    pub(super) fn turn(&self, j: usize, k: usize) -> usize {
        (k * (self.period / self.of_exit) + self.period - j * (self.period / self.of_incident)) % self.period
    }

    /// Azimuth from the centre of class `turn`, in `[-pi, pi]`.
    fn distance(&self, azimuth: f64, turn: usize) -> f64 {
        let d = azimuth - 2.0 * PI * turn as f64 / self.period as f64;
        d - 2.0 * PI * (d / (2.0 * PI)).round()
    }

    /// Density of the azimuth difference of two even points of the patches: a trapezium.
    fn kernel(&self, distance: f64) -> f64 {
        let (a, b) = self.widths;
        if self.of_incident == 1 || self.of_exit == 1 {
            return 0.5 / PI;
        }
        ((0.5 * (a + b) - distance.abs()) / (a * b)).clamp(0.0, 1.0 / a.max(b))
    }

    /// The classes whose kernel is positive at `azimuth`, with its value.
    pub(super) fn around(&self, azimuth: f64, mut visit: impl FnMut(usize, f64)) {
        let step = 2.0 * PI / self.period as f64;
        let half = 0.5 * (self.widths.0 + self.widths.1);
        let nearest = (azimuth / step).round() as i64;
        let reach = ((half / step).ceil() as i64).min(self.period as i64 / 2);
        // with an even period the outermost classes of both sides are one and the same
        let last = if 2 * reach as usize == self.period {
            reach - 1
        } else {
            reach
        };
        for m in -reach..=last {
            let turn = (nearest + m).rem_euclid(self.period as i64) as usize;
            let value = self.kernel(self.distance(azimuth, turn));
            if value > 0.0 {
                visit(turn, value);
            }
        }
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}
