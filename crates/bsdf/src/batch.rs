//! Many pairs at once, as columns of vector components, in single or double precision.

use gonio_geom::{DVec3, Direction};
use multiversion::multiversion;

use crate::Bsdf;
use crate::analytic::{Fast, Real};

/// The two precisions of a batch.
pub trait Number: Copy + Send + Sync + Default + PartialOrd + Into<f64> + 'static {
    /// The same as a number of formulas.
    type Fast: Real<Plain = Self::Fast>;
    /// As a number of formulas.
    fn fast(self) -> Self::Fast;
    /// Back from a number of formulas.
    fn of(fast: Self::Fast) -> Self;
    /// Rounded from `v`.
    fn rounded(v: f64) -> Self;
    /// [`Bsdf::eval_f32`] or [`Bsdf::eval_f64`].
    fn eval(model: &dyn Bsdf, wi: Directions<'_, Self>, ws: Directions<'_, Self>, f: &mut [&mut [Self]]);
    /// [`Bsdf::sample_f32`] or [`Bsdf::sample_f64`].
    fn sample(model: &dyn Bsdf, w: Directions<'_, Self>, u: [&[Self]; 3], out: &mut SampleColumns<'_, Self>);
}

macro_rules! number {
    ($t:ty, $eval:ident, $sample:ident) => {
        impl Number for $t {
            type Fast = Fast<$t>;
            #[inline(always)]
            fn fast(self) -> Fast<$t> {
                Fast(self)
            }
            #[inline(always)]
            fn of(fast: Fast<$t>) -> $t {
                fast.0
            }
            #[inline(always)]
            fn rounded(v: f64) -> $t {
                v as $t
            }
            fn eval(model: &dyn Bsdf, wi: Directions<'_, $t>, ws: Directions<'_, $t>, f: &mut [&mut [$t]]) {
                model.$eval(wi, ws, f);
            }
            fn sample(
                model: &dyn Bsdf,
                w: Directions<'_, $t>,
                u: [&[$t]; 3],
                out: &mut SampleColumns<'_, $t>,
            ) {
                model.$sample(w, u, out);
            }
        }
    };
}
number!(f32, eval_f32, sample_f32);
number!(f64, eval_f64, sample_f64);

/// One end of the pairs of a batch. Vectors are unit vectors to the precision of their numbers and are taken as they
/// are, never normalised.
#[derive(Clone, Copy, Debug)]
pub enum Directions<'a, T> {
    /// The same for every pair.
    One([T; 3]),
    /// One a pair: columns of x, y and z.
    Each([&'a [T]; 3]),
}

impl<'a, T: Number> Directions<'a, T> {
    /// The direction of pair `j`.
    #[inline(always)]
    pub fn at(&self, j: usize) -> [T; 3] {
        match self {
            Directions::One(v) => *v,
            Directions::Each(columns) => columns.map(|c| c[j]),
        }
    }

    /// Those of the pairs in `range` (panics past the end, as slices do).
    pub fn range(&self, range: std::ops::Range<usize>) -> Directions<'a, T> {
        match self {
            Directions::One(v) => Directions::One(*v),
            Directions::Each(columns) => Directions::Each(columns.map(|c| &c[range.clone()])),
        }
    }

    /// Whether there are `n` of them, or one for all.
    pub(crate) fn serves(&self, n: usize) -> bool {
        match self {
            Directions::One(_) => true,
            Directions::Each(columns) => columns.iter().all(|c| c.len() == n),
        }
    }

    /// The first vector whose squared length differs from 1 by more than `tolerance`, or that is not finite.
    pub fn first_not_unit(&self, tolerance: T) -> Option<usize> {
        match self {
            Directions::One(v) => (!all_unit([&v[..1], &v[1..2], &v[2..]], tolerance)).then_some(0),
            Directions::Each(columns) => {
                if all_unit(*columns, tolerance) {
                    return None;
                }
                (0..columns[0].len()).find(|&j| !all_unit(columns.map(|c| &c[j..=j]), tolerance))
            }
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw+fma", "x86_64+avx2+fma+bmi2"))]
fn all_unit<T: Number>(v: [&[T]; 3], tolerance: T) -> bool {
    // Counted rather than left early or joined as bools: that vectorises.
    let mut bad = 0_u32;
    for ((x, y), z) in v[0].iter().zip(v[1]).zip(v[2]) {
        let [x, y, z] = [x.fast(), y.fast(), z.fast()];
        let length2 = T::of(x * x + y * y + z * z - 1.0);
        let good = (length2 <= tolerance) & (T::of(-length2.fast()) <= tolerance);
        bad |= u32::from(!good);
    }
    bad == 0
}

/// The first number that is not in `[0, 1)`.
pub fn first_not_uniform<T: Number>(u: &[T]) -> Option<T> {
    if all_uniform(u) {
        return None;
    }
    u.iter().copied().find(|v| !all_uniform(&[*v]))
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw+fma", "x86_64+avx2+fma+bmi2"))]
fn all_uniform<T: Number>(u: &[T]) -> bool {
    let (zero, one) = (T::default(), T::rounded(1.0));
    let mut bad = 0_u32;
    for v in u {
        bad |= u32::from(!((*v >= zero) & (*v < one)));
    }
    bad == 0
}

/// Where the samples of a batch go.
pub struct SampleColumns<'a, T> {
    /// Components of the sampled directions; NaN for a failed sample.
    pub direction: [&'a mut [T]; 3],
    /// `f |cos| / pdf`, one row a channel; 0 for a failed sample.
    pub weight: Vec<&'a mut [T]>,
    /// Density per unit solid angle; 0 for a failed sample.
    pub pdf: &'a mut [T],
}

/// A unit vector in double precision; `None` for what has no direction.
fn direction<T: Number>(v: [T; 3]) -> Option<Direction> {
    Direction::new(DVec3::from_array(v.map(Into::into)))
}

/// `eval` pair by pair.
pub(crate) fn eval_each<B: Bsdf + ?Sized, T: Number>(
    model: &B,
    wi: Directions<'_, T>,
    ws: Directions<'_, T>,
    f: &mut [&mut [T]],
) {
    let mut values = vec![0.0; f.len()];
    for j in 0..f.first().map_or(0, |row| row.len()) {
        match (direction(wi.at(j)), direction(ws.at(j))) {
            (Some(wi), Some(ws)) => model.eval(wi, ws, &mut values),
            _ => values.fill(0.0),
        }
        for (row, v) in f.iter_mut().zip(&values) {
            row[j] = T::rounded(*v);
        }
    }
}

/// `sample` one by one.
pub(crate) fn sample_each<B: Bsdf + ?Sized, T: Number>(
    model: &B,
    w: Directions<'_, T>,
    u: [&[T]; 3],
    out: &mut SampleColumns<'_, T>,
) {
    let mut values = vec![0.0; out.weight.len()];
    for j in 0..out.pdf.len() {
        let w = direction(w.at(j));
        // Rounding u up to 1 is not for a sampler to see.
        let u = u.map(|u| Into::<f64>::into(u[j]).clamp(0.0, 1.0 - f64::EPSILON));
        let drawn = w.and_then(|w| Some((w, model.sample(w, u)?)));
        let (v, pdf) = match drawn {
            Some((w, sample)) => {
                model.eval(w, sample.direction, &mut values);
                let cosine = sample.direction.cos_theta().abs();
                values.iter_mut().for_each(|v| *v *= cosine / sample.pdf);
                if sample.lobe == crate::Lobe::Delta {
                    // An ideal direction has no f to take the other channels from.
                    values.fill(f64::NAN);
                }
                if let Some(first) = values.first_mut() {
                    *first = sample.weight;
                }
                (sample.direction.vec().to_array(), sample.pdf)
            }
            None => {
                values.fill(0.0);
                ([f64::NAN; 3], 0.0)
            }
        };
        for (column, v) in out.direction.iter_mut().zip(v) {
            column[j] = T::rounded(v);
        }
        for (row, v) in out.weight.iter_mut().zip(&values) {
            row[j] = T::rounded(*v);
        }
        out.pdf[j] = T::rounded(pdf);
    }
}
