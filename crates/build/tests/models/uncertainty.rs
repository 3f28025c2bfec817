//! The uncertainty that a model states at a pair of directions covers its errors there.

use crate::common::{EIGHT, Noise, measure, thinned};
use gonio_bsdf::Bsdf;
use gonio_bsdf::analytic::{Lambert, Spectrum, Sum, WardGmd};
use gonio_build::{BuildOptions, Coverage, DataDriven};
use gonio_geom::{Component, DVec3, Direction, disk};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn gloss() -> Sum {
    Sum::new(vec![
        Box::new(Lambert::reflection(&Spectrum::photopic("rho_d", 0.3).unwrap()).unwrap()),
        Box::new(WardGmd::isotropic(&Spectrum::photopic("rho_s", 0.05).unwrap(), 0.15).unwrap()),
    ])
    .unwrap()
}

fn model(noise: Noise, last: f64, common: f64) -> DataDriven {
    let mut measurement = measure(&gloss(), &EIGHT, &[Component::Reflection], last, noise);
    thinned(&mut measurement, 3);
    for slice in &mut measurement.slices {
        slice.u_common = common;
        for (u, dsf) in slice.u_dsf.iter_mut().zip(&slice.dsf) {
            *u = u.hypot(common * dsf);
        }
    }
    DataDriven::build(&measurement, &BuildOptions::default()).unwrap()
}

/// Directions even in projected solid angle.
fn directions(n: usize) -> Vec<Direction> {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    (0..n)
        .map(|_| {
            let (x, y) = disk::square_to_disk(rng.random(), rng.random());
            Direction::new(DVec3::new(x, y, (1.0 - x * x - y * y).max(1e-6).sqrt())).unwrap()
        })
        .collect()
}

#[test]
fn twice_the_stated_uncertainty_covers_the_errors() {
    let model = model(Noise(0.03, 1e-3), 86.0, 0.0);
    for theta in [30.0, 35.0, 55.0] {
        let wi = Direction::from_degrees(theta, 180.0);
        let (mut covered, mut all, mut stated, mut found) = (0.0, 0.0, 0.0, 0.0);
        for ws in directions(4000) {
            if model.coverage(wi, ws) > Coverage::Interpolated {
                continue;
            }
            let u = model.uncertainty(wi, ws).unwrap().total();
            let error = (model.eval_first(wi, ws) - gloss().eval_first(wi, ws)).abs();
            covered += f64::from(u8::from(error <= 2.0 * u));
            all += 1.0;
            stated += u * u;
            found += error * error;
        }
        assert!(covered / all > 0.9, "{theta}: {}", covered / all);
        // neither far too small nor far too large
        let ratio = f64::sqrt(stated / found);
        assert!((0.5..2.5).contains(&ratio), "{theta}: {ratio}");
    }
}

#[test]
fn each_source_shows_where_it_acts() {
    let model = model(Noise(0.01, 2e-4), 80.0, 0.02);
    let wi = Direction::from_degrees(40.0, 180.0);
    let at = |wi, ws| model.uncertainty(wi, ws).unwrap();
    let inside = Direction::from_degrees(30.0, 70.0);
    let u = at(wi, inside);
    let f = model.eval_first(wi, inside);
    assert!((u.calibration / f - 0.02).abs() < 1e-9);
    assert!(u.noise > 0.0 && u.noise < 0.02 * f, "{u:?}");
    assert!(u.incidence.unwrap() < 1e-6 * f, "a measured incidence: {u:?}");
    let between = at(Direction::from_degrees(45.0, 180.0), inside);
    assert!(between.incidence.unwrap() > 1e-5 * f, "{between:?}");
    let past = at(Direction::from_degrees(85.0, 180.0), inside);
    assert!(past.incidence.unwrap() > between.incidence.unwrap());
    // Beyond the last ring the slice is carried on, and says so.
    let horizon = Direction::from_degrees(88.0, 70.0);
    let (f, u) = (model.eval_first(wi, horizon), at(wi, horizon));
    assert!(
        u.slice / f > 3.0 * at(wi, inside).slice / model.eval_first(wi, inside),
        "{u:?}"
    );
    let below = Direction::from_degrees(150.0, 0.0);
    assert!(model.uncertainty(wi, below).is_none());
}
