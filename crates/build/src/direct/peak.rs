//! A peak of one slice that is as narrow as the beam itself, on a background that is not.

use gonio_fit::normal::Normal;
use gonio_fit::solver::{LeastSquares, SolverOptions, minimise};
use gonio_geom::{Component, DVec3, Direction};
use gonio_scan::{Flags, Slice};

use super::beam_shape::BeamShape;

/// Readings up to this many widths of the beam from the middle take part.
const REACH: f64 = 7.0;

/// Widths of the beam within which light must have been read, and beyond which the background is seen alone.
const CORE: f64 = 1.3;
const OUTSIDE: f64 = 3.0;

/// Fewest readings in both.
const LEAST_CORE: usize = 3;
const LEAST_OUTSIDE: usize = 12;

/// The peak is looked for up to this far from the mirror or through direction: widths of the beam, and radians (1 degree).
const ASTRAY: f64 = 3.0;
const FAR_ASTRAY: f64 = std::f64::consts::PI / 180.0;

/// Widths over that of the beam that count as the beam's own: a lobe adds its own width squared.
const NARROW: [f64; 2] = [0.75, 1.15];

/// Standard uncertainty of the logarithm of the width from which on it is not known.
const UNCLEAR: f64 = 0.1;

/// The background's 1/e half width is at least this many times that of the beam.
const BROAD: f64 = 2.5;

/// Chi-square with the peak over that without, at most.
const BETTER: f64 = 0.5;

/// What the beam's shape is not known to, relative to the value.
const SHAPE_ERROR: f64 = 0.03;

/// A reading is corrected for the peak where this holds no more than so many times the background, else the background
/// takes its place: what lies under a peak is not read, and a hole would let a base put another peak there.
const SHARE_CORRECTED: f64 = 0.1;

/// A reading is left as it is where the peak is less than this share of the background.
const TOUCHED: f64 = 1e-3;

/// Beyond so many widths from its middle the beam may be as high as one that is wider by the factor.
const SKIRT: f64 = 1.5;
const WIDER: f64 = 1.25;

/// Relative uncertainty of the background under the peak.
const BACKGROUND_ERROR: f64 = 0.05;

/// Solid angle of the readings over that of the disk they fill, off 1 by less: their sum is an integral.
const FILLED: f64 = 0.1;

/// A peak, and what the readings are without it.
#[derive(Clone, Debug)]
pub(super) struct Peak {
    /// Share of the incident light in the peak.
    pub(super) share: f64,
    /// Its standard uncertainty, calibration apart.
    pub(super) u_share: f64,
    /// Width over that of the beam.
    pub(super) scale: f64,
    /// Angle between its middle and the mirror or through direction, radians.
    pub(super) offset: f64,
    /// Readings it touches: number, DSF without the peak, and its independent uncertainty.
    pub(super) readings: Vec<(usize, f64, f64)>,
}

/// The outcome for one slice and component.
#[derive(Clone, Debug)]
pub(super) enum Found {
    /// There is a peak.
    Peak(Peak),
    /// There is none that is as narrow as the beam.
    Nothing,
    /// The readings about the direction are too few to tell.
    Unread,
}

/// Readings about the mirror or through direction, in its tangent plane.
#[derive(Clone)]
struct Surroundings {
    index: Vec<usize>,
    x: Vec<f64>,
    y: Vec<f64>,
    dsf: Vec<f64>,
    sigma: Vec<f64>,
    omega: Vec<f64>,
}

/// Variables: `ln a, x, y, ln s` of the peak `a S(gamma / s)`; `b, bx, by, k` of the background
/// `exp(b + bx x + by y - kx x^2 - ky y^2 - kxy x y)` about the same middle, in widths of the beam: a Gaussian lobe of any
/// axes.
struct Problem<'a> {
    around: &'a Surroundings,
    beam: &'a BeamShape,
}

/// Number of variables.
const VARIABLES: usize = 10;

impl Problem<'_> {
    /// Peak and background at reading `j` with the derivatives of their sum.
    fn at(&self, x: &[f64], j: usize) -> (f64, f64, [f64; VARIABLES]) {
        let w = self.beam.width;
        let (dx, dy) = (self.around.x[j] - w * x[1], self.around.y[j] - w * x[2]);
        let (scale, a) = (x[3].exp(), x[0].exp());
        let (s, by_gamma2, by_scale) = self.beam.density(dx * dx + dy * dy, scale);
        let (u, v) = (dx / w, dy / w);
        let curved = x[7] * u * u + x[8] * v * v + x[9] * u * v;
        let background = (x[4] + x[5] * u + x[6] * v - curved).exp();
        // The middle moves both.
        let moved = |d: f64, slope: f64| -2.0 * w * d * a * by_gamma2 - background * slope;
        let derivatives = [
            a * s,
            moved(dx, x[5] - 2.0 * x[7] * u - x[9] * v),
            moved(dy, x[6] - 2.0 * x[8] * v - x[9] * u),
            a * by_scale,
            background,
            background * u,
            background * v,
            -background * u * u,
            -background * v * v,
            -background * u * v,
        ];
        (a * s, background, derivatives)
    }

    /// By how much the peak may be higher than its shape says at reading `j`, beside its middle: the signature knows two
    /// radii of the beam, not its skirts.
    fn skirt(&self, x: &[f64], j: usize) -> f64 {
        let w = self.beam.width;
        let (dx, dy) = (self.around.x[j] - w * x[1], self.around.y[j] - w * x[2]);
        let gamma2 = dx * dx + dy * dy;
        if gamma2 < (SKIRT * w).powi(2) {
            return 0.0;
        }
        let wider = self.beam.density(gamma2, WIDER).0 - self.beam.density(gamma2, 1.0).0;
        x[0].exp() * wider.max(0.0)
    }

    /// Sum of squares of the residuals.
    fn chi2(&self, x: &[f64]) -> f64 {
        (0..self.around.index.len())
            .map(|j| {
                let (peak, background, _) = self.at(x, j);
                ((self.around.dsf[j] - peak - background) / self.around.sigma[j]).powi(2)
            })
            .sum()
    }
}

impl LeastSquares for Problem<'_> {
    fn len(&self) -> usize {
        VARIABLES
    }

    fn normal(&self, x: &[f64], out: &mut Normal) {
        for j in 0..self.around.index.len() {
            let (peak, background, derivatives) = self.at(x, j);
            let sigma = self.around.sigma[j];
            out.add_residual(
                (peak + background - self.around.dsf[j]) / sigma,
                &derivatives.map(|d| d / sigma),
            );
        }
    }
}

/// The peak of `component` in `slice`.
pub(super) fn find(slice: &Slice, component: Component, beam: &BeamShape) -> Found {
    let wi = slice.incidence.direction();
    let axis = match component {
        Component::Reflection => wi.mirror(),
        Component::Transmission => wi.through(),
    };
    let near = (ASTRAY * beam.width).max(FAR_ASTRAY);
    let Some(highest) = highest(slice, axis, near) else {
        return Found::Unread;
    };
    let around = Surroundings::of(slice, highest, beam);
    let w = beam.width;
    let at = |j: usize| around.x[j].hypot(around.y[j]);
    let core = (0..around.index.len()).filter(|&j| at(j) < CORE * w).count();
    let mut outside: Vec<f64> = (0..around.index.len())
        .filter(|&j| at(j) > OUTSIDE * w)
        .map(|j| around.dsf[j])
        .collect();
    if core < LEAST_CORE || outside.len() < LEAST_OUTSIDE {
        return Found::Unread;
    }
    outside.sort_unstable_by(f64::total_cmp);
    let problem = Problem {
        around: &around,
        beam,
    };
    let top = (0..around.index.len()).map(|j| around.dsf[j]).fold(0.0, f64::max);
    let level = outside[outside.len() / 2].max(1e-6 * top).max(f64::MIN_POSITIVE);
    let steepest = 1.0 / (BROAD * BROAD);
    let mut start = [0.0; VARIABLES];
    start[0] = (top / beam.density(0.0, 1.0).0).max(1e-12).ln();
    start[4] = level.ln();
    let flat = level.ln() - 20.0;
    let low = [
        -60.0, -ASTRAY, -ASTRAY, -1.0, flat, -2.0, -2.0, -0.02, -0.02, -steepest,
    ];
    let high = [
        5.0,
        ASTRAY,
        ASTRAY,
        1.5,
        top.ln() + 1.0,
        2.0,
        2.0,
        steepest,
        steepest,
        steepest,
    ];
    let with = minimise(&problem, &start, &low, &high, &SolverOptions::default());
    let mut alone = start;
    alone[0] = low[0];
    let fixed: [bool; VARIABLES] = std::array::from_fn(|k| k < 4);
    let options = SolverOptions {
        fixed: &fixed,
        ..SolverOptions::default()
    };
    let without = minimise(&problem, &alone, &low, &high, &options);
    let everything = [true; VARIABLES];
    let u_scale = with
        .normal
        .inverse(&everything)
        .map_or(f64::INFINITY, |m| m[(3, 3)].sqrt());
    if u_scale.is_nan() || u_scale > UNCLEAR {
        return Found::Unread;
    }
    let scale = with.x[3].exp();
    let narrow = (NARROW[0]..=NARROW[1]).contains(&scale);
    if !narrow || problem.chi2(&with.x) > BETTER * problem.chi2(&without.x) {
        return Found::Nothing;
    }
    // The beam scan tells the width better than the few readings of a narrow peak do.
    let mut start = with.x;
    start[3] = 0.0;
    let fixed: [bool; VARIABLES] = std::array::from_fn(|k| k == 3);
    let options = SolverOptions {
        fixed: &fixed,
        ..SolverOptions::default()
    };
    let doubted = around.with_doubt(&problem, &start);
    let problem = Problem {
        around: &doubted,
        beam,
    };
    let own = minimise(&problem, &start, &low, &high, &options);
    let relative = own
        .normal
        .inverse(&fixed.map(|f| !f))
        .map_or(f64::INFINITY, |m| m[(0, 0)].sqrt());
    let x = own.x;
    let fitted = x[0].exp();
    let (share, shape) = match around.summed(&problem, &x) {
        Some(share) => (share, 0.5 * (share - fitted)),
        None => (fitted, SHAPE_ERROR * fitted),
    };
    let u_share = (relative * fitted).hypot(shape);
    if !(u_share < 0.25 * share && share <= 1.05) {
        return Found::Nothing;
    }
    let middle = highest.1 + w * (x[1] * around_axes(highest.1).0 + x[2] * around_axes(highest.1).1);
    Found::Peak(Peak {
        share,
        u_share,
        scale,
        offset: Direction::new(middle).map_or(0.0, |m| m.angle_to(axis)),
        readings: around.without(&problem, &x),
    })
}

/// The highest reading within `near` of `axis`, and its direction.
fn highest(slice: &Slice, axis: Direction, near: f64) -> Option<(usize, DVec3)> {
    let cos = near.cos();
    (0..slice.len())
        .filter(|&j| readable(slice, j))
        .map(|j| (j, slice.direction(j)))
        .filter(|(_, d)| d.dot(axis) >= cos)
        .max_by(|a, b| slice.dsf[a.0].total_cmp(&slice.dsf[b.0]))
        .map(|(j, d)| (j, d.vec()))
}

fn readable(slice: &Slice, j: usize) -> bool {
    slice.flags[j].usable() && !slice.flags[j].intersects(Flags::HORIZON) && slice.dsf[j].is_finite()
}

fn around_axes(middle: DVec3) -> (DVec3, DVec3) {
    middle.any_orthonormal_pair()
}

impl Surroundings {
    fn of(slice: &Slice, (_, middle): (usize, DVec3), beam: &BeamShape) -> Self {
        let (a, b) = around_axes(middle);
        let reach = REACH * beam.width;
        let mut out = Surroundings {
            index: Vec::new(),
            x: Vec::new(),
            y: Vec::new(),
            dsf: Vec::new(),
            sigma: Vec::new(),
            omega: Vec::new(),
        };
        let mut top = 0.0f64;
        for j in (0..slice.len()).filter(|&j| readable(slice, j)) {
            let d = slice.direction(j).vec();
            let (x, y) = (d.dot(a), d.dot(b));
            if d.dot(middle) <= 0.0 || x.hypot(y) > reach {
                continue;
            }
            out.index.push(j);
            out.x.push(x);
            out.y.push(y);
            out.dsf.push(slice.dsf[j]);
            out.sigma
                .push(slice.u_independent(j).hypot(SHAPE_ERROR * slice.dsf[j]));
            out.omega.push(slice.omega[j]);
            top = top.max(slice.dsf[j]);
        }
        let least = (1e-6 * top).max(f64::MIN_POSITIVE);
        out.sigma.iter_mut().for_each(|s| *s = s.max(least));
        out
    }

    /// The same with what is not known of the beam's skirts in the uncertainties.
    fn with_doubt(&self, problem: &Problem<'_>, x: &[f64]) -> Self {
        let mut out = self.clone();
        for j in 0..self.index.len() {
            let doubt = problem.skirt(x, j);
            out.sigma[j] = out.sigma[j].hypot(doubt);
        }
        out
    }

    /// The share by summing what the fit leaves over the readings, where they fill their disk.
    fn summed(&self, problem: &Problem<'_>, x: &[f64]) -> Option<f64> {
        let w = problem.beam.width;
        let radius = OUTSIDE * w;
        let (mut sum, mut solid) = (0.0, 0.0);
        for j in 0..self.index.len() {
            if (self.x[j] - w * x[1]).hypot(self.y[j] - w * x[2]) < radius {
                let (peak, background, _) = problem.at(x, j);
                sum += self.omega[j] * (self.dsf[j] - peak - background);
                solid += self.omega[j];
            }
        }
        let disk = std::f64::consts::PI * radius * radius;
        ((solid / disk - 1.0).abs() < FILLED).then(|| x[0].exp() + sum)
    }

    /// The readings without the peak.
    fn without(&self, problem: &Problem<'_>, x: &[f64]) -> Vec<(usize, f64, f64)> {
        (0..self.index.len())
            .filter_map(|j| {
                let (peak, background, _) = problem.at(x, j);
                let doubt = problem.skirt(x, j);
                let most = peak.max(doubt);
                if most < TOUCHED * background {
                    return None;
                }
                let (dsf, u) = if most <= SHARE_CORRECTED * background {
                    (self.dsf[j] - peak, self.sigma[j].hypot(doubt))
                } else {
                    (background, BACKGROUND_ERROR * background)
                };
                Some((self.index[j], dsf, u))
            })
            .collect()
    }
}
