//! Light that a model sends into a cone about the mirrored or unbent direction, as into the port of an integrating sphere.

use std::f64::consts::TAU;

use gonio_geom::{Component, DVec3, Direction};

use crate::Bsdf;

/// Even points in azimuth about the axis.
const SPOKES: usize = 128;
/// Panels from the axis to the edge, each twice as wide as the one before.
const PANELS: i32 = 14;
/// Abscissas and weights of the Gauss-Legendre rule of eight points on [-1, 1], by symmetry.
const RULE: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// The mirrored direction of `wi`, or the unbent one in transmission.
pub fn ideal_direction(wi: Direction, component: Component) -> Direction {
    match component {
        Component::Reflection => wi.mirror(),
        Component::Transmission => wi.through(),
    }
}

/// `integral f |cos_s| domega_s` of channel number `channel` within `half_angle` (radians, 0 to pi/2) of the mirrored or
/// unbent direction, the ideal part included where it lies there. Directions beyond the horizon count as nothing.
///
/// [`within`] says how; `channel` past the model's channels gives NaN.
pub fn cone_integral(
    model: &dyn Bsdf,
    wi: Direction,
    component: Component,
    channel: usize,
    half_angle: f64,
) -> f64 {
    within(model, wi, component, channel, &|_| half_angle)
}

/// As [`cone_integral`], up to the angle `edge` from the axis, which is asked for unit vectors across the axis in the frame of
/// the sample: the outline of an opening that the axis goes through.
///
/// Gauss-Legendre points in fourteen panels from the axis outward, each twice as wide as the one before, at 128 even
/// azimuths: to 1e-6 for smooth models, and lobes about the axis of `alpha >= 0.002`.
pub fn within(
    model: &dyn Bsdf,
    wi: Direction,
    component: Component,
    channel: usize,
    edge: &dyn Fn(DVec3) -> f64,
) -> f64 {
    let n = model.channels().len();
    if channel >= n {
        return f64::NAN;
    }
    let axis = ideal_direction(wi, component);
    let side = axis.side();
    let a = axis.vec();
    // One spoke in the plane of incidence, where lobes are symmetric.
    let x = DVec3::Z.cross(a).try_normalize().map_or(DVec3::X, |y| y.cross(a));
    let y = a.cross(x);
    let mut f = vec![0.0; n];
    let mut sum = 0.0;
    for spoke in 0..SPOKES {
        let chi = TAU * spoke as f64 / SPOKES as f64;
        let across = chi.cos() * x + chi.sin() * y;
        let edge = edge(across);
        for panel in 0..PANELS {
            let high = edge * 0.5_f64.powi(panel);
            let low = if panel + 1 == PANELS { 0.0 } else { 0.5 * high };
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
            for (node, weight) in RULE.iter().flat_map(|(t, w)| [(-t, w), (*t, w)]) {
                let g = middle + half * node;
                let ws = Direction::from_unit(g.cos() * a + g.sin() * across);
                if ws.side() == side && ws.cos_theta() != 0.0 {
                    model.eval(wi, ws, &mut f);
                    sum += f[channel] * ws.cos_theta().abs() * g.sin() * half * weight;
                }
            }
        }
    }
    let mut shares = vec![0.0; n];
    let inside = model.delta(wi, component, &mut shares).is_some_and(|d| {
        let off = d.vec() - d.dot(axis) * a;
        off.length() < 1e-12 || d.angle_to(axis) <= edge(off.try_normalize().unwrap_or(x))
    });
    sum * TAU / SPOKES as f64 + if inside { shares[channel] } else { 0.0 }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::analytic::family;
    use crate::channel::Channel;
    use crate::directional_albedo;

    fn model(name: &str, values: &[f64]) -> Box<dyn Bsdf> {
        let values = [(Channel::Photopic, values.to_vec())];
        family(name).unwrap().model(&values).unwrap()
    }

    #[test]
    fn diffuse_light_fills_a_cone_by_its_projected_solid_angle() {
        let lambert = model("lambert", &[0.6]);
        for (theta, half) in [(0.0, 5.0), (8.0, 5.0), (45.0, 20.0), (60.0, 30.0)] {
            let wi = Direction::from_degrees(theta, 30.0);
            let half = f64::to_radians(half);
            let wanted = 0.6 * half.sin().powi(2) * wi.cos_theta();
            let found = cone_integral(lambert.as_ref(), wi, Component::Reflection, 0, half);
            assert!((found - wanted).abs() < 1e-9, "{found} {wanted}");
        }
    }

    #[test]
    fn a_cone_that_holds_the_lobe_holds_its_albedo() {
        for alpha in [0.002, 0.01, 0.05] {
            let lobe = model("ward-gmd", &[0.3, alpha]);
            let wi = Direction::from_degrees(30.0, 0.0);
            let all = directional_albedo(lobe.as_ref(), wi, Component::Reflection, 0);
            let found = cone_integral(lobe.as_ref(), wi, Component::Reflection, 0, 0.9);
            assert!((found - all).abs() < 1e-5, "{alpha}: {found} {all}");
        }
    }

    #[test]
    fn the_share_of_a_gaussian_lobe_follows_its_closed_form() {
        // 1 - exp(-tan^2(half / 2) / alpha^2), to a hundredth (docs/other-instruments.md).
        for (alpha, half, share) in [
            (0.02, 5.0, 0.991),
            (0.05, 5.0, 0.534),
            (0.1, 5.0, 0.174),
            (0.2, 10.0, 0.174),
        ] {
            let lobe = model("ward-gmd", &[1.0, alpha]);
            let wi = Direction::from_degrees(8.0, 0.0);
            let found = cone_integral(lobe.as_ref(), wi, Component::Reflection, 0, f64::to_radians(half));
            assert!((found - share).abs() < 0.01, "{alpha}: {found}");
        }
    }

    #[test]
    fn an_ideal_part_counts_where_it_lies_inside() {
        let glass = crate::RadianceMaterial::from_arguments("mirror", &[], &[0.7; 3])
            .unwrap()
            .unwrap();
        let glass = glass.bsdf().unwrap();
        let wi = Direction::from_degrees(8.0, 0.0);
        let found = cone_integral(glass.as_ref(), wi, Component::Reflection, 0, 0.05);
        assert!((found - 0.7).abs() < 1e-12, "{found}");
        assert!(cone_integral(glass.as_ref(), wi, Component::Reflection, 3, 0.05).is_nan());
    }
}
