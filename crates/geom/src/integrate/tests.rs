use std::f64::consts::{PI, TAU};

use super::*;

fn spiral(n: u32) -> Vec<DVec3> {
    (0..n)
        .map(|k| {
            let z = 1.0 - (f64::from(k) + 0.5) / f64::from(n);
            Direction::from_spherical(z.acos(), 2.399_963 * f64::from(k)).vec()
        })
        .collect()
}

fn integral(points: &[DVec3], dsf: &[f64]) -> HemisphereIntegral {
    hemisphere_integral(points, dsf, None, None, Side::Front, &IntegralOptions::default()).unwrap()
}

#[test]
fn a_lambertian_integrates_to_its_albedo_at_any_directions() {
    for n in [1, 2, 3, 10, 1000] {
        let points = spiral(n);
        let dsf: Vec<f64> = points.iter().map(|p| 0.6 * p.z / PI).collect();
        let r = integral(&points, &dsf);
        assert!((r.value - 0.6).abs() < 1e-12, "n {n}: {}", r.value);
    }
}

/// A broad lobe about 30° on a Lambertian base.
fn lobe(p: DVec3) -> f64 {
    let axis = Direction::from_degrees(30.0, 0.0).vec();
    (0.2 + 0.8 * (-(1.0 - p.dot(axis)) / 0.05).exp()) * p.z
}

#[test]
fn the_rules_of_rising_order_converge_to_the_integral() {
    let truth = {
        let points = spiral(200_000);
        integral(&points, &points.iter().map(|&p| lobe(p)).collect::<Vec<_>>()).value
    };
    let mut last = f64::INFINITY;
    for n in [300, 1200, 4800] {
        let points = spiral(n);
        let r = integral(&points, &points.iter().map(|&p| lobe(p)).collect::<Vec<_>>());
        let error = (r.value - truth).abs();
        assert!(
            error < 0.25 * last,
            "quadrupling the readings divides the error by far more than 4"
        );
        assert!(
            error <= 2.0 * r.u_quadrature,
            "error {error} u {}",
            r.u_quadrature
        );
        last = error;
    }
}

#[test]
fn both_sides_and_copies_give_the_same_integral() {
    let mut points = spiral(500);
    let mut dsf: Vec<f64> = points.iter().map(|&p| lobe(p)).collect();
    let front = integral(&points, &dsf);
    let below: Vec<DVec3> = points.iter().map(|p| DVec3::new(p.x, p.y, -p.z)).collect();
    let back =
        hemisphere_integral(&below, &dsf, None, None, Side::Back, &IntegralOptions::default()).unwrap();
    assert!((front.value - back.value).abs() < 1e-15);
    // two readings of one direction count with their mean
    points.push(points[40]);
    dsf.push(dsf[40] + 0.1);
    dsf[40] -= 0.1;
    assert!((integral(&points, &dsf).value - front.value).abs() < 1e-14);
}

#[test]
fn the_noise_of_the_readings_is_propagated() {
    let points = spiral(2000);
    let dsf: Vec<f64> = points.iter().map(|&p| lobe(p)).collect();
    let sigma: Vec<f64> = dsf.iter().map(|d| 0.05 * d + 1e-3).collect();
    let at = |values: &[f64]| {
        hemisphere_integral(
            &points,
            values,
            Some(&sigma),
            None,
            Side::Front,
            &IntegralOptions::default(),
        )
        .unwrap()
    };
    let stated = at(&dsf).u_noise;
    let mut state = 7u64;
    let mut uniform = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let runs = 400;
    let (mut sum, mut sum2) = (0.0, 0.0);
    for _ in 0..runs {
        let noisy: Vec<f64> = dsf
            .iter()
            .zip(&sigma)
            .map(|(d, s)| d + s * (-2.0 * (1.0 - uniform()).ln()).sqrt() * (TAU * uniform()).cos())
            .collect();
        let v = at(&noisy).value;
        sum += v;
        sum2 += v * v;
    }
    let mean = sum / f64::from(runs);
    let empirical = (sum2 / f64::from(runs) - mean * mean).sqrt();
    // standard error of a standard deviation over 400 runs: 3.5 %; five of them (false alarm below 1e-6)
    assert!(
        (empirical / stated - 1.0).abs() < 0.18,
        "stated {stated} found {empirical}"
    );
}

#[test]
fn readings_that_are_not_usable_leave_a_gap_that_is_stated() {
    let points = spiral(5000);
    let mut dsf: Vec<f64> = points.iter().map(|p| 0.5 * p.z / PI).collect();
    let usable: Vec<bool> = points.iter().map(|p| p.x < 0.5).collect();
    for (d, _) in dsf.iter_mut().zip(&usable).filter(|(_, u)| !**u) {
        *d = f64::NAN;
    }
    let options = IntegralOptions {
        reach: Some(0.1),
        ..IntegralOptions::default()
    };
    let r = hemisphere_integral(&points, &dsf, None, Some(&usable), Side::Front, &options).unwrap();
    assert!(
        (r.value - 0.5).abs() < 2e-4,
        "a Lambertian is filled in: {}",
        r.value
    );
    // the cap x > 0.5 + reach has a quarter of the hemisphere, less the rim
    let gap = TAU - r.measured_omega;
    assert!(gap > 1.0 && gap < 0.5 * PI, "gap {gap}");
    assert!(r.extrapolated > 0.05 && r.u_extrapolated > 0.3 * r.extrapolated);
    assert!(r.u_quadrature >= r.u_extrapolated);
}

#[test]
fn every_bad_array_has_its_error() {
    let points = spiral(10);
    let dsf = vec![0.1; 10];
    let o = IntegralOptions::default();
    let call = |dsf: &[f64], sigma: Option<&[f64]>, usable: Option<&[bool]>| {
        hemisphere_integral(&points, dsf, sigma, usable, Side::Front, &o).unwrap_err()
    };
    assert!(matches!(
        call(&dsf[..9], None, None),
        IntegralError::Length {
            field: "dsf",
            found: 9,
            expected: 10
        }
    ));
    assert!(matches!(
        call(&dsf, Some(&[0.0]), None),
        IntegralError::Length { field: "sigma", .. }
    ));
    assert!(matches!(
        call(&dsf, None, Some(&[false; 10])),
        IntegralError::NothingUsable { found: 10 }
    ));
    let mut bad = dsf.clone();
    bad[3] = f64::INFINITY;
    assert!(matches!(
        call(&bad, None, None),
        IntegralError::NotFinite {
            field: "dsf",
            index: 3,
            ..
        }
    ));
    let refused = hemisphere_integral(&points, &dsf, None, None, Side::Back, &o).unwrap_err();
    assert!(matches!(
        refused,
        IntegralError::NothingUsable { .. } | IntegralError::Weights(_)
    ));
}

/// A grid of rings 5 degrees apart with noise of 1 %, and beside it `extra` readings close together.
fn with_close_readings(extra: &[DVec3]) -> HemisphereIntegral {
    let mut points: Vec<DVec3> = Vec::new();
    for ring in 1..18 {
        points.extend((0..24).map(|k| Direction::from_degrees(f64::from(5 * ring), f64::from(15 * k)).vec()));
    }
    points.extend(extra);
    let side = if extra[0].z < 0.0 { Side::Back } else { Side::Front };
    if side == Side::Back {
        points[..17 * 24].iter_mut().for_each(|p| p.z = -p.z);
    }
    // Even noise without a generator: fractions of multiples of the golden ratio.
    let noise = |k: usize| 0.01 * 3f64.sqrt() * (2.0 * (0.618_033_988_75 * k as f64).fract() - 1.0);
    let dsf: Vec<f64> = points
        .iter()
        .enumerate()
        .map(|(k, p)| 0.3 * p.z.abs() * (1.0 + noise(k)))
        .collect();
    let sigma: Vec<f64> = dsf.iter().map(|d| 0.01 * d).collect();
    let options = IntegralOptions::default();
    hemisphere_integral(&points, &dsf, Some(&sigma), None, side, &options).unwrap()
}

#[test]
fn readings_of_nearly_the_same_direction_count_as_their_mean() {
    let truth = 0.3 * PI;
    let mut clusters: Vec<Vec<DVec3>> = Vec::new();
    for nadir in [0.0, 180.0] {
        // The same pole under 24 azimuths: equal up to rounding.
        let pole = |k: i32| Direction::from_degrees(nadir, f64::from(15 * k)).vec();
        clusters.push((0..24).map(pole).collect());
    }
    for apart in [1e-9, 1e-7, 1e-5, 1e-3, 2e-3, 0.01, 0.05, 0.5] {
        for theta in [0.0, 40.0] {
            let near = |k: i32| {
                let k = f64::from(k);
                Direction::from_degrees(
                    theta + apart * (k * 0.618).fract(),
                    20.0 + apart * (k * 0.414).fract(),
                )
            };
            clusters.push((0..20).map(|k| near(k).vec()).collect());
            clusters.push((0..2).map(|k| near(k).vec()).collect());
        }
    }
    for extra in &clusters {
        let r = with_close_readings(extra);
        let u = r.u_noise.hypot(r.u_quadrature);
        assert!(
            (r.value - truth).abs() < 0.005 * truth && u < 0.005 * truth,
            "{} readings from {:?} to {:?}: {r:?}, {truth}",
            extra.len(),
            extra[0],
            extra[1],
        );
    }
}

/// Directions over the hemisphere and a square raster of `pitch` radians about 30°, displaced by `phase` steps.
fn with_patch(pitch: f64, phase: [f64; 2]) -> Vec<DVec3> {
    let axis = Direction::from_degrees(30.0, 0.0).vec();
    let (a, b) = axis.any_orthonormal_pair();
    let radius = 12;
    let outside = |p: &DVec3| p.angle_between(axis) > (f64::from(radius) + 0.5) * pitch;
    let mut points: Vec<DVec3> = spiral(2_000).into_iter().filter(outside).collect();
    for k in -radius..=radius {
        for l in -radius..=radius {
            let (x, y) = (f64::from(k) + phase[0], f64::from(l) + phase[1]);
            if x.hypot(y) <= f64::from(radius) {
                points.push((axis + pitch * (x * a + y * b)).normalize());
            }
        }
    }
    points
}

#[test]
fn the_uncertainty_covers_peaks_that_hold_few_readings() {
    let axis = Direction::from_degrees(30.0, 0.0).vec();
    let pitch = 0.004;
    let (mut covered, mut cases) = (0, 0);
    for width in [0.25, 0.35, 0.42, 0.5, 0.7, 1.0] {
        let s = width * pitch;
        let mut rms = [0.0; 2];
        for k in 0..25 {
            let phase = [f64::from(k % 5) / 5.0, f64::from(k / 5) / 5.0];
            let points = with_patch(pitch, phase);
            let dsf: Vec<f64> = points
                .iter()
                .map(|p| 0.1 * p.z / PI + (-(p.angle_between(axis) / s).powi(2) / 2.0).exp() / (TAU * s * s))
                .collect();
            let r = integral(&points, &dsf);
            let error = (r.value - 1.1).abs();
            rms[0] += error * error / 25.0;
            rms[1] += r.u_quadrature.powi(2) / 25.0;
            covered += i32::from(error <= 2.0 * r.u_quadrature);
            cases += 1;
        }
        assert!(
            rms[1].sqrt() < 4.0 * rms[0].sqrt() + 0.01,
            "width {width}: u {} for an error of {}",
            rms[1].sqrt(),
            rms[0].sqrt()
        );
    }
    assert!(
        f64::from(covered) >= 0.95 * f64::from(cases),
        "{covered} of {cases}"
    );
}
