//! Isotropic tables over half and difference angles \[Rusinkiewicz1998\], the form of the MERL database \[Matusik2003\].
//!
//! Cells are even in the square root of the half vector's polar angle, so that those about the mirror direction are
//! small, and even in the difference angles. A value holds for its cell; a negative one says that the database has none.

mod coordinates;
mod sample;
mod tabulate;
#[cfg(test)]
mod tests;

use std::f64::consts::{FRAC_PI_2, PI};

use gonio_geom::{DVec3, Direction};

use crate::{Bsdf, BsdfError, Channel, Lobe, Properties, Sample};

pub use coordinates::HalfAngles;
use sample::Proposal;

/// How a value between the centres of cells is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lookup {
    /// The value of the cell, as the database's own reading code has it.
    #[default]
    Nearest,
    /// Linear between the centres of the eight nearest cells that hold a value, along the axes of the table.
    Trilinear,
}

/// A table of the reflection of light that arrives on the front.
#[derive(Clone, Debug)]
pub struct HalfDifference {
    shape: [usize; 3],
    channels: Vec<Channel>,
    /// 1/sr; `[channel][theta_h][theta_d][phi_d]`.
    values: Vec<f64>,
    lookup: Lookup,
    proposal: Proposal,
}

/// Up to eight cells with weights that sum to 1.
type Cells = ([(usize, f64); 8], usize);

impl HalfDifference {
    /// A table of `shape` cells in (theta_h, theta_d, phi_d): `values` in 1/sr, `[channel][theta_h][theta_d][phi_d]`,
    /// negative where there is no value.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] for a shape without cells or of more than 2^31, no channel, values that are not as many as
    /// shape and channels say or not finite.
    pub fn new(shape: [usize; 3], channels: Vec<Channel>, values: Vec<f64>) -> Result<Self, BsdfError> {
        let cells = cells_of(shape)?;
        if channels.is_empty() {
            return Err(domain("channels", "none", "at least one"));
        }
        if Some(values.len()) != cells.checked_mul(channels.len()) {
            let allowed = format!("{cells} for each of {} channels", channels.len());
            return Err(domain("values", format!("{} values", values.len()), allowed));
        }
        if let Some(at) = values.iter().position(|v| !v.is_finite()) {
            let found = format!("{} at value {}", values[at], at + 1);
            return Err(domain("values", found, "finite numbers"));
        }
        Ok(HalfDifference {
            proposal: Proposal::new(shape, &values),
            shape,
            channels,
            values,
            lookup: Lookup::default(),
        })
    }

    /// The same table with another rule between the centres of cells.
    #[must_use]
    pub fn with_lookup(mut self, lookup: Lookup) -> Self {
        self.lookup = lookup;
        self
    }

    /// Cells in (theta_h, theta_d, phi_d).
    pub fn shape(&self) -> [usize; 3] {
        self.shape
    }

    /// The values of a channel, `[theta_h][theta_d][phi_d]`, 1/sr; negative ones stand for none.
    pub fn values(&self, channel: usize) -> &[f64] {
        let n = self.values.len() / self.channels.len();
        &self.values[channel * n..(channel + 1) * n]
    }

    /// Share of the cells without a value in the first channel.
    pub fn empty_share(&self) -> f64 {
        let first = self.values(0);
        first.iter().filter(|v| **v < 0.0).count() as f64 / first.len() as f64
    }

    /// Centre of a cell.
    pub fn centre(shape: [usize; 3], cell: [usize; 3]) -> HalfAngles {
        let place = |k: usize| (cell[k] as f64 + 0.5) / shape[k] as f64;
        HalfAngles {
            theta_h: FRAC_PI_2 * place(0) * place(0),
            theta_d: FRAC_PI_2 * place(1),
            phi_d: PI * place(2),
        }
    }

    /// Position in cells along the three axes; the integral part is the cell.
    fn position(&self, angles: &HalfAngles) -> [f64; 3] {
        [
            (angles.theta_h / FRAC_PI_2).sqrt() * self.shape[0] as f64,
            angles.theta_d / FRAC_PI_2 * self.shape[1] as f64,
            angles.phi_d / PI * self.shape[2] as f64,
        ]
    }

    fn index(&self, cell: [usize; 3]) -> usize {
        (cell[0] * self.shape[1] + cell[1]) * self.shape[2] + cell[2]
    }

    fn nearest(&self, angles: &HalfAngles) -> usize {
        let p = self.position(angles);
        self.index([0, 1, 2].map(|k| (p[k] as usize).min(self.shape[k] - 1)))
    }

    fn trilinear(&self, angles: &HalfAngles) -> Cells {
        let p = self.position(angles);
        // the cell whose centre lies before, the one after, and the share of the latter
        let brackets = [0, 1, 2].map(|k| {
            let n = self.shape[k];
            let x = p[k] - 0.5;
            if k == 2 {
                let floor = x.floor();
                let low = (floor as i64).rem_euclid(n as i64) as usize;
                (low, (low + 1) % n, x - floor)
            } else {
                let x = x.clamp(0.0, (n - 1) as f64);
                let low = (x as usize).min(n.saturating_sub(2));
                (low, (low + 1).min(n - 1), x - low as f64)
            }
        });
        let mut cells = ([(0, 0.0); 8], 0);
        for corner in 0..8usize {
            let mut cell = [0; 3];
            let mut weight = 1.0;
            for (k, (low, high, share)) in brackets.into_iter().enumerate() {
                let upper = corner >> k & 1 == 1;
                cell[k] = if upper { high } else { low };
                weight *= if upper { share } else { 1.0 - share };
            }
            if weight > 0.0 {
                cells.0[cells.1] = (self.index(cell), weight);
                cells.1 += 1;
            }
        }
        cells
    }
}

/// Number of cells of a shape.
fn cells_of(shape: [usize; 3]) -> Result<usize, BsdfError> {
    let product = shape.iter().try_fold(1usize, |a, &b| a.checked_mul(b));
    match product {
        Some(n) if n > 0 && n <= 1 << 31 => Ok(n),
        _ => Err(domain("shape", format!("{shape:?}"), "1 to 2^31 cells")),
    }
}

fn domain(field: &'static str, found: impl Into<String>, allowed: impl Into<String>) -> BsdfError {
    BsdfError::Domain {
        field,
        found: found.into(),
        allowed: allowed.into(),
    }
}

impl Bsdf for HalfDifference {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Reciprocal and isotropic by its coordinates; measured values need not conserve energy.
    fn properties(&self) -> Properties {
        Properties {
            reciprocal: true,
            energy_conserving: false,
            isotropic: true,
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        f.fill(0.0);
        let Some(angles) = HalfAngles::of(wi, ws) else {
            return;
        };
        let n = self.values.len() / self.channels.len();
        match self.lookup {
            Lookup::Nearest => {
                let cell = self.nearest(&angles);
                for (c, f) in f.iter_mut().enumerate() {
                    *f = self.values[c * n + cell].max(0.0);
                }
            }
            Lookup::Trilinear => {
                let (cells, used) = self.trilinear(&angles);
                for (c, f) in f.iter_mut().enumerate() {
                    let mut sum = [0.0; 2];
                    for &(cell, weight) in &cells[..used] {
                        let value = self.values[c * n + cell];
                        if value >= 0.0 {
                            sum[0] += weight * value;
                            sum[1] += weight;
                        }
                    }
                    *f = if sum[1] > 0.0 { sum[0] / sum[1] } else { 0.0 };
                }
            }
        }
    }

    /// Whether the cell of the pair holds a value in every channel.
    fn has_data(&self, wi: Direction, ws: Direction) -> bool {
        let n = self.values.len() / self.channels.len();
        HalfAngles::of(wi, ws).is_some_and(|angles| {
            let cell = self.nearest(&angles);
            (0..self.channels.len()).all(|c| self.values[c * n + cell] >= 0.0)
        })
    }

    /// The density of [`Bsdf::sample`]; it integrates to less than 1, since directions below the horizon are failed samples.
    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        self.proposal.pdf(w, sampled)
    }

    /// A cosine-weighted direction, or the mirror direction about a half vector drawn from the table's mean over the
    /// difference angles.
    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        let (v, lobe): (DVec3, Lobe) = self.proposal.sample(w, u)?;
        let direction = Direction::new(v)?;
        let pdf = self.proposal.pdf(w, direction);
        let mut f = vec![0.0; self.channels.len()];
        self.eval(w, direction, &mut f);
        let weight = f[0] * direction.cos_theta() / pdf;
        (pdf > 0.0 && f.iter().any(|f| *f > 0.0)).then_some(Sample {
            direction,
            weight,
            pdf,
            lobe,
        })
    }
}
