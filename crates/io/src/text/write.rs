//! Numbers as files show them.

use std::io::Write;

/// Shortest decimal that reads back as `x`: plain between 1e-5 and 1e16, with an exponent elsewhere; `nan` for NaN.
pub(crate) fn write_number(out: &mut dyn Write, x: f64) -> std::io::Result<()> {
    let size = x.abs();
    if x.is_nan() {
        out.write_all(b"nan")
    } else if size == 0.0 || (1e-5..1e16).contains(&size) {
        write!(out, "{x}")
    } else {
        write!(out, "{x:e}")
    }
}

/// Degrees of `radians`, chosen so that they read back as exactly the same radians wherever such degrees exist, and
/// round where round ones do (30.1, not 30.100000000000001).
pub(crate) fn degrees(radians: f64) -> f64 {
    invert(radians, radians.to_degrees(), f64::to_radians)
}

/// `x * factor`, chosen so that dividing by `factor` gives exactly `x` wherever such a value exists.
pub(crate) fn scaled(x: f64, factor: f64) -> f64 {
    invert(x, x * factor, |y| y / factor)
}

fn invert(x: f64, guess: f64, forward: impl Fn(f64) -> f64) -> f64 {
    const ROUND: f64 = 1e10;
    let round = (guess * ROUND).round() / ROUND;
    let near = [
        round,
        guess,
        guess.next_up(),
        guess.next_down(),
        guess.next_up().next_up(),
        guess.next_down().next_down(),
    ];
    near.into_iter().find(|&y| forward(y) == x).unwrap_or(guess)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn angles_from_a_file_return_to_the_same_angles(d in 0.0..360.0f64) {
            let x = d.to_radians();
            prop_assert_eq!(degrees(x).to_radians().to_bits(), x.to_bits());
        }

        #[test]
        fn round_degrees_stay_round(n in 0u32..3_600_000) {
            let d = f64::from(n) / 10_000.0;
            prop_assert_eq!(degrees(d.to_radians()), d);
        }

        #[test]
        fn millimetres_return_to_the_same_metres(mm in 0.0..1e5f64) {
            let x = mm / 1000.0;
            prop_assert_eq!(scaled(x, 1000.0) / 1000.0, x);
        }

        #[test]
        fn numbers_read_back(bits in any::<u64>()) {
            let x = f64::from_bits(bits);
            let mut out = Vec::new();
            write_number(&mut out, x).unwrap();
            let y: f64 = std::str::from_utf8(&out).unwrap().parse().unwrap();
            prop_assert!(x.to_bits() == y.to_bits() || (x.is_nan() && y.is_nan()));
        }
    }
}
