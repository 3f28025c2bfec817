//! The way of a ray through the nodes.

use super::Bvh;
use super::node::{LEAF, Tests, WIDTH};
use super::ray::{Hit, Prepared, Ray};

/// Entries that the stack of a ray holds.
pub(super) const STACK: usize = 512;

#[derive(Clone, Copy)]
struct Entry {
    at: f32,
    child: u32,
}

/// The nearest hit.
///
/// # Safety
/// The processor has the instruction set of `T`.
#[inline(always)]
pub(super) unsafe fn closest<T: Tests>(bvh: &Bvh, ray: &Ray) -> Option<Hit> {
    let prepared = Prepared::new(ray, bvh.extent);
    let mut t_max = ray.t_max;
    let mut found = None;
    let mut stack = [const { std::mem::MaybeUninit::<Entry>::uninit() }; STACK];
    let mut depth = 0;
    let mut current = bvh.root;
    let mut entry = [0.0; WIDTH];
    loop {
        if current & LEAF != 0 {
            let k = (current & !LEAF) as usize;
            // SAFETY: children index nodes and packets of this tree.
            let packet = unsafe { bvh.packets.get_unchecked(k) };
            if let Some(hit) = unsafe { T::triangles(packet, &prepared, t_max) } {
                t_max = hit.t;
                found = Some(Hit {
                    t: hit.t,
                    u: hit.u,
                    v: hit.v,
                    triangle: packet.triangle[hit.lane & 7],
                });
            }
        } else {
            let node = unsafe { bvh.nodes.get_unchecked(current as usize) };
            let mut mask = unsafe { T::boxes(node, &prepared, t_max, &mut entry) };
            if mask != 0 {
                let first = mask.trailing_zeros() as usize & 7;
                mask &= mask - 1;
                let mut nearest = Entry {
                    at: entry[first],
                    child: node.child[first],
                };
                let bottom = depth;
                while mask != 0 {
                    let k = mask.trailing_zeros() as usize & 7;
                    mask &= mask - 1;
                    let mut later = Entry {
                        at: entry[k],
                        child: node.child[k],
                    };
                    if later.at < nearest.at {
                        std::mem::swap(&mut later, &mut nearest);
                    }
                    bvh.prefetch(later.child);
                    // Farthest at the bottom; the depth of the tree bounds the stack (checked when it is built).
                    let mut k = depth;
                    while k > bottom && unsafe { stack.get_unchecked(k - 1).assume_init().at } < later.at {
                        unsafe { *stack.get_unchecked_mut(k) = *stack.get_unchecked(k - 1) };
                        k -= 1;
                    }
                    unsafe { stack.get_unchecked_mut(k).write(later) };
                    depth += 1;
                }
                current = nearest.child;
                continue;
            }
        }
        loop {
            if depth == 0 {
                return found;
            }
            depth -= 1;
            let e = unsafe { stack.get_unchecked(depth).assume_init() };
            if e.at <= t_max {
                current = e.child;
                break;
            }
        }
    }
}

/// Whether anything is hit.
///
/// # Safety
/// The processor has the instruction set of `T`.
#[inline(always)]
pub(super) unsafe fn occluded<T: Tests>(bvh: &Bvh, ray: &Ray) -> bool {
    let prepared = Prepared::new(ray, bvh.extent);
    let mut stack = [const { std::mem::MaybeUninit::<u32>::uninit() }; STACK];
    let mut depth = 1;
    stack[0].write(bvh.root);
    let mut entry = [0.0; WIDTH];
    while depth > 0 {
        depth -= 1;
        let current = unsafe { stack.get_unchecked(depth).assume_init() };
        if current & LEAF != 0 {
            // SAFETY: children index nodes and packets of this tree.
            let packet = unsafe { bvh.packets.get_unchecked((current & !LEAF) as usize) };
            if unsafe { T::triangles(packet, &prepared, ray.t_max) }.is_some() {
                return true;
            }
        } else {
            let node = unsafe { bvh.nodes.get_unchecked(current as usize) };
            let mut mask = unsafe { T::boxes(node, &prepared, ray.t_max, &mut entry) };
            while mask != 0 {
                let k = mask.trailing_zeros() as usize & 7;
                mask &= mask - 1;
                unsafe { stack.get_unchecked_mut(depth).write(node.child[k]) };
                depth += 1;
            }
        }
    }
    false
}
