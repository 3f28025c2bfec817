//! A campaign holds what a real one holds, and its numbers follow from the model.

#![allow(clippy::unwrap_used)] // helpers outside #[test] fail a test by panicking, as the tests themselves do

use gonio_bsdf::Bsdf;
use gonio_bsdf::analytic::{Lambert, Spectrum, Sum, WardGmd};
use gonio_geom::{Angles, Component};
use gonio_instrument::{Campaign, Instrument, simulate};
use gonio_scan::{Scan, ScanKind};

fn plastic() -> Sum {
    Sum::new(vec![
        Box::new(Lambert::reflection(&Spectrum::photopic("rho_d", 0.4).unwrap()).unwrap()),
        Box::new(WardGmd::isotropic(&Spectrum::photopic("rho_s", 0.1).unwrap(), 0.15).unwrap()),
    ])
    .unwrap()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (mut n, mut sum) = (0.0, 0.0);
    for v in values {
        n += 1.0;
        sum += v;
    }
    sum / n
}

fn dark_level(records: &[Scan]) -> f64 {
    mean(
        records
            .iter()
            .filter(|r| r.kind == ScanKind::Dark)
            .flat_map(|r| r.value.iter().copied()),
    )
}

#[test]
fn the_same_seed_gives_the_same_records_and_another_seed_others() {
    let run = |seed| {
        let campaign = Campaign {
            seed,
            incidences: vec![Angles::from_degrees(40.0, 0.0)],
            ..Campaign::default()
        };
        simulate(&plastic(), &Instrument::default(), &campaign).unwrap()
    };
    assert_eq!(run(3), run(3));
    let (a, b) = (run(3), run(4));
    assert!(a.iter().zip(&b).all(|(x, y)| x.value[0] != y.value[0]));
}

#[test]
fn dark_records_bracket_every_scan_in_time() {
    let records = simulate(&plastic(), &Instrument::default(), &Campaign::default()).unwrap();
    assert!(records.iter().filter(|r| r.kind == ScanKind::Sample).count() >= 6);
    assert_eq!(records.first().unwrap().kind, ScanKind::Dark);
    assert_eq!(records.last().unwrap().kind, ScanKind::Dark);
    let ends = |r: &Scan| {
        let t = r.time.as_ref().unwrap();
        (t[0], t[t.len() - 1])
    };
    for pair in records.windows(2) {
        assert!(ends(&pair[0]).1 < ends(&pair[1]).0);
    }
    let readings: usize = records.iter().map(Scan::len).sum();
    assert!(readings > 100_000, "{readings}");
}

#[test]
fn the_raster_over_the_beam_sums_to_its_power() {
    let instrument = Instrument::default();
    let campaign = Campaign {
        incidences: vec![Angles::from_degrees(40.0, 0.0)],
        beam_scans: 8,
        ..Campaign::default()
    };
    let records = simulate(&plastic(), &instrument, &campaign).unwrap();
    let dark = dark_level(&records);
    let pitch = 0.15 * instrument.detector.aperture;
    for beam in records.iter().filter(|r| r.kind == ScanKind::Beam) {
        let power: f64 = beam.value.iter().map(|v| (v - dark) * pitch * pitch).sum();
        // Over about 420 effective readings .8 % of noise leaves .04 % and the pointing, .001 degrees on flanks of up
        // to 20 a degree, .07 %; eight scans at five of both together: false alarm 5e-6.
        assert!((power / instrument.beam.power - 1.0).abs() < 4.3e-3, "{power}");
    }
}

#[test]
fn readings_over_beam_power_are_the_dsf_of_the_model_within_noise() {
    let mut instrument = Instrument::default();
    instrument.detector.dark_swing = 0.0;
    let model = plastic();
    let incidence = Angles::from_degrees(50.0, 20.0);
    let campaign = Campaign {
        incidences: vec![incidence],
        ..Campaign::default()
    };
    let records = simulate(&model, &instrument, &campaign).unwrap();
    let dark = instrument.detector.dark_level;
    let sample = records.iter().find(|r| r.kind == ScanKind::Sample).unwrap();
    let z: Vec<f64> = (0..sample.len())
        .map(|j| {
            let ws = sample.direction(j);
            let dsf = model.eval_first(incidence.direction(), ws) * ws.cos_theta().abs();
            let signal = dsf * instrument.beam.power;
            let sigma = instrument
                .detector
                .noise_readout
                .hypot(instrument.detector.noise_relative * signal);
            (sample.value[j] - dark - signal) / sigma
        })
        .collect();
    let n = z.len() as f64;
    let centre = mean(z.iter().copied());
    let variance = mean(z.iter().map(|z| z * z)) - centre * centre;
    // Means of n deviates scatter by 1/sqrt(n), variances by sqrt(2/n): five of each, plus a tenth of the noise for
    // the finite beam, spot and aperture.
    assert!(centre.abs() < 0.1 + 5.0 / n.sqrt(), "mean {centre}");
    assert!(
        (variance - 1.0).abs() < 0.05 + 5.0 * (2.0 / n).sqrt(),
        "variance {variance}"
    );
}

#[test]
fn a_saturated_detector_never_reads_more_than_its_limit() {
    let mut instrument = Instrument::default();
    instrument.detector.saturation = 50.0;
    let records = simulate(&plastic(), &instrument, &Campaign::default()).unwrap();
    let most = records
        .iter()
        .flat_map(|r| r.value.iter().copied())
        .fold(f64::NEG_INFINITY, f64::max);
    assert_eq!(most, 50.0);
}

#[test]
fn both_hemispheres_and_every_channel_are_read() {
    use gonio_bsdf::Channel;
    let spectrum = Spectrum::new("rho", &[(Channel::Red, 0.2), (Channel::Green, 0.6)]).unwrap();
    let model = Sum::new(vec![
        Box::new(Lambert::reflection(&spectrum.clone()).unwrap()),
        Box::new(Lambert::transmission(&spectrum).unwrap()),
    ])
    .unwrap();
    let mut instrument = Instrument::default();
    instrument.path.patch = None;
    let campaign = Campaign {
        incidences: vec![Angles::from_degrees(20.0, 0.0)],
        components: vec![Component::Reflection, Component::Transmission],
        ..Campaign::default()
    };
    let records = simulate(&model, &instrument, &campaign).unwrap();
    let dark = dark_level(&records);
    let level = |channel| {
        let r = records
            .iter()
            .find(|r| r.kind == ScanKind::Sample && r.channel == channel)
            .unwrap();
        let on = |back: bool| {
            mean(
                (0..r.len())
                    .filter(|&j| (r.direction(j).cos_theta() < 0.0) == back)
                    .map(|j| r.value[j] - dark),
            )
        };
        (on(false), on(true))
    };
    let ((red, red_back), (green, green_back)) = (level(Channel::Red), level(Channel::Green));
    assert!((green / red - 3.0).abs() < 0.05 && (green_back / red_back - 3.0).abs() < 0.05);
}

#[test]
fn impossible_campaigns_are_refused_by_name() {
    let refused = |campaign: Campaign| {
        simulate(&plastic(), &Instrument::default(), &campaign)
            .unwrap_err()
            .to_string()
    };
    let base = Campaign::default;
    assert!(
        refused(Campaign {
            incidences: vec![],
            ..base()
        })
        .starts_with("incidences: found none")
    );
    let grazing = vec![Angles::from_degrees(89.9, 0.0)];
    assert!(
        refused(Campaign {
            incidences: grazing,
            ..base()
        })
        .contains("theta_i = 89.9")
    );
    assert!(
        refused(Campaign {
            components: vec![],
            ..base()
        })
        .starts_with("components")
    );
    assert!(
        refused(Campaign {
            beam_scans: 0,
            ..base()
        })
        .starts_with("beam_scans")
    );
    let mut instrument = Instrument::default();
    instrument.detector.distance = -1.0;
    let error = simulate(&plastic(), &instrument, &base())
        .unwrap_err()
        .to_string();
    assert!(error.starts_with("distance: found -1 m"), "{error}");
}

#[test]
fn an_ideal_mirror_returns_its_share_of_the_beam() {
    use gonio_bsdf::RadianceMaterial;
    use gonio_bsdf::radiance::Mirror;
    let model = RadianceMaterial::from(Mirror {
        color: [0.3, 0.6, 0.9],
        alternate: None,
    });
    let mut instrument = Instrument::default();
    instrument.detector.noise_readout = 0.0;
    instrument.detector.noise_relative = 0.0;
    instrument.detector.pointing = 0.0;
    instrument.detector.dark_level = 0.0;
    instrument.detector.dark_swing = 0.0;
    // Rings of the patch fine enough for a sum over the image of the beam.
    let pitch = 0.02_f64.to_radians();
    instrument.path.patch = Some(gonio_instrument::Patch {
        radius: 0.7_f64.to_radians(),
        pitch,
        growth: 0.0,
        along: 1.0,
    });
    instrument.path.jitter = 0.0;
    let incidence = Angles::from_degrees(40.0, 20.0);
    let campaign = Campaign {
        incidences: vec![incidence],
        ..Campaign::default()
    };
    let records = simulate(model.bsdf().unwrap().as_ref(), &instrument, &campaign).unwrap();
    let mirror = incidence.direction().mirror();
    for (record, share) in records
        .iter()
        .filter(|r| r.kind == ScanKind::Sample)
        .zip([0.3, 0.6, 0.9])
    {
        // Readings of the patch have rings of their own about the mirror direction.
        let patch = instrument.path.patch.unwrap();
        let rings = (patch.radius / pitch).round() as usize;
        let in_patch: usize = (0..rings)
            .map(|k| {
                let gamma = (k as f64 + 0.5) * pitch;
                (std::f64::consts::TAU * gamma.sin() / pitch).round().max(4.0) as usize
            })
            .sum();
        let first = record.len() - in_patch;
        let sum: f64 = (first..record.len())
            .map(|j| {
                let at = Angles {
                    theta: record.theta_s[j],
                    phi: record.phi_s[j],
                };
                let gamma = at.direction().angle_to(mirror);
                let n = (std::f64::consts::TAU * gamma.sin() / pitch).round().max(4.0);
                record.value[j] * std::f64::consts::TAU * gamma.sin() * pitch / n
            })
            .sum();
        let expected = share * instrument.beam.power;
        assert!((sum / expected - 1.0).abs() < 5e-3, "{sum} {expected}");
    }
}

#[test]
fn a_model_that_bends_the_beam_is_refused() {
    use gonio_bsdf::RadianceMaterial;
    use gonio_bsdf::radiance::Dielectric;
    let body = RadianceMaterial::from(Dielectric {
        transmissivity: [1.0; 3],
        refractive_index: 1.52,
        hartmann: 0.0,
    });
    let e = simulate(
        body.bsdf().unwrap().as_ref(),
        &Instrument::default(),
        &Campaign::default(),
    )
    .unwrap_err();
    assert!(
        e.to_string().starts_with("model: found an ideal part that bends"),
        "{e}"
    );
}
