//! The tests by AVX2 and FMA: eight boxes, or eight triangles, at once.

use std::arch::x86_64::*;

use super::node::{LaneHit, Node, PACKET, Packet, Tests, WIDER, WIDTH};
use super::ray::Prepared;

/// Processors with AVX2 and FMA.
pub(super) struct Avx2;

type M = __m256;

/// The corners of eight triangles in the frame of the ray, one coordinate.
#[derive(Clone, Copy)]
struct Corner {
    x: M,
    y: M,
    z: M,
}

impl Corner {
    #[inline(always)]
    unsafe fn new(rows: &[[f32; PACKET]; 3], ray: &Prepared) -> Corner {
        unsafe {
            let at = |axis: usize| {
                _mm256_sub_ps(
                    _mm256_load_ps(rows.get_unchecked(axis).as_ptr()),
                    _mm256_set1_ps(*ray.origin.get_unchecked(axis)),
                )
            };
            let z = at(ray.along);
            Corner {
                x: _mm256_fnmadd_ps(_mm256_set1_ps(ray.shear[0]), z, at(ray.across[0])),
                y: _mm256_fnmadd_ps(_mm256_set1_ps(ray.shear[1]), z, at(ray.across[1])),
                z,
            }
        }
    }

    /// `x other.y - y other.x` with an error of one and a half units in its last place, so with its exact sign
    /// [JeannerodLouvetMuller2013].
    #[inline(always)]
    unsafe fn edge(self, other: Corner) -> M {
        unsafe {
            let w = _mm256_mul_ps(self.y, other.x);
            let lost = _mm256_fnmadd_ps(self.y, other.x, w);
            _mm256_add_ps(_mm256_fmsub_ps(self.x, other.y, w), lost)
        }
    }
}

impl Tests for Avx2 {
    #[inline(always)]
    unsafe fn boxes(node: &Node, ray: &Prepared, t_max: f32, entry: &mut [f32; WIDTH]) -> u32 {
        unsafe {
            let plane = |row: usize, axis: usize, side: usize| {
                let q = _mm_loadl_epi64(node.bounds.get_unchecked(row).as_ptr().cast());
                let q = _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(q));
                let p = _mm256_fmadd_ps(
                    q,
                    _mm256_set1_ps(node.step[axis]),
                    _mm256_set1_ps(node.origin[axis]),
                );
                _mm256_mul_ps(
                    _mm256_sub_ps(p, _mm256_set1_ps(ray.from[side][axis])),
                    _mm256_set1_ps(ray.inverse[axis]),
                )
            };
            let [x, y, z] = ray.near;
            // 0 <-> 3, 1 <-> 4, 2 <-> 5
            let (fx, fy, fz) = (3 - x, 5 - y, 7 - z);
            let near = _mm256_max_ps(
                _mm256_max_ps(plane(x, 0, 0), plane(y, 1, 0)),
                _mm256_max_ps(plane(z, 2, 0), _mm256_set1_ps(ray.t_min)),
            );
            let far = _mm256_min_ps(
                _mm256_min_ps(plane(fx, 0, 1), plane(fy, 1, 1)),
                _mm256_min_ps(plane(fz, 2, 1), _mm256_set1_ps(t_max)),
            );
            let inside = _mm256_cmp_ps::<_CMP_LE_OQ>(near, _mm256_mul_ps(far, _mm256_set1_ps(WIDER)));
            _mm256_storeu_ps(entry.as_mut_ptr(), near);
            _mm256_movemask_ps(inside) as u32
        }
    }

    #[inline(always)]
    unsafe fn triangles(packet: &Packet, ray: &Prepared, t_max: f32) -> Option<LaneHit> {
        unsafe {
            let a = Corner::new(&packet.vertices[0], ray);
            let b = Corner::new(&packet.vertices[1], ray);
            let c = Corner::new(&packet.vertices[2], ray);
            let (wa, wb, wc) = (c.edge(b), a.edge(c), b.edge(a));
            let least = _mm256_min_ps(_mm256_min_ps(wa, wb), wc);
            let most = _mm256_max_ps(_mm256_max_ps(wa, wb), wc);
            let zero = _mm256_setzero_ps();
            let inside = _mm256_or_ps(
                _mm256_cmp_ps::<_CMP_GE_OQ>(least, zero),
                _mm256_cmp_ps::<_CMP_LE_OQ>(most, zero),
            );
            if _mm256_movemask_ps(inside) == 0 {
                return None;
            }
            let sum = _mm256_add_ps(_mm256_add_ps(wa, wb), wc);
            let depth = _mm256_fmadd_ps(wa, a.z, _mm256_fmadd_ps(wb, b.z, _mm256_mul_ps(wc, c.z)));
            let t = _mm256_div_ps(_mm256_mul_ps(depth, _mm256_set1_ps(ray.shear[2])), sum);
            let hit = _mm256_and_ps(
                _mm256_and_ps(inside, _mm256_cmp_ps::<_CMP_NEQ_UQ>(sum, zero)),
                _mm256_and_ps(
                    _mm256_cmp_ps::<_CMP_GE_OQ>(t, _mm256_set1_ps(ray.t_min)),
                    _mm256_cmp_ps::<_CMP_LE_OQ>(t, _mm256_set1_ps(t_max)),
                ),
            );
            let mut mask = _mm256_movemask_ps(hit) as u32;
            if mask == 0 {
                return None;
            }
            let mut at = [0.0_f32; PACKET];
            _mm256_storeu_ps(at.as_mut_ptr(), t);
            let mut lane = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            while mask != 0 {
                let other = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                if at[other] < at[lane] {
                    lane = other;
                }
            }
            let mut u = [0.0_f32; PACKET];
            let mut v = [0.0_f32; PACKET];
            _mm256_storeu_ps(u.as_mut_ptr(), _mm256_div_ps(wb, sum));
            _mm256_storeu_ps(v.as_mut_ptr(), _mm256_div_ps(wc, sum));
            Some(LaneHit {
                lane,
                t: at[lane],
                u: u[lane],
                v: v[lane],
            })
        }
    }
}
