//! The registry: every analytic model behind one object-safe interface.

use std::marker::PhantomData;

use gonio_geom::Component;
use multiversion::multiversion;

use super::{Analytic, Dual, Fast, Formula, ModelInfo, Pair, PairsView, Real};
use crate::{Bsdf, BsdfError, Channel};

/// A model without its parameters: what the command line and the law tests work with.
pub trait Parametric: Send + Sync {
    /// The model as data.
    fn info(&self) -> &'static ModelInfo;

    /// The model with `parameters`, one list a channel.
    ///
    /// # Errors
    /// As [`Analytic::new`].
    fn model(&self, parameters: &[(Channel, Vec<f64>)]) -> Result<Box<dyn Bsdf>, BsdfError>;

    /// Refractive index behind the sample over that in front of it, for parameters `p`: transmission is reciprocal in
    /// `f / n_s^2`. Without an interface it is 1.
    fn index_ratio(&self, _p: &[f64]) -> f64 {
        1.0
    }
}

/// A model that has derivatives by its parameters: what the fit works with.
pub trait Family: Parametric {
    /// The DSF `f |cos theta_s|` of each pair and its derivatives by each parameter.
    ///
    /// `p` has one value a parameter, `dsf` one entry a pair, `gradient` one row a parameter of as many entries as
    /// pairs (parameter-major). Lengths that do not match panic. Zero where the model does not scatter. Parameters
    /// are not checked against their range.
    fn dsf_and_gradient(&self, p: &[f64], pairs: PairsView<'_>, dsf: &mut [f64], gradient: &mut [f64]);

    /// The DSF of each pair, as [`Family::dsf_and_gradient`].
    fn dsf(&self, p: &[f64], pairs: PairsView<'_>, dsf: &mut [f64]);
}

/// The family of formula `F` with `N` parameters.
pub struct Of<F, const N: usize>(PhantomData<F>);

impl<F: Formula, const N: usize> Of<F, N> {
    /// The family; `N` must be the number of parameters of `F` (checked at compile time).
    pub const NEW: Self = {
        assert!(
            F::INFO.parameters.len() == N,
            "N must be the number of parameters"
        );
        Of(PhantomData)
    };
}

impl<F: Formula, const N: usize> Parametric for Of<F, N> {
    fn info(&self) -> &'static ModelInfo {
        F::INFO
    }

    fn model(&self, parameters: &[(Channel, Vec<f64>)]) -> Result<Box<dyn Bsdf>, BsdfError> {
        Ok(Box::new(Analytic::<F>::new(parameters)?))
    }

    fn index_ratio(&self, p: &[f64]) -> f64 {
        F::index_ratio(p)
    }
}

impl<F: Formula, const N: usize> Family for Of<F, N> {
    fn dsf_and_gradient(&self, p: &[f64], pairs: PairsView<'_>, dsf: &mut [f64], gradient: &mut [f64]) {
        assert_eq!(p.len(), N, "parameters of {}", F::INFO.name);
        assert_eq!(dsf.len(), pairs.len(), "one value a pair");
        assert_eq!(gradient.len(), N * pairs.len(), "one row a parameter");
        gradient_loop::<F, N>(p, pairs, dsf, gradient);
    }

    fn dsf(&self, p: &[f64], pairs: PairsView<'_>, dsf: &mut [f64]) {
        assert_eq!(p.len(), N, "parameters of {}", F::INFO.name);
        assert_eq!(dsf.len(), pairs.len(), "one value a pair");
        value_loop::<F, N>(p, pairs, dsf);
    }
}

/// Pairs that are worked on together; a loop of this fixed length over local arrays vectorises.
const LANES: usize = 16;

type Block = [[f64; LANES]; 3];

/// Rows `start..start + LANES` of the columns; past the end the last row is repeated.
#[inline(always)]
fn block(columns: [&[f64]; 3], start: usize) -> Block {
    let n = columns[0].len();
    let mut block = [[0.0; LANES]; 3];
    for (to, from) in block.iter_mut().zip(columns) {
        if start + LANES <= n {
            to.copy_from_slice(&from[start..start + LANES]);
        } else {
            for (l, v) in to.iter_mut().enumerate() {
                *v = from[(start + l).min(n - 1)];
            }
        }
    }
    block
}

#[inline(always)]
fn pair(wi: [f64; 3], b: &Block, l: usize) -> Pair<Fast<f64>> {
    Pair {
        wi: [Fast(wi[0]), Fast(wi[1]), Fast(wi[2])],
        ws: [Fast(b[0][l]), Fast(b[1][l]), Fast(b[2][l])],
    }
}

/// `|cos theta_s|` where the formula holds, else 0.
#[inline(always)]
fn cosine<F: Formula>(ci: f64, cs: f64) -> f64 {
    let lit = (ci > 0.0)
        & (((cs > 0.0) & F::INFO.scatters.into(Component::Reflection))
            | ((cs < 0.0) & F::INFO.scatters.into(Component::Transmission)));
    if lit { cs.abs() } else { 0.0 }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw+fma", "x86_64+avx2+fma+bmi2"))]
fn value_loop<F: Formula, const N: usize>(p: &[f64], pairs: PairsView<'_>, dsf: &mut [f64]) {
    let parameters: [Fast<f64>; N] = std::array::from_fn(|k| Fast(p[k]));
    let shape = F::shape::<Fast<f64>>(&parameters);
    // The side the light comes from is the front of the formula.
    let shape = if F::SIDED && pairs.back {
        F::behind(&shape)
    } else {
        shape
    };
    for (k, out) in dsf.chunks_mut(LANES).enumerate() {
        let b = block(pairs.ws, k * LANES);
        let mut value = [0.0; LANES];
        for l in 0..LANES {
            let c = cosine::<F>(pairs.wi[2], b[2][l]);
            let f = F::bsdf::<Fast<f64>>(&shape, &pair(pairs.wi, &b, l)).0 * c;
            value[l] = if c > 0.0 { f } else { 0.0 };
        }
        out.copy_from_slice(&value[..out.len()]);
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw+fma", "x86_64+avx2+fma+bmi2"))]
fn gradient_loop<F: Formula, const N: usize>(
    p: &[f64],
    pairs: PairsView<'_>,
    dsf: &mut [f64],
    gradient: &mut [f64],
) {
    let n = dsf.len();
    let parameters: [Dual<Fast<f64>, N>; N] = std::array::from_fn(|k| Dual::variable(p[k], k));
    let shape = F::shape::<Dual<Fast<f64>, N>>(&parameters);
    // The side the light comes from is the front of the formula.
    let shape = if F::SIDED && pairs.back {
        F::behind(&shape)
    } else {
        shape
    };
    for (k, out) in dsf.chunks_mut(LANES).enumerate() {
        let b = block(pairs.ws, k * LANES);
        let mut value = [0.0; LANES];
        let mut slope = [[0.0; LANES]; N];
        for l in 0..LANES {
            let c = cosine::<F>(pairs.wi[2], b[2][l]);
            let f = F::bsdf::<Dual<Fast<f64>, N>>(&shape, &pair(pairs.wi, &b, l)).times(Fast(c));
            value[l] = if c > 0.0 { f.value.0 } else { 0.0 };
            for (row, d) in slope.iter_mut().zip(f.slope) {
                row[l] = if c > 0.0 { d.0 } else { 0.0 };
            }
        }
        out.copy_from_slice(&value[..out.len()]);
        for (row, from) in gradient.chunks_exact_mut(n).zip(&slope) {
            row[k * LANES..k * LANES + out.len()].copy_from_slice(&from[..out.len()]);
        }
    }
}
