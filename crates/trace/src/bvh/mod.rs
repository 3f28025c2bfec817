//! Bounding volume hierarchy: the nearest triangle of a ray, and whether there is one.
//!
//! Built by a library, walked here eight boxes at a time, by AVX2 where the processor has it. The test against triangles
//! is watertight: no ray passes between two triangles with a common edge.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod build;
#[cfg(target_arch = "x86_64")]
mod bundle;
mod few;
mod forest;
mod group;
mod memory;
mod node;
mod ray;
mod traverse;
#[cfg(target_arch = "x86_64")]
mod wide;

pub use ray::{Hit, Ray};

use crate::lanes::{LANES, Rays};
use node::{NONE, Node, Packet, Portable};

/// Triangles by index.
#[derive(Clone, Copy, Debug)]
pub struct Triangles<'a> {
    /// Coordinates of the vertices.
    pub vertices: &'a [[f32; 3]],
    /// Three vertices a triangle.
    pub indices: &'a [[u32; 3]],
}

impl Triangles<'_> {
    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.indices.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    /// Corners of triangle `k`.
    pub fn corners(&self, k: usize) -> [[f32; 3]; 3] {
        self.indices[k].map(|i| self.vertices[i as usize])
    }
}

/// Distance and index of the nearest triangles of rays.
pub(crate) struct Nearest {
    t: [f32; LANES],
    /// [`NONE`] where there is none.
    triangle: [u32; LANES],
}

impl Nearest {
    /// Of ray `k`.
    #[inline(always)]
    pub(crate) fn get(&self, k: usize) -> Option<(f32, u32)> {
        (self.triangle[k] != NONE).then(|| (self.t[k], self.triangle[k]))
    }
}

/// A hierarchy of triangles.
pub struct Bvh {
    nodes: Vec<Node>,
    packets: Vec<Packet>,
    root: u32,
    /// Largest coordinate.
    extent: f32,
    /// The triangles, where they are few.
    few: Option<group::Few>,
}

impl Bvh {
    /// The hierarchy of triangles of finite coordinates whose indices are below the number of vertices.
    pub fn new(triangles: &Triangles<'_>) -> Self {
        build::build(triangles)
    }

    /// Asks for a node or packet before it is needed.
    #[inline(always)]
    fn prefetch(&self, child: u32) {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
            let k = (child & !node::LEAF) as usize;
            let start: *const i8 = if child & node::LEAF == 0 {
                self.nodes.as_ptr().wrapping_add(k).cast()
            } else {
                self.packets.as_ptr().wrapping_add(k).cast()
            };
            // SAFETY: prefetching never faults.
            unsafe {
                _mm_prefetch::<_MM_HINT_T0>(start);
                _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(64));
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        let _ = child;
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.packets.as_slice())
    }

    /// Whether the two functions for many rays do better than those for one.
    #[inline]
    pub(crate) fn takes_many(&self) -> bool {
        #[cfg(target_arch = "x86_64")]
        return self.few.is_some() && has_avx2();
        #[cfg(not(target_arch = "x86_64"))]
        false
    }

    /// The nearest triangles of the first `count` rays, whose frames are known.
    #[inline]
    pub(crate) fn closest_of_many(&self, rays: &Rays, count: usize) -> Nearest {
        let mut out = Nearest {
            t: [0.0; LANES],
            triangle: [NONE; LANES],
        };
        #[cfg(target_arch = "x86_64")]
        if let Some(few) = &self.few {
            // SAFETY: the processor has the instructions.
            if is_x86_feature_detected!("avx512f") {
                unsafe { bundle::closest_by_16(few, rays, count, &mut out) };
                return out;
            } else if has_avx2() {
                unsafe { bundle::closest_by_8(few, rays, count, &mut out) };
                return out;
            }
        }
        for k in 0..count {
            if let Some(hit) = self.closest(&rays.get(k)) {
                out.t[k] = hit.t;
                out.triangle[k] = hit.triangle;
            }
        }
        out
    }

    /// Bit mask of the first `count` rays, whose frames are known, that meet a triangle.
    #[inline]
    pub(crate) fn occluded_of_many(&self, rays: &Rays, count: usize) -> u64 {
        #[cfg(target_arch = "x86_64")]
        if let Some(few) = &self.few {
            // SAFETY: the processor has the instructions.
            if is_x86_feature_detected!("avx512f") {
                return unsafe { bundle::occluded_by_16(few, rays, count) };
            } else if has_avx2() {
                return unsafe { bundle::occluded_by_8(few, rays, count) };
            }
        }
        (0..count).fold(0, |all, k| all | (u64::from(self.occluded(&rays.get(k))) << k))
    }

    /// The nearest triangle between `t_min` and `t_max` of the ray.
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            // SAFETY: the processor has the instructions.
            return unsafe { closest_avx2(self, ray) };
        }
        // SAFETY: needs no instruction set.
        unsafe { traverse::closest::<Portable>(self, ray) }
    }

    /// Whether there is a triangle between `t_min` and `t_max` of the ray.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            // SAFETY: the processor has the instructions.
            return unsafe { occluded_avx2(self, ray) };
        }
        // SAFETY: needs no instruction set.
        unsafe { traverse::occluded::<Portable>(self, ray) }
    }
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn closest_avx2(bvh: &Bvh, ray: &Ray) -> Option<Hit> {
    unsafe { traverse::closest::<avx2::Avx2>(bvh, ray) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn occluded_avx2(bvh: &Bvh, ray: &Ray) -> bool {
    unsafe { traverse::occluded::<avx2::Avx2>(bvh, ray) }
}

#[cfg(test)]
mod tests;
#[cfg(all(test, target_arch = "x86_64"))]
mod tests_many;
