//! Measured materials in the adaptive parameterisation of \[DupuyJakob2018\], the form of the RGL material database.
//!
//! For an incidence the half vector `m` is mapped to the unit square by the inverse of the map that draws visible
//! normals of the material's own microfacet model (its retro-reflection gave it). On that square the measured lobe,
//! divided by what the microfacet model says, is broad and smooth, so that a small table holds it. Tables are bilinear
//! on the square and linear between incidences.

mod microsurface;
mod tables;
mod tabulate;
#[cfg(test)]
mod tests;
mod warp;

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI, TAU};

use gonio_geom::{DVec3, Direction};

use crate::{Bsdf, BsdfError, Channel, Lobe, Properties, Sample};

pub use tables::{RglTables, Table};
pub use tabulate::RglOptions;
use warp::{Blend, Grid, Warp};

/// Incidences closer to grazing than this, radians (89.5 degrees), were not measured: the database fills them by
/// repeating the values before.
const MEASURED_TO: f64 = 1.562_069_680_534_925;

/// A measured material. It reflects light that arrives on the front, and nothing else.
///
/// With the half vector `m`, the square's point `p(m)` and the channel's table `s`:
/// `f cos(theta_s) = s(p) ndf(m) / (4 sigma(wi))` \[DupuyJakob2018\].
#[derive(Clone, Debug)]
pub struct Rgl {
    theta_i: Vec<f64>,
    phi_i: Vec<f64>,
    reduction: u32,
    channels: Vec<Channel>,
    ndf: Grid,
    sigma: Grid,
    vndf: Warp,
    luminance: Warp,
    spectra: Grid,
    valid: Option<Vec<bool>>,
    jacobian: bool,
}

/// The half vector of a pair in the tables' coordinates.
struct Half {
    /// Polar and azimuthal coordinate of the half vector, `[0, 1]`.
    m: [f64; 2],
    /// The same of the incidence.
    i: [f64; 2],
    /// Sine of the half vector's polar angle.
    sin_m: f64,
    /// Cosine between incidence and half vector.
    cos_im: f64,
    blend: Blend,
}

fn polar_coordinate(theta: f64) -> f64 {
    (FRAC_2_PI * theta).sqrt()
}

fn azimuth_coordinate(phi: f64) -> f64 {
    let turn = (phi + PI) / TAU;
    turn - turn.floor()
}

/// The place of `x` among ascending `nodes`: lower node and share of the next, clamped to the ends.
fn bracket(nodes: &[f64], x: f64) -> (usize, f64) {
    if nodes.len() < 2 {
        return (0, 0.0);
    }
    let k = nodes.partition_point(|n| *n <= x).clamp(1, nodes.len() - 1) - 1;
    (k, ((x - nodes[k]) / (nodes[k + 1] - nodes[k])).clamp(0.0, 1.0))
}

impl Rgl {
    /// The material of `tables`.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] that names the field for shapes that do not fit together, values out of range, a table
    /// `vndf` or `luminance` that is all zero, azimuths that cover neither the turn nor its half or quarter.
    pub fn new(tables: RglTables) -> Result<Self, BsdfError> {
        tables.check()?;
        let zero = |field| {
            move |k: usize| BsdfError::Domain {
                field,
                found: format!("only zeros at incidence {}", k + 1),
                allowed: "a positive value at every incidence".into(),
            }
        };
        Ok(Rgl {
            reduction: tables.reduction(),
            theta_i: tables.theta_i,
            phi_i: tables.phi_i,
            channels: tables.channels,
            ndf: Grid::new(tables.ndf),
            sigma: Grid::new(tables.sigma),
            vndf: Warp::new(tables.vndf).map_err(zero("vndf"))?,
            luminance: Warp::new(tables.luminance).map_err(zero("luminance"))?,
            spectra: Grid::new(tables.spectra),
            valid: tables.valid,
            jacobian: tables.jacobian,
        })
    }

    /// Polar angles of incidence of the tables, radians, ascending.
    pub fn theta_i(&self) -> &[f64] {
        &self.theta_i
    }

    /// Azimuths of incidence of the tables, radians, ascending; one for an isotropic material.
    pub fn phi_i(&self) -> &[f64] {
        &self.phi_i
    }

    /// The part of [`Rgl::theta_i`] that was measured: up to 89.5 degrees. Nearer to grazing no instrument of the
    /// database reads, and its tables repeat the last measured incidence.
    pub fn measured_theta_i(&self) -> &[f64] {
        &self.theta_i[..self.theta_i.partition_point(|t| *t <= MEASURED_TO)]
    }

    /// Nodes of the square a channel and incidence, (azimuthal, polar).
    pub fn resolution(&self) -> (usize, usize) {
        self.spectra.size()
    }

    /// Whether the material depends on `phi_s - phi_i` only.
    pub fn is_isotropic(&self) -> bool {
        self.phi_i.len() <= 2
    }

    /// Signs that turn directions into the part of the turn that the tables hold.
    fn signs(&self, w: DVec3) -> DVec3 {
        let into = |v: f64| if v > 0.0 { -1.0 } else { 1.0 };
        match self.reduction {
            2 => DVec3::new(into(w.y), into(w.y), 1.0),
            4 => DVec3::new(into(w.x), into(w.y), 1.0),
            _ => DVec3::ONE,
        }
    }

    fn blend(&self, theta_i: f64, phi_i: f64) -> Blend {
        let azimuth = bracket(&self.phi_i, phi_i);
        Blend::new(azimuth, bracket(&self.theta_i, theta_i), self.theta_i.len())
    }

    /// `None` below the horizon of either direction.
    fn half(&self, wi: Direction, ws: Direction) -> Option<Half> {
        if !(wi.cos_theta() > 0.0 && ws.cos_theta() > 0.0) {
            return None;
        }
        let signs = self.signs(wi.vec());
        let (i, s) = (wi.vec() * signs, ws.vec() * signs);
        let m = (i + s).try_normalize()?;
        let sin_m = m.x.hypot(m.y);
        let (theta_i, phi_i) = (i.x.hypot(i.y).atan2(i.z), azimuth(i));
        let origin = if self.is_isotropic() { phi_i } else { 0.0 };
        Some(Half {
            m: [
                polar_coordinate(sin_m.atan2(m.z)),
                azimuth_coordinate(azimuth(m) - origin),
            ],
            i: [polar_coordinate(theta_i), azimuth_coordinate(phi_i - origin)],
            sin_m,
            cos_im: i.dot(m),
            blend: self.blend(theta_i, phi_i),
        })
    }

    /// `f` of every channel in 1/sr, as the tables give it: negative where the file holds a colour outside the gamut,
    /// which [`Bsdf::eval`] raises to 0.
    pub fn eval_signed(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        f.fill(0.0);
        let Some(half) = self.half(wi, ws) else { return };
        let microfacet = if self.jacobian {
            let cell = self.ndf.cell(half.m[0], half.m[1]);
            let ndf = self.ndf.value(0, cell);
            ndf / (4.0 * self.sigma.value(0, self.sigma.cell(half.i[0], half.i[1])))
        } else {
            1.0
        };
        let ([u, v], _) = self.vndf.invert(&half.blend, half.m[0], half.m[1]);
        let cell = self.spectra.cell(u, v);
        let (n, factor) = (self.channels.len(), microfacet / ws.cos_theta());
        for &(k, weight) in half.blend.parts() {
            for (c, f) in f.iter_mut().take(n).enumerate() {
                *f += factor * weight * self.spectra.value(k * n + c, cell);
            }
        }
    }

    /// Density per solid angle of the half vector `m` over that of the square's coordinates.
    fn jacobian(half: &Half) -> f64 {
        // theta = pi/2 x^2, phi = 2 pi y - pi; then the reflection about m
        2.0 * PI * PI * half.m[0] * half.sin_m * 4.0 * half.cos_im
    }
}

fn azimuth(v: DVec3) -> f64 {
    v.y.atan2(v.x)
}

impl Bsdf for Rgl {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Nothing but its symmetry: measured values keep neither reciprocity nor energy exactly.
    fn properties(&self) -> Properties {
        Properties {
            reciprocal: false,
            energy_conserving: false,
            isotropic: self.is_isotropic(),
        }
    }

    /// Values below 0 are 0 ([`Rgl::eval_signed`] gives them as they are); beyond the last incidence of the tables that
    /// one holds.
    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        self.eval_signed(wi, ws, f);
        for f in f {
            *f = f.max(0.0);
        }
    }

    /// Incidences up to the last measured one, and values that rest at least by half of their weight on nodes above the
    /// horizon: those below it hold what an extrapolation made up.
    fn has_data(&self, wi: Direction, ws: Direction) -> bool {
        let Some(half) = self.half(wi, ws) else {
            return false;
        };
        let end = self.measured_theta_i().last().copied().unwrap_or(0.0);
        if wi.theta() > end + 1e-6 {
            return false;
        }
        let Some(valid) = &self.valid else { return true };
        let ([u, v], _) = self.vndf.invert(&half.blend, half.m[0], half.m[1]);
        let grid = self.luminance.grid();
        let cell = grid.cell(u, v);
        let (s, t) = cell.at;
        let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t];
        let mut sum = 0.0;
        for &(k, weight) in half.blend.parts() {
            for (n, w) in grid.corner_indices(k, cell.node).into_iter().zip(weights) {
                sum += if valid[n] { weight * w } else { 0.0 };
            }
        }
        sum >= 0.5
    }

    /// The density of [`Bsdf::sample`]. It integrates to less than 1: directions below the horizon are failed samples.
    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        let Some(half) = self.half(w, sampled) else {
            return 0.0;
        };
        let jacobian = Self::jacobian(&half);
        if jacobian <= 0.0 {
            return 0.0;
        }
        let ([u, v], visible) = self.vndf.invert(&half.blend, half.m[0], half.m[1]);
        visible * self.luminance.density(&half.blend, u, v) / jacobian
    }

    /// A point of the square by its luminance, the visible normal it is mapped to, and the reflection about that.
    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        if w.cos_theta() <= 0.0 {
            return None;
        }
        let signs = self.signs(w.vec());
        let i = w.vec() * signs;
        let (theta_i, phi_i) = (i.x.hypot(i.y).atan2(i.z), azimuth(i));
        let blend = self.blend(theta_i, phi_i);
        let (p, _) = self.luminance.sample(&blend, u[0], u[1])?;
        let ([x, y], _) = self.vndf.sample(&blend, p[0], p[1])?;
        let origin = if self.is_isotropic() { phi_i } else { 0.0 };
        let m = Direction::from_spherical(FRAC_PI_2 * x * x, TAU * y - PI + origin).vec();
        let cos_im = i.dot(m);
        let direction = Direction::new((2.0 * cos_im * m - i) * signs)?;
        if cos_im <= 0.0 || direction.cos_theta() <= 0.0 {
            return None;
        }
        let pdf = Bsdf::pdf(self, w, direction);
        let mut f = vec![0.0; self.channels.len()];
        self.eval(w, direction, &mut f);
        let weight = f[0] * direction.cos_theta() / pdf;
        (pdf > 0.0 && f.iter().any(|f| *f > 0.0)).then_some(Sample {
            direction,
            weight,
            pdf,
            lobe: Lobe::Glossy,
        })
    }
}
