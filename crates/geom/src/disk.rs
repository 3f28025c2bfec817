//! The concentric map between the unit square and the unit disk.

use std::f64::consts::FRAC_PI_4;

/// The point of the unit disk that `(u, v)` of the unit square maps to; area is preserved up to the factor pi
/// [ShirleyChiu1997]. Read as direction cosines `(x, y)`, equal areas of the square are equal *projected* solid
/// angles. Values outside `[0, 1]` map outside the disk.
pub fn square_to_disk(u: f64, v: f64) -> (f64, f64) {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return (0.0, 0.0);
    }
    if a.abs() > b.abs() {
        let (s, c) = (FRAC_PI_4 * b / a).sin_cos();
        (a * c, a * s)
    } else {
        let (s, c) = (FRAC_PI_4 * a / b).sin_cos();
        (b * s, b * c)
    }
}

/// The inverse of [`square_to_disk`]; the result is clamped to `[0, 1]`.
pub fn disk_to_square(x: f64, y: f64) -> (f64, f64) {
    let r = x.hypot(y);
    let (a, b) = if x.abs() > y.abs() {
        let a = r.copysign(x);
        (a, a * (y / x).atan() / FRAC_PI_4)
    } else if y != 0.0 {
        let b = r.copysign(y);
        (b * (x / y).atan() / FRAC_PI_4, b)
    } else {
        (0.0, 0.0)
    };
    ((0.5 + 0.5 * a).clamp(0.0, 1.0), (0.5 + 0.5 * b).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_round_trips_and_keeps_area() {
        let n = 37;
        let h = 1e-5;
        for i in 0..n {
            for j in 0..n {
                let (u, v) = (
                    (f64::from(i) + 0.5) / f64::from(n),
                    (f64::from(j) + 0.4) / f64::from(n),
                );
                let (x, y) = square_to_disk(u, v);
                let (p, q) = disk_to_square(x, y);
                assert!((p - u).abs() < 1e-14 && (q - v).abs() < 1e-14, "{u} {v}");
                let (xu, yu) = square_to_disk(u + h, v);
                let (xv, yv) = square_to_disk(u, v + h);
                let jacobian = ((xu - x) * (yv - y) - (xv - x) * (yu - y)) / (h * h);
                let kink = ((2.0 * u - 1.0).abs() - (2.0 * v - 1.0).abs()).abs() < 3.0 * h;
                assert!(
                    kink || (jacobian / std::f64::consts::PI - 1.0).abs() < 1e-3,
                    "{u} {v} {jacobian}"
                );
            }
        }
    }

    #[test]
    fn the_positive_x_axis_is_the_middle_of_the_right_edge() {
        assert_eq!(disk_to_square(1.0, 0.0), (1.0, 0.5));
        assert_eq!(disk_to_square(0.0, -1.0), (0.5, 0.0));
        assert_eq!(disk_to_square(0.0, 0.0), (0.5, 0.5));
    }
}
