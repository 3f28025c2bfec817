//! Two models side by side at one incidence.

use std::f64::consts::PI;

use gonio_bsdf::{Bsdf, BsdfError};
use gonio_geom::{Component, DVec3, Direction, Side};

/// Distance of the half vector from the normal up to which the directions are even; farther off they thin out.
const CORE: f64 = 0.004;
/// Distances and azimuths of half vectors.
const RINGS: usize = 240;
const SECTORS: usize = 144;

/// Two models at one incidence and component, over the same directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// `integral |f_b - f_a| cos / integral f_a cos`.
    pub rel_l1: f64,
    /// `sqrt(integral (dsf_b - dsf_a)^2 / integral dsf_a^2)`.
    pub rel_rms: f64,
    /// Directional albedos, `a` and `b`.
    pub albedo: [f64; 2],
    /// Largest DSF of each, 1/sr.
    pub peak: [f64; 2],
    /// Angle between the directions of the largest DSF, radians.
    pub peak_shift: f64,
    /// `integral |f(wi, ws) - f(ws, wi)| cos / integral f cos` of each: 0 for a reciprocal model.
    pub reciprocity: [f64; 2],
}

/// Compares channel `channel_b` of `b` with channel `channel_a` of `a` at `wi`, over directions dense about the mirror or
/// unbent direction: lobes of half vectors narrower than 0.004, and others narrower than about 1 degree, are not resolved.
/// Where `a` is 0 everywhere, ratios are NaN. Ideal parts count as nothing.
///
/// # Errors
/// [`BsdfError::Domain`] for a channel that a model does not have, and for `wi` on the horizon.
pub fn compare(
    a: (&dyn Bsdf, usize),
    b: (&dyn Bsdf, usize),
    wi: Direction,
    component: Component,
) -> Result<Comparison, BsdfError> {
    for (model, channel) in [a, b] {
        let n = model.channels().len();
        if channel >= n {
            return Err(BsdfError::Domain {
                field: "channel",
                found: format!("number {channel}"),
                allowed: format!("0 to {} ({n} channels)", n.saturating_sub(1)),
            });
        }
    }
    if wi.cos_theta() == 0.0 {
        return Err(BsdfError::Domain {
            field: "theta_i",
            found: "90 degrees".into(),
            allowed: "incidences off the horizon".into(),
        });
    }
    let (mut eval_a, mut eval_b) = (Channel::new(a), Channel::new(b));
    let (mut l1, mut square, mut square_a) = (0.0, 0.0, 0.0);
    let (mut albedo, mut turned) = ([0.0; 2], [0.0; 2]);
    let mut peak = [(0.0, wi); 2];
    for (ws, weight) in directions(wi, component) {
        let cos = ws.cos_theta().abs();
        let f = [eval_a.at(wi, ws), eval_b.at(wi, ws)];
        let back = [eval_a.at(ws, wi), eval_b.at(ws, wi)];
        let difference = (f[1] - f[0]) * cos;
        l1 += weight * difference.abs();
        square += weight * difference * difference;
        square_a += weight * (f[0] * cos).powi(2);
        for k in 0..2 {
            albedo[k] += weight * f[k] * cos;
            turned[k] += weight * (f[k] - back[k]).abs() * cos;
            if f[k] * cos > peak[k].0 {
                peak[k] = (f[k] * cos, ws);
            }
        }
    }
    Ok(Comparison {
        rel_l1: share(l1, albedo[0]),
        rel_rms: share(square, square_a).sqrt(),
        albedo,
        peak: peak.map(|p| p.0),
        peak_shift: if peak.iter().all(|p| p.0 > 0.0) {
            peak[0].1.angle_to(peak[1].1)
        } else {
            f64::NAN
        },
        reciprocity: [0, 1].map(|k| share(turned[k], albedo[k])),
    })
}

/// `part / whole`; NaN of nothing.
fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { f64::NAN }
}

/// Directional albedo by the same directions.
pub(super) fn albedo(model: &dyn Bsdf, wi: Direction, component: Component, channel: usize) -> f64 {
    let mut eval = Channel::new((model, channel));
    directions(wi, component)
        .map(|(ws, weight)| eval.at(wi, ws) * weight * ws.cos_theta().abs())
        .sum()
}

/// One channel of a model.
struct Channel<'a> {
    model: &'a dyn Bsdf,
    index: usize,
    values: Vec<f64>,
}

impl<'a> Channel<'a> {
    fn new((model, index): (&'a dyn Bsdf, usize)) -> Self {
        Channel {
            model,
            index,
            values: vec![0.0; model.channels().len()],
        }
    }

    /// The value; 0 where the model breaks its promise of finite ones.
    fn at(&mut self, wi: Direction, ws: Direction) -> f64 {
        self.model.eval(wi, ws, &mut self.values);
        let v = self.values[self.index];
        if v.is_finite() { v } else { 0.0 }
    }
}

/// Directions over the hemisphere of `component`, with their solid angles: reflections about half vectors in rings whose
/// spacing grows from [`CORE`] outwards; midpoints of a product rule.
fn directions(wi: Direction, component: Component) -> impl Iterator<Item = (Direction, f64)> {
    let v = wi.vec();
    let i = DVec3::new(v.x, v.y, v.z.abs());
    let side = component.scattered_side(wi.side());
    let reach = (1.0 / CORE).asinh();
    (0..RINGS * SECTORS).filter_map(move |k| {
        let u = ((k / SECTORS) as f64 + 0.5) / RINGS as f64 * reach;
        let phi = 2.0 * PI * (((k % SECTORS) as f64 + 0.5) / SECTORS as f64) + wi.phi();
        let sin = CORE * u.sinh();
        let cos = (1.0 - sin * sin).max(0.0).sqrt();
        let h = DVec3::new(sin * phi.cos(), sin * phi.sin(), cos);
        let along = i.dot(h);
        let s = 2.0 * along * h - i;
        if !(s.z > 0.0 && cos > 0.0) {
            return None;
        }
        // d omega_h = sin d(sin) d(phi) / cos, d omega_s = 4 (i.h) d omega_h
        let cell = CORE * u.cosh() * (reach / RINGS as f64) * (2.0 * PI / SECTORS as f64);
        let weight = 4.0 * along.abs() * sin * cell / cos;
        let s = DVec3::new(s.x, s.y, if side == Side::Back { -s.z } else { s.z });
        Some((Direction::new(s)?, weight))
    })
}
