use std::f64::consts::PI;

use gonio_bsdf::analytic::{Lambert, Spectrum};
use gonio_bsdf::{Bsdf, Channel, Properties};
use gonio_geom::{Angles, Component, Direction, Side};

use super::*;

/// A lobe of `width` in the tilt of the half vector with data above `end` only; two channels, the second twice the first.
struct Lobe {
    width: f64,
    end: f64,
}

impl Bsdf for Lobe {
    fn channels(&self) -> &[Channel] {
        &[Channel::Red, Channel::Blue]
    }

    fn properties(&self) -> Properties {
        Properties {
            reciprocal: true,
            energy_conserving: true,
            isotropic: true,
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        f.fill(0.0);
        if wi.side() == Side::Front && ws.side() == Side::Front {
            let h = wi.vec() + ws.vec();
            let tan = h.x.hypot(h.y) / h.z / self.width;
            let d = (-tan * tan).exp() / (PI * self.width.powi(2));
            f[0] = 0.02 * d / (wi.cos_theta() * ws.cos_theta()).sqrt() + 0.05 / PI;
            f[1] = 2.0 * f[0];
        }
    }

    fn has_data(&self, _: Direction, ws: Direction) -> bool {
        ws.cos_theta() > self.end
    }
}

const LOBE: Lobe = Lobe {
    width: 0.02,
    end: 0.0,
};

#[test]
fn integrals_are_those_of_the_model_for_narrow_lobes_at_every_incidence() {
    for width in [0.01, 0.03, 0.1, 0.3] {
        let model = Lobe { width, end: 0.0 };
        let tabulation = Tabulation {
            incidences: [0.0, 30.0, 60.0, 75.0]
                .map(|t| Angles::from_degrees(t, 20.0))
                .to_vec(),
            ..Tabulation::default()
        };
        let measurement = tabulate(&model, &tabulation).unwrap();
        assert_eq!(measurement.slices.len(), 8);
        for (k, slice) in measurement.slices.iter().enumerate() {
            let wi = slice.incidence.direction();
            assert_eq!(slice.incidence, tabulation.incidences[k / 2]);
            assert_eq!(slice.channel, model.channels()[k % 2]);
            let found = slice.integral(Side::Front).unwrap();
            let truth = gonio_bsdf::directional_albedo(&model, wi, Component::Reflection, k % 2);
            assert!(
                (found.value / truth - 1.0).abs() < 0.005,
                "width {width}, {:?}: {found:?} {truth}",
                slice.incidence.to_degrees()
            );
        }
    }
}

#[test]
fn values_and_uncertainties_are_those_stated() {
    let tabulation = Tabulation {
        u_relative: 0.03,
        u_floor: 1e-3,
        sample_name: Some("lobe".into()),
        ..Tabulation::default()
    };
    let measurement = tabulate(&LOBE, &tabulation).unwrap();
    assert_eq!(measurement.sample_name.as_deref(), Some("lobe"));
    let slice = &measurement.slices[3];
    let mut f = [0.0; 2];
    for j in 0..slice.len() {
        LOBE.eval(slice.incidence.direction(), slice.direction(j), &mut f);
        let dsf = f[1] * slice.theta_s[j].cos();
        assert!((slice.dsf[j] / dsf - 1.0).abs() < 1e-12);
        let u = 1e-3_f64.hypot(0.03 * dsf);
        assert!((slice.u_dsf[j] / u - 1.0).abs() < 1e-12);
        assert_eq!(slice.flags[j] == Flags::NONE, dsf >= 2.0 * u);
    }
    let total: f64 = slice.omega.iter().sum();
    assert!((total - 2.0 * PI).abs() < 1e-9);
}

#[test]
fn directions_without_data_are_left_out_and_count_as_extrapolated() {
    let model = Lobe { width: 0.3, end: 0.5 };
    let tabulation = Tabulation {
        incidences: vec![Angles::from_degrees(20.0, 0.0)],
        ..Tabulation::default()
    };
    let slice = &tabulate(&model, &tabulation).unwrap().slices[0];
    assert!(slice.theta_s.iter().all(|t| t.cos() > 0.5));
    let found = slice.integral(Side::Front).unwrap();
    assert!(found.extrapolated > 0.05 * found.value);
    let nothing = Lobe { width: 0.3, end: 2.0 };
    let text = tabulate(&nothing, &tabulation).unwrap_err().to_string();
    assert!(text.contains("theta_i = 20, phi_i = 0 degrees, where the model has no data"));
}

#[test]
fn the_lit_side_and_the_component_choose_the_hemisphere() {
    let model = Lambert::transmission(&Spectrum::photopic("albedo", 0.4).unwrap()).unwrap();
    for (theta, side) in [(30.0, Side::Back), (150.0, Side::Front)] {
        let tabulation = Tabulation {
            incidences: vec![Angles::from_degrees(theta, 0.0)],
            components: vec![Component::Transmission],
            ..Tabulation::default()
        };
        let slice = &tabulate(&model, &tabulation).unwrap().slices[0];
        assert!((0..slice.len()).all(|j| slice.direction(j).side() == side));
        // the densest place is the unbent direction
        let unbent = slice.incidence.direction().through();
        let near = (0..slice.len())
            .filter(|&j| slice.direction(j).angle_to(unbent) < 0.01)
            .count();
        assert!(near > 50, "{near}");
        let found = slice.integral(side).unwrap();
        assert!((found.value - 0.4).abs() < 1e-4, "{found:?}");
    }
}

#[test]
fn channels_are_taken_by_name() {
    let tabulation = Tabulation {
        channels: Some(vec![Channel::Blue]),
        ..Tabulation::default()
    };
    let all = tabulate(&LOBE, &Tabulation::default()).unwrap();
    let blue = tabulate(&LOBE, &tabulation).unwrap();
    let expected: Vec<_> = all.slices.into_iter().skip(1).step_by(2).collect();
    assert_eq!(blue.slices, expected);
    let tabulation = Tabulation {
        channels: Some(vec![Channel::Green]),
        ..Tabulation::default()
    };
    let text = tabulate(&LOBE, &tabulation).unwrap_err().to_string();
    assert!(text.contains("green") && text.contains("red, blue"), "{text}");
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    type Spoil = fn(&mut Tabulation);
    let cases: [(&str, Spoil); 10] = [
        ("incidences", |t| t.incidences.clear()),
        ("incidences", |t| {
            t.incidences[0] = Angles::from_degrees(90.0, 0.0)
        }),
        ("incidences", |t| t.incidences[0].theta = f64::NAN),
        ("components", |t| t.components.clear()),
        ("components", |t| t.components = vec![Component::Reflection; 2]),
        ("u_relative", |t| t.u_relative = -0.1),
        ("u_floor", |t| t.u_floor = f64::INFINITY),
        ("peak_pitch", |t| t.spacing.peak_pitch = 1.0),
        ("growth", |t| t.spacing.growth = 0.0),
        ("theta_max", |t| t.spacing.theta_max = 2.0),
    ];
    for (field, spoil) in cases {
        let mut tabulation = Tabulation::default();
        spoil(&mut tabulation);
        let text = tabulate(&LOBE, &tabulation).unwrap_err().to_string();
        assert!(text.starts_with(field), "{field}: {text}");
    }
}
