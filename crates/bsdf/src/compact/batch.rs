//! Many pairs of a compact model at once, in single precision.

use gonio_geom::{Component, Side};
use multiversion::multiversion;

use crate::analytic::{Fast, Real};
use crate::batch::Directions;

use super::dense::Slab;
use super::frame::{ANISOTROPIC, BILATERAL, CHIRAL, HALF_TURN, ISOTROPIC, QUADRILATERAL};
use super::{Part, Symmetry};

/// Pairs that are worked on together.
const LANES: usize = 64;
/// Most channels of a pass.
const ROWS: usize = 4;

type Lanes = [f32; LANES];

/// The table at the one incidence of `n` pairs, when there are enough of them to make it for.
pub(super) fn slab(part: &Part, wi: Directions<'_, f32>, n: usize) -> Option<Slab> {
    let Directions::One([x, y, z]) = wi else {
        return None;
    };
    if part.dense.plane() > n || Side::of_z(f64::from(z)) != part.side {
        return None;
    }
    let wi = [x, y, z.abs()].map(f64::from);
    let [x, p_i, ..] = part.frame.coordinates(wi, wi);
    let density = part.frame.density();
    Some(
        part.dense
            .slab((x * density[0]) as f32, (p_i * density[1]) as f32),
    )
}

/// Multiplies base values `f` (one row a channel) by the ratio of `part`, and adds them to `out`, for the pairs that lie in
/// the part's component.
pub(super) fn add(
    part: &Part,
    slab: Option<&Slab>,
    wi: Directions<'_, f32>,
    ws: Directions<'_, f32>,
    base: &[&mut [f32]],
    out: &mut [&mut [f32]],
) {
    match part.frame.symmetry {
        Symmetry::Isotropic => add_kind::<ISOTROPIC, 3>(part, slab, wi, ws, base, out),
        Symmetry::IsotropicChiral => add_kind::<CHIRAL, 3>(part, slab, wi, ws, base, out),
        Symmetry::Quadrilateral => add_kind::<QUADRILATERAL, 4>(part, slab, wi, ws, base, out),
        Symmetry::Bilateral => add_kind::<BILATERAL, 4>(part, slab, wi, ws, base, out),
        Symmetry::HalfTurn => add_kind::<HALF_TURN, 4>(part, slab, wi, ws, base, out),
        Symmetry::Anisotropic => add_kind::<ANISOTROPIC, 4>(part, slab, wi, ws, base, out),
    }
}

fn add_kind<const KIND: u8, const RANK: usize>(
    part: &Part,
    slab: Option<&Slab>,
    wi: Directions<'_, f32>,
    ws: Directions<'_, f32>,
    base: &[&mut [f32]],
    out: &mut [&mut [f32]],
) {
    match slab {
        Some(_) => add_loop::<KIND, 2>(part, slab, wi, ws, base, out),
        None => add_loop::<KIND, RANK>(part, None, wi, ws, base, out),
    }
}

/// `D` is 2 with a slab, which one incidence for all pairs has, without one the rank of the table.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw+fma", "x86_64+avx2+fma+bmi2"))]
fn add_loop<const KIND: u8, const D: usize>(
    part: &Part,
    slab: Option<&Slab>,
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
    load(wi, 0, n, &mut i);
    let one = [i[0][0], i[1][0], i[2][0]];
    for start in (0..n).step_by(LANES) {
        if D > 2 {
            load(wi, start, n, &mut i);
        }
        load(ws, start, n, &mut s);
        let mut inside = [0_u32; LANES];
        let mut positions = [[0.0; LANES]; 4];
        for l in 0..LANES {
            let [ix, iy, iz] = if D == 2 { one } else { [i[0][l], i[1][l], i[2][l]] };
            let (zi, zs) = (iz * sign, s[2][l] * turn);
            inside[l] = u32::from((zi > 0.0) & (zs > 0.0));
            let at = chart.coordinates::<Fast<f32>, KIND>(
                [Fast(ix), Fast(iy), Fast(zi.abs())],
                [Fast(s[0][l]), Fast(s[1][l]), Fast(zs.abs())],
            );
            positions[0][l] = at[0].0 * density[0];
            positions[1][l] = at[1].0 * density[1];
            positions[2][l] = at[2].0 * density[2];
            positions[3][l] = at[3].0 * density[3];
        }
        if inside == [0; LANES] {
            continue;
        }
        let places = part.dense.places::<D, LANES>(&positions);
        let range = start..n.min(start + LANES);
        for (group, base) in base.chunks(ROWS).enumerate() {
            let mut logs = [[0.0; LANES]; ROWS];
            part.dense
                .interpolate::<D, LANES>(group, slab, &places, &mut logs);
            for ((log, base), out) in logs.iter().zip(base).zip(&mut out[group * ROWS..]) {
                apply(log, &inside, &base[range.clone()], &mut out[range.clone()]);
            }
        }
    }
}

/// `out += base e^log` where `inside` is 1.
#[inline(always)]
fn apply(log: &Lanes, inside: &[u32; LANES], base: &[f32], out: &mut [f32]) {
    let mut values = [0.0; LANES];
    if let Some(whole) = base.first_chunk::<LANES>() {
        values = *whole;
    } else {
        values[..base.len()].copy_from_slice(base);
    }
    for l in 0..LANES {
        let value = Fast(log[l]).exp().0 * values[l];
        values[l] = if inside[l] == 1 { value } else { 0.0 };
    }
    if let Some(whole) = out.first_chunk_mut::<LANES>() {
        for l in 0..LANES {
            whole[l] += values[l];
        }
    } else {
        for (out, value) in out.iter_mut().zip(values) {
            *out += value;
        }
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
