//! Several rays at once against the triangles of a small scene: eight by AVX2, sixteen by AVX-512.

use std::arch::x86_64::{__m256, __m512};

use super::Nearest;
use super::few::Pair;
use super::group::Few;
use super::node::NONE;
use super::wide::Wide;
use crate::lanes::{Rays, Vectors};

#[derive(Clone, Copy)]
struct Triple<W> {
    x: W,
    y: W,
    z: W,
}

impl<W: Wide> Triple<W> {
    #[inline(always)]
    unsafe fn load(all: &Vectors, first: usize) -> Self {
        unsafe {
            let [x, y, z] = all.rows();
            Triple {
                x: W::load(x.as_ptr().add(first)),
                y: W::load(y.as_ptr().add(first)),
                z: W::load(z.as_ptr().add(first)),
            }
        }
    }

    #[inline(always)]
    unsafe fn dot(self, other: Self) -> W {
        unsafe {
            self.x
                .mul_add(other.x, self.y.mul_add(other.y, self.z.mul(other.z)))
        }
    }

    /// `x other.y - y other.x` with its exact sign, as of the tests of single rays [JeannerodLouvetMuller2013].
    #[inline(always)]
    unsafe fn edge(self, other: Self) -> W {
        unsafe {
            let w = self.y.mul(other.x);
            self.x.mul_sub(other.y, w).add(self.y.mul_from(other.x, w))
        }
    }
}

/// Rays in their own frames: `across` and `aside` are at right angles to `along`.
struct Bundle<W> {
    origin: Triple<W>,
    along: Triple<W>,
    across: Triple<W>,
    aside: Triple<W>,
}

impl<W: Wide> Bundle<W> {
    #[inline(always)]
    unsafe fn new(rays: &Rays, first: usize) -> Self {
        unsafe {
            Bundle {
                origin: Triple::load(&rays.origin, first),
                along: Triple::load(&rays.direction, first),
                across: Triple::load(&rays.across, first),
                aside: Triple::load(&rays.aside, first),
            }
        }
    }

    /// A corner in the frames of the rays: the same for all triangles that share it, so that no ray passes between them.
    #[inline(always)]
    unsafe fn corner(&self, at: &[f32; 3]) -> Triple<W> {
        unsafe {
            let way = Triple {
                x: W::all(at[0]).sub(self.origin.x),
                y: W::all(at[1]).sub(self.origin.y),
                z: W::all(at[2]).sub(self.origin.z),
            };
            Triple {
                x: self.across.dot(way),
                y: self.aside.dot(way),
                z: self.along.dot(way),
            }
        }
    }

    /// The two triangles of a pair.
    #[inline(always)]
    unsafe fn turn(&self, pair: &Pair) -> [Turned<W>; 2] {
        unsafe {
            // One by one: closures do not have the instructions of their surroundings.
            let a = self.corner(&pair.corners[0]);
            let b = self.corner(&pair.corners[1]);
            let c = self.corner(&pair.corners[2]);
            let d = self.corner(&pair.corners[3]);
            let diagonal = c.edge(a);
            // Edges opposite to the corners, in the order of the pair.
            [
                Turned {
                    w: [c.edge(b), W::all(0.0).sub(diagonal), b.edge(a)],
                    z: [a.z, b.z, c.z],
                },
                Turned {
                    w: [d.edge(c), a.edge(d), diagonal],
                    z: [a.z, c.z, d.z],
                },
            ]
        }
    }
}

/// Rays against boxes: distances along them are these times coordinates, less the others.
struct Slabs<W> {
    inverse: Triple<W>,
    start: Triple<W>,
    /// Whether a ray begins so far away that its rounding exceeds the slack of the boxes.
    remote: bool,
}

impl<W: Wide> Slabs<W> {
    #[inline(always)]
    unsafe fn new(bundle: &Bundle<W>, reach: f32) -> Self {
        unsafe {
            let Triple { x, y, z } = bundle.origin;
            let off = x.abs().max(y.abs()).max(z.abs());
            let remote = W::bits(off.at_least(W::all(reach))) != 0;
            let inverse = Triple {
                x: inverse(bundle.along.x),
                y: inverse(bundle.along.y),
                z: inverse(bundle.along.z),
            };
            let start = Triple {
                x: bundle.origin.x.mul(inverse.x),
                y: bundle.origin.y.mul(inverse.y),
                z: bundle.origin.z.mul(inverse.z),
            };
            Slabs {
                inverse,
                start,
                remote,
            }
        }
    }

    /// Whether one of the rays passes through a box before it ends.
    #[inline(always)]
    unsafe fn any(&self, [low, high]: &[[f32; 3]; 2], far: W) -> bool {
        unsafe {
            let (x0, x1) = self.between(self.inverse.x, self.start.x, low[0], high[0]);
            let (y0, y1) = self.between(self.inverse.y, self.start.y, low[1], high[1]);
            let (z0, z1) = self.between(self.inverse.z, self.start.z, low[2], high[2]);
            let from = x0.max(y0).max(z0).max(W::all(0.0));
            let to = x1.min(y1).min(z1).min(far);
            W::bits(from.at_most(to)) != 0
        }
    }

    #[inline(always)]
    unsafe fn between(&self, inverse: W, start: W, low: f32, high: f32) -> (W, W) {
        unsafe {
            let a = inverse.mul_sub(W::all(low), start);
            let b = inverse.mul_sub(W::all(high), start);
            (a.min(b), a.max(b))
        }
    }
}

/// The inverse of a coordinate of a unit vector, finite.
#[inline(always)]
unsafe fn inverse<W: Wide>(x: W) -> W {
    unsafe { W::all(1.0).div(x.abs().max(W::all(1e-12)).turned_by(x)) }
}

/// A triangle in the frames of the rays.
struct Turned<W> {
    /// Edge functions opposite to the corners.
    w: [W; 3],
    /// Depths of the corners.
    z: [W; 3],
}

/// A distance as a fraction, of which the lower part is not negative: dividing is as slow as a test of a triangle. The
/// frames are as large as the scene (their axes across are of the length of its inverse), so that products of two such
/// parts neither overflow nor vanish.
#[derive(Clone, Copy)]
struct Distance<W> {
    over: W,
    under: W,
}

impl<W: Wide> Turned<W> {
    /// Which rays meet it before `far`, and where.
    #[inline(always)]
    unsafe fn met(&self, far: Distance<W>) -> (W::Mask, Distance<W>) {
        unsafe {
            let [wa, wb, wc] = self.w;
            let [za, zb, zc] = self.z;
            let zero = W::all(0.0);
            let (least, most) = (wa.min(wb).min(wc), wa.max(wb).max(wc));
            let inside = W::or(least.at_least(zero), most.at_most(zero));
            let sum = wa.add(wb).add(wc);
            let depth = wa.mul_add(za, wb.mul_add(zb, wc.mul(zc)));
            let met = Distance {
                over: depth.turned_by(sum),
                under: sum.abs(),
            };
            // Of a triangle seen edge on, both are zero: it is not nearer than anything.
            let nearer = met.over.mul(far.under).below(far.over.mul(met.under));
            let mask = W::and(inside, W::and(met.over.at_least(zero), nearer));
            (mask, met)
        }
    }
}

#[inline(always)]
unsafe fn closest<W: Wide>(few: &Few, rays: &Rays, count: usize, out: &mut Nearest) {
    for first in (0..count).step_by(W::WIDTH) {
        unsafe {
            let bundle = Bundle::<W>::new(rays, first);
            let mut nearest = Distance {
                over: W::load(rays.far.as_ptr().add(first)),
                under: W::all(1.0),
            };
            let mut which = W::all(f32::from_bits(NONE));
            let slabs = Slabs::new(&bundle, few.reach);
            for group in &few.groups {
                if let Some(around) = &group.around
                    && !slabs.remote
                    && !slabs.any(around, W::load(rays.far.as_ptr().add(first)))
                {
                    continue;
                }
                for pair in &few.pairs[group.pairs.clone()] {
                    let [one, other] = bundle.turn(pair);
                    let (mask, met) = one.met(nearest);
                    nearest.over = nearest.over.with(met.over, mask);
                    nearest.under = nearest.under.with(met.under, mask);
                    which = which.with(W::all(f32::from_bits(pair.triangles[0])), mask);
                    let (mask, met) = other.met(nearest);
                    nearest.over = nearest.over.with(met.over, mask);
                    nearest.under = nearest.under.with(met.under, mask);
                    which = which.with(W::all(f32::from_bits(pair.triangles[1])), mask);
                }
            }
            let t = nearest.over.div(nearest.under);
            t.store(out.t.as_mut_ptr().add(first));
            which.store(out.triangle.as_mut_ptr().add(first).cast());
        }
    }
}

#[inline(always)]
unsafe fn occluded<W: Wide>(few: &Few, rays: &Rays, count: usize) -> u64 {
    let mut all = 0;
    for first in (0..count).step_by(W::WIDTH) {
        unsafe {
            let bundle = Bundle::<W>::new(rays, first);
            let far = Distance {
                over: W::load(rays.far.as_ptr().add(first)),
                under: W::all(1.0),
            };
            let mut stopped = 0;
            let slabs = Slabs::new(&bundle, few.reach);
            for group in &few.groups {
                if let Some(around) = &group.around
                    && !slabs.remote
                    && !slabs.any(around, far.over)
                {
                    continue;
                }
                for pair in &few.pairs[group.pairs.clone()] {
                    let [one, other] = bundle.turn(pair);
                    stopped |= W::bits(W::or(one.met(far).0, other.met(far).0));
                }
                if stopped.count_ones() as usize == W::WIDTH {
                    break;
                }
            }
            all |= u64::from(stopped) << first;
        }
    }
    all
}

/// The nearest hits of the first `count` rays, eight at once.
///
/// # Safety
/// The processor has AVX2 and FMA.
#[target_feature(enable = "avx2,fma")]
pub(super) unsafe fn closest_by_8(few: &Few, rays: &Rays, count: usize, out: &mut Nearest) {
    unsafe { closest::<__m256>(few, rays, count, out) }
}

/// Sixteen at once.
///
/// # Safety
/// The processor has AVX-512 F.
#[target_feature(enable = "avx512f")]
pub(super) unsafe fn closest_by_16(few: &Few, rays: &Rays, count: usize, out: &mut Nearest) {
    unsafe { closest::<__m512>(few, rays, count, out) }
}

/// Bit mask of the first `count` rays that meet a triangle, eight at once.
///
/// # Safety
/// The processor has AVX2 and FMA.
#[target_feature(enable = "avx2,fma")]
pub(super) unsafe fn occluded_by_8(few: &Few, rays: &Rays, count: usize) -> u64 {
    unsafe { occluded::<__m256>(few, rays, count) }
}

/// Sixteen at once.
///
/// # Safety
/// The processor has AVX-512 F.
#[target_feature(enable = "avx512f")]
pub(super) unsafe fn occluded_by_16(few: &Few, rays: &Rays, count: usize) -> u64 {
    unsafe { occluded::<__m512>(few, rays, count) }
}
