//! What beam and motion take from a lobe, as uncertainties.

use crate::local::resolution_bias;
use crate::{Slice, narrow_peak};

/// Adds to `u_dsf` what a beam of `resolution` (second moment, rad^2, and full width, radians) and a reading that lasts for
/// the share `integration` of its way leave unresolved, and to the integrals what a peak as narrow as the beam holds beside
/// its readings.
///
/// Both lower a peak and raise its foot: where they have one sign they add up, else each counts for itself. Last of all, for
/// they spread light and take none: the integrals do not depend on them.
pub(crate) fn add_uncertainty(slice: &mut Slice, resolution: Option<(f64, f64)>, integration: Option<f64>) {
    let moving = motion_bias(slice, integration.unwrap_or(0.0));
    let of_beam = match resolution {
        Some((second_moment, fwhm)) => {
            narrow_peak::add_uncertainty(slice, second_moment);
            resolution_bias(slice, second_moment, fwhm)
        }
        None => vec![0.0; slice.len()],
    };
    for (u, (m, b)) in slice.u_dsf.iter_mut().zip(moving.into_iter().zip(of_beam)) {
        *u = u.hypot(m.hypot(b).max((m + b).abs()));
    }
}

/// `L^2 / 24 d^2 D / ds^2` of every reading, 1/sr: what an average over a way of length `L` is off by, to second order.
///
/// `L` is the share `integration` of the shorter of the steps before and after the reading, the derivative along the path that
/// of a parabola through the three. Zero at the ends of a record and beside readings that are not usable.
fn motion_bias(slice: &Slice, integration: f64) -> Vec<f64> {
    let n = slice.len();
    let mut out = vec![0.0; n];
    if integration == 0.0 {
        return out;
    }
    let step = |j: usize| slice.direction(j).angle_to(slice.direction(j + 1));
    for (j, bias) in out.iter_mut().enumerate().take(n.saturating_sub(1)).skip(1) {
        let (before, after) = (step(j - 1), step(j));
        let together = (j - 1..=j + 1)
            .all(|k| slice.flags[k].usable() && slice.direction(k).side() == slice.direction(j).side());
        if !together || before <= 0.0 || after <= 0.0 {
            continue;
        }
        let [a, b, c] = [slice.dsf[j - 1], slice.dsf[j], slice.dsf[j + 1]];
        let bend = 2.0 * ((c - b) / after - (b - a) / before) / (before + after);
        *bias = (integration * before.min(after)).powi(2) / 24.0 * bend;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Flags;
    use gonio_bsdf::Channel;
    use gonio_geom::Angles;

    /// A parabola over theta on a half plane, read at uneven steps.
    fn slice(theta: &[f64], curvature: f64) -> Slice {
        let n = theta.len();
        Slice {
            incidence: Angles { theta: 0.0, phi: 0.0 },
            channel: Channel::Photopic,
            theta_s: theta.to_vec(),
            phi_s: vec![0.3; n],
            dsf: theta
                .iter()
                .map(|t| 1.0 + 0.5 * curvature * (t - 0.5).powi(2))
                .collect(),
            u_dsf: vec![0.01; n],
            omega: vec![0.0; n],
            flags: vec![Flags::default(); n],
            u_common: 0.0,
            integrals: Vec::new(),
        }
    }

    #[test]
    fn an_average_over_a_way_is_off_by_the_curvature() {
        let theta = [0.40, 0.42, 0.43, 0.46, 0.47, 0.5];
        let slice = slice(&theta, -8.0);
        let found = motion_bias(&slice, 0.5);
        for j in 1..theta.len() - 1 {
            let way = 0.5 * (theta[j] - theta[j - 1]).min(theta[j + 1] - theta[j]);
            // The mean of the parabola over the way, less its value.
            let mean = |a: f64, b: f64| {
                let cube = |t: f64| -8.0 / 6.0 * (t - 0.5).powi(3);
                1.0 + (cube(b) - cube(a)) / (b - a)
            };
            let off = mean(theta[j] - 0.5 * way, theta[j] + 0.5 * way) - slice.dsf[j];
            assert!((found[j] - off).abs() < 1e-12, "{j}: {} {off}", found[j]);
        }
        assert_eq!((found[0], found[5]), (0.0, 0.0));
        assert!(motion_bias(&slice, 0.0).iter().all(|u| *u == 0.0));
    }

    #[test]
    fn beam_and_motion_lower_a_peak_together() {
        let theta: Vec<f64> = (0..41).map(|k| 0.3 + 0.01 * f64::from(k)).collect();
        let added = |resolution, integration| {
            let mut slice = slice(&theta, -8.0);
            slice.u_dsf.fill(0.0);
            add_uncertainty(&mut slice, resolution, integration);
            slice.u_dsf[20]
        };
        let (beam, motion) = (added(Some((1e-5, 0.005)), None), added(None, Some(0.5)));
        assert!(beam > 0.0 && motion > 0.0);
        let both = added(Some((1e-5, 0.005)), Some(0.5));
        assert!((both / (beam + motion) - 1.0).abs() < 1e-12, "{both}");
    }

    #[test]
    fn unusable_neighbours_say_nothing() {
        let mut slice = slice(&[0.40, 0.42, 0.44, 0.46, 0.48], -8.0);
        slice.flags[1] |= Flags::SATURATED;
        let found = motion_bias(&slice, 1.0);
        assert_eq!(&found[..3], &[0.0; 3]);
        assert!(found[3] < 0.0);
    }
}
