use std::f64::consts::{PI, TAU};

use proptest::prelude::*;

use super::*;
use crate::Direction;

fn direction(theta: f64, phi: f64) -> DVec3 {
    Direction::from_spherical(theta, phi).vec()
}

fn rings(step: f64, along: f64) -> Vec<DVec3> {
    let mut points = Vec::new();
    let mut theta = step / 2.0;
    while theta < 88.0 {
        let n = (360.0 * theta.to_radians().sin() / along).round().max(8.0) as usize;
        points.extend((0..n).map(|k| direction(theta.to_radians(), TAU * k as f64 / n as f64)));
        theta += step;
    }
    points
}

/// Topology, orientation, Euler's formula and the empty circumcircle of every edge.
fn check(d: &Delaunay) {
    let mesh = d.mesh();
    for (h, &g) in mesh.twin.iter().enumerate() {
        assert_eq!(mesh.twin[g as usize], h as u32);
        let start = |h: u32| mesh.tri[(h / 3) as usize][(h % 3) as usize];
        assert_eq!(start(h as u32), start(next(g)));
    }
    let mut used = vec![false; d.len()];
    for (t, v) in d.triangles().iter().enumerate() {
        let [a, b, c] = v.map(|i| d.xy()[i as usize]);
        assert!(orient(a, b, c) > 0.0, "triangle {t} is not counter-clockwise");
        for k in 0..3 {
            used[v[k] as usize] = true;
            if let Some(u) = d.neighbour(t as u32, k) {
                let other = d.triangles()[u as usize];
                let far = other.iter().find(|i| !v.contains(i)).unwrap();
                let c = |p: [f64; 2]| robust::Coord { x: p[0], y: p[1] };
                let [a, b, e] = v.map(|i| c(d.xy()[i as usize]));
                assert!(robust::incircle(a, b, e, c(d.xy()[*far as usize])) <= 0.0);
            }
        }
    }
    if !d.triangles().is_empty() {
        let vertices = used.iter().filter(|&&u| u).count();
        assert_eq!(vertices + d.copies().len(), d.len());
        assert_eq!(d.triangles().len(), 2 * vertices - 2 - d.hull().len());
    }
}

#[test]
fn ring_paths_are_triangulated_exactly() {
    let points = rings(3.0, 0.5);
    let d = Delaunay::new(&points, Side::Front).unwrap();
    check(&d);
    assert!(d.copies().is_empty());
}

#[test]
fn a_square_grid_with_every_cell_cocircular_is_triangulated() {
    let points: Vec<DVec3> = (-20..=20)
        .flat_map(|i| (-20..=20).map(move |j| (f64::from(i) * 0.02, f64::from(j) * 0.02)))
        .map(|(x, y)| DVec3::new(x, y, 1.0).normalize())
        .collect();
    let d = Delaunay::new(&points, Side::Front).unwrap();
    check(&d);
    assert!(d.triangles().len() >= 2 * 40 * 40);
}

#[test]
fn tiny_sets_and_in_plane_scans_have_no_triangles_and_do_not_fail() {
    for n in 0..3 {
        let points: Vec<DVec3> = (0..n).map(|k| direction(0.3, f64::from(k))).collect();
        assert!(
            Delaunay::new(&points, Side::Front)
                .unwrap()
                .triangles()
                .is_empty()
        );
    }
    let scan: Vec<DVec3> = (-80..=80)
        .map(|k| {
            let (s, c) = f64::from(k).to_radians().sin_cos();
            DVec3::new(s, 0.0, c)
        })
        .collect();
    let d = Delaunay::new(&scan, Side::Front).unwrap();
    assert!(d.triangles().is_empty() && d.hull().is_empty());
    assert_eq!(d.adjacency().targets.len(), 0);
}

#[test]
fn copies_are_one_vertex() {
    let mut points = rings(10.0, 5.0);
    let n = points.len() as u32;
    points.extend_from_within(..);
    let d = Delaunay::new(&points, Side::Front).unwrap();
    check(&d);
    assert_eq!(d.copies().len(), n as usize);
    for &(copy, vertex) in d.copies() {
        assert_eq!(points[copy as usize], points[vertex as usize]);
    }
}

#[test]
fn a_million_fold_range_of_spacings_is_triangulated() {
    let mut points = rings(5.0, 5.0);
    points.extend((0..200).map(|k| direction(0.5 + 1e-8 * f64::from(k % 14), 1e-8 * f64::from(k / 14))));
    check(&Delaunay::new(&points, Side::Front).unwrap());
}

#[test]
fn a_linear_field_of_the_projected_plane_is_interpolated_exactly() {
    let points = rings(6.0, 3.0);
    for side in Side::BOTH {
        let flip = DVec3::new(1.0, 1.0, side.sign());
        let points: Vec<DVec3> = points.iter().map(|p| *p * flip).collect();
        let d = Delaunay::new(&points, side).unwrap();
        let field = |p: DVec3| 1.0 + 2.0 * p.x / (1.0 + p.z.abs()) - 3.0 * p.y / (1.0 + p.z.abs());
        let values: Vec<f64> = points.iter().map(|&p| field(p)).collect();
        let locator = d.locator();
        for k in 0..2000 {
            let q = direction(1.4 * f64::from(k % 50) / 50.0, f64::from(k)) * flip;
            let at = locator.locate(q).unwrap();
            let v: f64 = (0..3)
                .map(|j| at.weights[j] * values[at.vertices[j] as usize])
                .sum();
            assert!((v - field(q)).abs() < 1e-12);
            assert_eq!(
                d.interpolate(&values, q, at.triangle)
                    .map(|w| (w - v).abs() < 1e-12),
                Some(true)
            );
        }
        assert!(d.locate(direction(0.3, 0.0) * -flip, 0).is_none());
        assert!(d.locate(direction(PI / 2.0, 0.0), 0).is_none());
    }
}

#[test]
fn bad_directions_are_refused_by_index() {
    let ok = direction(0.2, 0.0);
    assert!(matches!(
        Delaunay::new(&[ok, DVec3::new(0.0, 0.0, 2.0)], Side::Front),
        Err(DelaunayError::NotUnit { index: 1, .. })
    ));
    assert!(matches!(
        Delaunay::new(&[ok, DVec3::new(f64::NAN, 0.0, 1.0)], Side::Front),
        Err(DelaunayError::NotUnit { index: 1, .. })
    ));
    assert!(matches!(
        Delaunay::new(&[ok], Side::Back),
        Err(DelaunayError::WrongSide { index: 0, .. })
    ));
}

proptest! {
    #[test]
    fn any_points_even_on_a_coarse_lattice_are_triangulated(
        cells in prop::collection::vec((-4i32..=4, -4i32..=4), 0..80),
    ) {
        let points: Vec<DVec3> = cells
            .iter()
            .map(|&(i, j)| DVec3::new(f64::from(i) * 0.125, f64::from(j) * 0.125, 1.0).normalize())
            .collect();
        let d = Delaunay::new(&points, Side::Front).unwrap();
        check(&d);
        let rows = d.adjacency();
        for i in 0..points.len() {
            for &j in rows.of(i) {
                prop_assert!(rows.of(j as usize).contains(&(i as u32)));
            }
        }
    }
}
