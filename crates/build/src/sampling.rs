//! Drawing directions from a data-driven model.
//!
//! A proposal near the model is drawn from, and the weight makes the sample exact: one time in ten evenly in projected solid
//! angle, else from the analytic base, or from a table of the model's own values, which also knows lobes the base has not.

use std::f64::consts::PI;
use std::sync::Arc;

use gonio_geom::disk::{disk_to_square, square_to_disk};
use gonio_geom::{Component, DVec3};
use rayon::prelude::*;

use crate::base::Base;

/// Cells along each side of the square of directions of scattering.
const CELLS: usize = 32;

/// Polar and azimuthal rows of the table over incidence: isotropic models, and others.
const ISOTROPIC: (usize, usize) = (36, 1);
const ANISOTROPIC: (usize, usize) = (18, 24);

/// Probability of the even part, and of the table (with a base, without one).
const EVEN: f64 = 0.1;
const TABLE: [f64; 2] = [0.3, 0.9];

/// Least probability of a component that scatters.
const LEAST_COMPONENT: f64 = 0.05;

/// What one side draws from: one entry a component.
#[derive(Debug)]
pub(crate) struct Proposal {
    parts: Vec<(Component, One)>,
}

/// A drawn component and a local direction on the upper hemisphere.
pub(crate) type Drawn = (Component, DVec3);

impl Proposal {
    /// Of the components of one side: `eval` is the model in the local frame.
    pub(crate) fn new(
        components: &[(Component, Option<Arc<Base>>)],
        isotropic: bool,
        eval: impl Fn(Component, DVec3, DVec3) -> f64 + Sync,
    ) -> Self {
        let one = |(component, base): &(Component, Option<Arc<Base>>)| {
            let of = |i, s| eval(*component, i, s);
            (*component, One::new(base.clone(), isotropic, of))
        };
        Proposal {
            parts: components.iter().map(one).collect(),
        }
    }

    /// Share of the light from `i` that is scattered, roughly.
    pub(crate) fn albedo(&self, i: DVec3) -> f64 {
        self.parts.iter().map(|(_, p)| p.table.row(i).albedo).sum()
    }

    /// Density of a direction `s` of `component`, 1/sr.
    pub(crate) fn density(&self, component: Component, i: DVec3, s: DVec3) -> f64 {
        let shares = self.shares(i);
        self.parts
            .iter()
            .zip(shares)
            .filter(|((c, _), _)| *c == component)
            .map(|((_, part), share)| share * part.density(i, s))
            .sum()
    }

    /// A direction for `u` in `[0, 1)^3`; `None` is a failed sample.
    pub(crate) fn draw(&self, i: DVec3, u: [f64; 3]) -> Option<Drawn> {
        let mut rest = u[2];
        let last = self.parts.len().checked_sub(1)?;
        for (k, ((component, part), share)) in self.parts.iter().zip(self.shares(i)).enumerate() {
            if rest < share || k == last {
                let within = (rest / share).clamp(0.0, 1.0 - f64::EPSILON);
                return Some((*component, part.draw(i, [u[0], u[1], within])?));
            }
            rest -= share;
        }
        None
    }

    /// Probability of each component.
    fn shares(&self, i: DVec3) -> impl Iterator<Item = f64> {
        let total = self.albedo(i).max(f64::MIN_POSITIVE);
        let n = self.parts.len() as f64;
        let left = 1.0 - n * LEAST_COMPONENT;
        self.parts
            .iter()
            .map(move |(_, p)| (p.table.row(i).albedo / total, left))
            .map(|(share, left)| LEAST_COMPONENT + left * share)
            .collect::<Vec<_>>()
            .into_iter()
    }
}

/// The proposal of one component.
#[derive(Debug)]
struct One {
    base: Option<Arc<Base>>,
    table: Tabulated,
}

impl One {
    fn new(base: Option<Arc<Base>>, isotropic: bool, eval: impl Fn(DVec3, DVec3) -> f64 + Sync) -> Self {
        One {
            // An expansion draws nothing: the table follows matte samples well.
            base: base.filter(|b| !b.is_expansion()),
            table: Tabulated::new(isotropic, eval),
        }
    }

    /// Probabilities of the table and of the base; the rest is even.
    fn split(&self) -> (f64, f64) {
        match self.base {
            Some(_) => (TABLE[0], 1.0 - EVEN - TABLE[0]),
            None => (TABLE[1], 0.0),
        }
    }

    fn density(&self, i: DVec3, s: DVec3) -> f64 {
        let (table, base) = self.split();
        let even = s.z.max(0.0) / PI;
        let from_base = self.base.as_ref().map_or(0.0, |b| b.density(i, s));
        EVEN * even + table * even * self.table.density(i, s) + base * from_base
    }

    fn draw(&self, i: DVec3, u: [f64; 3]) -> Option<DVec3> {
        let (table, base) = self.split();
        let on_disk = |x: f64, y: f64| {
            let (x, y) = square_to_disk(x, y);
            DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
        };
        match u[2] {
            k if k < EVEN => Some(on_disk(u[0], u[1])),
            k if k < EVEN + table => {
                let (x, y) = self.table.draw(i, [u[0], u[1]]);
                Some(on_disk(x, y))
            }
            k => {
                let rest = ((k - EVEN - table) / base).clamp(0.0, 1.0 - f64::EPSILON);
                self.base.as_ref()?.draw(i, [u[0], u[1], rest])
            }
        }
    }
}

/// The values of a component over a grid of incidences, in cells of equal projected solid angle.
#[derive(Debug)]
struct Tabulated {
    isotropic: bool,
    rows: Vec<Row>,
}

#[derive(Debug)]
struct Row {
    /// Running sums over the cells, 1 at the end.
    cumulative: Vec<f64>,
    albedo: f64,
}

impl Tabulated {
    fn new(isotropic: bool, eval: impl Fn(DVec3, DVec3) -> f64 + Sync) -> Self {
        let (thetas, phis) = if isotropic { ISOTROPIC } else { ANISOTROPIC };
        let rows = (0..thetas * phis)
            .into_par_iter()
            .map(|k| {
                let theta = 0.5 * PI * ((k / phis) as f64 + 0.5) / thetas as f64;
                let phi = 2.0 * PI * (k % phis) as f64 / phis as f64;
                let (s, c) = theta.sin_cos();
                let i = if isotropic {
                    DVec3::new(-s, 0.0, c)
                } else {
                    DVec3::new(s * phi.cos(), s * phi.sin(), c)
                };
                Row::new(|s| eval(i, s))
            })
            .collect();
        Tabulated { isotropic, rows }
    }

    fn row(&self, i: DVec3) -> &Row {
        let (thetas, phis) = if self.isotropic { ISOTROPIC } else { ANISOTROPIC };
        let theta = i.x.hypot(i.y).atan2(i.z) / (0.5 * PI) * thetas as f64;
        let a = (theta.max(0.0) as usize).min(thetas - 1);
        let turn = i.y.atan2(i.x).rem_euclid(2.0 * PI) / (2.0 * PI);
        let b = (turn * phis as f64).round() as usize % phis;
        &self.rows[a * phis + b]
    }

    /// Turns a direction into the frame of the rows: isotropic rows have the incidence at azimuth pi.
    fn turned(&self, i: DVec3, s: DVec3, back: bool) -> DVec3 {
        let r = i.x.hypot(i.y);
        if !self.isotropic || r < 1e-12 {
            return s;
        }
        let (c, n) = (-i.x / r, if back { -i.y / r } else { i.y / r });
        DVec3::new(c * s.x - n * s.y, n * s.x + c * s.y, s.z)
    }

    /// Density over that of even projected solid angle.
    fn density(&self, i: DVec3, s: DVec3) -> f64 {
        let s = self.turned(i, s, false);
        let (u, v) = disk_to_square(s.x, s.y);
        let cell = |x: f64| ((x * CELLS as f64).max(0.0) as usize).min(CELLS - 1);
        let k = cell(u) * CELLS + cell(v);
        self.row(i).share(k) * (CELLS * CELLS) as f64
    }

    fn draw(&self, i: DVec3, u: [f64; 2]) -> (f64, f64) {
        let row = self.row(i);
        let k = row
            .cumulative
            .partition_point(|&c| c <= u[0])
            .min(CELLS * CELLS - 1);
        let before = if k == 0 { 0.0 } else { row.cumulative[k - 1] };
        let within = ((u[0] - before) / row.share(k).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0 - f64::EPSILON);
        let x = ((k / CELLS) as f64 + within) / CELLS as f64;
        let y = ((k % CELLS) as f64 + u[1]) / CELLS as f64;
        let (x, y) = square_to_disk(x, y);
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        let s = self.turned(i, DVec3::new(x, y, z), true);
        disk_to_square(s.x, s.y)
    }
}

impl Row {
    fn new(f: impl Fn(DVec3) -> f64) -> Self {
        let centre = |k: usize| (k as f64 + 0.5) / CELLS as f64;
        let values: Vec<f64> = (0..CELLS * CELLS)
            .map(|k| {
                let (x, y) = square_to_disk(centre(k / CELLS), centre(k % CELLS));
                let value = f(DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt()));
                if value.is_finite() { value.max(0.0) } else { 0.0 }
            })
            .collect();
        let total: f64 = values.iter().sum();
        let even = 1.0 / (CELLS * CELLS) as f64;
        let mut sum = 0.0;
        let cumulative = values
            .iter()
            .map(|v| {
                sum += if total > 0.0 { v / total } else { even };
                sum
            })
            .collect();
        Row {
            cumulative,
            albedo: PI * total * even,
        }
    }

    /// Probability of a cell.
    fn share(&self, k: usize) -> f64 {
        let before = if k == 0 { 0.0 } else { self.cumulative[k - 1] };
        self.cumulative[k] - before
    }
}
