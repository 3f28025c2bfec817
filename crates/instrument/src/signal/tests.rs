use super::*;
use crate::{Beam, BeamProfile};
use gonio_bsdf::analytic::{Lambert, Spectrum, WardGmd};

fn signal_at(model: &dyn Bsdf, beam: &Beam, detector: &Detector, wi: Direction, ws: Direction) -> f64 {
    let instrument = Instrument {
        beam: beam.clone(),
        detector: detector.clone(),
        ..Instrument::default()
    };
    let outputs = detector.outputs_for(model.channels()).unwrap();
    SampleSignal::new(model, &instrument, &outputs, wi).all(&[ws], &[DVec3::ZERO])[0][0]
}

#[test]
fn a_lambertian_spot_is_biased_by_no_more_than_its_size_over_the_distance_squared() {
    let model = Lambert::reflection(&Spectrum::photopic("rho", 0.8).unwrap()).unwrap();
    let (mut beam, detector) = (Beam::default(), Detector::default());
    beam.spot_diameter = 0.05;
    for deg in [0.0, 40.0, 80.0] {
        let ws = Direction::from_degrees(deg, 70.0);
        let got = signal_at(&model, &beam, &detector, Direction::NORMAL, ws);
        let dsf = beam.power * 0.8 / std::f64::consts::PI * ws.cos_theta();
        // (a/r)^2 = 6.0e-4; the factor in front stays below 2 for all polar angles.
        assert!((got / dsf - 1.0).abs() < 1.2e-3, "{deg} deg: {}", got / dsf);
    }
}

#[test]
fn a_small_aperture_and_beam_leave_the_model_as_it_is() {
    let model = WardGmd::isotropic(&Spectrum::photopic("rho", 0.5).unwrap(), 0.15).unwrap();
    let beam = Beam {
        spot_diameter: 0.0,
        profile: BeamProfile::TopHat { radius: 1e-4 },
        ..Beam::default()
    };
    let detector = Detector {
        aperture: 1e-5,
        ..Detector::default()
    };
    let wi = Direction::from_degrees(45.0, 10.0);
    for (theta, phi) in [(45.0, 190.0), (30.0, 180.0), (70.0, 200.0)] {
        let ws = Direction::from_degrees(theta, phi);
        let got = signal_at(&model, &beam, &detector, wi, ws);
        let dsf = beam.power * model.eval_first(wi, ws) * ws.cos_theta();
        assert!((got / dsf - 1.0).abs() < 1e-5, "{}", got / dsf);
    }
}

#[test]
fn the_peak_of_a_lobe_falls_by_the_variance_of_the_signature() {
    // A lobe exp(-g^2/w^2), w = 2 alpha, under a kernel of variance s^2 an axis: peak down by 2 s^2/w^2 at normal
    // incidence. Gaussian beam: w_b^2/2 an axis; disk aperture: a^2/4 an axis.
    let alpha = 0.05;
    let model = WardGmd::isotropic(&Spectrum::photopic("rho", 0.5).unwrap(), alpha).unwrap();
    let (w_b, a) = (0.01, 0.012);
    let beam = Beam {
        spot_diameter: 0.0,
        profile: BeamProfile::Gaussian { half_width: w_b },
        ..Beam::default()
    };
    let detector = Detector {
        aperture: a,
        ..Detector::default()
    };
    let got = signal_at(&model, &beam, &detector, Direction::NORMAL, Direction::NORMAL);
    let dsf = beam.power * model.eval_first(Direction::NORMAL, Direction::NORMAL);
    let w = 2.0 * alpha;
    let disk = (w * w / (a * a)) * (1.0 - (-a * a / (w * w)).exp());
    let expected = disk * w * w / (w * w + w_b * w_b);
    assert!(
        (got / dsf - expected).abs() < 1e-3,
        "{} expected {expected}",
        got / dsf
    );
}

#[test]
fn means_over_few_rays_are_off_by_less_than_a_tenth_of_the_noise() {
    // Lobes from narrow to broad, near their peaks and far from them, against 65_536 rays.
    for alpha in [0.02, 0.05, 0.2] {
        let model = WardGmd::isotropic(&Spectrum::photopic("rho", 0.5).unwrap(), alpha).unwrap();
        let instrument = Instrument::default();
        let outputs = instrument.detector.outputs_for(model.channels()).unwrap();
        for theta in [5.0, 50.0, 75.0] {
            let wi = Direction::from_degrees(theta, 30.0);
            let (a, b) = wi.mirror().vec().any_orthonormal_pair();
            let ws: Vec<Direction> = (0..200)
                .filter_map(|k| {
                    let (radius, turn) = (0.0025 * f64::from(k), 2.4 * f64::from(k));
                    Direction::new(wi.mirror().vec() + radius * (turn.cos() * a + turn.sin() * b))
                })
                .filter(|d| d.cos_theta() > 0.05)
                .collect();
            let still = vec![DVec3::ZERO; ws.len()];
            let mut signal = SampleSignal::new(&model, &instrument, &outputs, wi);
            let found = signal.all(&ws, &still).remove(0);
            let way = Way::new(wi, 0.0);
            let distance = instrument.detector.distance;
            signal.rays = rays(&instrument.beam, distance, &instrument.holder, &way, 65_536).0;
            let mut columns = signal.columns(&ws, &still);
            let mut sum = vec![vec![0.0; ws.len()]];
            signal.accumulate(0..65_536, &mut columns, &mut sum);
            for (j, (found, sum)) in found.iter().zip(&sum[0]).enumerate() {
                let truth = signal.power * sum / 65_536.0;
                let noise = instrument
                    .detector
                    .noise(instrument.detector.noise_readout, truth);
                let off = (found - truth).abs() / noise;
                assert!(
                    off < 0.1,
                    "alpha {alpha}, {theta} deg, reading {j}: {off} of the noise"
                );
            }
        }
    }
}

#[test]
fn the_bare_beam_integrates_to_its_power() {
    let detector = Detector::default();
    for profile in [
        BeamProfile::Gaussian { half_width: 0.002 },
        BeamProfile::TopHat { radius: 0.005 },
    ] {
        let beam = Beam {
            profile: profile.clone(),
            ..Beam::default()
        };
        let signal = BeamSignal::new(&beam, &detector, Direction::NORMAL.through());
        let (n, half) = (200, 0.012);
        let pitch = 2.0 * half / f64::from(n);
        let mut sum = 0.0;
        for i in 0..n {
            for j in 0..n {
                let v = DVec3::new(
                    -half + (f64::from(i) + 0.5) * pitch,
                    -half + (f64::from(j) + 0.5) * pitch,
                    -1.0,
                );
                // Solid angle of a tangent-plane element.
                sum += signal.at(Direction::new(v).unwrap()) * pitch * pitch / v.length().powi(3);
            }
        }
        assert!((sum / beam.power - 1.0).abs() < 2e-4, "{profile:?}: {sum}");
    }
}
