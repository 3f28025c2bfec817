use std::f64::consts::{FRAC_PI_2, PI, TAU};

use proptest::prelude::*;

use super::*;
use crate::Direction;

fn direction(theta: f64, phi: f64) -> DVec3 {
    Direction::from_spherical(theta, phi).vec()
}

fn sums(cells: &Cells) -> (f64, f64) {
    (
        cells.omega.iter().sum(),
        cells.moment.iter().map(|m| m.z.abs()).sum(),
    )
}

fn assert_tiles(points: &[DVec3], side: Side) -> Cells {
    let cells = hemisphere_cells(points, side).unwrap();
    let (omega, projected) = sums(&cells);
    assert!(
        (omega - TAU).abs() < 1e-9,
        "sum of omega is off by {}",
        omega - TAU
    );
    assert!(
        (projected - PI).abs() < 1e-9,
        "sum of projected omega is off by {}",
        projected - PI
    );
    assert!(cells.omega.iter().all(|&o| o >= -1e-15));
    cells
}

/// Independent of the triangulation: every cell cut by the half spaces towards all other points.
fn brute_force(points: &[DVec3], i: usize) -> (f64, DVec3) {
    let mut work = Vec::new();
    let mut total = (0.0, DVec3::ZERO);
    for quarter in &polygon::QUARTERS {
        let mut piece = quarter.to_vec();
        for q in points {
            if *q != points[i] {
                polygon::clip(&mut piece, points[i] - *q, &mut work);
            }
        }
        let (omega, moment) = area_and_moment(&piece);
        total.0 += omega;
        total.1 += moment;
    }
    total
}

#[test]
fn one_point_owns_the_hemisphere() {
    for p in [DVec3::Z, direction(1.2, 0.4), direction(FRAC_PI_2, 2.0)] {
        let cells = assert_tiles(&[p], Side::Front);
        assert!(cells.reach[0] >= FRAC_PI_2);
    }
}

#[test]
fn points_around_the_normal_at_equal_steps_share_equally() {
    for n in [2u32, 3, 4, 5, 12, 360] {
        for theta in [0.001, 0.7, 1.4, FRAC_PI_2] {
            let points: Vec<DVec3> = (0..n)
                .map(|k| direction(theta, TAU * f64::from(k) / f64::from(n) + 0.1))
                .collect();
            let cells = assert_tiles(&points, Side::Front);
            for i in 0..n as usize {
                assert!(
                    (cells.omega[i] - TAU / f64::from(n)).abs() < 1e-9,
                    "n {n} theta {theta}"
                );
            }
        }
    }
}

#[test]
fn the_pole_within_a_ring_owns_the_cap_like_polygon_of_the_bisectors() {
    // n bisector planes at theta/2 around the pole: a regular n-gon with apothem theta/2
    let (n, theta) = (6u32, 1.0f64);
    let mut points = vec![DVec3::Z];
    points.extend((0..n).map(|k| direction(theta, TAU * f64::from(k) / f64::from(n))));
    let cells = assert_tiles(&points, Side::Front);
    let half = PI / f64::from(n);
    let angle = 2.0 * ((theta / 2.0).cos() * half.sin()).acos(); // interior angle of the regular spherical n-gon
    let expected = f64::from(n) * angle - f64::from(n - 2) * PI;
    assert!((cells.omega[0] - expected).abs() < 1e-13);
}

#[test]
fn an_in_plane_scan_gives_lunes_between_the_bisectors() {
    let scan: Vec<DVec3> = (-4..=4)
        .map(|k| {
            let (s, c) = (f64::from(k) * 0.2).sin_cos();
            DVec3::new(s, 0.0, c)
        })
        .collect();
    let cells = assert_tiles(&scan, Side::Front);
    for k in 1..8 {
        assert!(
            (cells.omega[k] - 0.4).abs() < 1e-12,
            "a lune of angle 0.2 has 2 * 0.2 sr"
        );
    }
    assert!(
        (cells.omega[0] - (PI - 1.4)).abs() < 1e-12,
        "the outer lunes reach the horizon"
    );
}

#[test]
fn copies_share_their_cell_equally() {
    let mut points: Vec<DVec3> = (0..50)
        .map(|k| direction(0.03 * f64::from(k), f64::from(k * k)))
        .collect();
    let single = hemisphere_cells(&points, Side::Front).unwrap();
    points.extend([points[7], points[7], points[20]]);
    let cells = assert_tiles(&points, Side::Front);
    for i in [7, 50, 51] {
        assert!((cells.omega[i] - single.omega[7] / 3.0).abs() < 1e-15);
        assert_eq!(cells.reach[i], single.reach[7]);
    }
    assert!((cells.omega[52] - single.omega[20] / 2.0).abs() < 1e-15);
    let same = assert_tiles(&[direction(0.5, 1.0); 4], Side::Front);
    assert!(same.omega.iter().all(|o| (o - FRAC_PI_2).abs() < 1e-14));
}

#[test]
fn the_back_is_the_mirror_image_of_the_front() {
    let front: Vec<DVec3> = (0..200)
        .map(|k| direction(0.0078 * f64::from(k), 2.4 * f64::from(k)))
        .collect();
    let back: Vec<DVec3> = front.iter().map(|p| DVec3::new(p.x, p.y, -p.z)).collect();
    let (f, b) = (assert_tiles(&front, Side::Front), assert_tiles(&back, Side::Back));
    for i in 0..front.len() {
        assert_eq!(f.omega[i], b.omega[i]);
        assert_eq!(f.moment[i] * DVec3::new(1.0, 1.0, -1.0), b.moment[i]);
    }
}

#[test]
fn a_path_with_rings_and_a_fine_patch_tiles_the_hemisphere() {
    let mut points = Vec::new();
    for ring in 0..29 {
        let theta = (1.5 + 3.0 * f64::from(ring)).to_radians();
        let n = ((360.0 * theta.sin() / 0.1) as usize).max(8);
        points.extend((0..n).map(|k| direction(theta, TAU * k as f64 / n as f64)));
    }
    for i in -80..=80 {
        for j in -16..=16 {
            let (x, y) = (0.1 * f64::from(i), 0.5 * f64::from(j));
            points.push((direction(0.52, 0.0) + DVec3::new(x, y, 0.0) * 0.0175).normalize());
        }
    }
    assert_tiles(&points, Side::Front);
}

#[test]
fn cells_turn_with_the_points_about_the_normal() {
    let points: Vec<DVec3> = (0..500)
        .map(|k| direction(0.003 * f64::from(k), 2.4 * f64::from(k)))
        .collect();
    let turned: Vec<DVec3> = points
        .iter()
        .map(|&p| Direction::from_unit(p).rotated(0.7).vec())
        .collect();
    let (a, b) = (
        assert_tiles(&points, Side::Front),
        assert_tiles(&turned, Side::Front),
    );
    for i in 0..points.len() {
        assert!((a.omega[i] - b.omega[i]).abs() < 1e-13);
        assert!((a.reach[i] - b.reach[i]).abs() < 1e-12);
    }
}

#[test]
fn the_projected_weights_integrate_a_lambertian_exactly() {
    let points: Vec<DVec3> = (0..300)
        .map(|k| direction(0.005 * f64::from(k), 2.4 * f64::from(k)))
        .collect();
    let cells = hemisphere_cells(&points, Side::Front).unwrap();
    let rho: f64 = (0..300).map(|i| cells.omega_projected(i) / PI).sum();
    assert!((rho - 1.0).abs() < 1e-12);
}

#[test]
fn no_points_and_points_of_the_other_side_are_refused() {
    assert_eq!(hemisphere_cells(&[], Side::Front), Err(WeightsError::Empty));
    assert!(matches!(
        hemisphere_cells(&[-DVec3::Z], Side::Front),
        Err(WeightsError::Delaunay(DelaunayError::WrongSide { index: 0, .. }))
    ));
}

/// Points of one kind each: scattered, in a patch anywhere, on a circle, on a lattice, on the horizon.
fn any_points() -> impl Strategy<Value = Vec<DVec3>> {
    let one = (0.0..1.0f64, 0.0..TAU).prop_map(|(z, phi)| direction(z.acos(), phi));
    let scattered = prop::collection::vec(one, 1..60);
    let patch = (
        0.0..FRAC_PI_2,
        0.0..TAU,
        -9.0..-0.5f64,
        prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 1..60),
    )
        .prop_map(|(theta, phi, size, offsets)| {
            let axis = direction(theta, phi);
            let (u, v) = axis.any_orthonormal_pair();
            let r = 10f64.powf(size);
            offsets
                .iter()
                .map(|&(a, b)| (axis + r * (a * u + b * v)).normalize())
                .map(|p| DVec3::new(p.x, p.y, p.z.max(0.0)).normalize())
                .collect()
        });
    let circle = (
        0.0..FRAC_PI_2,
        0.0..TAU,
        0.01..1.5f64,
        prop::collection::vec(0.0..TAU, 1..60),
    )
        .prop_map(|(theta, phi, radius, turns)| {
            let axis = direction(theta, phi);
            let (u, v) = axis.any_orthonormal_pair();
            turns
                .iter()
                .map(|t| axis * radius.cos() + (u * t.cos() + v * t.sin()) * radius.sin())
                .map(|p| DVec3::new(p.x, p.y, p.z.abs()).normalize())
                .collect()
        });
    let lattice = prop::collection::vec((0u32..=6, 0u32..8), 1..60).prop_map(|cells| {
        cells
            .iter()
            .map(|&(t, p)| direction(f64::from(t) * FRAC_PI_2 / 6.0, f64::from(p) * TAU / 8.0))
            .collect()
    });
    prop_oneof![scattered, patch, circle, lattice]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn cells_of_any_points_tile_the_hemisphere(points in any_points()) {
        assert_tiles(&points, Side::Front);
    }

    #[test]
    fn cells_of_scattered_points_are_those_of_brute_force(
        seeds in prop::collection::vec((0.0..1.0f64, 0.0..TAU), 1..40),
    ) {
        let points: Vec<DVec3> = seeds.iter().map(|&(z, phi)| direction(z.acos(), phi)).collect();
        let cells = hemisphere_cells(&points, Side::Front).unwrap();
        for i in 0..points.len() {
            let (omega, moment) = brute_force(&points, i);
            prop_assert!((cells.omega[i] - omega).abs() < 1e-10);
            prop_assert!((cells.moment[i] - moment).length() < 1e-10);
        }
    }
}
