//! Averages over pairs of patches of the two hemispheres.
//!
//! A ray through the window that leaves through it, or through the window on the other side, counts for its way back as well
//! (Helmholtz reciprocity [Veach1997, sec. 5.2]). One that leaves a part beside its window does not: the light that would come in there is
//! not asked for.

use std::sync::atomic::AtomicBool;

use glam::Vec3;
use gonio_bsdf::FourComponents;
use gonio_bsdf::klems::{KlemsBasis, Role};
use gonio_geom::{Component, Direction, Side};

use super::Device;
use super::rows::{Effort, Mean, Patches, Progress, Row, grey, key, rows};

/// A matrix over pairs of patches, `[exit][incident]` row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchTable {
    /// Mean BSDF of each pair, red, green and blue, 1/sr.
    pub values: Vec<[f64; 3]>,
    /// Standard error of its luminance (of equal red, green and blue: of each), 1/sr.
    pub errors: Vec<f64>,
}

impl PatchTable {
    /// Luminance of pair `k`, 1/sr: that of its red, green and blue over that of white.
    pub fn luminance(&self, k: usize) -> f64 {
        grey(self.values[k])
    }
}

/// BSDF of a device, averaged over pairs of patches: rays are followed through points and directions that are even in area
/// and projected solid angle. Two estimates of one pair, one from each of its ends, are one value by reciprocity; each counts as
/// its scatter lets it.
///
/// Of a part that does not repeat, values are of the light that falls on the window, wherever it leaves; from sides that no rays
/// are sent from, of the light that leaves through the window, wherever it comes from.
///
/// `None` when `stop` was set before the end.
pub fn patch_tables(
    device: &Device,
    basis: &KlemsBasis,
    effort: &Effort,
    stop: &AtomicBool,
    report: Progress<'_>,
) -> Option<FourComponents<PatchTable>> {
    let rows = rows(device, basis, effort, stop, report, |row| row)?;
    Some(tables(basis, &rows))
}

impl Patches for KlemsBasis {
    const RECIPROCAL: bool = true;

    fn starts(&self) -> usize {
        self.len()
    }

    fn exits(&self) -> usize {
        self.len()
    }

    fn lambda(&self, exit: usize) -> f64 {
        KlemsBasis::lambda(self)[exit]
    }

    fn exit(&self, _: Vec3, ws: Direction) -> usize {
        self.patch(ws, Role::Exit)
    }

    fn point(&self, start: usize, side: Side, [s, t, _]: [f64; 3]) -> Direction {
        KlemsBasis::point(self, start, Role::Exit, side, s, t)
    }
}

/// Matrices from rows: what each says of its direction as that of the light, and as that of the exit.
fn tables(basis: &KlemsBasis, rows: &[Row]) -> FourComponents<PatchTable> {
    let n = basis.len();
    // The index of each patch as incident.
    let turned: Vec<usize> = (0..n)
        .map(|k| basis.patch(basis.point(k, Role::Exit, Side::Front, 0.5, 0.5), Role::Incident))
        .collect();
    let mut sums: [Vec<Mean>; 4] = Default::default();
    let mut put = |key: usize, exit: usize, incident: usize, part: &Mean| {
        if sums[key].is_empty() {
            sums[key] = vec![([0.0; 3], 0.0); n * n];
        }
        let sum = &mut sums[key][exit * n + turned[incident]];
        for (s, x) in sum.0.iter_mut().zip(part.0) {
            *s += x;
        }
        sum.1 += part.1;
    };
    for row in rows {
        for (k, end) in Side::BOTH.into_iter().enumerate() {
            let component = Component::between(row.side, end);
            for (patch, (onward, back)) in row.onward[k].iter().zip(&row.back[k]).enumerate() {
                put(key(row.side, component), patch, row.start, onward);
                put(key(end, component), row.start, patch, back);
            }
        }
    }
    let mut four = FourComponents::default();
    for ((side, component), sums) in FourComponents::<()>::KEYS.into_iter().zip(sums) {
        if !sums.is_empty() {
            let table = PatchTable {
                values: sums.iter().map(|(f, _)| *f).collect(),
                errors: sums.iter().map(|(_, square)| square.sqrt()).collect(),
            };
            four.set(side, component, Some(table));
        }
    }
    four
}
