//! Many rays at once against few triangles.

use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::tests::{closed, random_ray, soup};
use super::*;
use crate::lanes::{LANES, Rays};

type Closest = unsafe fn(&group::Few, &Rays, usize, &mut Nearest);
type Occluded = unsafe fn(&group::Few, &Rays, usize) -> u64;

/// The functions that the processor has.
fn functions() -> Vec<(Closest, Occluded)> {
    let mut all: Vec<(Closest, Occluded)> = Vec::new();
    if has_avx2() {
        all.push((bundle::closest_by_8, bundle::occluded_by_8));
    }
    if is_x86_feature_detected!("avx512f") {
        all.push((bundle::closest_by_16, bundle::occluded_by_16));
    }
    all
}

fn bundle_of(rays: &[Ray]) -> Rays {
    let mut all = Rays::default();
    for (k, ray) in rays.iter().enumerate() {
        let direction = Vec3::from(ray.direction).normalize();
        all.set(k, ray.origin.into(), direction, ray.t_max);
    }
    all.turn(rays.len(), 0.5);
    all
}

fn nearest() -> Nearest {
    Nearest {
        t: [0.0; LANES],
        triangle: [NONE; LANES],
    }
}

#[test]
fn many_rays_meet_what_each_meets_alone() {
    let mesh = soup(61, 11);
    let bvh = mesh.bvh();
    let few = group::Few::new(few::pairs(&mesh.triangles()).unwrap());
    let mut rng = Pcg64::seed_from_u64(12);
    let (mut differ, mut hits, mut all) = (0, 0, 0);
    for (closest, occluded) in functions() {
        for count in [1, 7, 8, 9, 16, 23, 64].repeat(20) {
            let rays: Vec<Ray> = (0..count)
                .map(|k| Ray {
                    // Some end early.
                    t_max: if k % 3 == 0 { 0.7 } else { f32::INFINITY },
                    ..random_ray(&mut rng)
                })
                .collect();
            let many = bundle_of(&rays);
            let mut found = nearest();
            // SAFETY: the processor has the instructions.
            let mask = unsafe {
                closest(&few, &many, count, &mut found);
                occluded(&few, &many, count)
            };
            assert_eq!(mask >> (count - 1) >> 1, 0);
            for k in 0..count {
                let alone = bvh.closest(&many.get(k));
                all += 1;
                hits += usize::from(alone.is_some());
                match (found.get(k), alone) {
                    (Some((t, triangle)), Some(hit)) if triangle == hit.triangle => {
                        assert!((t - hit.t).abs() < 1e-4 * hit.t.max(0.01), "{t} {}", hit.t);
                    }
                    (None, None) => {}
                    _ => differ += 1,
                }
                differ += usize::from((mask >> k & 1 == 1) != alone.is_some());
            }
        }
    }
    // Rays that graze an edge within single precision.
    assert!(differ <= all / 500, "{differ} of {all}");
    assert!(hits > 50, "{hits} of {all} meet something");
}

#[test]
fn none_of_many_rays_aimed_at_edges_and_vertices_leaves_a_closed_surface() {
    let mesh = closed(4);
    let few = group::Few::new(few::pairs(&mesh.triangles()).unwrap());
    let mut rng = Pcg64::seed_from_u64(13);
    for (closest, occluded) in functions() {
        for _ in 0..1_000_000 / LANES / 2 {
            let rays: Vec<Ray> = (0..LANES)
                .map(|k| {
                    let corners = mesh.triangles().corners(rng.random_range(0..mesh.indices.len()));
                    let s: f32 = if k % 16 == 0 { 0.0 } else { rng.random() };
                    let target: [f32; 3] =
                        std::array::from_fn(|a| corners[0][a] + s * (corners[1][a] - corners[0][a]));
                    let origin: [f32; 3] = std::array::from_fn(|_| rng.random_range(-0.3..0.3));
                    Ray::new(origin, std::array::from_fn(|a| target[a] - origin[a]))
                })
                .collect();
            let many = bundle_of(&rays);
            let mut found = nearest();
            // SAFETY: the processor has the instructions.
            let mask = unsafe {
                closest(&few, &many, LANES, &mut found);
                occluded(&few, &many, LANES)
            };
            assert_eq!(mask, u64::MAX);
            assert!((0..LANES).all(|k| found.get(k).is_some()));
        }
    }
}
