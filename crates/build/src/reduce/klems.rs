//! Reduction to Klems matrices: averages over pairs of patches.

use std::f64::consts::PI;

use gonio_bsdf::klems::{Klems, KlemsBasis, KlemsMatrix, Ring, Role};
use gonio_bsdf::{Bsdf, BsdfError, FourComponents};
use gonio_geom::{Component, Direction, Side};
use rayon::prelude::*;

use super::OneChannel;

/// How to reduce a model to Klems matrices.
#[derive(Clone, Debug, PartialEq)]
pub struct KlemsOptions {
    /// Angle basis of incidence and exit.
    pub basis: KlemsBasis,
    /// Components to fill; `None` fills every component that scatters.
    pub components: Option<Vec<(Side, Component)>>,
    /// Number of the model's channel.
    pub channel: usize,
    /// A cell is halved while the mean deviation of its values, as a share of the directional albedo, is above this.
    /// What a cell is then wrong by is far less.
    pub tolerance: f64,
    /// Incidences across an incident patch, in each coordinate (isotropic models: four times as many in the polar
    /// angle alone).
    pub incident_points: usize,
    /// Scales incident patches whose directional albedo exceeds 1 back to 1, and reports them.
    pub cap_albedo: bool,
}

impl Default for KlemsOptions {
    /// The full basis, all components, tolerance 0.0001, 4 incidences across a patch, nothing rescaled.
    fn default() -> Self {
        KlemsOptions {
            basis: KlemsBasis::full(),
            components: None,
            channel: 0,
            tolerance: 0.0001,
            incident_points: 4,
            cap_albedo: false,
        }
    }
}

/// A Klems model with what the reduction found.
#[derive(Clone, Debug)]
pub struct KlemsReduction {
    /// The model.
    pub model: Klems,
    /// Greatest directional albedo (reflection and transmission of one side) over incident patches, before any
    /// capping. Above 1 the model gains energy there.
    pub max_albedo: f64,
    /// Incident patches that were scaled to albedo 1, with their albedo before; empty unless capping was asked for.
    pub capped: Vec<(Side, usize, f64)>,
    /// Number of evaluations of the model.
    pub evaluations: u64,
    /// Cells that were still rough at the finest size, over all incidences.
    pub unsettled: usize,
}

/// Averages `model` over all pairs of patches, weighted with the projected solid angle of both directions:
/// `f_oi = 1/(Lambda_o Lambda_i) integral integral f cos_i cos_s domega_i domega_s`, which keeps energy and
/// reciprocity [Klems1994].
///
/// Gauss-Legendre rules over incidence; over exit, cells of the patches that are halved where the model is rough and
/// about the mirror, unbent and retro directions. For isotropic models one incident patch stands for its ring.
///
/// # Errors
/// [`BsdfError::Domain`] for a channel the model does not have, no component that scatters, or a tolerance or
/// number of points out of range.
pub fn to_klems(model: &dyn Bsdf, options: &KlemsOptions) -> Result<KlemsReduction, BsdfError> {
    let one = OneChannel::new(model, options.channel)?;
    let positive = options.tolerance.is_finite() && options.tolerance > 0.0;
    if !positive || !(1..=64).contains(&options.incident_points) {
        return Err(BsdfError::Domain {
            field: "tolerance, incident_points",
            found: format!("{}, {}", options.tolerance, options.incident_points),
            allowed: "a positive tolerance, 1 to 64 points".into(),
        });
    }
    let components = one.components(options.components.as_deref())?;
    let basis = &options.basis;
    let n = basis.len();
    let mut evaluations = 0;
    let mut unsettled = 0;
    let mut filled = FourComponents::default();
    for (side, component) in components {
        let filling = Filling {
            one,
            options,
            side,
            to: component.scattered_side(side),
            component,
        };
        let rings: Vec<usize> = (0..basis.rings().len()).collect();
        let done: Vec<Rows> = rings.par_iter().map(|a| filling.ring(*a)).collect();
        let mut values = vec![0f32; n * n];
        for (i, row) in done.iter().flat_map(|r| &r.rows).enumerate() {
            for (o, mean) in row.iter().enumerate() {
                values[o * n + i] = *mean as f32;
            }
        }
        evaluations += done.iter().map(|r| r.evaluations).sum::<u64>();
        unsettled += done.iter().map(|r| r.unsettled).sum::<usize>();
        filled.set(side, component, Some(values));
    }
    finish(&one, options, &filled, evaluations, unsettled)
}

/// Albedos, capping, matrices.
fn finish(
    one: &OneChannel<'_>,
    options: &KlemsOptions,
    filled: &FourComponents<Vec<f32>>,
    evaluations: u64,
    unsettled: usize,
) -> Result<KlemsReduction, BsdfError> {
    let basis = &options.basis;
    let n = basis.len();
    let mut filled = filled.clone();
    let mut max_albedo = 0.0f64;
    let mut capped = Vec::new();
    for side in Side::BOTH {
        for i in 0..n {
            let albedo: f64 = [Component::Reflection, Component::Transmission]
                .iter()
                .filter_map(|c| filled.get(side, *c))
                .map(|v| {
                    (0..n)
                        .map(|o| f64::from(v[o * n + i]) * basis.lambda()[o])
                        .sum::<f64>()
                })
                .sum();
            max_albedo = max_albedo.max(albedo);
            if options.cap_albedo && albedo > 1.0 {
                capped.push((side, i, albedo));
                // single precision rounds up too: stay below by one part in ten million
                let scale = ((1.0 - 1e-7) / albedo) as f32;
                filled = filled.map(|s, _, v| {
                    let mut v = v.clone();
                    if s == side {
                        (0..n).for_each(|o| v[o * n + i] *= scale);
                    }
                    v
                });
            }
        }
    }
    let mut matrices = FourComponents::default();
    for (side, component, values) in filled.iter() {
        let m = KlemsMatrix::new(basis.clone(), basis.clone(), values.clone())?;
        matrices.set(side, component, Some(m));
    }
    Ok(KlemsReduction {
        model: Klems::new(one.channel(), matrices),
        max_albedo,
        capped,
        evaluations,
        unsettled,
    })
}

/// A Gauss-Legendre rule on `[0, 1]`: nodes and weights.
fn gauss(n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|k| {
            // Newton's iteration for the roots of the Legendre polynomial, from Tricomi's estimate [AbramowitzStegun1964]
            let mut x = (PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..50 {
                let (mut p, mut before) = (1.0, 0.0);
                for m in 1..=n {
                    let m = m as f64;
                    (p, before) = (((2.0 * m - 1.0) * x * p - (m - 1.0) * before) / m, p);
                }
                slope = n as f64 * (x * p - before) / (x * x - 1.0);
                let step = p / slope;
                x -= step;
                if step.abs() < 1e-15 {
                    break;
                }
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// The coordinate of a ring at the share `t` of its way in cosine, with the weight of projected solid angle there.
///
/// Models are smooth in the cosine of the polar angle; in the sine squared they have infinite slope at the horizon.
fn in_cosine(ring: &Ring, t: f64) -> (f64, f64) {
    let near = ring.theta_lo.to_radians().cos();
    let far = if ring.theta_hi == 90.0 {
        0.0
    } else {
        ring.theta_hi.to_radians().cos()
    };
    let c = near + t * (far - near);
    let u = (near * near - c * c) / (near * near - far * far);
    (u, 2.0 * c / (near + far))
}

/// Nodes of the two-point rule on `[0, 1]`.
const TWO: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];
/// Depth to which cells that touch the mirror, unbent or retro direction are halved in any case.
const DIRECTED_DEPTH: u32 = 4;
/// Depth at which halving stops.
const MAX_DEPTH: u32 = 12;
/// Width in azimuth, as a share of the cosine of incidence, to which cells on the plane of incidence are halved: a lobe
/// of slopes of width alpha narrows to `2 alpha cos theta_i` across the plane.
const RIDGE_WIDTH: f64 = 0.1;
/// Polar distance from the mirror or unbent direction up to which the plane of incidence is followed, radians.
const RIDGE_REACH: f64 = 0.35;

/// One component of a model on a basis.
struct Filling<'a> {
    one: OneChannel<'a>,
    options: &'a KlemsOptions,
    side: Side,
    to: Side,
    component: Component,
}

/// The entries of some incident patches, each `[exit patch]`, and what they cost.
#[derive(Clone, Debug, Default)]
struct Rows {
    rows: Vec<Vec<f64>>,
    evaluations: u64,
    unsettled: usize,
}

/// A part of an exit patch: shares of the way in cosine and azimuth.
#[derive(Clone, Copy, Debug)]
struct Part {
    t: f64,
    v: f64,
    side: f64,
    depth: u32,
}

impl Filling<'_> {
    /// The rows of incident ring `a`.
    fn ring(&self, a: usize) -> Rows {
        let basis = &self.options.basis;
        let ring = &basis.rings()[a];
        if self.one.model.properties().isotropic {
            return self.isotropic_ring(ring);
        }
        let mut out = Rows::default();
        let rule = gauss(self.options.incident_points);
        // a whole turn is best covered by equal steps
        let turn: Vec<(f64, f64)> = if ring.n_phi == 1 {
            let n = 4 * self.options.incident_points;
            (0..n)
                .map(|k| ((k as f64 + 0.5) / n as f64, 1.0 / n as f64))
                .collect()
        } else {
            rule.clone()
        };
        for j in 0..ring.n_phi {
            let mut row = vec![0.0; basis.len()];
            for (t, wt) in &rule {
                let (u, wu) = in_cosine(ring, *t);
                for (v, wv) in &turn {
                    let wi = basis.point(ring.first + j, Role::Incident, self.side, u, *v);
                    self.exit(wi, &mut out, |o, _, value| row[o] += wt * wu * wv * value);
                }
            }
            out.rows.push(row);
        }
        out
    }

    /// The rows of a ring of an isotropic model: azimuth differences are collected once and spread over the pairs of
    /// patches that see them.
    fn isotropic_ring(&self, ring: &Ring) -> Rows {
        let basis = &self.options.basis;
        let mut out = Rows::default();
        // sums over bins of the azimuth from the mirror azimuth, for each exit ring
        let mut bins = vec![vec![0.0; BINS]; basis.rings().len()];
        // the whole accuracy of a patch goes into the polar angle
        for (t, weight) in gauss(4 * self.options.incident_points) {
            let (u, wu) = in_cosine(ring, t);
            let weight = weight * wu;
            let wi = basis.point(ring.first, Role::Incident, self.side, u, 0.5);
            // patch 0 is seen from azimuth 180 degrees, so its mirror azimuth is 0
            self.exit(wi, &mut out, |o, v, value| {
                let rb = basis.ring(o);
                let place = |v: f64| ((o - rb.first) as f64 - 0.5 + v) / rb.n_phi as f64 * BINS as f64;
                spread(
                    &mut bins[basis.ring_index(o)],
                    place(v[0]),
                    place(v[1]),
                    weight * value,
                );
            });
        }
        out.rows = vec![vec![0.0; basis.len()]; ring.n_phi];
        for (rb, bins) in basis.rings().iter().zip(&bins) {
            let classes = Classes::new(ring, rb);
            let mut values = vec![0.0; classes.period];
            for (k, sum) in bins.iter().enumerate() {
                if *sum > 0.0 {
                    let azimuth = 2.0 * PI * (k as f64 + 0.5) / BINS as f64;
                    classes.around(azimuth, |turn, kernel| values[turn] += sum * kernel);
                }
            }
            let width = 2.0 * PI / rb.n_phi as f64;
            for (j, row) in out.rows.iter_mut().enumerate() {
                for k in 0..rb.n_phi {
                    row[rb.first + k] = values[classes.turn(j, k)] * width;
                }
            }
        }
        out
    }

    /// Integrates over the exit patches at one incidence: `visit(patch, azimuths, share)` adds up to the average of the
    /// model over the patch; `azimuths` is the part of the patch's azimuth it stands for, as shares. Cells are halved in both coordinates until what they may be wrong by is small.
    fn exit(&self, wi: Direction, out: &mut Rows, mut visit: impl FnMut(usize, [f64; 2], f64)) {
        let basis = &self.options.basis;
        let mut stack = Vec::new();
        for o in 0..basis.len() {
            let lambda = basis.lambda()[o];
            let ring = basis.ring(o);
            let reach = patch_reach(ring);
            stack.push(Part {
                t: 0.0,
                v: 0.0,
                side: 1.0,
                depth: 0,
            });
            while let Some(part) = stack.pop() {
                let (mut values, mut weights) = ([0.0; 4], [0.0; 4]);
                for (k, (value, weight)) in values.iter_mut().zip(&mut weights).enumerate() {
                    let (u, w) = in_cosine(ring, part.t + part.side * TWO[k & 1]);
                    let ws = basis.point(o, Role::Exit, self.to, u, part.v + part.side * TWO[k >> 1]);
                    *value = w * self.one.eval(wi, ws);
                    *weight = w;
                }
                out.evaluations += 4;
                let mean = values.iter().sum::<f64>() / 4.0;
                let level = mean / (weights.iter().sum::<f64>() / 4.0);
                let spread = values
                    .iter()
                    .zip(&weights)
                    .map(|(v, w)| (v - level * w).abs())
                    .sum::<f64>()
                    / 4.0;
                let area = part.side * part.side;
                let rough = spread * area * lambda > self.options.tolerance;
                let coarse = part.depth
                    < if ring.n_phi <= 8 {
                        if ring.n_phi == 1 { 2 } else { 1 }
                    } else {
                        0
                    };
                let directed = coarse || self.directed(wi, o, &part, reach);
                if (rough || directed) && part.depth < MAX_DEPTH {
                    let side = 0.5 * part.side;
                    for k in 0..4u32 {
                        stack.push(Part {
                            t: part.t + side * f64::from(k & 1),
                            v: part.v + side * f64::from(k >> 1),
                            side,
                            depth: part.depth + 1,
                        });
                    }
                    continue;
                }
                out.unsettled += usize::from(rough);
                for (k, value) in values.iter().enumerate() {
                    if *value > 0.0 {
                        let v = part.v + 0.5 * part.side * (k >> 1) as f64;
                        visit(o, [v, v + 0.5 * part.side], 0.25 * area * value);
                    }
                }
            }
        }
    }

    /// Whether a cell is halved whatever its values, so that narrow lobes are seen.
    fn directed(&self, wi: Direction, o: usize, part: &Part, reach: f64) -> bool {
        let basis = &self.options.basis;
        let ring = basis.ring(o);
        let (u, _) = in_cosine(ring, part.t + 0.5 * part.side);
        let centre = basis.point(o, Role::Exit, self.to, u, part.v + 0.5 * part.side);
        if part.depth < DIRECTED_DEPTH && self.off_axis(wi, centre) < reach * part.side {
            return true;
        }
        let width = 2.0 * PI / ring.n_phi as f64 * part.side;
        let polar = |d: Direction| d.vec().x.hypot(d.vec().y).atan2(d.vec().z.abs());
        let (theta_i, theta_s) = (polar(wi), polar(centre));
        if width * theta_s.sin() < RIDGE_WIDTH * theta_i.cos() || (theta_s - theta_i).abs() > RIDGE_REACH {
            return false;
        }
        // azimuth from the mirror azimuth
        let (i, c) = (wi.vec(), centre.vec());
        let azimuth = (i.x * c.y - i.y * c.x).atan2(i.x * c.x + i.y * c.y);
        (PI - azimuth.abs()) < 0.51 * width
    }

    /// Angle of `ws` from the mirror or unbent direction, or from the retro direction where that is nearer.
    fn off_axis(&self, wi: Direction, ws: Direction) -> f64 {
        let straight = match self.component {
            Component::Reflection => wi.mirror(),
            Component::Transmission => wi.through(),
        };
        let angle = ws.angle_to(straight);
        match self.component {
            Component::Reflection => angle.min(ws.angle_to(wi)),
            Component::Transmission => angle,
        }
    }
}

/// Bins of azimuth of the isotropic reduction: a quarter of a degree.
const BINS: usize = 1440;

/// Adds `value` to the bins from `from` to `to` (in bins, any turn), by their share.
fn spread(bins: &mut [f64], from: f64, to: f64, value: f64) {
    let n = bins.len() as f64;
    let per_bin = value / (to - from);
    let mut at = from;
    while at < to {
        let next = (at + 1e-9).floor() + 1.0;
        let end = next.min(to);
        let bin = (at + 1e-9).floor().rem_euclid(n) as usize;
        bins[bin.min(bins.len() - 1)] += per_bin * (end - at).max(0.0);
        at = next;
    }
}

/// Greatest angle from the centre of a patch to its rim, radians, generously.
fn patch_reach(ring: &Ring) -> f64 {
    let (lo, hi) = (ring.theta_lo.to_radians(), ring.theta_hi.to_radians());
    if ring.n_phi == 1 {
        return 2.0 * hi;
    }
    (hi - lo).hypot(PI / ring.n_phi as f64 * hi.sin())
}

/// Pairs of patches of two rings that differ by a rotation: classes of equal azimuth difference, in steps of a turn
/// over `period`.
struct Classes {
    period: usize,
    of_incident: usize,
    of_exit: usize,
    /// Widths of the two patches in azimuth, radians.
    widths: (f64, f64),
}

impl Classes {
    fn new(incident: &Ring, exit: &Ring) -> Self {
        let (na, nb) = (incident.n_phi, exit.n_phi);
        Classes {
            period: na * nb / gcd(na, nb),
            of_incident: na,
            of_exit: nb,
            widths: (2.0 * PI / na as f64, 2.0 * PI / nb as f64),
        }
    }

    fn turn(&self, j: usize, k: usize) -> usize {
        (k * (self.period / self.of_exit) + self.period - j * (self.period / self.of_incident)) % self.period
    }

    /// Azimuth from the centre of class `turn`, in `[-pi, pi]`.
    fn distance(&self, azimuth: f64, turn: usize) -> f64 {
        let d = azimuth - 2.0 * PI * turn as f64 / self.period as f64;
        d - 2.0 * PI * (d / (2.0 * PI)).round()
    }

    /// Density of the azimuth difference of two even points of the patches: a trapezium.
    fn kernel(&self, distance: f64) -> f64 {
        let (a, b) = self.widths;
        if self.of_incident == 1 || self.of_exit == 1 {
            return 0.5 / PI;
        }
        ((0.5 * (a + b) - distance.abs()) / (a * b)).clamp(0.0, 1.0 / a.max(b))
    }

    /// The classes whose kernel is positive at `azimuth`, with its value.
    fn around(&self, azimuth: f64, mut visit: impl FnMut(usize, f64)) {
        let step = 2.0 * PI / self.period as f64;
        let half = 0.5 * (self.widths.0 + self.widths.1);
        let nearest = (azimuth / step).round() as i64;
        let reach = ((half / step).ceil() as i64).min(self.period as i64 / 2);
        // with an even period the outermost classes of both sides are one and the same
        let last = if 2 * reach as usize == self.period {
            reach - 1
        } else {
            reach
        };
        for m in -reach..=last {
            let turn = (nearest + m).rem_euclid(self.period as i64) as usize;
            let value = self.kernel(self.distance(azimuth, turn));
            if value > 0.0 {
                visit(turn, value);
            }
        }
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}
