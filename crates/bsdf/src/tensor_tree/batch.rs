//! Values and samples of many pairs: coordinates of a block in one loop, then its cells.

use gonio_geom::{Component, Side};
use multiversion::multiversion;

use super::mapping::{fixed, isotropic_incidence, mirror_azimuth, square};
use super::ring::INWARD;
use super::sample::{Point, Sampler};
use super::{Rank, Source, TensorTree};
use crate::batch::{Directions, Number, SampleColumns};

/// Pairs that are worked on together; their columns stay in the first cache.
const BLOCK: usize = 256;

/// Vectors of a block, as columns.
type Vectors = [[f64; BLOCK]; 3];

/// Pairs of a block whose directions leave to the same two sides.
struct Alike {
    place: [u16; BLOCK],
    incident: Vectors,
    exit: Vectors,
    position: [[u32; BLOCK]; 4],
    n: usize,
}

impl Alike {
    fn new() -> Self {
        Alike {
            place: [0; BLOCK],
            incident: [[0.0; BLOCK]; 3],
            exit: [[0.0; BLOCK]; 3],
            position: [[0; BLOCK]; 4],
            n: 0,
        }
    }

    fn push(&mut self, place: usize, incident: [f64; 3], exit: [f64; 3]) {
        let n = self.n;
        self.place[n] = place as u16;
        for k in 0..3 {
            self.incident[k][n] = incident[k];
            self.exit[k][n] = exit[k];
        }
        self.n += 1;
    }
}

/// Values of pairs; `wi` and `ws` are taken as unit vectors.
pub(crate) fn eval<T: Number>(model: &TensorTree, wi: Directions<'_, T>, ws: Directions<'_, T>, f: &mut [T]) {
    let mut alike = Alike::new();
    for (block, out) in f.chunks_mut(BLOCK).enumerate() {
        let start = block * BLOCK;
        let pair = |j: usize| -> ([f64; 3], [f64; 3]) {
            (wi.at(start + j).map(Into::into), ws.at(start + j).map(Into::into))
        };
        // Blocks are most often of one kind.
        let mut below = [0_usize; 2];
        for j in 0..out.len() {
            let (v, w) = pair(j);
            below[0] += usize::from(v[2] < 0.0);
            below[1] += usize::from(w[2] < 0.0);
        }
        for (i, s) in [(false, false), (false, true), (true, false), (true, true)] {
            let may = |below: usize, back: bool| below != if back { 0 } else { out.len() };
            if !may(below[0], i) || !may(below[1], s) {
                continue;
            }
            alike.n = 0;
            for j in 0..out.len() {
                let (v, w) = pair(j);
                if (v[2] < 0.0, w[2] < 0.0) == (i, s) {
                    alike.push(j, v, w);
                }
            }
            let (from, to) = (Side::BOTH[usize::from(i)], Side::BOTH[usize::from(s)]);
            match model.source(from, Component::between(from, to)) {
                Some(source) => values(&mut alike, source, out),
                None => alike.place[..alike.n]
                    .iter()
                    .for_each(|j| out[usize::from(*j)] = T::default()),
            }
        }
        for (j, f) in out.iter_mut().enumerate() {
            if pair(j).1[2] == 0.0 {
                *f = T::default();
            }
        }
    }
}

fn values<T: Number>(alike: &mut Alike, source: Source<'_>, out: &mut [T]) {
    let Alike {
        place,
        incident,
        exit,
        position,
        n,
    } = alike;
    let (i, o) = if source.reversed {
        (exit, incident)
    } else {
        (incident, exit)
    };
    let (grid, tree) = (source.grid(), source.tree);
    match tree.rank() {
        Rank::Three => {
            let scale = if source.reversed { INWARD } else { 1.0 };
            isotropic(i, o, scale, position, *n);
            let [a, b, c, _] = &*position;
            for j in 0..*n {
                out[usize::from(place[j])] = T::rounded(f64::from(grid.value(tree, [a[j], b[j], c[j]])));
            }
        }
        Rank::Four => {
            anisotropic(i, o, position, *n);
            let [a, b, c, d] = &*position;
            for j in 0..*n {
                out[usize::from(place[j])] =
                    T::rounded(f64::from(grid.value(tree, [a[j], b[j], c[j], d[j]])));
            }
        }
    }
}

/// Coordinates at rank 3, exit cosines times `scale`.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw+fma", "x86_64+avx2+fma+bmi2"))]
fn isotropic(i: &Vectors, o: &Vectors, scale: f64, position: &mut [[u32; BLOCK]; 4], n: usize) {
    let [a, b, c, _] = position;
    for j in 0..n.min(BLOCK) {
        let [at, u, v] = isotropic_coordinates([i[0][j], i[1][j]], [o[0][j] * scale, o[1][j] * scale]);
        (a[j], b[j], c[j]) = (fixed(at), fixed(u), fixed(v));
    }
}

/// Incident coordinate, and the square of the exit direction turned so that the mirror azimuth lies on `+x`.
#[inline(always)]
pub(crate) fn isotropic_coordinates(i: [f64; 2], o: [f64; 2]) -> [f64; 3] {
    let (c, s) = mirror_azimuth(i[0], i[1]);
    let (u, v) = square(c * o[0] + s * o[1], c * o[1] - s * o[0]);
    [isotropic_incidence(i[0], i[1]), u, v]
}

/// Coordinates at rank 4.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw+fma", "x86_64+avx2+fma+bmi2"))]
fn anisotropic(i: &Vectors, o: &Vectors, position: &mut [[u32; BLOCK]; 4], n: usize) {
    let [a, b, c, d] = position;
    for j in 0..n.min(BLOCK) {
        let (p, q) = square(-i[0][j], -i[1][j]);
        let (u, v) = square(o[0][j], o[1][j]);
        (a[j], b[j], c[j], d[j]) = (fixed(p), fixed(q), fixed(u), fixed(v));
    }
}

/// Samples, one row of weights.
pub(crate) fn sample<T: Number>(
    model: &TensorTree,
    w: Directions<'_, T>,
    u: [&[T]; 3],
    out: &mut SampleColumns<'_, T>,
) {
    let samplers = Side::BOTH.map(|side| Sampler::new(model, side));
    if samplers.iter().all(Sampler::only_columns) {
        sample_blocks(&samplers, w, u, out, Sampler::column_cell, Sampler::column_point);
    } else {
        sample_blocks(&samplers, w, u, out, Sampler::cell, Sampler::point);
    }
}

/// First the cells of a block, then the points in them: the cells' memory is asked for early.
#[inline(always)]
fn sample_blocks<'a, T: Number, C: Copy>(
    samplers: &[Sampler<'a>; 2],
    w: Directions<'_, T>,
    u: [&[T]; 3],
    out: &mut SampleColumns<'_, T>,
    cell: impl Fn(&Sampler<'a>, [f64; 3], f64) -> Option<C>,
    point: impl Fn(&Sampler<'a>, [f64; 3], C, [f64; 2]) -> Point,
) {
    // Rounding u up to 1 is not for a sampler to see.
    let uniform = |k: usize, j: usize| Into::<f64>::into(u[k][j]).clamp(0.0, 1.0 - f64::EPSILON);
    let mut drawn = Vec::with_capacity(BLOCK);
    for start in (0..out.pdf.len()).step_by(BLOCK) {
        let end = (start + BLOCK).min(out.pdf.len());
        drawn.clear();
        drawn.extend((start..end).map(|j| {
            let w: [f64; 3] = w.at(j).map(Into::into);
            cell(&samplers[usize::from(w[2] < 0.0)], w, uniform(2, j))
        }));
        for (j, cell) in (start..end).zip(&drawn) {
            let w: [f64; 3] = w.at(j).map(Into::into);
            let sampler = &samplers[usize::from(w[2] < 0.0)];
            let found = cell
                .map(|cell| point(sampler, w, cell, [uniform(0, j), uniform(1, j)]))
                .filter(|p| p.pdf > 0.0);
            let (direction, weight, pdf) =
                found.map_or(([f64::NAN; 3], 0.0, 0.0), |p| (p.direction, p.weight, p.pdf));
            for (column, v) in out.direction.iter_mut().zip(direction) {
                column[j] = T::rounded(v);
            }
            for row in &mut out.weight {
                row[j] = T::rounded(weight);
            }
            out.pdf[j] = T::rounded(pdf);
        }
    }
}
