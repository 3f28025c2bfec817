//! Loops over many pairs of one formula, as vector instructions of what the processor has.

use std::marker::PhantomData;

use gonio_geom::Component;
use multiversion::multiversion;

use super::{Formula, Pair, Real, Role};
use crate::batch::{Directions, Number, SampleColumns};

/// Pairs that are worked on together; a loop of this fixed length over local arrays vectorises.
const LANES: usize = 64;
/// Most parameters of a formula.
const MOST: usize = 16;
/// Channels that are worked on together when they differ in amplitudes and indices alone.
const TOGETHER: usize = 3;

type Lanes<T> = [[T; LANES]; 3];

/// Values of `F` into one row a channel, from one list of parameters a channel.
pub(super) fn eval<F: Formula, T: Number>(
    parameters: &[Vec<f64>],
    wi: Directions<'_, T>,
    ws: Directions<'_, T>,
    f: &mut [&mut [T]],
) {
    assert_eq!(f.len(), parameters.len(), "one row a channel");
    for (p, row) in parameters.iter().zip(f) {
        eval_loop::<F, T, 1, false>(std::slice::from_ref(p), wi, ws, [row]);
    }
}

/// [`eval`] that shares the work of channels that differ in amplitudes and indices alone, and that of one `wi` for all pairs.
pub(super) fn eval_together<F: Formula>(
    parameters: &[Vec<f64>],
    wi: Directions<'_, f32>,
    ws: Directions<'_, f32>,
    f: &mut [&mut [f32]],
) {
    assert_eq!(f.len(), parameters.len(), "one row a channel");
    for (p, rows) in parameters.chunks(TOGETHER).zip(f.chunks_mut(TOGETHER)) {
        match (rows, wi) {
            ([a, b, c], Directions::One(_)) if shared::<F>(p) => {
                eval_loop::<F, f32, 3, true>(p, wi, ws, [a, b, c]);
            }
            ([a, b, c], Directions::Each(_)) if shared::<F>(p) => {
                eval_loop::<F, f32, 3, false>(p, wi, ws, [a, b, c]);
            }
            (rows, _) => eval::<F, f32>(p, wi, ws, rows),
        }
    }
}

/// Samples of `F` with the first channel's parameters, weighted for every channel.
pub(super) fn sample<F: Formula, T: Number>(
    parameters: &[Vec<f64>],
    w: Directions<'_, T>,
    u: [&[T]; 3],
    out: &mut SampleColumns<'_, T>,
) {
    assert_eq!(out.weight.len(), parameters.len(), "one row a channel");
    let Some((first, others)) = out.weight.split_first_mut() else {
        return;
    };
    sample_loop::<F, T, 1, false>(&parameters[..1], w, u, &mut out.direction, [first], out.pdf);
    if others.is_empty() {
        return;
    }
    let s = out.direction.each_ref().map(|c| &c[..]);
    eval::<F, T>(&parameters[1..], w, Directions::Each(s), others);
    let zero = T::default();
    for row in others {
        for ((v, z), pdf) in row.iter_mut().zip(s[2]).zip(&*out.pdf) {
            let weight = v.fast() * z.fast().abs() / pdf.fast();
            *v = if *pdf > zero { T::of(weight) } else { zero };
        }
    }
}

/// [`sample`] as [`eval_together`] does it, for three channels.
pub(super) fn sample_together<F: Formula>(
    parameters: &[Vec<f64>],
    w: Directions<'_, f32>,
    u: [&[f32]; 3],
    out: &mut SampleColumns<'_, f32>,
) {
    assert_eq!(out.weight.len(), parameters.len(), "one row a channel");
    let direction = &mut out.direction;
    match (&mut out.weight[..], w) {
        ([a, b, c], Directions::One(_)) if shared::<F>(parameters) => {
            sample_loop::<F, f32, 3, true>(parameters, w, u, direction, [a, b, c], out.pdf);
        }
        ([a, b, c], Directions::Each(_)) if shared::<F>(parameters) => {
            sample_loop::<F, f32, 3, false>(parameters, w, u, direction, [a, b, c], out.pdf);
        }
        _ => sample::<F, f32>(parameters, w, u, out),
    }
}

/// What loops know about a formula when they are compiled. (A static may lie where the compiler cannot see into it.)
struct Known<F>(PhantomData<F>);

impl<F: Formula> Known<F> {
    const REFLECTS: bool = F::INFO.scatters.into(Component::Reflection);
    const TRANSMITS: bool = F::INFO.scatters.into(Component::Transmission);
    const PARAMETERS: usize = F::INFO.parameters.len();

    /// The parameters that usually differ between channels.
    const SPECTRAL: [bool; MOST] = {
        assert!(Self::PARAMETERS <= MOST, "room for every parameter");
        let mut spectral = [false; MOST];
        let mut k = 0;
        while k < Self::PARAMETERS {
            spectral[k] = matches!(F::INFO.parameters[k].role, Role::Amplitude | Role::Index);
            k += 1;
        }
        spectral
    };
}

/// Whether channels have all parameters in common that are not [`Known::SPECTRAL`].
fn shared<F: Formula>(parameters: &[Vec<f64>]) -> bool {
    (0..Known::<F>::PARAMETERS)
        .all(|k| Known::<F>::SPECTRAL[k] || parameters.iter().all(|p| p[k] == parameters[0][k]))
}

/// The prepared parameters of `C` channels, so built that the compiler sees what they have in common: no closures, which
/// may stay out of line, and indices that are known.
#[inline(always)]
#[allow(clippy::needless_range_loop)]
fn shapes<F: Formula, R: Real, const C: usize>(parameters: &[Vec<f64>]) -> [F::Shape<R>; C] {
    let mut p = [R::constant(0.0); MOST];
    for k in 0..Known::<F>::PARAMETERS {
        p[k] = R::constant(parameters[0][k]);
    }
    let mut shapes = [F::shape::<R>(&p[..Known::<F>::PARAMETERS]); C];
    for c in 1..C {
        for k in 0..Known::<F>::PARAMETERS {
            if Known::<F>::SPECTRAL[k] {
                p[k] = R::constant(parameters[c][k]);
            }
        }
        shapes[c] = F::shape::<R>(&p[..Known::<F>::PARAMETERS]);
    }
    shapes
}

/// Vectors `start..start + LANES`; past the end the last one is repeated.
#[inline(always)]
fn load<T: Number>(columns: [&[T]; 3], start: usize, to: &mut Lanes<T>) {
    for (to, from) in to.iter_mut().zip(columns) {
        if let Some(whole) = from.get(start..start + LANES) {
            to.copy_from_slice(whole);
        } else {
            for (l, v) in to.iter_mut().enumerate() {
                *v = from[(start + l).min(from.len() - 1)];
            }
        }
    }
}

/// Vector `l`, as numbers of formulas. (No closures below: a compiler that leaves one out of line does not vectorise.)
#[inline(always)]
fn at<T: Number>(lanes: &Lanes<T>, l: usize) -> [T::Fast; 3] {
    [lanes[0][l].fast(), lanes[1][l].fast(), lanes[2][l].fast()]
}

#[inline(always)]
fn store<T: Number>(lanes: &[T; LANES], start: usize, to: &mut [T]) {
    if let Some(whole) = to.get_mut(start..start + LANES) {
        whole.copy_from_slice(lanes);
    } else {
        let rest = &mut to[start..];
        rest.copy_from_slice(&lanes[..rest.len()]);
    }
}

/// Whether `F` scatters between cosines `ci > 0` and `cs`.
#[inline(always)]
fn lit<F: Formula, T: Number>(ci: T, cs: T) -> bool {
    let zero = T::default();
    (ci > zero) & (((cs > zero) & Known::<F>::REFLECTS) | ((cs < zero) & Known::<F>::TRANSMITS))
}

/// Side of `w`: what multiplies z to bring it to the front.
#[inline(always)]
fn side<R: Real>(z: R) -> R {
    R::select((-z).plain(), R::constant(-1.0), R::constant(1.0))
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw+fma", "x86_64+avx2+fma+bmi2"))]
fn eval_loop<F: Formula, T: Number, const C: usize, const ONE: bool>(
    parameters: &[Vec<f64>],
    wi: Directions<'_, T>,
    ws: Directions<'_, T>,
    mut f: [&mut [T]; C],
) {
    let n = f[0].len();
    assert!(
        f.iter().all(|row| row.len() == n) && wi.serves(n) && ws.serves(n),
        "one entry a pair"
    );
    let shapes = shapes::<F, T::Fast, C>(parameters);
    let mut i = [[T::default(); LANES]; 3];
    let mut s = [[T::default(); LANES]; 3];
    if let Directions::One(v) = wi {
        i = v.map(|v| [v; LANES]);
    }
    if let Directions::One(v) = ws {
        s = v.map(|v| [v; LANES]);
    }
    let one = at(&i, 0);
    for start in (0..n).step_by(LANES) {
        if let Directions::Each(columns) = wi {
            load(columns, start, &mut i);
        }
        if let Directions::Each(columns) = ws {
            load(columns, start, &mut s);
        }
        let mut values = [[T::default(); LANES]; C];
        #[allow(clippy::needless_range_loop)] // as many arrays as channels
        for l in 0..LANES {
            let wi = if ONE { one } else { at(&i, l) };
            let ws = at(&s, l);
            let side = side(wi[2]);
            let pair = Pair {
                wi: [wi[0], wi[1], wi[2] * side],
                ws: [ws[0], ws[1], ws[2] * side],
            };
            let lit = lit::<F, T>(T::of(pair.wi[2]), T::of(pair.ws[2]));
            for c in 0..C {
                let value = T::of(F::bsdf::<T::Fast>(&shapes[c], &pair));
                values[c][l] = if lit & (value > T::default()) {
                    value
                } else {
                    T::default()
                };
            }
        }
        for (row, lanes) in f.iter_mut().zip(&values) {
            store(lanes, start, row);
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw+fma", "x86_64+avx2+fma+bmi2"))]
fn sample_loop<F: Formula, T: Number, const C: usize, const ONE: bool>(
    parameters: &[Vec<f64>],
    w: Directions<'_, T>,
    u: [&[T]; 3],
    direction: &mut [&mut [T]; 3],
    mut weight: [&mut [T]; C],
    pdf: &mut [T],
) {
    let n = pdf.len();
    assert!(
        direction.iter().all(|row| row.len() == n)
            && weight.iter().all(|row| row.len() == n)
            && u.iter().all(|row| row.len() == n)
            && w.serves(n),
        "one entry a sample"
    );
    let shapes = shapes::<F, T::Fast, C>(parameters);
    let mut i = [[T::default(); LANES]; 3];
    if let Directions::One(v) = w {
        i = v.map(|v| [v; LANES]);
    }
    let one = at(&i, 0);
    let nan = T::rounded(f64::NAN);
    let mut uniform = [[T::default(); LANES]; 3];
    for start in (0..n).step_by(LANES) {
        if let Directions::Each(columns) = w {
            load(columns, start, &mut i);
        }
        load(u, start, &mut uniform);
        let mut sampled = [[T::default(); LANES]; 3];
        let mut weights = [[T::default(); LANES]; C];
        let mut densities = [T::default(); LANES];
        for l in 0..LANES {
            let w = if ONE { one } else { at(&i, l) };
            let u = at(&uniform, l);
            let side = side(w[2]);
            let w = [w[0], w[1], w[2] * side];
            let (s, density) = F::sample_lanes::<T::Fast>(&shapes[0], w, u);
            let pair = Pair { wi: w, ws: s };
            let lit = lit::<F, T>(T::of(w[2]), T::of(s[2])) & (T::of(density) > T::default());
            let factor = s[2].abs() / density;
            for c in 0..C {
                let value = T::of(F::bsdf::<T::Fast>(&shapes[c], &pair) * factor);
                weights[c][l] = if lit { value } else { T::default() };
            }
            densities[l] = if lit { T::of(density) } else { T::default() };
            sampled[0][l] = if lit { T::of(s[0]) } else { nan };
            sampled[1][l] = if lit { T::of(s[1]) } else { nan };
            sampled[2][l] = if lit { T::of(s[2] * side) } else { nan };
        }
        for (row, lanes) in direction.iter_mut().zip(&sampled) {
            store(lanes, start, row);
        }
        for (row, lanes) in weight.iter_mut().zip(&weights) {
            store(lanes, start, row);
        }
        store(&densities, start, pdf);
    }
}
