//! Measurements no model can be built from.

#![allow(
    clippy::unwrap_used,
    reason = "a test that cannot set up its material has failed"
)]

use crate::common::{Noise, measure};
use gonio_bsdf::Channel;
use gonio_bsdf::analytic::{Lambert, Spectrum};
use gonio_build::{BuildError, BuildOptions, DataDriven};
use gonio_geom::Component::Reflection;
use gonio_scan::{Flags, Measurement};

fn two_incidences() -> Measurement {
    let truth = Lambert::reflection(&Spectrum::photopic("albedo", 0.5).unwrap()).unwrap();
    measure(
        &truth,
        &[(20.0, 0.0), (40.0, 0.0)],
        &[Reflection],
        80.0,
        Noise(0.0, 0.0),
    )
}

fn refusal(measurement: &Measurement) -> BuildError {
    DataDriven::build(measurement, &BuildOptions::default()).unwrap_err()
}

#[test]
fn an_empty_measurement_is_refused() {
    let error = refusal(&Measurement::default());
    assert!(matches!(error, BuildError::Channel { .. }), "{error}");
}

#[test]
fn several_channels_need_a_name_and_a_wrong_name_lists_them() {
    let mut measurement = two_incidences();
    measurement.slices[1].channel = Channel::Wavelength(532.0);
    assert!(refusal(&measurement).to_string().contains("photopic, 532nm"));
    let options = BuildOptions {
        channel: Some(Channel::Red),
        ..BuildOptions::default()
    };
    let error = DataDriven::build(&measurement, &options).unwrap_err();
    assert!(error.to_string().contains("found red"), "{error}");
}

#[test]
fn a_single_incidence_is_refused() {
    let mut measurement = two_incidences();
    measurement.slices.pop();
    assert_eq!(
        refusal(&measurement),
        BuildError::TooFewIncidences { found: 1, needed: 2 }
    );
}

#[test]
fn readings_of_one_scattering_plane_are_refused_with_the_incidence_named() {
    let mut measurement = two_incidences();
    for phi in &mut measurement.slices[1].phi_s {
        *phi = if *phi < std::f64::consts::PI {
            0.0
        } else {
            std::f64::consts::PI
        };
    }
    let text = refusal(&measurement).to_string();
    assert!(
        text.contains("(40.000, 0.000)") && text.contains("one scattering plane"),
        "{text}"
    );
}

#[test]
fn a_slice_without_usable_readings_does_not_count_and_few_are_refused() {
    let mut measurement = two_incidences();
    measurement.slices[0].flags.fill(Flags::NO_DATA);
    assert!(matches!(
        refusal(&measurement),
        BuildError::TooFewIncidences { found: 1, .. }
    ));
    for flag in &mut measurement.slices[0].flags[..5] {
        *flag = Flags::NONE;
    }
    assert!(refusal(&measurement).to_string().contains("5 usable readings"));
}

#[test]
fn columns_of_different_length_are_refused() {
    let mut measurement = two_incidences();
    measurement.slices[0].u_dsf.pop();
    assert!(matches!(
        refusal(&measurement),
        BuildError::Columns { field: "u_dsf", .. }
    ));
}
