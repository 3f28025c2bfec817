//! The microfacet surface whose retro-reflection is that of a model \[DupuyJakob2018\].
//!
//! Its distribution of normals is the eigenvector of a positive kernel; power iteration finds it.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use gonio_geom::{DVec3, Direction};

use super::Table;
use crate::{Bsdf, Channel};

/// Share of an even distribution in that of the normals, so that no direction is without nodes.
pub(super) const EVEN: f64 = 0.01;
/// Power iterations at most, and the relative change that ends them.
const ITERATIONS: usize = 200;
const SETTLED: f64 = 1e-9;

/// Nodes over the half vector: columns of polar coordinate, rows of azimuth.
pub(super) struct Nodes {
    pub(super) rows: usize,
    pub(super) columns: usize,
}

impl Nodes {
    pub(super) fn theta(&self, column: usize) -> f64 {
        let x = column as f64 / (self.columns - 1) as f64;
        FRAC_PI_2 * x * x
    }

    fn phi(&self, row: usize) -> f64 {
        TAU * row as f64 / (self.rows - 1) as f64 - PI
    }

    pub(super) fn vector(&self, row: usize, column: usize) -> DVec3 {
        Direction::from_spherical(self.theta(column), self.phi(row)).vec()
    }

    /// `d omega / (dx dy)` over a constant.
    pub(super) fn jacobian(&self, column: usize) -> f64 {
        column as f64 / (self.columns - 1) as f64 * self.theta(column).sin()
    }

    /// Solid angle that a node stands for in the trapezoid rule.
    pub(super) fn solid_angle(&self, row: usize, column: usize) -> f64 {
        let end = |k: usize, n: usize| if k == 0 || k + 1 == n { 0.5 } else { 1.0 };
        let cell = 1.0 / ((self.columns - 1) * (self.rows - 1)) as f64;
        2.0 * PI * PI * self.jacobian(column) * cell * end(column, self.columns) * end(row, self.rows)
    }
}

/// Mean of `max(0, i . m)` over the azimuth between two directions of these polar angles.
pub(super) fn mean_cosine(a: f64, b: f64) -> f64 {
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
pub(super) struct Microsurface {
    pub(super) nodes: Nodes,
    isotropic: bool,
    /// `[row][column]`; one row for an isotropic surface.
    ndf: Vec<f64>,
}

impl Microsurface {
    /// The surface whose retro-reflection is that of `model`: \[DupuyJakob2018\], eigenvector of
    /// `f(w, w) cos(w) max(0, w . m)`.
    pub(super) fn of(model: &dyn Bsdf, channels: &[(Channel, usize)], nodes: Nodes) -> Self {
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
    pub(super) fn area(&self, row: usize, column: usize) -> f64 {
        if self.isotropic {
            let theta = self.nodes.theta(column);
            self.integrate(|m, _| mean_cosine(theta, self.nodes.theta(m)))
        } else {
            let w = self.nodes.vector(row, column);
            self.integrate(|_, m| w.dot(m).max(0.0))
        }
    }

    pub(super) fn density(&self, row: usize, column: usize) -> f64 {
        let row = if self.isotropic { 0 } else { row };
        self.ndf[row * self.nodes.columns + column]
    }

    /// A table of `g(row, column)`; two equal rows for an isotropic surface.
    pub(super) fn table(&self, g: impl Fn(usize, usize) -> f64) -> Table {
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
