//! How far a prediction is from a reading.

use multiversion::multiversion;

/// The measure that a fit minimises. All of them work on the DSF, never on the BSDF, whose noise explodes at the horizon.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Metric {
    /// `(prediction - reading) / sigma` with the soft-L1 loss `2 (sqrt(1 + r^2) - 1)`: the most precise where the model is
    /// right, and not moved by outliers.
    #[default]
    Chi2,
    /// Differences of cube roots, each with the root of its solid angle: close to what the eye sees
    /// \[ForesFerwerdaGu2012\].
    CubeRoot,
    /// Differences of `ln(1 + dsf)`, each with the root of its solid angle.
    Log1p,
}

impl Metric {
    /// All of them.
    pub const ALL: [Metric; 3] = [Metric::Chi2, Metric::CubeRoot, Metric::Log1p];

    /// Name used in files and Python.
    pub fn name(self) -> &'static str {
        match self {
            Metric::Chi2 => "chi2",
            Metric::CubeRoot => "cube_root",
            Metric::Log1p => "log1p",
        }
    }
}

/// The loss of a residual of chi-square.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Loss {
    /// `2 (sqrt(1 + r^2) - 1)`: grows linearly, so that outliers keep a bounded pull.
    #[default]
    SoftL1,
    /// `r^2`.
    Linear,
}

/// Cost and, a reading, the weight of `J J^T` (`curvature`) and of `J` (`pull`, the derivative of the loss by the
/// prediction).
pub(crate) struct Weighed<'a> {
    pub(crate) curvature: &'a mut [f64],
    pub(crate) pull: &'a mut [f64],
}

/// The columns of some readings.
#[derive(Clone, Copy)]
pub(crate) struct Columns<'a> {
    pub(crate) predicted: &'a [f64],
    pub(crate) y: &'a [f64],
    pub(crate) omega: &'a [f64],
    pub(crate) inverse_variance: &'a [f64],
}

impl<'a> Columns<'a> {
    /// Number of readings; predictions, readings, inverse variances and solid angles as slices of that length, whose
    /// bounds the compiler then need not check.
    #[inline(always)]
    fn of_one_length(self) -> (usize, [&'a [f64]; 4]) {
        let n = self.y.len();
        (
            n,
            [
                &self.predicted[..n],
                &self.y[..n],
                &self.inverse_variance[..n],
                &self.omega[..n],
            ],
        )
    }
}

/// Fills `out` and returns the cost. `floor` is added to both sides before a cube root is taken, so that its slope stays
/// finite in the noise; `by_solid_angle` weighs chi-square by the solid angle too.
pub(crate) fn weigh(
    metric: Metric,
    loss: Loss,
    by_solid_angle: bool,
    floor: f64,
    columns: Columns<'_>,
    out: &mut Weighed<'_>,
) -> f64 {
    match (metric, loss) {
        (Metric::Chi2, Loss::SoftL1) => soft_l1(columns, out.curvature, out.pull, by_solid_angle),
        (Metric::Chi2, Loss::Linear) => linear(columns, out.curvature, out.pull, by_solid_angle),
        (Metric::CubeRoot, _) => transformed(
            columns,
            out,
            |d| {
                let root = (d + floor).max(0.0).cbrt();
                (
                    root,
                    if root > 0.0 {
                        1.0 / (3.0 * root * root)
                    } else {
                        0.0
                    },
                )
            },
            |j| columns.omega[j],
        ),
        (Metric::Log1p, _) => transformed(
            columns,
            out,
            |d| {
                let v = (1.0 + d).max(0.5);
                (v.ln(), 1.0 / v)
            },
            |j| columns.omega[j],
        ),
    }
}

/// Squares of the differences of `transform`, which returns value and slope.
fn transformed(
    columns: Columns<'_>,
    out: &mut Weighed<'_>,
    transform: impl Fn(f64) -> (f64, f64),
    weight: impl Fn(usize) -> f64,
) -> f64 {
    let mut cost = 0.0;
    for j in 0..columns.y.len() {
        let (value, slope) = transform(columns.predicted[j]);
        let r = value - transform(columns.y[j]).0;
        let w = weight(j);
        cost += 0.5 * w * r * r;
        out.curvature[j] = w * slope * slope;
        out.pull[j] = w * slope * r;
    }
    cost
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw+fma", "x86_64+avx2+fma+bmi2"))]
fn linear(columns: Columns<'_>, curvature: &mut [f64], pull: &mut [f64], by_solid_angle: bool) -> f64 {
    let (n, [d, y, v, omega]) = columns.of_one_length();
    let (curvature, pull) = (&mut curvature[..n], &mut pull[..n]);
    for j in 0..n {
        let w = if by_solid_angle { omega[j] * v[j] } else { v[j] };
        curvature[j] = w;
        pull[j] = w * (d[j] - y[j]);
    }
    let mut cost = [0.0; LANES];
    let mut start = 0;
    while start < n {
        let end = (start + LANES).min(n);
        for j in start..end {
            cost[j - start] += 0.5 * pull[j] * (d[j] - y[j]);
        }
        start = end;
    }
    cost.iter().sum()
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw+fma", "x86_64+avx2+fma+bmi2"))]
fn soft_l1(columns: Columns<'_>, curvature: &mut [f64], pull: &mut [f64], by_solid_angle: bool) -> f64 {
    let (n, [d, y, v, omega]) = columns.of_one_length();
    let (curvature, pull) = (&mut curvature[..n], &mut pull[..n]);
    let mut cost = [0.0; LANES];
    let mut start = 0;
    while start < n {
        let end = (start + LANES).min(n);
        for j in start..end {
            let w = if by_solid_angle { omega[j] } else { 1.0 };
            let r = d[j] - y[j];
            let z = r * r * v[j];
            let root = (1.0 + z).sqrt();
            let inverse = 1.0 / root;
            let slope = w * v[j] * inverse;
            pull[j] = slope * r;
            curvature[j] = slope * inverse * inverse;
            cost[j - start] += w * z / (1.0 + root);
        }
        start = end;
    }
    cost.iter().sum()
}

/// Independent sums of a reduction.
const LANES: usize = 16;

/// Adds to `gradient` and to the upper triangle `matrix` (row after row) what `columns` (one row of `m` derivatives a
/// parameter) contribute. `scratch` is as long as a row.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw+fma", "x86_64+avx2+fma+bmi2"))]
pub(crate) fn accumulate(
    columns: &[f64],
    m: usize,
    curvature: &[f64],
    pull: &[f64],
    scratch: &mut [f64],
    gradient: &mut [f64],
    matrix: &mut [f64],
) {
    let scratch = &mut scratch[..m];
    let (curvature, pull) = (&curvature[..m], &pull[..m]);
    let mut at = 0;
    for a in 0..gradient.len() {
        let row = &columns[a * m..(a + 1) * m];
        gradient[a] += dot(row, pull);
        for j in 0..m {
            scratch[j] = row[j] * curvature[j];
        }
        for b in a..gradient.len() {
            matrix[at] += dot(scratch, &columns[b * m..(b + 1) * m]);
            at += 1;
        }
    }
}

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = [0.0; LANES];
    let n = a.len().min(b.len());
    let whole = n - n % LANES;
    for (x, y) in a[..whole].chunks_exact(LANES).zip(b[..whole].chunks_exact(LANES)) {
        for l in 0..LANES {
            sum[l] += x[l] * y[l];
        }
    }
    let mut total: f64 = sum.iter().sum();
    for j in whole..n {
        total += a[j] * b[j];
    }
    total
}
