//! Bounding volume hierarchy: the nearest triangle of a ray, and whether there is one.
//!
//! Built by a library, walked here eight boxes at a time, by AVX2 where the processor has it. The test against triangles
//! is watertight: no ray passes between two triangles with a common edge.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod build;
mod forest;
mod memory;
mod node;
mod ray;
mod traverse;

pub use ray::{Hit, Ray};

use node::{Node, Packet, Portable};

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

/// A hierarchy of triangles.
pub struct Bvh {
    nodes: Vec<Node>,
    packets: Vec<Packet>,
    root: u32,
    /// Largest coordinate.
    extent: f32,
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
