//! Light from all directions at infinity.

use std::sync::Arc;

use glam::Vec3;

use super::Towards;

/// Rows of equal solid angle and columns of the table by which directions are drawn.
const ROWS: usize = 128;
const COLUMNS: usize = 256;
/// Directions in a cell whose radiance is averaged, on each axis.
const WITHIN: usize = 2;
/// Share of the directions that are drawn without regard to radiance: what the table misses is found.
const EVEN: f32 = 0.1;

/// Radiance by direction, drawn in proportion to it.
#[derive(Clone)]
pub struct Sky {
    emission: Arc<dyn Fn(Vec3) -> Vec3 + Send + Sync>,
    /// Sums of the table's rows, and within each row.
    rows: Vec<f32>,
    columns: Vec<f32>,
}

impl std::fmt::Debug for Sky {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Sky").finish_non_exhaustive()
    }
}

/// The direction of a point of the unit square; equal areas are equal solid angles.
fn direction(u: f32, v: f32) -> Vec3 {
    let z = 1.0 - 2.0 * v;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (s, c) = (std::f32::consts::TAU * u).sin_cos();
    Vec3::new(r * c, r * s, z)
}

impl Sky {
    /// A sky of this radiance, W/(m2 sr) in red, green and blue, by unit direction towards it.
    pub fn new(emission: Arc<dyn Fn(Vec3) -> Vec3 + Send + Sync>) -> Self {
        let mut rows = Vec::with_capacity(ROWS);
        let mut columns = Vec::with_capacity(ROWS * COLUMNS);
        let mut total = 0.0;
        for row in 0..ROWS {
            let mut sum = 0.0;
            for column in 0..COLUMNS {
                for k in 0..WITHIN * WITHIN {
                    let at = |n: usize, inside: usize, all: usize| {
                        (n as f32 + (inside as f32 + 0.5) / WITHIN as f32) / all as f32
                    };
                    let d = direction(at(column, k % WITHIN, COLUMNS), at(row, k / WITHIN, ROWS));
                    let value = emission(d).max_element();
                    sum += if value.is_finite() { value.max(0.0) } else { 0.0 };
                }
                columns.push(sum);
            }
            total += sum;
            rows.push(total);
        }
        Sky {
            emission,
            rows,
            columns,
        }
    }

    /// Radiance from a unit direction.
    #[inline]
    pub fn radiance(&self, d: Vec3) -> Vec3 {
        (self.emission)(d)
    }

    /// Draws a direction; its radiance is asked for when nothing is in the way.
    pub(crate) fn sample(&self, u: [f32; 2]) -> Towards {
        let direction = self.direction(u);
        Towards {
            direction,
            distance: f32::INFINITY,
            radiance: Vec3::ONE,
            pdf: self.pdf(direction),
        }
    }

    /// The direction of two uniform numbers.
    pub(crate) fn direction(&self, [u, v]: [f32; 2]) -> Vec3 {
        let total = self.rows[ROWS - 1];
        if u < EVEN || total <= 0.0 {
            return direction((u / EVEN).fract(), v);
        }
        let u = (u - EVEN) / (1.0 - EVEN);
        let (row, down) = pick(&self.rows, v);
        let (column, along) = pick(&self.columns[row * COLUMNS..(row + 1) * COLUMNS], u);
        direction(
            (column as f32 + along) / COLUMNS as f32,
            (row as f32 + down) / ROWS as f32,
        )
    }

    /// Density per solid angle of a unit direction.
    pub(crate) fn pdf(&self, d: Vec3) -> f32 {
        let sphere = 0.25 * std::f32::consts::FRAC_1_PI;
        let total = self.rows[ROWS - 1];
        if total <= 0.0 {
            return sphere;
        }
        let row = (((0.5 - 0.5 * d.z) * ROWS as f32) as usize).min(ROWS - 1);
        let turn = d.y.atan2(d.x) / std::f32::consts::TAU;
        let column = ((turn.rem_euclid(1.0) * COLUMNS as f32) as usize).min(COLUMNS - 1);
        let cells = &self.columns[row * COLUMNS..(row + 1) * COLUMNS];
        let cell = cells[column] - if column == 0 { 0.0 } else { cells[column - 1] };
        let share = cell / total * (ROWS * COLUMNS) as f32;
        sphere * (EVEN + (1.0 - EVEN) * share)
    }
}

/// The cell of running sums that a uniform number falls into, and where in it.
fn pick(sums: &[f32], u: f32) -> (usize, f32) {
    let wanted = u * sums[sums.len() - 1];
    let k = sums.partition_point(|s| *s <= wanted).min(sums.len() - 1);
    let below = if k == 0 { 0.0 } else { sums[k - 1] };
    let width = sums[k] - below;
    let within = if width > 0.0 {
        (wanted - below) / width
    } else {
        0.5
    };
    (k, within.clamp(0.0, 0.999_999))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::Sampler;

    #[test]
    fn directions_are_drawn_with_the_stated_density() {
        let bright = Vec3::new(0.4, -0.3, 0.8).normalize();
        let sky = Sky::new(Arc::new(move |d: Vec3| {
            Vec3::splat(if d.z > 0.0 {
                1.0 + 30.0 * d.dot(bright).max(0.0).powi(40)
            } else {
                0.1
            })
        }));
        // Of any function of direction, the mean over pdf is its integral.
        let functions: [fn(Vec3) -> f32; 3] = [|_| 1.0, |d| d.z.max(0.0), |d| d.x * d.x];
        let integrals = [4.0, 1.0, 4.0 / 3.0].map(|x: f32| x * std::f32::consts::PI);
        let n = 200_000;
        let mut sums = [0.0_f64; 3];
        for k in 0..n {
            let t = sky.sample(Sampler::new(5, 0, k).two());
            assert!((sky.pdf(t.direction) / t.pdf - 1.0).abs() < 1e-6);
            for (s, f) in sums.iter_mut().zip(functions) {
                *s += f64::from(f(t.direction) / t.pdf) / f64::from(n);
            }
        }
        for (s, wanted) in sums.into_iter().zip(integrals) {
            assert!((s / f64::from(wanted) - 1.0).abs() < 0.01, "{s} {wanted}");
        }
    }
}
