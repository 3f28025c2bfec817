//! Tables of other models in the adaptive parameterisation \[DupuyJakob2018\].
//!
//! The retro-reflection of a model is that of a microfacet surface whose distribution of normals is the eigenvector of
//! a positive kernel; power iteration finds it. What the model reflects is then divided by what that surface says and
//! sampled where the surface reflects.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use gonio_geom::{DVec3, Direction};

use super::warp::{Blend, Grid, Warp};
use super::{RglTables, Table, azimuth_coordinate, polar_coordinate};
use crate::{Bsdf, BsdfError, Channel};

/// Share of an even distribution in that of the normals, so that no direction is without nodes.
const EVEN: f64 = 0.01;
/// Power iterations at most, and the relative change that ends them.
const ITERATIONS: usize = 200;
const SETTLED: f64 = 1e-9;
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

/// Nodes over the half vector: columns of polar coordinate, rows of azimuth.
struct Nodes {
    rows: usize,
    columns: usize,
}

impl Nodes {
    fn theta(&self, column: usize) -> f64 {
        let x = column as f64 / (self.columns - 1) as f64;
        FRAC_PI_2 * x * x
    }

    fn phi(&self, row: usize) -> f64 {
        TAU * row as f64 / (self.rows - 1) as f64 - PI
    }

    fn vector(&self, row: usize, column: usize) -> DVec3 {
        Direction::from_spherical(self.theta(column), self.phi(row)).vec()
    }

    /// `d omega / (dx dy)` over a constant.
    fn jacobian(&self, column: usize) -> f64 {
        column as f64 / (self.columns - 1) as f64 * self.theta(column).sin()
    }

    /// Solid angle that a node stands for in the trapezoid rule.
    fn solid_angle(&self, row: usize, column: usize) -> f64 {
        let end = |k: usize, n: usize| if k == 0 || k + 1 == n { 0.5 } else { 1.0 };
        let cell = 1.0 / ((self.columns - 1) * (self.rows - 1)) as f64;
        2.0 * PI * PI * self.jacobian(column) * cell * end(column, self.columns) * end(row, self.rows)
    }
}

/// Mean of `max(0, i . m)` over the azimuth between two directions of these polar angles.
fn mean_cosine(a: f64, b: f64) -> f64 {
    let (c, s) = (a.cos() * b.cos(), a.sin() * b.sin());
    if c >= s {
        c
    } else if c <= -s {
        0.0
    } else {
        let edge = (-c / s).acos();
        (c * edge + s * edge.sin()) / PI
    }
}

/// A distribution of normals over nodes with its projected areas.
struct Microsurface {
    nodes: Nodes,
    isotropic: bool,
    /// `[row][column]`; one row for an isotropic surface.
    ndf: Vec<f64>,
}

impl Microsurface {
    /// The surface whose retro-reflection is that of `model`: \[DupuyJakob2018\], eigenvector of
    /// `f(w, w) cos(w) max(0, w . m)`.
    fn of(model: &dyn Bsdf, channels: &[(Channel, usize)], nodes: Nodes) -> Self {
        let isotropic = model.properties().isotropic;
        let rows = if isotropic { 1 } else { nodes.rows };
        let mut f = vec![0.0; model.channels().len()];
        let mut retro = Vec::with_capacity(rows * nodes.columns);
        for row in 0..rows {
            for column in 0..nodes.columns {
                let w = Direction::from_unit(nodes.vector(row, column));
                model.eval(w, w, &mut f);
                let sum: f64 = channels.iter().map(|(_, c)| f[*c].max(0.0)).sum();
                retro.push(sum / channels.len() as f64 * w.cos_theta().max(0.0));
            }
        }
        let mut surface = Microsurface {
            ndf: vec![1.0; retro.len()],
            nodes,
            isotropic,
        };
        if retro.iter().any(|r| *r > 0.0) {
            surface.iterate(&retro);
        }
        surface.normalise();
        surface
            .ndf
            .iter_mut()
            .for_each(|d| *d = (1.0 - EVEN) * *d + EVEN / PI);
        surface
    }

    fn iterate(&mut self, retro: &[f64]) {
        self.normalise();
        for _ in 0..ITERATIONS {
            let columns = self.nodes.columns;
            let next: Vec<f64> = retro
                .iter()
                .enumerate()
                .map(|(k, r)| {
                    if *r > 0.0 {
                        r * self.area(k / columns, k % columns)
                    } else {
                        0.0
                    }
                })
                .collect();
            let before = std::mem::replace(&mut self.ndf, next);
            self.normalise();
            let change = before.iter().zip(&self.ndf).map(|(a, b)| (a - b).abs());
            let largest = self.ndf.iter().copied().fold(0.0, f64::max);
            if change.fold(0.0, f64::max) <= SETTLED * largest {
                break;
            }
        }
    }

    /// Sum over all normals of `ndf * g(polar angle, vector)`.
    fn integrate(&self, g: impl Fn(usize, DVec3) -> f64) -> f64 {
        let columns = self.nodes.columns;
        let mut sum = 0.0;
        for (k, d) in self.ndf.iter().enumerate() {
            let (row, column) = (k / columns, k % columns);
            let weight = if self.isotropic {
                // the whole turn at once
                self.nodes.solid_angle(1, column) * (self.nodes.rows - 1) as f64
            } else {
                self.nodes.solid_angle(row, column)
            };
            sum += weight * d * g(column, self.nodes.vector(row, column));
        }
        sum
    }

    /// Scales the projected area along the normal to 1.
    fn normalise(&mut self) {
        let sum = self.integrate(|_, m| m.z);
        if sum > 0.0 {
            self.ndf.iter_mut().for_each(|d| *d /= sum);
        }
    }

    /// Projected area along the direction of a node.
    fn area(&self, row: usize, column: usize) -> f64 {
        if self.isotropic {
            let theta = self.nodes.theta(column);
            self.integrate(|m, _| mean_cosine(theta, self.nodes.theta(m)))
        } else {
            let w = self.nodes.vector(row, column);
            self.integrate(|_, m| w.dot(m).max(0.0))
        }
    }

    fn density(&self, row: usize, column: usize) -> f64 {
        let row = if self.isotropic { 0 } else { row };
        self.ndf[row * self.nodes.columns + column]
    }

    /// A table of `g(row, column)`; two equal rows for an isotropic surface.
    fn table(&self, g: impl Fn(usize, usize) -> f64) -> Table {
        let (rows, columns) = (
            if self.isotropic { 1 } else { self.nodes.rows },
            self.nodes.columns,
        );
        let mut values: Vec<f32> = (0..rows * columns)
            .map(|k| g(k / columns, k % columns) as f32)
            .collect();
        if self.isotropic {
            values.extend_from_within(..);
        }
        Table {
            shape: vec![rows.max(2), columns],
            values,
        }
    }
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
