//! Directional-hemispherical reflectance and transmittance of a model by adaptive quadrature.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use gonio_geom::{Component, DVec3, Direction, Side};

use crate::batch::Directions;
use crate::{Bsdf, Lobe};

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
/// Accurate to 1e-6 for lobes of `alpha >= 0.005` about any direction that the model's own sampler finds, and about the
/// mirror and the unbent direction whatever the sampler; piecewise constant models stop at a few parts in 1e5 (see
/// [`hemispherical_integral`] for the error). A `wi` on the horizon (`cos_theta() == 0`) gives 0. `channel` past the
/// model's channels gives NaN.
pub fn directional_albedo(model: &dyn Bsdf, wi: Direction, component: Component, channel: usize) -> f64 {
    let n = model.channels().len();
    if channel >= n {
        return f64::NAN;
    }
    let side = component.scattered_side(wi.side());
    let mut shares = vec![0.0; n];
    model.delta(wi, component, &mut shares);
    let hints: Vec<Direction> = (0..HINTS)
        .filter_map(|k| model.sample(wi, scattered_point(k)))
        .filter(|s| s.lobe != Lobe::Delta && s.direction.side() == side)
        .map(|s| s.direction)
        .collect();
    let v = wi.vec();
    let wi_for_all = Directions::One([v.x, v.y, v.z]);
    let mut values = vec![[0.0; NODES]; n];
    let broad = integrate(wi, side, &hints, |ws, dsf| {
        let ws = ws.each_ref().map(|column| &column[..dsf.len()]);
        let mut rows: Vec<&mut [f64]> = values.iter_mut().map(|row| &mut row[..dsf.len()]).collect();
        model.eval_f64(wi_for_all, Directions::Each(ws), &mut rows);
        for ((out, f), z) in dsf.iter_mut().zip(&values[channel]).zip(ws[2]) {
            *out = f * z.abs();
        }
    });
    broad.value + shares[channel]
}

/// Absolute error at which the subdivision stops.
const TOLERANCE: f64 = 1e-7;
/// Most boxes to evaluate before the result is returned with the error it has.
const MAX_BOXES: usize = 20_000;
/// Size of the first boxes at the mirror or unbent direction, radians; farther off they grow with the distance.
const CENTRE: f64 = 0.004;
/// Azimuth from the mirror direction at which the boxes begin and end: off the plane of incidence, where lobes lie.
const SEAM: f64 = -FRAC_PI_2;
/// Samples that show where a lobe lies between the nodes of the first boxes.
const HINTS: u32 = 256;

/// Directions in the plane of incidence that are searched for a lobe elsewhere, such as refracted light.
const SEARCHED: u32 = 2048;

/// `integral g(ws) domega_s` over the hemisphere `side`, subdivided about the mirror or unbent direction of `wi` and
/// about the largest value in the plane of incidence.
///
/// Nested Gauss-Kronrod products in `(theta, phi)` [Piessens1983], boxes of largest error halved along the coordinate
/// that has more of it until the error sum is below 1e-7 or 20 000 boxes have been evaluated.
pub fn hemispherical_integral(wi: Direction, side: Side, g: impl Fn(Direction) -> f64) -> Integral {
    let searched = (0..SEARCHED).map(|k| {
        let theta = PI * ((f64::from(k) + 0.5) / f64::from(SEARCHED) - 0.5);
        let d = Direction::from_spherical(theta.abs(), wi.phi() + if theta < 0.0 { PI } else { 0.0 });
        if side == Side::Front { d } else { d.flipped() }
    });
    let weight = |d: &Direction| g(*d) * d.theta().sin();
    let largest = searched.max_by(|a, b| weight(a).total_cmp(&weight(b)));
    integrate(wi, side, largest.as_slice(), |[x, y, z], values| {
        for (k, value) in values.iter_mut().enumerate() {
            *value = g(Direction::from_unit(DVec3::new(x[k], y[k], z[k])));
        }
    })
}

/// Point `k` of an even sequence in the unit cube: multiples of the powers of the root of `x^4 = x + 1`.
fn scattered_point(k: u32) -> [f64; 3] {
    const ROOT: f64 = 1.220_744_084_605_759_5;
    [1, 2, 3].map(|power| (0.5 + f64::from(k + 1) / ROOT.powi(power)).fract())
}

/// [`hemispherical_integral`] that also looks at `hints`, directions where `g` may be large. `g` takes columns of unit
/// vectors, of which the first are wanted, and fills as many values.
fn integrate(
    wi: Direction,
    side: Side,
    hints: &[Direction],
    mut g: impl FnMut(&[[f64; NODES]; 3], &mut [f64]),
) -> Integral {
    let (theta_0, phi_0) = (wi.theta().min(PI - wi.theta()), wi.phi() + PI);
    let mut integrand = Integrand {
        phi_0,
        side: side.sign(),
        g: &mut g,
    };
    let hints: Vec<Hint> = hints
        .iter()
        .map(|d| {
            let theta = d.theta().min(PI - d.theta());
            let dphi = d.phi() - phi_0;
            let at = [theta, dphi - TAU * ((dphi - SEAM) / TAU).floor()];
            let mut value = [0.0];
            integrand.evaluate(&[at[0]], &[at[1]], &mut value);
            Hint { at, value: value[0] }
        })
        .collect();

    let mut heap = BinaryHeap::new();
    let mut error = 0.0;
    let mut evaluated = 0;
    let mut first = vec![([0.0, SEAM], [FRAC_PI_2, SEAM + TAU])];
    while let Some((low, high)) = first.pop() {
        let patch = Patch::evaluate(&mut integrand, low, high);
        evaluated += 1;
        match patch.coarse_axis([theta_0, 0.0], &hints) {
            Some(axis) if evaluated < MAX_BOXES => first.extend(patch.halves(axis)),
            _ => {
                error += patch.error;
                heap.push(patch);
            }
        }
    }
    while error > TOLERANCE && evaluated < MAX_BOXES {
        let Some(worst) = heap.pop() else { break };
        error -= worst.error;
        for (low, high) in worst.halves(worst.axis) {
            let patch = Patch::evaluate(&mut integrand, low, high);
            error += patch.error;
            heap.push(patch);
        }
        evaluated += 2;
    }
    // Summed afresh: the running sum carries the rounding of every box that was replaced.
    Integral {
        value: heap.iter().map(|b| b.value).sum(),
        error: heap.iter().map(|b| b.error).sum(),
    }
}

/// Directions of one box.
const NODES: usize = KRONROD.len() * KRONROD.len();

/// Takes columns of unit vectors, of which the first are wanted, and fills as many values.
type OfColumns<'a> = dyn FnMut(&[[f64; NODES]; 3], &mut [f64]) + 'a;

/// What is integrated, over polar angle and azimuth from the mirror direction.
struct Integrand<'a> {
    phi_0: f64,
    /// Sign of the hemisphere.
    side: f64,
    g: &'a mut OfColumns<'a>,
}

impl Integrand<'_> {
    /// `g sin(theta)` at every polar angle with every azimuth, polar angle by polar angle.
    fn evaluate(&mut self, theta: &[f64], dphi: &[f64], values: &mut [f64]) {
        let mut ws = [[0.0; NODES]; 3];
        let azimuth = |dphi: &f64| (self.phi_0 + dphi).sin_cos();
        let mut sin_cos_phi = [(0.0, 0.0); KRONROD.len()];
        for (to, dphi) in sin_cos_phi.iter_mut().zip(dphi) {
            *to = azimuth(dphi);
        }
        for (i, theta) in theta.iter().enumerate() {
            let (sin, cos) = theta.sin_cos();
            for (j, (sin_phi, cos_phi)) in sin_cos_phi[..dphi.len()].iter().enumerate() {
                let k = i * dphi.len() + j;
                (ws[0][k], ws[1][k], ws[2][k]) = (sin * cos_phi, sin * sin_phi, cos * self.side);
            }
        }
        (self.g)(&ws, values);
        for (row, theta) in values.chunks_mut(dphi.len()).zip(theta) {
            let sin = theta.sin();
            row.iter_mut().for_each(|v| *v *= sin);
        }
    }
}

/// A direction where the integrand may be large, and its value there.
struct Hint {
    at: [f64; 2],
    value: f64,
}

/// One box of the subdivision; coordinate 0 is theta, 1 is phi from the mirror direction.
struct Patch {
    low: [f64; 2],
    high: [f64; 2],
    value: f64,
    error: f64,
    /// The coordinate with more of the error.
    axis: usize,
    /// Largest value at the nodes.
    largest: f64,
}

impl Patch {
    fn evaluate(g: &mut Integrand<'_>, low: [f64; 2], high: [f64; 2]) -> Self {
        let centre = [0, 1].map(|a| 0.5 * (low[a] + high[a]));
        let half = [0, 1].map(|a| 0.5 * (high[a] - low[a]));
        let nodes = [0, 1].map(|a| KRONROD.map(|(x, _)| centre[a] + half[a] * x));
        let mut values = [0.0; NODES];
        g.evaluate(&nodes[0], &nodes[1], &mut values);
        // The Kronrod rule in both coordinates, and with the Gauss rule in one of them.
        let (mut fine, mut coarse_theta, mut coarse_phi) = (0.0, 0.0, 0.0);
        let mut largest = 0.0_f64;
        for (i, &(_, wt)) in KRONROD.iter().enumerate() {
            let (mut row, mut row_coarse) = (0.0, 0.0);
            for (j, &(_, wp)) in KRONROD.iter().enumerate() {
                let v = values[i * KRONROD.len() + j];
                largest = largest.max(v);
                row += wp * v;
                if j % 2 == 1 {
                    row_coarse += GAUSS[j / 2] * v;
                }
            }
            fine += wt * row;
            coarse_phi += wt * row_coarse;
            if i % 2 == 1 {
                coarse_theta += GAUSS[i / 2] * row;
            }
        }
        let area = half[0] * half[1];
        let errors = [coarse_theta, coarse_phi].map(|c| ((fine - c) * area).abs());
        Patch {
            low,
            high,
            value: fine * area,
            error: errors[0] + errors[1],
            axis: usize::from(errors[1] > errors[0]),
            largest,
        }
    }

    fn halves(&self, axis: usize) -> [([f64; 2], [f64; 2]); 2] {
        let (mut low, mut high) = (self.low, self.high);
        let middle = 0.5 * (low[axis] + high[axis]);
        high[axis] = middle;
        low[axis] = middle;
        [(self.low, high), (low, self.high)]
    }

    /// The coordinate to halve when the box is too coarse for its error to be trusted: large for its distance from
    /// `centre`, or with a hint inside or close by that towers above its nodes.
    fn coarse_axis(&self, centre: [f64; 2], hints: &[Hint]) -> Option<usize> {
        let size = [0, 1].map(|a| self.high[a] - self.low[a]);
        let width = [size[0], size[1] * (0.5 * (self.low[0] + self.high[0])).sin()];
        let longer = usize::from(width[1] > width[0]);
        let distance = [0, 1]
            .map(|a| (self.low[a] - centre[a]).max(centre[a] - self.high[a]))
            .into_iter()
            .fold(0.0, f64::max);
        if size[1] > 2.0 {
            return Some(1);
        }
        let missed = || {
            hints.iter().any(|h| {
                (0..2).all(|a| (self.low[a]..=self.high[a]).contains(&h.at[a]))
                    && h.value > 2.0 * self.largest
            })
        };
        (width[longer] > CENTRE + distance || (width[longer] > 1e-6 && missed())).then_some(longer)
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
