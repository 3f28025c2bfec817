use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::*;

pub(super) struct Mesh {
    vertices: Vec<[f32; 3]>,
    pub(super) indices: Vec<[u32; 3]>,
}

impl Mesh {
    pub(super) fn triangles(&self) -> Triangles<'_> {
        Triangles {
            vertices: &self.vertices,
            indices: &self.indices,
        }
    }

    pub(super) fn bvh(&self) -> Bvh {
        Bvh::new(&self.triangles())
    }
}

/// Triangles of random places and sizes.
pub(super) fn soup(n: usize, seed: u64) -> Mesh {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut mesh = Mesh {
        vertices: Vec::new(),
        indices: Vec::new(),
    };
    for k in 0..n as u32 {
        let centre: [f32; 3] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
        let size = 0.3 * rng.random::<f32>().powi(3);
        for _ in 0..3 {
            mesh.vertices
                .push(centre.map(|c| c + size * rng.random_range(-1.0..1.0)));
        }
        mesh.indices.push([3 * k, 3 * k + 1, 3 * k + 2]);
    }
    mesh
}

/// A closed surface: a displaced sphere of `rings` rings, shared vertices.
pub(super) fn closed(rings: u32) -> Mesh {
    let around = 2 * rings;
    let point = |i: u32, j: u32| {
        let theta = std::f32::consts::PI * i as f32 / rings as f32;
        let phi = std::f32::consts::TAU * (j % around) as f32 / around as f32;
        let r = 1.0 + 0.2 * (5.0 * theta).sin() * (3.0 * phi).cos();
        [
            r * theta.sin() * phi.cos(),
            r * theta.sin() * phi.sin(),
            r * theta.cos(),
        ]
    };
    let mut mesh = Mesh {
        vertices: vec![point(0, 0), point(rings, 0)],
        indices: Vec::new(),
    };
    for i in 1..rings {
        mesh.vertices.extend((0..around).map(|j| point(i, j)));
    }
    let at = |i: u32, j: u32| match i {
        0 => 0,
        _ if i == rings => 1,
        _ => 2 + (i - 1) * around + j % around,
    };
    for i in 0..rings {
        for j in 0..around {
            if i > 0 {
                mesh.indices.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
            }
            if i + 1 < rings {
                mesh.indices.push([at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)]);
            }
        }
    }
    mesh
}

pub(super) fn random_ray(rng: &mut Pcg64) -> Ray {
    let v = |rng: &mut Pcg64| std::array::from_fn(|_| rng.random_range(-1.5..1.5));
    Ray::new(v(rng), v(rng))
}

/// The nearest hit by double precision, one triangle after the other.
fn exhaustive(mesh: &Mesh, ray: &Ray) -> Option<(f64, usize)> {
    let v = |p: [f32; 3]| glam::DVec3::from(p.map(f64::from));
    let (o, d) = (v(ray.origin), v(ray.direction));
    (0..mesh.indices.len())
        .filter_map(|k| {
            let [a, b, c] = mesh.triangles().corners(k).map(v);
            let n = (b - a).cross(c - a);
            let t = n.dot(a - o) / n.dot(d);
            let p = o + t * d;
            let inside = [(a, b), (b, c), (c, a)]
                .iter()
                .all(|(a, b)| (*b - *a).cross(p - *a).dot(n) >= 0.0);
            (inside && t >= 0.0).then_some((t, k))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
}

#[test]
fn the_nearest_triangle_is_that_of_an_exhaustive_search() {
    let mesh = soup(400, 3);
    let bvh = mesh.bvh();
    let mut rng = Pcg64::seed_from_u64(4);
    let mut differ = 0;
    for _ in 0..4000 {
        let ray = random_ray(&mut rng);
        let found = bvh.closest(&ray);
        let truth = exhaustive(&mesh, &ray);
        assert_eq!(bvh.occluded(&ray), found.is_some());
        match (found, truth) {
            (Some(f), Some((t, k))) if f.triangle as usize == k => {
                assert!((f64::from(f.t) - t).abs() < 1e-4 * t.max(1e-2), "{} {t}", f.t);
                let [a, b, c] = mesh.triangles().corners(k).map(glam::Vec3::from);
                let p = (1.0 - f.u - f.v) * a + f.u * b + f.v * c;
                let q = glam::Vec3::from(ray.origin) + f.t * glam::Vec3::from(ray.direction);
                assert!(p.distance(q) < 1e-4, "{p} {q}");
            }
            (None, None) => {}
            _ => differ += 1,
        }
    }
    // Rays that graze an edge within single precision.
    assert!(differ <= 4, "{differ} of 4000");
}

#[test]
fn every_processor_finds_the_same() {
    let mesh = soup(3000, 5);
    let bvh = mesh.bvh();
    let mut rng = Pcg64::seed_from_u64(6);
    for _ in 0..3000 {
        let ray = random_ray(&mut rng);
        // SAFETY: needs no instruction set.
        let portable = unsafe { traverse::closest::<node::Portable>(&bvh, &ray) };
        match (bvh.closest(&ray), portable) {
            (Some(a), Some(b)) => assert!((a.t - b.t).abs() <= 1e-5 * a.t.max(1.0), "{} {}", a.t, b.t),
            (a, b) => assert_eq!(a.is_some(), b.is_some()),
        }
    }
}

#[test]
fn no_ray_aimed_at_an_edge_or_a_vertex_leaves_a_closed_surface() {
    let mesh = closed(60);
    let bvh = mesh.bvh();
    let mut rng = Pcg64::seed_from_u64(8);
    for k in 0..1_000_000 {
        let corners = mesh.triangles().corners(rng.random_range(0..mesh.indices.len()));
        let s: f32 = if k % 16 == 0 { 0.0 } else { rng.random() };
        let target: [f32; 3] = std::array::from_fn(|a| corners[0][a] + s * (corners[1][a] - corners[0][a]));
        let origin: [f32; 3] = std::array::from_fn(|_| rng.random_range(-0.3..0.3));
        let ray = Ray::new(origin, std::array::from_fn(|a| target[a] - origin[a]));
        assert!(bvh.closest(&ray).is_some(), "ray {k}: {ray:?}");
        assert!(bvh.occluded(&ray));
    }
}

#[test]
fn limits_of_the_ray_are_kept() {
    let mesh = Mesh {
        vertices: vec![[-1.0, -1.0, 2.0], [1.0, -1.0, 2.0], [0.0, 1.0, 2.0]],
        indices: vec![[0, 1, 2]],
    };
    let bvh = mesh.bvh();
    let ray = Ray::new([0.0; 3], [0.0, 0.0, 1.0]);
    assert_eq!(bvh.closest(&ray).unwrap().t, 2.0);
    for (t_min, t_max, hit) in [(0.0, 1.9, false), (2.1, 9.0, false), (1.9, 2.0, true)] {
        let ray = Ray { t_min, t_max, ..ray };
        assert_eq!(bvh.closest(&ray).is_some(), hit);
        assert_eq!(bvh.occluded(&ray), hit);
    }
    let away = Ray::new([0.0; 3], [0.0, 0.0, -1.0]);
    assert!(bvh.closest(&away).is_none());
}

#[test]
fn nothing_degenerate_and_equal_triangles_are_no_trouble() {
    let empty = Mesh {
        vertices: Vec::new(),
        indices: Vec::new(),
    };
    assert!(
        empty
            .bvh()
            .closest(&Ray::new([0.0; 3], [1.0, 0.0, 0.0]))
            .is_none()
    );
    let mut same = soup(1, 1);
    same.indices = vec![[0, 1, 2]; 5000];
    let bvh = same.bvh();
    let [a, b, c] = same.triangles().corners(0).map(glam::Vec3::from);
    let ray = Ray::new(
        [3.0, 2.0, 1.0],
        ((a + b + c) / 3.0 - glam::Vec3::new(3.0, 2.0, 1.0)).into(),
    );
    assert!((bvh.closest(&ray).unwrap().t - 1.0).abs() < 1e-5);
    let flat = Mesh {
        vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]],
        indices: vec![[0, 1, 2], [0, 0, 0]],
    };
    assert!(
        flat.bvh()
            .closest(&Ray::new([0.5, 0.0, -1.0], [0.0, 0.0, 1.0]))
            .is_none()
    );
}

#[test]
fn a_million_triangles_take_less_than_200_bytes_each() {
    let mesh = soup(20_000, 9);
    let bytes = mesh.bvh().bytes() + 12 * mesh.vertices.len() + 12 * mesh.indices.len();
    assert!(bytes < 200 * mesh.indices.len(), "{bytes}");
}
