//! The chi-square test itself on trial: it must accept a sound sampler and reject one whose lobe is a little too narrow.
//! tests/statistical/judge.py puts the same cases to Mitsuba's test.

use gonio_bsdf::Bsdf;
use gonio_bsdf::analytic::{Spectrum, WardGmd};
use gonio_geom::Direction;

use crate::chi_square::ChiSquare;
use crate::trial::run;

const ALPHA: f64 = 0.15;

/// The verdict on `samples` samples of a lobe whose exponent, `1/alpha^2`, is `factor` times that of the density.
fn verdict(factor: f64, alpha: f64, samples: u64) -> ChiSquare {
    let model = |alpha: f64| {
        let rho = Spectrum::photopic("rho", 0.5).unwrap();
        WardGmd::isotropic(&rho, alpha).unwrap()
    };
    let (density, sampled) = (model(alpha), model(alpha / factor.sqrt()));
    let wi = Direction::from_degrees(40.0, 200.0);
    run(&density, |w, u| sampled.sample(w, u), wi, "judge", samples).chi_square
}

#[test]
fn a_sound_sampler_is_accepted_and_an_exponent_off_by_two_percent_rejected() {
    for alpha in [0.005, ALPHA] {
        let (sound, wrong) = (verdict(1.0, alpha, 1_000_000), verdict(1.02, alpha, 1_000_000));
        assert!(sound.p > 1e-3, "alpha {alpha}: {sound:?}");
        assert!(wrong.p < 1e-9, "alpha {alpha}: {wrong:?}");
    }
}

/// Writes one line a case to the file that `GONIO_JUDGED` names.
#[test]
#[ignore = "ten million samples a case; `make validate` runs it"]
fn half_a_percent_is_rejected_at_ten_million_samples() {
    let rows = [1.0, 1.005, 1.02].map(|factor| (factor, verdict(factor, ALPHA, 10_000_000)));
    if let Ok(path) = std::env::var("GONIO_JUDGED") {
        let lines: Vec<String> = rows.iter().map(|(f, v)| format!("{f}\t{:e}\n", v.p)).collect();
        std::fs::write(path, lines.concat()).unwrap();
    }
    assert!(rows[0].1.p > 1e-3, "{rows:?}");
    assert!(rows[1].1.p < 1e-9 && rows[2].1.p < 1e-9, "{rows:?}");
}
