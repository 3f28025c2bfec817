//! Integration over the exit patches at one incidence, with cells that are halved where the model is rough.

use std::f64::consts::PI;

use gonio_bsdf::klems::{Ring, Role};
use gonio_geom::{Component, Direction};

use super::Filling;
use super::incident::Rows;
use super::rule::in_cosine;

/// Nodes of the two-point rule on `[0, 1]`.
const TWO: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];
/// Depth to which cells that touch the mirror, unbent or retro direction are halved in any case.
const DIRECTED_DEPTH: u32 = 4;
/// Depth at which halving stops.
const MAX_DEPTH: u32 = 12;
/// Width in azimuth, as a share of the cosine of incidence, to which cells on the plane of incidence are halved: a lobe
/// of slopes of width alpha narrows to `2 alpha cos theta_i` across the plane.
const RIDGE_WIDTH: f64 = 0.1;
/// Polar distance from the mirror or unbent direction up to which the plane of incidence is followed, radians.
const RIDGE_REACH: f64 = 0.35;

/// A part of an exit patch: shares of the way in cosine and azimuth.
#[derive(Clone, Copy, Debug)]
struct Part {
    t: f64,
    v: f64,
    side: f64,
    depth: u32,
}

impl Filling<'_> {
    /// Integrates over the exit patches at one incidence: `visit(patch, azimuths, share)` adds up to the average of the
    /// model over the patch; `azimuths` is the part of the patch's azimuth it stands for, as shares. Cells are
    /// halved in both coordinates until what they may be wrong by is small.
    pub(super) fn exit(&self, wi: Direction, out: &mut Rows, mut visit: impl FnMut(usize, [f64; 2], f64)) {
        let basis = &self.options.basis;
        let mut stack = Vec::new();
        for o in 0..basis.len() {
            let lambda = basis.lambda()[o];
            let ring = basis.ring(o);
            let reach = patch_reach(ring);
            stack.push(Part {
                t: 0.0,
                v: 0.0,
                side: 1.0,
                depth: 0,
            });
            while let Some(part) = stack.pop() {
                let (mut values, mut weights) = ([0.0; 4], [0.0; 4]);
                for (k, (value, weight)) in values.iter_mut().zip(&mut weights).enumerate() {
                    let (u, w) = in_cosine(ring, part.t + part.side * TWO[k & 1]);
                    let ws = basis.point(o, Role::Exit, self.to, u, part.v + part.side * TWO[k >> 1]);
                    *value = w * self.one.eval(wi, ws);
                    *weight = w;
                }
                out.evaluations += 4;
                let mean = values.iter().sum::<f64>() / 4.0;
                let level = mean / (weights.iter().sum::<f64>() / 4.0);
                let spread = values
                    .iter()
                    .zip(&weights)
                    .map(|(v, w)| (v - level * w).abs())
                    .sum::<f64>()
                    / 4.0;
                let area = part.side * part.side;
                let rough = spread * area * lambda > self.options.tolerance;
                let coarse = part.depth
                    < if ring.n_phi <= 8 {
                        if ring.n_phi == 1 { 2 } else { 1 }
                    } else {
                        0
                    };
                let directed = coarse || self.directed(wi, o, &part, reach);
                if (rough || directed) && part.depth < MAX_DEPTH {
                    let side = 0.5 * part.side;
                    for k in 0..4u32 {
                        stack.push(Part {
                            t: part.t + side * f64::from(k & 1),
                            v: part.v + side * f64::from(k >> 1),
                            side,
                            depth: part.depth + 1,
                        });
                    }
                    continue;
                }
                out.unsettled += usize::from(rough);
                for (k, value) in values.iter().enumerate() {
                    if *value > 0.0 {
                        let v = part.v + 0.5 * part.side * (k >> 1) as f64;
                        visit(o, [v, v + 0.5 * part.side], 0.25 * area * value);
                    }
                }
            }
        }
    }

    /// Whether a cell is halved whatever its values, so that narrow lobes are seen.
    fn directed(&self, wi: Direction, o: usize, part: &Part, reach: f64) -> bool {
        let basis = &self.options.basis;
        let ring = basis.ring(o);
        let (u, _) = in_cosine(ring, part.t + 0.5 * part.side);
        let centre = basis.point(o, Role::Exit, self.to, u, part.v + 0.5 * part.side);
        if part.depth < DIRECTED_DEPTH && self.off_axis(wi, centre) < reach * part.side {
            return true;
        }
        let width = 2.0 * PI / ring.n_phi as f64 * part.side;
        let polar = |d: Direction| d.vec().x.hypot(d.vec().y).atan2(d.vec().z.abs());
        let (theta_i, theta_s) = (polar(wi), polar(centre));
        if width * theta_s.sin() < RIDGE_WIDTH * theta_i.cos() || (theta_s - theta_i).abs() > RIDGE_REACH {
            return false;
        }
        // azimuth from the mirror azimuth
        let (i, c) = (wi.vec(), centre.vec());
        let azimuth = (i.x * c.y - i.y * c.x).atan2(i.x * c.x + i.y * c.y);
        (PI - azimuth.abs()) < 0.51 * width
    }

    /// Angle of `ws` from the mirror or unbent direction, or from the retro direction where that is nearer.
    fn off_axis(&self, wi: Direction, ws: Direction) -> f64 {
        let straight = match self.component {
            Component::Reflection => wi.mirror(),
            Component::Transmission => wi.through(),
        };
        let angle = ws.angle_to(straight);
        match self.component {
            Component::Reflection => angle.min(ws.angle_to(wi)),
            Component::Transmission => angle,
        }
    }
}

/// Greatest angle from the centre of a patch to its rim, radians, generously.
fn patch_reach(ring: &Ring) -> f64 {
    let (lo, hi) = (ring.theta_lo.to_radians(), ring.theta_hi.to_radians());
    if ring.n_phi == 1 {
        return 2.0 * hi;
    }
    (hi - lo).hypot(PI / ring.n_phi as f64 * hi.sin())
}
