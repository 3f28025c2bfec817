//! Rays a CPU second through a closed room of displaced spheres.
//!
//! `rays TRIANGLES [RAYS]` prints a JSON line: primary, bounced and shadow rays, one thread, in millions a second.
#![allow(clippy::print_stdout, clippy::unwrap_used, missing_docs)]

use std::time::Instant;

use gonio_trace::bvh::{Bvh, Ray, Triangles};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

pub struct Mesh {
    pub vertices: Vec<[f32; 3]>,
    pub indices: Vec<[u32; 3]>,
}

fn sphere(mesh: &mut Mesh, centre: [f32; 3], radius: f32, rings: u32, rng: &mut Pcg64) {
    let base = mesh.vertices.len() as u32;
    let around = 2 * rings;
    let waves: [f32; 4] = std::array::from_fn(|_| rng.random_range(2.0..9.0));
    for i in 0..=rings {
        let theta = std::f32::consts::PI * i as f32 / rings as f32;
        for j in 0..around {
            let phi = std::f32::consts::TAU * j as f32 / around as f32;
            let n = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
            let bump = 1.0
                + 0.08 * ((waves[0] * n[0] + 1.0).sin() + (waves[1] * n[1]).sin() + (waves[2] * n[2]).sin());
            mesh.vertices
                .push(std::array::from_fn(|a| centre[a] + radius * bump * n[a]));
        }
    }
    for i in 0..rings {
        for j in 0..around {
            let at = |i: u32, j: u32| base + i * around + j % around;
            mesh.indices.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            mesh.indices.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
}

fn room(triangles: usize) -> Mesh {
    let mut mesh = Mesh {
        vertices: (0..8)
            .map(|k| [(k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2 & 1) as f32])
            .collect(),
        indices: Vec::new(),
    };
    for q in [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ] {
        mesh.indices.push([q[0], q[1], q[2]]);
        mesh.indices.push([q[0], q[2], q[3]]);
    }
    let mut rng = Pcg64::seed_from_u64(1);
    let count = 25;
    let rings = ((triangles as f32 / (count as f32 * 4.0)).sqrt()).round() as u32;
    for _ in 0..count {
        let centre = std::array::from_fn(|_| rng.random_range(0.15..0.85));
        let radius = rng.random_range(0.04..0.12);
        sphere(&mut mesh, centre, radius, rings, &mut rng);
    }
    mesh
}

/// CPU seconds of this thread.
fn cpu() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    text.split(' ').next().unwrap().parse::<f64>().unwrap() * 1e-9
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let triangles: usize = arguments.next().map_or(100_000, |a| a.parse().unwrap());
    let count: usize = arguments.next().map_or(1 << 20, |a| a.parse().unwrap());
    let mesh = room(triangles);
    let start = (Instant::now(), cpu());
    let bvh = Bvh::new(&Triangles {
        vertices: &mesh.vertices,
        indices: &mesh.indices,
    });
    let build = (start.0.elapsed().as_secs_f64(), cpu() - start.1);
    let mut rng = Pcg64::seed_from_u64(7);
    let eye = [0.5, 0.02, 0.5];
    let side = (count as f64).sqrt() as usize;
    let mut primary = Vec::with_capacity(side * side);
    for j in 0..side {
        for i in 0..side {
            let (x, z) = (
                (i as f32 + 0.5) / side as f32 - 0.5,
                (j as f32 + 0.5) / side as f32 - 0.5,
            );
            primary.push(Ray::new(eye, [x * 1.4, 1.0, z * 1.4]));
        }
    }
    let mut hits = Vec::with_capacity(primary.len());
    let time = |work: &mut dyn FnMut()| {
        let start = cpu();
        work();
        cpu() - start
    };
    let first = time(&mut || hits = primary.iter().map(|r| bvh.closest(r)).collect());
    let missed = hits.iter().filter(|h| h.is_none()).count();
    let mut bounced = Vec::with_capacity(primary.len());
    let mut shadow = Vec::with_capacity(primary.len());
    for (r, h) in primary.iter().zip(&hits) {
        let Some(h) = h else { continue };
        let corners = mesh.indices[h.triangle as usize].map(|k| glam::Vec3::from(mesh.vertices[k as usize]));
        let mut n = (corners[1] - corners[0])
            .cross(corners[2] - corners[0])
            .normalize_or_zero();
        let d = glam::Vec3::from(r.direction);
        if n.dot(d) > 0.0 {
            n = -n;
        }
        let p = (glam::Vec3::from(r.origin) + h.t * d + 1e-4 * n)
            .clamp(glam::Vec3::splat(1e-4), glam::Vec3::splat(1.0 - 1e-4));
        let (a, b) = n.any_orthonormal_pair();
        let (u, v): (f32, f32) = (rng.random(), rng.random());
        let (s, c) = (std::f32::consts::TAU * v).sin_cos();
        let w = u.sqrt() * (c * a + s * b) + (1.0 - u).sqrt() * n;
        bounced.push(Ray::new(p.into(), w.into()));
        let lamp = glam::Vec3::new(rng.random_range(0.3..0.7), rng.random_range(0.3..0.7), 0.97);
        shadow.push(Ray {
            t_max: 1.0,
            ..Ray::new(p.into(), (lamp - p).into())
        });
    }
    let mut sum = 0.0;
    let mut lost = 0;
    let second = time(&mut || {
        for r in &bounced {
            match bvh.closest(r) {
                Some(h) => sum += h.t,
                None => lost += 1,
            }
        }
    });
    if let Some(folder) = std::env::var_os("RAYS_OUT").map(std::path::PathBuf::from) {
        let write = |name: &str, data: Vec<[f32; 3]>| {
            let bytes: Vec<u8> = data.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
            std::fs::write(folder.join(name), bytes).unwrap();
        };
        let corners = mesh
            .indices
            .iter()
            .flat_map(|t| t.map(|k| mesh.vertices[k as usize]));
        write("triangles.f32", corners.collect());
        for (name, rays) in [("primary", &primary), ("bounce", &bounced)] {
            write(&format!("{name}-o.f32"), rays.iter().map(|r| r.origin).collect());
            write(
                &format!("{name}-d.f32"),
                rays.iter().map(|r| r.direction).collect(),
            );
        }
    }
    let mut dark = 0;
    let third = time(&mut || dark = shadow.iter().filter(|r| bvh.occluded(r)).count());
    let m = |n: usize, t: f64| n as f64 / t / 1e6;
    println!(
        "{{\"triangles\": {}, \"bytes_per_triangle\": {:.1}, \"build_s\": {:.3}, \"build_cpu_s\": {:.3}, \"primary\": {:.2}, \"bounce\": {:.2}, \"shadow\": {:.2}, \"missed\": {missed}, \"lost\": {lost}, \"dark\": {dark}, \"sum\": {sum}}}",
        mesh.indices.len(),
        bvh.bytes() as f64 / mesh.indices.len() as f64,
        build.0,
        build.1,
        m(primary.len(), first),
        m(bounced.len(), second),
        m(shadow.len(), third),
    );
}
