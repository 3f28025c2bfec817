use gonio_bsdf::analytic::family;
use gonio_bsdf::half_difference::HalfAngles;
use gonio_geom::Direction;
use proptest::prelude::*;

use super::*;

/// A whole file whose value at cell `k` of colour `c` is `f(c, k)`.
fn file(f: impl Fn(usize, usize) -> f64) -> Vec<u8> {
    let mut bytes = header().to_vec();
    for c in 0..3 {
        (0..CELLS).for_each(|k| bytes.extend(f(c, k).to_le_bytes()));
    }
    bytes
}

fn refused(bytes: &[u8]) -> String {
    parse(bytes, Path::new("a.binary")).unwrap_err().to_string()
}

#[test]
fn values_are_scaled_by_colour_and_found_by_the_angles_of_the_database() {
    let bytes = file(|c, k| 1500.0 * (c + 1) as f64 + k as f64);
    let table = parse(&bytes, Path::new("a")).unwrap();
    assert_eq!(table.channels(), CHANNELS);
    let angles = HalfAngles {
        theta_h: 41f64.to_radians(),
        theta_d: 30.5f64.to_radians(),
        phi_d: 100.5f64.to_radians(),
    };
    let (wi, ws) = angles.pair();
    let mut f = [0.0; 3];
    table.eval(wi.rotated(0.3), ws.rotated(0.3), &mut f);
    // 90 sqrt(41 / 90) = 60.7; the difference angles count whole degrees
    let cell = ((60 * 90 + 30) * 180 + 100) as f64;
    for (c, (f, scale)) in f.into_iter().zip([1.0, 1.15, 1.66]).enumerate() {
        let wanted = (1500.0 * (c + 1) as f64 + cell) * scale / 1500.0;
        assert!((f - wanted).abs() < 1e-9 * wanted, "{c}: {f} {wanted}");
    }
}

#[test]
fn a_written_file_is_read_back_within_rounding_with_its_empty_cells() {
    let bytes = file(|c, k| {
        if k % 7 == 0 {
            -0.5
        } else {
            0.1 + ((k * 31 + c) % 1000) as f64
        }
    });
    let table = parse(&bytes, Path::new("a")).unwrap();
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.binary");
    write(&path, &table).unwrap();
    assert!(is_merl(&path).unwrap());
    assert_eq!(std::fs::metadata(&path).unwrap().len() as usize, SIZE);
    let back = read(&path).unwrap();
    for c in 0..3 {
        let pairs = table.values(c).iter().zip(back.values(c));
        let worst = pairs.map(|(a, b)| (a - b).abs() / a.abs()).fold(0.0, f64::max);
        assert!(worst <= 2.0 * f64::EPSILON, "{worst}");
    }
    assert!((back.empty_share() - 1.0 / 7.0).abs() < 1e-6);
}

#[test]
fn a_model_survives_the_file_within_the_size_of_its_cells() {
    let parameters: Vec<(Channel, Vec<f64>)> = CHANNELS
        .iter()
        .zip([0.1, 0.2, 0.3])
        .map(|(c, rho)| (*c, vec![rho, 0.3]))
        .collect();
    let model = family("ward-gmd").unwrap().model(&parameters).unwrap();
    let channels: Vec<(Channel, usize)> = CHANNELS.into_iter().zip(0..).collect();
    let table = HalfDifference::of(model.as_ref(), SHAPE, &channels).unwrap();
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.binary");
    write(&path, &table).unwrap();
    let back = read(&path).unwrap();
    let (mut f, mut g) = ([0.0; 3], [0.0; 3]);
    let (mut difference, mut sum) = ([0.0; 3], [0.0; 3]);
    for (theta_i, theta_s, phi) in (0..3000).map(|k| (k % 79, k * 7 % 77, k * 13 % 360)) {
        let wi = Direction::from_degrees(f64::from(theta_i) + 0.3, 10.0);
        let ws = Direction::from_degrees(f64::from(theta_s) + 0.2, f64::from(phi) + 0.1);
        model.eval(wi, ws, &mut f);
        back.eval(wi, ws, &mut g);
        for c in 0..3 {
            difference[c] += ws.cos_theta() * (f[c] - g[c]).abs();
            sum[c] += ws.cos_theta() * f[c];
        }
    }
    for c in 0..3 {
        assert!(difference[c] < 0.02 * sum[c], "{c}: {}", difference[c] / sum[c]);
    }
}

#[test]
fn other_content_is_refused_by_field() {
    assert!(refused(b"").contains("file: found 0 bytes"));
    let mut other = header();
    other[0] = 45;
    assert!(refused(&other).contains("numbers of cells: found 45 x 90 x 180, allowed 90 x 90 x 180"));
    assert!(refused(&header()).contains("file: found 12 bytes"));
    let mut bytes = file(|_, _| 1.0);
    bytes.pop();
    assert!(refused(&bytes).contains("34992011 bytes"));
    bytes.push(0);
    let infinite = f64::INFINITY.to_le_bytes();
    bytes[HEADER + 8 * CELLS..HEADER + 8 * CELLS + 8].copy_from_slice(&infinite);
    assert!(refused(&bytes).contains("values: found inf at value 1458001"));
}

#[test]
fn only_a_table_of_the_database_s_shape_and_colours_is_written() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a");
    let small = HalfDifference::new([1, 1, 1], CHANNELS.to_vec(), vec![0.0; 3]).unwrap();
    assert!(
        write(&path, &small)
            .unwrap_err()
            .to_string()
            .contains("shape: found [1, 1, 1]")
    );
    let grey = HalfDifference::new(SHAPE, vec![Channel::Photopic], vec![0.0; CELLS]).unwrap();
    let text = write(&path, &grey).unwrap_err().to_string();
    assert!(text.contains("channels: found photopic"), "{text}");
    assert!(!path.exists());
}

proptest! {
    #[test]
    fn no_content_panics(bytes in prop::collection::vec(any::<u8>(), 0..64)) {
        prop_assert!(parse(&bytes, Path::new("a")).is_err());
        prop_assert!(parse(&[&header()[..], &bytes].concat(), Path::new("a")).is_err());
    }
}
