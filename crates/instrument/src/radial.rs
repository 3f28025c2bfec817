//! Functions of the distance from a centre, averaged over a moving cap.

use std::f64::consts::{FRAC_PI_2, PI};

use gonio_geom::quadrature::gauss_legendre;

/// Nodes of an average, two parts of the cap each.
const NODES: usize = 32;
/// Entries of a table over the width of its narrowest feature, and its least and greatest number of them.
const ENTRIES: (f64, f64, f64) = (64.0, 512.0, 16_384.0);

/// A function of the chord from a centre of the unit sphere, 0 beyond its reach; linear between evenly spaced chords.
pub(crate) struct Radial {
    values: Vec<f64>,
    step: f64,
}

impl Radial {
    /// The mean of `f`, which is 0 beyond chord `edge`, over the cap of angular radius `radius > 0` about each point of the
    /// sphere. `feature` is the distance over which `f` changes, the edge apart.
    pub(crate) fn smeared(f: impl Fn(f64) -> f64, edge: f64, feature: f64, radius: f64) -> Self {
        let reach = edge + 2.0 * (0.5 * radius).sin();
        let (per_feature, least, most) = ENTRIES;
        let n = (per_feature * reach / feature.min(radius))
            .clamp(least, most)
            .ceil();
        let step = reach / n;
        let rule = gauss_legendre(NODES);
        let values = (0..=n as usize)
            .map(|k| mean(&f, edge, k as f64 * step, radius, &rule))
            .collect();
        Radial { values, step }
    }

    /// Chord beyond which it is 0.
    pub(crate) fn reach(&self) -> f64 {
        (self.values.len() - 1) as f64 * self.step
    }

    /// Its value at chord `c`.
    pub(crate) fn at(&self, c: f64) -> f64 {
        let x = c / self.step;
        let k = x as usize;
        match (self.values.get(k), self.values.get(k + 1)) {
            (Some(a), Some(b)) => a + (x - k as f64) * (b - a),
            _ => 0.0,
        }
    }
}

/// The mean of `f` over the cap of angular radius `radius` whose axis is at chord `r` from the centre.
fn mean(f: &impl Fn(f64) -> f64, edge: f64, r: f64, radius: f64, rule: &[(f64, f64)]) -> f64 {
    let angle = |chord: f64| 2.0 * (0.5 * chord).min(1.0).asin();
    // A ring at the angle `t` about the centre, by the turn of it that lies in the cap, over 2 pi.
    let ring = |t: f64| f(2.0 * (0.5 * t).sin()) * t.sin();
    let (axis, end) = (angle(r), angle(edge));
    let (near, far) = (axis - radius, axis + radius);
    // Whole rings, where the cap holds the centre.
    let inner = (-near).clamp(0.0, end);
    let whole: f64 = rule.iter().map(|&(t, w)| w * inner * ring(t * inner)).sum();
    // Arcs; the sine takes the square root out of both of their ends.
    let (lo, hi) = (near.abs().min(end), far.min(end));
    let (middle, half) = (0.5 * (lo + hi), 0.5 * (hi - lo));
    let arcs: f64 = rule
        .iter()
        .map(|&(t, w)| {
            let turn = PI * t - FRAC_PI_2;
            let at = middle + half * turn.sin();
            w * PI * half * turn.cos() * ring(at) * half_arc(at, axis, radius) / PI
        })
        .sum();
    // The cap has 2 pi times this.
    let cap = 2.0 * (0.5 * radius).sin().powi(2);
    (whole + arcs) / cap
}

/// Half the turn, radians, of the ring at the angle `t` about the centre that lies in the cap of angle `radius` about an axis
/// `axis` away: the half-angle formula of the triangle of the three, which keeps its digits where the cap is small.
fn half_arc(t: f64, axis: f64, radius: f64) -> f64 {
    let off = t - axis;
    let over = (0.5 * (radius - off)).sin() * (0.5 * (radius + off)).sin();
    let under = t.sin() * axis.sin();
    if under <= 0.0 {
        return if over >= 0.0 { PI } else { 0.0 };
    }
    2.0 * (over / under).clamp(0.0, 1.0).sqrt().asin()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn integral(radial: &Radial) -> f64 {
        let n = 200_000;
        let step = radial.reach() / f64::from(n);
        (0..n)
            .map(|k| {
                let c = (f64::from(k) + 0.5) * step;
                radial.at(c) * 2.0 * PI * c * step
            })
            .sum()
    }

    #[test]
    fn averages_keep_the_integral() {
        let even = |edge: f64| move |c: f64| f64::from(c <= edge) / (PI * edge * edge);
        for radius in [0.0002, 0.003, 0.01, 0.05] {
            let sum = integral(&Radial::smeared(even(0.01), 0.01, 0.01, radius));
            assert!((sum - 1.0).abs() < 2e-5, "even, {radius}: {sum}");
            let w = 0.002;
            let gauss = |c: f64| (-(c * c) / (w * w)).exp() / (PI * w * w);
            let sum = integral(&Radial::smeared(gauss, 5.0 * w, w, radius));
            assert!((sum - 1.0).abs() < 2e-5, "Gaussian, {radius}: {sum}");
        }
    }

    #[test]
    fn two_even_disks_overlap_in_a_lens() {
        let (edge, radius) = (0.01, 0.004);
        let found = Radial::smeared(|c| f64::from(c <= edge), edge, edge, radius);
        for r in [0.0, 0.003, 0.006, 0.007, 0.0095, 0.0125, 0.0139] {
            // The lens of two circles in the plane; the sphere differs by the square of the radii.
            let angle = |a: f64, b: f64| ((r * r + a * a - b * b) / (2.0 * r * a)).clamp(-1.0, 1.0).acos();
            let segment = |a: f64, t: f64| a * a * (t - t.sin() * t.cos());
            let share = if r <= edge - radius {
                1.0
            } else {
                let lens = segment(edge, angle(edge, radius)) + segment(radius, angle(radius, edge));
                lens / (PI * radius * radius)
            };
            assert!(
                (found.at(r) - share).abs() < 2e-4,
                "{r}: {} for {share}",
                found.at(r)
            );
        }
    }

    #[test]
    fn a_gaussian_over_a_wide_cap_is_its_share() {
        let w = 1e-3;
        let f = |c: f64| (-(c * c) / (w * w)).exp();
        let found = Radial::smeared(f, 5.0 * w, w, 0.02);
        // All of it well inside, half of it at the edge (the curved edge takes w / (2 sqrt(pi) a) of that).
        let whole = w * w / (0.02 * 0.02);
        assert!((found.at(0.01) / whole - 1.0).abs() < 1e-4);
        let at_edge = 0.5 - 0.25 * w / (PI.sqrt() * 0.02);
        assert!(
            (found.at(0.02) / whole - at_edge).abs() < 1e-3,
            "{}",
            found.at(0.02) / whole
        );
        assert_eq!(found.at(0.03), 0.0);
    }
}
