use super::*;
use crate::testing::{Noise, path_scan, record, slice_of};
use gonio_geom::Angles;

/// Slices of a Gaussian microfacet-like lobe on a sample that stands tilted and turned.
fn tilted(tilt: [f64; 2], azimuth: f64, noise: f64) -> Measurement {
    let n = Direction::from_unit(normal(tilt[0], tilt[1]));
    let mut random = Noise::new(17);
    let slices = [10.0, 30.0, 50.0, 65.0]
        .iter()
        .map(|&t| {
            let wi = Angles::from_degrees(t, 0.0).direction().vec();
            let scan = path_scan(2.0, 1.0, |ws| {
                let ws = turned(ws.vec(), -azimuth);
                let h = Direction::new(wi + ws).unwrap_or(Direction::NORMAL);
                let lobe = (-(h.angle_to(n) / 0.12).powi(2)).exp();
                (lobe + 1e-3) * (1.0 + noise * random.normal())
            });
            slice_of(crate::Scan {
                incidence: record(t, 0.0).incidence,
                ..scan
            })
        })
        .collect();
    Measurement {
        slices,
        ..Measurement::default()
    }
}

#[test]
fn a_tilt_of_3_degrees_and_an_azimuth_offset_of_2_are_recovered_to_a_tenth() {
    let (tilt, azimuth) = ([1.8_f64.to_radians(), -2.4_f64.to_radians()], 2_f64.to_radians());
    let m = tilted(tilt, azimuth, 0.02);
    let found = align(&m).unwrap();
    assert!((found.tilt().to_degrees() - 3.0).abs() < 0.1);
    for (value, truth) in [
        (found.tilt_x, tilt[0]),
        (found.tilt_y, tilt[1]),
        (found.azimuth, azimuth),
    ] {
        assert!(
            (value - truth).to_degrees().abs() < 0.1,
            "{} {}",
            value.to_degrees(),
            truth.to_degrees()
        );
    }
    assert_eq!(found.peaks.len(), 4);
    // Each parameter within four standard uncertainties (once in 5000 seeds by chance).
    for (k, truth) in [tilt[0], tilt[1], azimuth].into_iter().enumerate() {
        let value = [found.tilt_x, found.tilt_y, found.azimuth][k];
        assert!((value - truth).abs() < 4.0 * found.u()[k]);
    }
}

#[test]
fn after_the_correction_the_mirror_peaks_stand_in_the_mirror_directions() {
    let mut m = tilted([0.03, 0.02], 0.03, 0.0);
    let found = align(&m).unwrap();
    correct_alignment(&mut m, &found).unwrap();
    let again = align(&m).unwrap();
    assert!(
        again.tilt().to_degrees() < 0.1 && again.azimuth.to_degrees().abs() < 0.1,
        "{again:?}"
    );
    let covered: f64 = m.slices[0].omega.iter().sum();
    assert!(covered > 6.0, "{covered}");
}

#[test]
fn angles_that_do_not_stand_out_of_their_uncertainty_are_not_corrected() {
    let mut m = tilted([0.0, 0.03], 0.0, 0.02);
    let found = align(&m).unwrap();
    let before = m.slices.clone();
    let mut vague = found.clone();
    vague.covariance = [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]];
    correct_alignment(&mut m, &vague).unwrap();
    assert_eq!(m.slices, before);
    assert!(
        m.warnings[0].contains("nothing was corrected"),
        "{:?}",
        m.warnings
    );
    correct_alignment(&mut m, &found).unwrap();
    assert!(m.warnings[1].contains("directions corrected"), "{:?}", m.warnings);
    assert!(align(&m).unwrap().tilt().to_degrees() < 0.1);
}

#[test]
fn an_aligned_sample_stays_and_a_matt_one_cannot_be_aligned() {
    let found = align(&tilted([0.0, 0.0], 0.0, 0.0)).unwrap();
    assert!(found.tilt().to_degrees() < 0.05);
    let matt = Measurement {
        slices: vec![slice_of(path_scan(5.0, 2.0, |d| d.cos_theta())); 3],
        ..Measurement::default()
    };
    assert!(align(&matt).unwrap_err().to_string().contains("mirror peak"));
}
