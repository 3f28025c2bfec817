//! Readings of geometry against those of the model that it carries, and against closed forms.
#![allow(clippy::unwrap_used, missing_docs)]

use std::sync::Arc;

use gonio_bsdf::{Bsdf, Channel, RadianceMaterial};
use gonio_geom::{Angles, Component, Direction};
use gonio_instrument::device::{MonteCarlo, ReadingEffort, simulate_device};
use gonio_instrument::{
    Beam, BeamProfile, Campaign, Detector, DetectorPath, Device, Extent, Instrument, Output, PathTable,
    simulate,
};
use gonio_scan::{Scan, ScanKind};
use gonio_trace::material::Material;
use gonio_trace::scene::{Parts, Surface};

fn quad(parts: &mut Parts, corners: [[f32; 3]; 4]) {
    let k = parts.vertices.len() as u32;
    parts.vertices.extend(corners);
    parts.triangles.extend([[k, k + 1, k + 2], [k, k + 2, k + 3]]);
    parts.triangle_surface.extend([0; 2]);
}

fn material(name: &str, reals: &[f64]) -> Arc<dyn Bsdf> {
    let found = RadianceMaterial::from_arguments(name, &[], reals)
        .unwrap()
        .unwrap();
    Arc::from(found.bsdf().unwrap())
}

fn made_of(model: &Arc<dyn Bsdf>) -> Parts {
    Parts {
        materials: vec![Material::model(Arc::clone(model), None)],
        surfaces: vec![Surface::default()],
        ..Parts::default()
    }
}

/// A plate of 200 by 200 units about the origin.
fn plate(model: &Arc<dyn Bsdf>) -> Parts {
    let mut parts = made_of(model);
    let (a, b) = (-100.0, 100.0);
    quad(&mut parts, [[a, a, 0.0], [b, a, 0.0], [b, b, 0.0], [a, b, 0.0]]);
    parts
}

/// A goniophotometer with a noise of half a percent that sees grey light.
fn instrument() -> Instrument {
    Instrument {
        detector: Detector {
            noise_relative: 0.005,
            noise_readout: 0.02,
            integration: 0.02,
            aperture: 0.3_f64.to_radians(),
            outputs: vec![Output {
                channel: Channel::Photopic,
                power: 1.0,
                weights: vec![0.2, 0.3, 0.5],
            }],
            ..Detector::default()
        },
        beam: Beam {
            profile: BeamProfile::Gaussian {
                half_width: 0.3_f64.to_radians(),
            },
            ..Beam::default()
        },
        path: DetectorPath {
            pitch_across: 20.0_f64.to_radians(),
            pitch_along: 10.0_f64.to_radians(),
            ..DetectorPath::default()
        },
        ..Instrument::default()
    }
}

fn campaign(incidences: &[(f64, f64)], components: &[Component]) -> Campaign {
    Campaign {
        incidences: incidences
            .iter()
            .map(|(t, p)| Angles::from_degrees(*t, *p))
            .collect(),
        components: components.to_vec(),
        ..Campaign::default()
    }
}

fn millimetres() -> ReadingEffort {
    ReadingEffort {
        unit: 1e-3,
        ..ReadingEffort::default()
    }
}

fn measured(
    (parts, extent): (Parts, Extent),
    unit: f64,
    it: &Instrument,
    how: &Campaign,
) -> (Vec<Scan>, Vec<MonteCarlo>) {
    let device = Device::new(parts, extent).unwrap();
    let effort = ReadingEffort {
        unit,
        met: 1 << 19,
        joined: 1 << 12,
        ..ReadingEffort::default()
    };
    simulate_device(&device, &effort, it, how, |_, _| true)
        .unwrap()
        .unwrap()
}

fn samples(records: &[Scan]) -> Vec<&Scan> {
    records.iter().filter(|r| r.kind == ScanKind::Sample).collect()
}

#[test]
fn a_plate_reads_as_the_model_it_carries() {
    let it = instrument();
    let reflection = || vec![Component::Reflection];
    for (model, components, incidence, tails) in [
        (
            material("plastic", &[0.4, 0.4, 0.4, 0.05, 0.1]),
            reflection(),
            (60.0, 30.0),
            0.0,
        ),
        (
            material("metal", &[0.7, 0.6, 0.5, 0.9, 0.08]),
            reflection(),
            (10.0, 0.0),
            0.0,
        ),
        (
            material("trans", &[0.5, 0.6, 0.7, 0.05, 0.12, 0.5, 0.4]),
            vec![Component::Reflection, Component::Transmission],
            (30.0, 0.0),
            0.0,
        ),
        // The image of the beam is averaged over 256 points of an aperture that stands for its motion in four places.
        (
            material("mirror", &[0.8, 0.8, 0.8]),
            reflection(),
            (30.0, 0.0),
            0.04,
        ),
    ] {
        let how = campaign(&[incidence], &components);
        let wanted = simulate(model.as_ref(), &it, &how).unwrap();
        let (found, known) = measured((plate(&model), Extent::default()), 1e-3, &it, &how);
        assert_eq!(known.len(), 1);
        for ((wanted, found), known) in samples(&wanted).iter().zip(samples(&found)).zip(&known) {
            assert_eq!(wanted.theta_s, found.theta_s);
            let (mut square, mut claimed, mut above) = (0.0, 0.0, 0);
            for (j, (a, b)) in wanted.value.iter().zip(&found.value).enumerate() {
                // Both have the same noise: what is left is how well both means are known, that of the model to a tenth of it.
                let noise = it.detector.noise(0.02, (a - 2.0).max(0.0));
                let off = (a - b) / noise;
                let error = f64::from(known.error_over_noise[j]);
                let theta = wanted.theta_s[j].to_degrees();
                let image = tails * a / noise;
                assert!(
                    off.abs() < 6.0 * error + 0.4 + image,
                    "{theta} {j}: {a} {b} {noise} {error}"
                );
                square += off * off;
                claimed += error * error + image * image;
                above += usize::from(error > 0.5);
            }
            let n = wanted.value.len() as f64;
            let (rms, claimed) = ((square / n).sqrt(), (claimed / n).sqrt());
            assert!(rms < 1.5 * claimed + 0.1, "{rms} {claimed}");
            // In the tails of the beam's image rays are rare, and lobes are steep.
            assert!(above as f64 <= 0.15 * n, "{above} of {n}");
        }
    }
}

#[test]
fn a_groove_of_two_mirrors_sends_the_beam_back_and_aside() {
    // Mirrors at 45 degrees, period 1: of light of slope t across the groove 1 - t meets both mirrors and goes back where it came
    // from in the plane across the groove, t meets one and goes aside.
    let (rho, theta) = (0.8, 20.0_f64.to_radians());
    let t = theta.tan();
    let mut parts = made_of(&material("mirror", &[rho; 3]));
    let (low, high) = (-1.0, 2.0);
    quad(
        &mut parts,
        [
            [low, 0.0, 0.0],
            [high, 0.0, 0.0],
            [high, 0.5, -0.5],
            [low, 0.5, -0.5],
        ],
    );
    quad(
        &mut parts,
        [
            [low, 0.5, -0.5],
            [high, 0.5, -0.5],
            [high, 1.0, 0.0],
            [low, 1.0, 0.0],
        ],
    );
    let extent = Extent {
        window: Some([0.0, 0.0, 1.0, 1.0]),
        periodic: true,
    };
    let mut it = instrument();
    it.detector.shadow = 0.0;
    it.detector.integration = 0.0;
    // A raster over the retro direction and over where one reflection goes: 90 degrees aside in the plane across.
    let wi = Angles::from_degrees(20.0, 90.0);
    let raster = |theta: f64, phi: f64| {
        (-16..16).flat_map(move |a| {
            (-16..16).map(move |b| {
                (
                    theta + 0.15 * (f64::from(a) + 0.5),
                    phi + 0.15 * f64::from(b) / theta.to_radians().sin(),
                )
            })
        })
    };
    let table: Vec<Direction> = raster(20.0, 90.0)
        .chain(raster(70.0, 90.0))
        .map(|(t, p)| Angles::from_degrees(t, p).direction())
        .collect();
    it.path.table = Some(PathTable {
        lines: vec![(wi, table)],
    });
    // A hundred periods across the spot: the share of each mirror hangs no more on where its rim lies.
    let (records, known) = measured(
        (parts, extent),
        1e-4,
        &it,
        &campaign(&[(20.0, 90.0)], &[Component::Reflection]),
    );
    let record = samples(&records)[0];
    let sum = |there: f64| -> f64 {
        let each = record.theta_s.iter().zip(&record.value);
        let near = each.filter(|(theta, _)| (**theta - there).abs() < 0.1);
        near.map(|(theta, v)| (v - 2.0) * 0.15_f64.to_radians().powi(2) * theta.sin() / there.sin())
            .sum()
    };
    let (retro, aside) = (sum(20.0_f64.to_radians()), sum(70.0_f64.to_radians()));
    for (found, wanted) in [(retro, rho * rho * (1.0 - t)), (aside, rho * t)] {
        // The noise of some forty readings, and twice that for what is left of the Monte-Carlo part.
        assert!((found / 1000.0 / wanted - 1.0).abs() < 0.003, "{found} {wanted}");
    }
    assert!(known[0].error_over_noise.iter().all(|e| e.is_finite()));
}

#[test]
fn parts_that_do_not_fit_the_spot_are_refused() {
    let model = material("plastic", &[0.4, 0.4, 0.4, 0.0, 0.0]);
    let how = campaign(&[(10.0, 0.0)], &[Component::Reflection]);
    let refused = |extent: Extent, it: &Instrument, effort: &ReadingEffort| {
        let device = Device::new(plate(&model), extent).unwrap();
        let found = simulate_device(&device, effort, it, &how, |_, _| true);
        found.err().unwrap().to_string()
    };
    let it = instrument();
    let small = Extent {
        window: Some([-2.0, -2.0, 2.0, 2.0]),
        periodic: false,
    };
    let error = refused(small, &it, &millimetres());
    assert!(error.contains("sample smaller than the spot"), "{error}");
    let mut consents = instrument();
    consents.holder.overfill = true;
    let device = Device::new(plate(&model), small).unwrap();
    assert!(simulate_device(&device, &millimetres(), &consents, &how, |_, _| false).is_ok());
    let coarse = Extent {
        window: Some([0.0, 0.0, 20.0, 2.0]),
        periodic: true,
    };
    let error = refused(coarse, &it, &millimetres());
    assert!(error.contains("window") && error.contains("spot"), "{error}");
    let error = refused(
        small,
        &it,
        &ReadingEffort {
            unit: 0.0,
            ..ReadingEffort::default()
        },
    );
    assert!(error.contains("unit"), "{error}");
}
