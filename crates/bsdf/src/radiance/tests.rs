use std::f64::consts::FRAC_PI_2;

use gonio_geom::DVec3;

use super::*;

fn words(text: &str) -> Vec<String> {
    text.split_whitespace().map(String::from).collect()
}

fn material(word: &str, strings: &str, reals: &[f64]) -> Result<RadianceMaterial, String> {
    match RadianceMaterial::from_arguments(word, &words(strings), reals) {
        Some(made) => made.map_err(|e| e.to_string()),
        None => Err(format!("no type {word}")),
    }
}

/// One of each type.
fn samples() -> Vec<RadianceMaterial> {
    let u = "1 0 0 .";
    vec![
        material("plastic", "", &[0.1, 0.2, 0.3, 0.04, 0.05]).unwrap(),
        material("metal", "", &[0.9, 0.8, 0.3, 0.7, 0.0]).unwrap(),
        material("trans", "", &[0.9, 0.8, 0.3, 0.04, 0.1, 0.5, 0.25]).unwrap(),
        material("plastic2", u, &[0.1, 0.2, 0.3, 0.04, 0.05, 0.2]).unwrap(),
        material("metal2", "0 1 0 . -rz 30", &[0.1, 0.2, 0.3, 0.4, 0.05, 0.2]).unwrap(),
        material("trans2", u, &[0.9, 0.8, 0.3, 0.04, 0.1, 0.2, 0.5, 0.25]).unwrap(),
        material(
            "ashik2",
            "sin(Px) 0 1 a.cal",
            &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 50.0, 200.0],
        )
        .unwrap(),
        material("glass", "", &[0.96, 0.9, 0.8]).unwrap(),
        material("mirror", "tinted", &[0.9, 0.8, 0.7]).unwrap(),
        material("dielectric", "", &[0.99, 0.98, 0.97, 1.5, 12.0]).unwrap(),
    ]
}

#[test]
fn every_type_gives_its_arguments_back() {
    let all = samples();
    assert_eq!(
        all.iter().map(RadianceMaterial::type_word).collect::<Vec<_>>(),
        RadianceMaterial::TYPES
    );
    for m in all {
        let again = RadianceMaterial::from_arguments(m.type_word(), &m.strings(), &m.reals());
        assert_eq!(again, Some(Ok(m)));
    }
}

#[test]
fn an_argument_outside_its_range_is_named_with_what_is_allowed() {
    for m in samples() {
        for (k, argument) in m.arguments().iter().enumerate().take(m.reals().len()) {
            for bad in [argument.low - 0.5, argument.high * 1.5, f64::NAN, f64::INFINITY] {
                let mut reals = m.reals();
                reals[k] = bad;
                let e = material(m.type_word(), &m.strings().join(" "), &reals).unwrap_err();
                assert_eq!(
                    e,
                    format!(
                        "{}: found {bad}, allowed {} to {}",
                        argument.name, argument.low, argument.high
                    )
                );
            }
        }
    }
}

#[test]
fn a_list_of_the_wrong_length_names_the_arguments() {
    assert_eq!(
        material("plastic", "", &[0.5; 4]).unwrap_err(),
        "real arguments: found 4, allowed 5: red green blue spec rough"
    );
    assert_eq!(
        material("glass", "", &[0.5; 5]).unwrap_err(),
        "real arguments: found 5, allowed 3 or 4: rtn gtn btn n"
    );
    assert_eq!(
        material("metal", "1 0", &[0.5; 5]).unwrap_err(),
        "string arguments: found 2, allowed 0"
    );
    assert_eq!(
        material("metal2", "1 0 0", &[0.5; 6]).unwrap_err(),
        "string arguments: found 3, allowed at least 4: ux uy uz function-file transform…"
    );
}

#[test]
fn a_dispersion_that_undoes_the_index_is_refused() {
    let e = material("dielectric", "", &[1.0, 1.0, 1.0, 1.5, -800.0]).unwrap_err();
    assert_eq!(e, "hc: found -800, allowed n + hc/500 of at least 0.1");
}

#[test]
fn a_changed_field_is_found_by_check() {
    let mut plastic = Plastic::new([0.5; 3], 0.05, 0.1).unwrap();
    plastic.roughness = 3.0;
    assert_eq!(
        plastic.check().unwrap_err().to_string(),
        "rough: found 3, allowed 0 to 1"
    );
}

#[test]
fn the_transform_turns_the_orientation() {
    let azimuth = |text: &str| Orientation::from_strings(&words(text)).unwrap().azimuth();
    let near = |text: &str, expected: f64| {
        let found = azimuth(text).unwrap().unwrap();
        assert!((found - expected).abs() < 1e-12, "{text}: {found} {expected}");
    };
    near("1 0 0 .", 0.0);
    near("0 2 5 .", FRAC_PI_2);
    near("1 0 0 . -rz 30", 30_f64.to_radians());
    near("1 0 0 . -rz 30 -mx", 150_f64.to_radians());
    near("0 0 1 . -rx -90", FRAC_PI_2);
    near("0 0 1 . -ry 90 -t 1 2 3 -s .5", 0.0);
    assert_eq!(azimuth("0 0 1 ."), Ok(None));
    assert_eq!(
        Orientation::from_azimuth(0.3).unwrap().azimuth().unwrap(),
        Some(0.3_f64.sin().atan2(0.3_f64.cos()))
    );
}

#[test]
fn an_orientation_that_is_not_a_number_is_kept_but_not_evaluated() {
    let o = Orientation::from_strings(&words("Dx 0 1 a.cal -i 2")).unwrap();
    assert_eq!(o.strings(), words("Dx 0 1 a.cal -i 2"));
    assert_eq!(
        o.vector().unwrap_err().to_string(),
        "ux: found \"Dx\", allowed a number; expressions of a function file are kept but not evaluated"
    );
    let e = |text: &str| {
        let o = Orientation::from_strings(&words(text)).unwrap();
        o.vector().unwrap_err().to_string()
    };
    assert_eq!(
        e("1 0 0 . -i 2"),
        "transform: found \"-i\", allowed -rx -ry -rz -mx -my -mz -s -t"
    );
    assert_eq!(
        e("1 0 0 . -rz"),
        "transform: found -rz , allowed -rz with its numbers"
    );
    assert!(Orientation::new(DVec3::ZERO).is_err());
    assert!(Orientation::from_azimuth(f64::NAN).is_err());
}
