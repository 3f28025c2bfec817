//! Many pairs of a compact model at once, in single precision.

use gonio_geom::{Component, Side};
use multiversion::multiversion;

use crate::analytic::{Fast, Real};
use crate::batch::Directions;

use super::Part;
use super::frame::{ANISOTROPIC, BILATERAL, CHIRAL, ISOTROPIC, QUADRILATERAL, Symmetry};

/// Pairs that are worked on together.
const LANES: usize = 64;
/// Most channels of a pass.
const ROWS: usize = 4;

type Lanes = [f32; LANES];

/// Multiplies base values `f` (one row a channel) by the ratio of `part`, and adds them to `out`, for the pairs that lie in
/// the part's component.
pub(super) fn add(
    part: &Part,
    wi: Directions<'_, f32>,
    ws: Directions<'_, f32>,
    base: &[&mut [f32]],
    out: &mut [&mut [f32]],
) {
    match part.frame.symmetry {
        Symmetry::Isotropic => add_loop::<ISOTROPIC>(part, wi, ws, base, out),
        Symmetry::IsotropicChiral => add_loop::<CHIRAL>(part, wi, ws, base, out),
        Symmetry::Quadrilateral => add_loop::<QUADRILATERAL>(part, wi, ws, base, out),
        Symmetry::Bilateral => add_loop::<BILATERAL>(part, wi, ws, base, out),
        Symmetry::Anisotropic => add_loop::<ANISOTROPIC>(part, wi, ws, base, out),
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw+fma", "x86_64+avx2+fma+bmi2"))]
fn add_loop<const KIND: u8>(
    part: &Part,
    wi: Directions<'_, f32>,
    ws: Directions<'_, f32>,
    base: &[&mut [f32]],
    out: &mut [&mut [f32]],
) {
    let n = out.first().map_or(0, |row| row.len());
    let sign = part.side.sign() as f32;
    let turn = if part.component == Component::Transmission {
        -sign
    } else {
        sign
    };
    let chart = part.frame.chart();
    let density = part.frame.density().map(|d| d as f32);
    let mut i = [[0.0; LANES]; 3];
    let mut s = [[0.0; LANES]; 3];
    let mut logs = [[0.0; LANES]; ROWS];
    for start in (0..n).step_by(LANES) {
        load(wi, start, n, &mut i);
        load(ws, start, n, &mut s);
        let mut inside = [0.0; LANES];
        let mut positions = [[0.0; LANES]; 4];
        let mut any = 0.0;
        for l in 0..LANES {
            let (zi, zs) = (i[2][l] * sign, s[2][l] * turn);
            let lit = if (zi > 0.0) & (zs > 0.0) { 1.0 } else { 0.0 };
            inside[l] = lit;
            any += lit;
            let at = chart.coordinates::<Fast<f32>, KIND>(
                [Fast(i[0][l]), Fast(i[1][l]), Fast(zi.abs())],
                [Fast(s[0][l]), Fast(s[1][l]), Fast(zs.abs())],
            );
            for k in 0..4 {
                positions[k][l] = at[k].0 * density[k];
            }
        }
        if any == 0.0 {
            continue;
        }
        for c in (0..base.len()).step_by(ROWS) {
            let rows = (base.len() - c).min(ROWS);
            part.dense
                .interpolate_group(c / ROWS, &positions, &inside, &mut logs[..rows]);
            for (k, log) in logs[..rows].iter().enumerate() {
                apply(
                    log,
                    &inside,
                    &base[c + k][start..n.min(start + LANES)],
                    &mut out[c + k][start..n.min(start + LANES)],
                );
            }
        }
    }
}

/// `out += base e^log` where `inside` is 1.
#[inline(always)]
fn apply(log: &Lanes, inside: &Lanes, base: &[f32], out: &mut [f32]) {
    for (((log, inside), base), out) in log.iter().zip(inside).zip(base).zip(out) {
        let value = Fast(*log).exp().0 * *base;
        *out += if *inside > 0.0 { value } else { 0.0 };
    }
}

/// Vectors `start..start + LANES` of `n`; past the end the last one is repeated.
#[inline(always)]
fn load(from: Directions<'_, f32>, start: usize, n: usize, to: &mut [Lanes; 3]) {
    match from {
        Directions::One(v) => {
            for (to, v) in to.iter_mut().zip(v) {
                *to = [v; LANES];
            }
        }
        Directions::Each(columns) => {
            for (to, from) in to.iter_mut().zip(columns) {
                if let Some(whole) = from.get(start..start + LANES) {
                    to.copy_from_slice(whole);
                } else {
                    for (l, v) in to.iter_mut().enumerate() {
                        *v = from[(start + l).min(n - 1)];
                    }
                }
            }
        }
    }
}

/// Whether any pair lies in the component of `side`.
pub(super) fn any_in(
    side: Side,
    component: Component,
    wi: Directions<'_, f32>,
    ws: Directions<'_, f32>,
    n: usize,
) -> bool {
    let sign = side.sign() as f32;
    let turn = if component == Component::Transmission {
        -sign
    } else {
        sign
    };
    (0..n).any(|j| wi.at(j)[2] * sign > 0.0 && ws.at(j)[2] * turn > 0.0)
}
