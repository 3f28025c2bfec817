//! Directional-hemispherical reflectance and transmittance of a model by adaptive quadrature.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::{FRAC_PI_2, PI};

use gonio_geom::{Component, Direction, Side};

use crate::Bsdf;

/// An integral with a bound on its numerical error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integral {
    /// The value.
    pub value: f64,
    /// Sum of the differences between the nested rules; the true error of a smooth integrand is far smaller.
    pub error: f64,
}

/// `integral f |cos_s| domega_s` over the hemisphere that `component` names, for channel number `channel`, the ideal
/// part of the model included ([`Bsdf::delta`]).
///
/// Accurate to 1e-6 for lobes of `alpha >= 0.02` about the mirror or the unbent direction; piecewise constant models
/// stop at a few parts in 1e5 (see [`hemispherical_integral`] for the error). A `wi` on the horizon
/// (`cos_theta() == 0`) gives 0. `channel` past the model's channels gives NaN.
pub fn directional_albedo(model: &dyn Bsdf, wi: Direction, component: Component, channel: usize) -> f64 {
    let n = model.channels().len();
    if channel >= n {
        return f64::NAN;
    }
    let side = component.scattered_side(wi.side());
    let mut shares = vec![0.0; n];
    model.delta(wi, component, &mut shares);
    if n == 1 {
        let broad = hemispherical_integral(wi, side, |ws| model.eval_first(wi, ws) * ws.cos_theta().abs());
        return broad.value + shares[0];
    }
    let broad = hemispherical_integral(wi, side, |ws| {
        let mut f = vec![0.0; n];
        model.eval(wi, ws, &mut f);
        f[channel] * ws.cos_theta().abs()
    });
    broad.value + shares[channel]
}

/// Absolute error at which the subdivision stops.
const TOLERANCE: f64 = 1e-7;
/// Most boxes to evaluate before the result is returned with the error it has.
const MAX_BOXES: usize = 20_000;

/// `integral g(ws) domega_s` over the hemisphere `side`, subdivided about the mirror or unbent direction of `wi`.
///
/// Nested Gauss-Kronrod products in `(theta, phi)` [Piessens1983], boxes of largest error halved in both coordinates
/// until the error sum is below 1e-7 or 20 000 boxes have been evaluated.
pub fn hemispherical_integral(wi: Direction, side: Side, g: impl Fn(Direction) -> f64) -> Integral {
    let (theta_0, phi_0) = (wi.theta().min(PI - wi.theta()), wi.phi() + PI);
    let integrand = |theta: f64, dphi: f64| {
        let d = Direction::from_spherical(theta, phi_0 + dphi);
        let ws = if side == Side::Front { d } else { d.flipped() };
        g(ws) * theta.sin()
    };
    let steps = [0.003, 0.01, 0.03, 0.1, 0.3, 1.0];
    let mut thetas = vec![0.0, theta_0, FRAC_PI_2];
    let mut phis = vec![-PI, 0.0, PI];
    for step in steps {
        thetas.extend([theta_0 - step, theta_0 + step]);
        phis.extend([-step, step]);
    }
    let thetas = breaks(thetas, 0.0, FRAC_PI_2);
    let phis = breaks(phis, -PI, PI);

    let mut heap = BinaryHeap::new();
    let (mut value, mut error) = (0.0, 0.0);
    let add = |heap: &mut BinaryHeap<Patch>, value: &mut f64, error: &mut f64, theta, phi| {
        let patch = Patch::evaluate(&integrand, theta, phi);
        *value += patch.value;
        *error += patch.error;
        heap.push(patch);
    };
    for t in thetas.windows(2) {
        for p in phis.windows(2) {
            add(&mut heap, &mut value, &mut error, (t[0], t[1]), (p[0], p[1]));
        }
    }
    let mut evaluated = heap.len();
    while error > TOLERANCE && evaluated < MAX_BOXES {
        let Some(worst) = heap.pop() else { break };
        value -= worst.value;
        error -= worst.error;
        let (t, p) = (worst.theta, worst.phi);
        let (tm, pm) = (0.5 * (t.0 + t.1), 0.5 * (p.0 + p.1));
        for theta in [(t.0, tm), (tm, t.1)] {
            for phi in [(p.0, pm), (pm, p.1)] {
                add(&mut heap, &mut value, &mut error, theta, phi);
            }
        }
        evaluated += 4;
    }
    // Summed afresh: the running sums carry the rounding of every box that was replaced.
    Integral {
        value: heap.iter().map(|b| b.value).sum(),
        error: heap.iter().map(|b| b.error).sum(),
    }
}

/// Sorted distinct break points inside `[low, high]`, both ends included.
fn breaks(mut points: Vec<f64>, low: f64, high: f64) -> Vec<f64> {
    points.retain(|p| (low..=high).contains(p));
    points.sort_by(f64::total_cmp);
    points.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
    points
}

/// One box of the subdivision.
struct Patch {
    theta: (f64, f64),
    phi: (f64, f64),
    value: f64,
    error: f64,
}

impl Patch {
    fn evaluate(g: &impl Fn(f64, f64) -> f64, theta: (f64, f64), phi: (f64, f64)) -> Self {
        let (tc, th) = (0.5 * (theta.0 + theta.1), 0.5 * (theta.1 - theta.0));
        let (pc, ph) = (0.5 * (phi.0 + phi.1), 0.5 * (phi.1 - phi.0));
        let (mut fine, mut coarse) = (0.0, 0.0);
        for (i, &(xt, wt)) in KRONROD.iter().enumerate() {
            let (mut row_fine, mut row_coarse) = (0.0, 0.0);
            for (j, &(xp, wp)) in KRONROD.iter().enumerate() {
                let v = g(tc + th * xt, pc + ph * xp);
                row_fine += wp * v;
                if j % 2 == 1 {
                    row_coarse += GAUSS[j / 2] * v;
                }
            }
            fine += wt * row_fine;
            if i % 2 == 1 {
                coarse += GAUSS[i / 2] * row_coarse;
            }
        }
        let area = th * ph;
        Patch {
            theta,
            phi,
            value: fine * area,
            error: ((fine - coarse) * area).abs(),
        }
    }
}

impl PartialEq for Patch {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Patch {}
impl PartialOrd for Patch {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Patch {
    fn cmp(&self, other: &Self) -> Ordering {
        self.error.total_cmp(&other.error)
    }
}

/// Nodes and weights of the 15-point Kronrod rule on `[-1, 1]` [Piessens1983]; the odd ones are Gauss nodes.
#[rustfmt::skip]
const KRONROD: [(f64, f64); 15] = [
    (-0.991_455_371_120_812_6, 0.022_935_322_010_529_225),
    (-0.949_107_912_342_758_5, 0.063_092_092_629_978_55),
    (-0.864_864_423_359_769_1, 0.104_790_010_322_250_18),
    (-0.741_531_185_599_394_4, 0.140_653_259_715_525_92),
    (-0.586_087_235_467_691_1, 0.169_004_726_639_267_9),
    (-0.405_845_151_377_397_2, 0.190_350_578_064_785_4),
    (-0.207_784_955_007_898_47, 0.204_432_940_075_298_9),
    (0.0, 0.209_482_141_084_727_83),
    (0.207_784_955_007_898_47, 0.204_432_940_075_298_9),
    (0.405_845_151_377_397_2, 0.190_350_578_064_785_4),
    (0.586_087_235_467_691_1, 0.169_004_726_639_267_9),
    (0.741_531_185_599_394_4, 0.140_653_259_715_525_92),
    (0.864_864_423_359_769_1, 0.104_790_010_322_250_18),
    (0.949_107_912_342_758_5, 0.063_092_092_629_978_55),
    (0.991_455_371_120_812_6, 0.022_935_322_010_529_225),
];

/// Weights of the 7-point Gauss rule at the odd nodes of [`KRONROD`].
#[rustfmt::skip]
const GAUSS: [f64; 7] = [
    0.129_484_966_168_869_7, 0.279_705_391_489_276_7, 0.381_830_050_505_118_9, 0.417_959_183_673_469_4,
    0.381_830_050_505_118_9, 0.279_705_391_489_276_7, 0.129_484_966_168_869_7,
];
