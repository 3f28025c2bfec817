//! Two models side by side at one incidence.

use std::f64::consts::PI;

use gonio_bsdf::{Bsdf, BsdfError};
use gonio_geom::{Component, DVec3, Direction, Side};

use super::apart::{Apart, Sums};

/// Distance of the half vector from the normal up to which the directions are even; farther off they thin out.
const CORE: f64 = 0.004;
/// Distances and azimuths of half vectors.
const RINGS: usize = 240;
const SECTORS: usize = 144;
/// Of the directions, one in so many tells the reciprocity: models that move lobes take a while for every new incidence.
/// Prime to both numbers above, so that all rings and sectors have their share.
const TURNED: usize = 7;

/// Two models at one incidence and component, over the same directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// `integral |f_b - f_a| cos / integral f_a cos` of the scattered light.
    pub rel_l1: f64,
    /// `sqrt(integral (dsf_b - dsf_a)^2 / integral dsf_a^2)`.
    pub rel_rms: f64,
    /// Directional albedos, `a` and `b`, ideal parts included.
    pub albedo: [f64; 2],
    /// Share of the light that leaves without spread, of each; of a table what it holds of the other's.
    pub ideal: [f64; 2],
    /// Largest DSF of each, 1/sr.
    pub peak: [f64; 2],
    /// Angle between the directions of the largest DSF, radians.
    pub peak_shift: f64,
    /// [`reciprocity`] of each.
    pub reciprocity: [f64; 2],
}

/// Compares channel `channel_b` of `b` with channel `channel_a` of `a` at `wi`, over directions dense about the mirror or
/// unbent direction: lobes of half vectors narrower than 0.004, and others narrower than about 1 degree, are not resolved.
/// Where `a` is 0 everywhere, ratios are NaN. Ideal parts are compared with each other, scattered light with scattered light:
/// where only one model has an ideal part, the cells of the other that hold it ([`Bsdf::holds`]) are left out, and what they
/// hold beyond the scattered light of the first counts as ideal.
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
        check(model, channel, wi)?;
    }
    let apart = Apart::new([a, b], wi, component);
    let mut eval = [Channel::new(a), Channel::new(b)];
    let (mut l1, mut square, mut square_a) = (0.0, 0.0, 0.0);
    let mut sums = Sums::default();
    let mut turned = [Turned::default(); 2];
    let mut peak = [(0.0, wi); 2];
    for (place, (ws, weight)) in directions(wi, component).enumerate() {
        let cos = ws.cos_theta().abs();
        let f = [0, 1].map(|k| eval[k].at(wi, ws));
        let to = if apart.held(ws) {
            &mut sums.held
        } else {
            &mut sums.compared
        };
        (0..2).for_each(|k| to[k] += weight * f[k] * cos);
        if place.is_multiple_of(TURNED) {
            (0..2).for_each(|k| turned[k].add(f[k], eval[k].at(ws, wi), weight * cos));
        }
        if apart.held(ws) {
            continue;
        }
        let difference = (f[1] - f[0]) * cos;
        l1 += weight * difference.abs();
        square += weight * difference * difference;
        square_a += weight * (f[0] * cos).powi(2);
        for k in 0..2 {
            if f[k] * cos > peak[k].0 {
                peak[k] = (f[k] * cos, ws);
            }
        }
    }
    let light = apart.light(&sums);
    Ok(Comparison {
        rel_l1: share(l1, sums.compared[0]),
        rel_rms: share(square, square_a).sqrt(),
        albedo: light.albedo,
        ideal: light.ideal,
        peak: peak.map(|p| p.0),
        peak_shift: if peak.iter().all(|p| p.0 > 0.0) {
            peak[0].1.angle_to(peak[1].1)
        } else {
            f64::NAN
        },
        reciprocity: turned.map(Turned::share),
    })
}

/// `integral |f(wi, ws) - f(ws, wi)| cos / integral f cos` at `wi`, ideal parts aside, over a seventh of the directions
/// of [`compare`]: 0 for a reciprocal model, NaN where nothing scatters and where nothing is known of light that comes the
/// other way, as in transmission measured from one side.
///
/// # Errors
/// As [`compare`].
pub fn reciprocity(model: (&dyn Bsdf, usize), wi: Direction, component: Component) -> Result<f64, BsdfError> {
    check(model.0, model.1, wi)?;
    let mut eval = Channel::new(model);
    let mut turned = Turned::default();
    for (ws, weight) in directions(wi, component).step_by(TURNED) {
        let (f, back) = (eval.at(wi, ws), eval.at(ws, wi));
        turned.add(f, back, weight * ws.cos_theta().abs());
    }
    Ok(turned.share())
}

/// Sums of the light one way, the other way, and their difference.
#[derive(Clone, Copy, Debug, Default)]
struct Turned {
    there: f64,
    back: f64,
    difference: f64,
}

impl Turned {
    fn add(&mut self, f: f64, back: f64, weight: f64) {
        self.there += weight * f;
        self.back += weight * back;
        self.difference += weight * (f - back).abs();
    }

    fn share(self) -> f64 {
        if self.back > 0.0 {
            share(self.difference, self.there)
        } else {
            f64::NAN
        }
    }
}

fn check(model: &dyn Bsdf, channel: usize, wi: Direction) -> Result<(), BsdfError> {
    let n = model.channels().len();
    if channel >= n {
        return Err(BsdfError::Domain {
            field: "channel",
            found: format!("number {channel}"),
            allowed: format!("0 to {} ({n} channels)", n.saturating_sub(1)),
        });
    }
    if wi.cos_theta() == 0.0 {
        return Err(BsdfError::Domain {
            field: "theta_i",
            found: "90 degrees".into(),
            allowed: "incidences off the horizon".into(),
        });
    }
    Ok(())
}

/// `part / whole`; NaN of nothing.
fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { f64::NAN }
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
