//! Tables of other models in the adaptive parameterisation \[DupuyJakob2018\].
//!
//! What the model reflects is divided by what a microfacet surface of the same retro-reflection says, and sampled where
//! that surface reflects.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use gonio_geom::Direction;

use super::microsurface::{Microsurface, Nodes};
use super::warp::{Blend, Grid, Warp};
use super::{RglTables, Table, azimuth_coordinate, polar_coordinate};
use crate::{Bsdf, BsdfError, Channel};

/// Distance of the outermost nodes of the square from its edges, where the map has no density.
const INSET: f64 = 1e-4;

/// Sizes of the tables.
#[derive(Clone, Debug, PartialEq)]
pub struct RglOptions {
    /// Polar angles of incidence, radians, ascending in `[0, pi/2)`.
    pub theta_i: Vec<f64>,
    /// Azimuths of incidence of an anisotropic model, at least 3: over the whole turn from `-pi`, both ends included, or
    /// over its first half for a model that half a turn of the sample does not change.
    pub azimuths: usize,
    /// Nodes in azimuth and polar angle of the half vector.
    pub half_vector: (usize, usize),
    /// Nodes along a side of the square.
    pub resolution: usize,
}

impl RglOptions {
    /// Every 5 degrees of incidence to 85, and 89; for a model that is not isotropic 13 azimuths.
    pub fn of(model: &dyn Bsdf) -> Self {
        let isotropic = model.properties().isotropic;
        let every_5 = (0..18).map(|k| f64::from(5 * k));
        RglOptions {
            theta_i: every_5.chain([89.0]).map(f64::to_radians).collect(),
            azimuths: 13,
            half_vector: if isotropic { (65, 128) } else { (49, 64) },
            resolution: 48,
        }
    }

    fn check(&self) -> Result<(), BsdfError> {
        let wrong = |field, found: String, allowed: &str| {
            Err(BsdfError::Domain {
                field,
                found,
                allowed: allowed.into(),
            })
        };
        let ascending = self.theta_i.windows(2).all(|w| w[0] < w[1]);
        let inside = self.theta_i.iter().all(|t| (0.0..FRAC_PI_2).contains(t));
        if self.theta_i.len() < 2 || !ascending || !inside {
            let found = format!("{:?}", self.theta_i);
            return wrong(
                "theta_i",
                found,
                "two or more ascending angles from 0 to below 90 degrees",
            );
        }
        let sizes = [
            ("azimuths", self.azimuths, 3),
            ("half_vector", self.half_vector.0.min(self.half_vector.1), 4),
            ("resolution", self.resolution, 4),
        ];
        for (field, n, least) in sizes {
            if !(least..=1024).contains(&n) || self.half_vector.0.max(self.half_vector.1) > 1024 {
                return wrong(field, n.to_string(), &format!("{least} to 1024"));
            }
        }
        Ok(())
    }
}

/// Whether half a turn of the sample leaves the values of `model` as they are, by 512 pairs of directions.
fn is_twofold(model: &dyn Bsdf, channels: &[(Channel, usize)]) -> bool {
    const PAIRS: usize = 512;
    const EQUAL: f64 = 1e-9;
    let n = model.channels().len();
    let (mut f, mut g) = (vec![0.0; n], vec![0.0; n]);
    // points of a lattice in four dimensions
    let place = |k: usize, step: f64| (0.5 + step * k as f64).fract();
    (0..PAIRS).all(|k| {
        let direction = |a: f64, b: f64| {
            let theta = place(k, a).sqrt().asin();
            Direction::from_spherical(theta, TAU * place(k, b))
        };
        let (wi, ws) = (
            direction(0.856_674_883_8, 0.733_891_856_6),
            direction(0.628_706_729_2, 0.538_597_271_7),
        );
        model.eval(wi, ws, &mut f);
        model.eval(wi.mirror(), ws.mirror(), &mut g);
        channels
            .iter()
            .all(|&(_, c)| (f[c] - g[c]).abs() <= EQUAL * f[c].abs().max(g[c].abs()))
    })
}

impl RglTables {
    /// The front reflection of `model` in the form of an RGL material. `channels` are those of the tables, each with the
    /// index of the model's channel that it takes. Ideal parts of the model have no value and are left out. Evaluated at
    /// a node the tables give the model; between nodes they interpolate.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] for sizes out of range, no channel, an index past the model's channels.
    pub fn of(
        model: &dyn Bsdf,
        channels: &[(Channel, usize)],
        options: &RglOptions,
    ) -> Result<RglTables, BsdfError> {
        options.check()?;
        let there = model.channels().len();
        if channels.is_empty() || channels.iter().any(|(_, c)| *c >= there) {
            return Err(BsdfError::Domain {
                field: "channels",
                found: format!("{:?}", channels.iter().map(|(_, c)| c).collect::<Vec<_>>()),
                allowed: format!("one or more indices below {there}"),
            });
        }
        let isotropic = model.properties().isotropic;
        let phi_i: Vec<f64> = if isotropic {
            vec![0.0]
        } else {
            let n = options.azimuths;
            let turn = if is_twofold(model, channels) { PI } else { TAU };
            (0..n).map(|k| turn * k as f64 / (n - 1) as f64 - PI).collect()
        };
        let (rows, columns) = options.half_vector;
        let surface = Microsurface::of(model, channels, Nodes { rows, columns });
        let ndf = surface.table(|row, column| surface.density(row, column));
        let sigma = surface.table(|row, column| surface.area(row, column));
        let mut out = Squares {
            model,
            channels,
            ndf: Grid::new(ndf.clone()),
            sigma: Grid::new(sigma.clone()),
            n: options.resolution,
            luminance: Vec::new(),
            spectra: Vec::new(),
            valid: Vec::new(),
        };
        let mut vndf = Vec::new();
        for &phi in &phi_i {
            for &theta in &options.theta_i {
                let wi = Direction::from_spherical(theta, phi);
                let mut visible = Vec::with_capacity(rows * columns);
                for row in 0..rows {
                    for column in 0..columns {
                        let cosine = wi.vec().dot(surface.nodes.vector(row, column)).max(0.0);
                        let weight = cosine * surface.nodes.jacobian(column);
                        visible.push((surface.density(row, column) * weight) as f32);
                    }
                }
                let table = Table {
                    shape: vec![1, rows, columns],
                    values: visible,
                };
                out.incidence(wi, &table)?;
                vndf.extend(table.values);
            }
        }
        let (n_p, n_t, n) = (phi_i.len(), options.theta_i.len(), options.resolution);
        Ok(RglTables {
            theta_i: options.theta_i.clone(),
            phi_i,
            ndf,
            sigma,
            vndf: Table {
                shape: vec![n_p, n_t, rows, columns],
                values: vndf,
            },
            luminance: Table {
                shape: vec![n_p, n_t, n, n],
                values: out.luminance,
            },
            spectra: Table {
                shape: vec![n_p, n_t, channels.len(), n, n],
                values: out.spectra,
            },
            channels: channels.iter().map(|(channel, _)| *channel).collect(),
            valid: Some(out.valid),
            jacobian: true,
        })
    }
}

/// The tables over the square in the making.
struct Squares<'a> {
    model: &'a dyn Bsdf,
    channels: &'a [(Channel, usize)],
    ndf: Grid,
    sigma: Grid,
    n: usize,
    luminance: Vec<f32>,
    spectra: Vec<f32>,
    valid: Vec<bool>,
}

impl Squares<'_> {
    /// Adds the tables of one incidence, whose visible normals `vndf` draws.
    fn incidence(&mut self, wi: Direction, vndf: &Table) -> Result<(), BsdfError> {
        let warp = Warp::new(vndf.clone()).map_err(|_| BsdfError::Domain {
            field: "model",
            found: "no visible normal at an incidence".into(),
            allowed: "a model that reflects".into(),
        })?;
        let first = Blend::new((0, 0.0), (0, 0.0), 1);
        let place = |k: usize, low: f64| (k as f64 / (self.n - 1) as f64).clamp(low, 1.0 - INSET);
        // an isotropic material counts the half vector from the incidence, which lies at azimuth 0 here
        let i = [
            polar_coordinate(wi.theta()),
            azimuth_coordinate(wi.vec().y.atan2(wi.vec().x)),
        ];
        let area = self.sigma.value(0, self.sigma.cell(i[0], i[1]));
        let mut f = vec![0.0; self.model.channels().len()];
        let squares = self.n * self.n;
        let mut values = vec![0.0f32; squares * self.channels.len()];
        for node in 0..squares {
            let (v, u) = (place(node / self.n, INSET), place(node % self.n, 0.0));
            let [x, y] = warp.place(&first, u, v);
            let m = Direction::from_spherical(FRAC_PI_2 * x * x, TAU * y - PI).vec();
            let cosine = wi.vec().dot(m);
            let scattered = Direction::new(2.0 * cosine * m - wi.vec());
            let above = scattered.filter(|s| cosine > 0.0 && s.cos_theta() > 0.0);
            self.valid.push(above.is_some());
            let Some(ws) = above else { continue };
            self.model.eval(wi, ws, &mut f);
            let microfacet = self.ndf.value(0, self.ndf.cell(x, y)) / (4.0 * area);
            for (c, &(_, index)) in self.channels.iter().enumerate() {
                values[c * squares + node] = (f[index] * ws.cos_theta() / microfacet) as f32;
            }
        }
        let mean = |node: usize| {
            let sum: f32 = (0..self.channels.len())
                .map(|c| values[c * squares + node].max(0.0))
                .sum();
            sum / self.channels.len() as f32
        };
        let luminance: Vec<f32> = (0..squares).map(mean).collect();
        let dark = luminance.iter().all(|l| *l <= 0.0);
        // a table of zeros cannot be drawn from
        self.luminance
            .extend(luminance.into_iter().map(|l| if dark { 1.0 } else { l }));
        self.spectra.extend(values);
        Ok(())
    }
}

#[cfg(test)]
#[path = "tabulate_tests.rs"]
mod tests;
