//! The noise-free signal of a sample: the model averaged over beam, spot, aperture and motion.

use gonio_bsdf::Bsdf;
use gonio_bsdf::batch::Directions;
use gonio_geom::{Component, DVec3, Direction};
use rayon::prelude::*;

use crate::beam_signal::BeamSignal;
use crate::detector::Output;
use crate::way::{Ray, Way, rays};
use crate::{Detector, Instrument};

/// What comes to the detector without noise.
pub(crate) trait Signal {
    /// The signal of each output (rows) at receiver directions `ws` of the sample's frame that travel by `travel` (chord, of
    /// unit distance) during a reading.
    fn all(&self, ws: &[Direction], travel: &[DVec3]) -> Vec<Vec<f64>>;
}

/// What is measured.
pub(crate) trait Specimen {
    /// Its signal for light from `wi` of the sample's frame.
    fn signal<'a>(
        &'a self,
        instrument: &'a Instrument,
        outputs: &'a [Output],
        wi: Direction,
    ) -> Box<dyn Signal + 'a>;
}

impl Specimen for &dyn Bsdf {
    fn signal<'a>(
        &'a self,
        instrument: &'a Instrument,
        outputs: &'a [Output],
        wi: Direction,
    ) -> Box<dyn Signal + 'a> {
        Box::new(SampleSignal::new(*self, instrument, outputs, wi))
    }
}

/// Rays of an average: few where four times as many agree, else more.
const LEVELS: [usize; 5] = [16, 64, 256, 1024, 4096];
/// Change from one level to the next that ends it, in units of the noise of the reading.
const TOLERANCE: f64 = 0.05;
/// The same as a share of the signal for a reading without noise.
const SILENT: f64 = 1e-5;
/// Readings that are averaged together; neighbours on the path need about as many rays.
const BLOCK: usize = 128;

/// What an ideal part leaves of the beam: its image, mirrored or straight through.
struct Unscattered {
    image: BeamSignal,
    /// Share of the beam, one a channel of the model.
    shares: Vec<f64>,
}

/// Everything about one incidence that does not depend on the reading. Directions are those of the sample's frame.
pub(crate) struct SampleSignal<'a> {
    model: &'a dyn Bsdf,
    detector: &'a Detector,
    outputs: &'a [Output],
    rays: Vec<Ray>,
    power: f64,
    /// Share of the beam that meets the sample.
    fill: f64,
    unscattered: Vec<Unscattered>,
}

/// Columns of a block of readings.
struct Columns {
    /// Receiver centre, metres, and the axes of its aperture times its radius.
    centre: [Vec<f64>; 3],
    a: [Vec<f64>; 3],
    b: [Vec<f64>; 3],
    normal: [Vec<f64>; 3],
    /// Way travelled during a reading, metres.
    travel: [Vec<f64>; 3],
    to: [Vec<f64>; 3],
    weight: Vec<f64>,
    /// The model's answer, one row a channel.
    f: Vec<Vec<f64>>,
}

fn columns(vectors: impl Iterator<Item = DVec3> + Clone) -> [Vec<f64>; 3] {
    [0, 1, 2].map(|k| vectors.clone().map(|v| v[k]).collect())
}

impl<'a> SampleSignal<'a> {
    /// For light from `wi` of the sample's frame.
    pub(crate) fn new(
        model: &'a dyn Bsdf,
        instrument: &'a Instrument,
        outputs: &'a [Output],
        wi: Direction,
    ) -> Self {
        let Instrument {
            beam,
            detector,
            holder,
            ..
        } = instrument;
        let way = Way::new(wi, holder.surface().z);
        let most = LEVELS[LEVELS.len() - 1];
        let (rays, fill) = rays(beam, detector.distance, holder, &way, most);
        let start = way.lit(0.0, 0.0);
        let one = |component| {
            let mut shares = vec![0.0; model.channels().len()];
            let to = model.delta(wi, component, &mut shares)?;
            // From where the beam's axis meets the sample on to the detector sphere.
            let along = start.dot(to.vec());
            let r2 = detector.distance * detector.distance;
            let length = (along * along - start.length_squared() + r2).max(0.0).sqrt() - along;
            Some(Unscattered {
                image: BeamSignal::new(beam, detector, Direction::new(start + length * to.vec())?),
                shares,
            })
        };
        SampleSignal {
            model,
            detector,
            outputs,
            rays,
            power: beam.power,
            fill,
            unscattered: [Component::Reflection, Component::Transmission]
                .into_iter()
                .filter_map(one)
                .collect(),
        }
    }

    /// Share of the beam that meets the sample.
    pub(crate) fn fill(&self) -> f64 {
        self.fill
    }

    fn block(&self, ws: &[Direction], travel: &[DVec3]) -> Vec<Vec<f64>> {
        let nc = self.model.channels().len();
        let mut columns = self.columns(ws, travel);
        let zero = || vec![vec![0.0; ws.len()]; nc];
        let mut sum = zero();
        let mut rays = 0;
        if !self.rays.is_empty() {
            for level in LEVELS {
                let before = sum.clone();
                self.accumulate(rays..level, &mut columns, &mut sum);
                let agree = rays > 0 && self.agree((&before, rays), (&sum, level));
                rays = level;
                if agree {
                    break;
                }
            }
        }
        let scale = self.fill / rays.max(1) as f64;
        sum.iter_mut().flatten().for_each(|s| *s *= self.power * scale);
        for part in &self.unscattered {
            for (j, (d, t)) in ws.iter().zip(travel).enumerate() {
                let image = self.fill * part.image.moving(*d, *t);
                if image > 0.0 {
                    sum.iter_mut()
                        .zip(&part.shares)
                        .for_each(|(s, share)| s[j] += share * image);
                }
            }
        }
        self.outputs.iter().map(|o| mixed(o, &sum)).collect()
    }

    fn columns(&self, ws: &[Direction], travel: &[DVec3]) -> Columns {
        let distance = self.detector.distance;
        let radius = distance * self.detector.aperture.tan();
        let axes: Vec<(DVec3, DVec3)> = ws.iter().map(|d| d.vec().any_orthonormal_pair()).collect();
        Columns {
            centre: columns(ws.iter().map(|d| distance * d.vec())),
            a: columns(axes.iter().map(|f| radius * f.0)),
            b: columns(axes.iter().map(|f| radius * f.1)),
            normal: columns(ws.iter().map(|d| d.vec())),
            travel: columns(travel.iter().map(|t| distance * *t)),
            to: [(); 3].map(|()| vec![0.0; ws.len()]),
            weight: vec![0.0; ws.len()],
            f: vec![vec![0.0; ws.len()]; self.model.channels().len()],
        }
    }

    /// Adds the contributions of the rays in `range` to `sum`, one row a channel of the model.
    fn accumulate(&self, range: std::ops::Range<usize>, columns: &mut Columns, sum: &mut [Vec<f64>]) {
        let r2 = self.detector.distance * self.detector.distance;
        let n = columns.weight.len();
        for ray in &self.rays[range] {
            let [u, v] = ray.aperture;
            for k in 0..3 {
                let (centre, a, b) = (&columns.centre[k][..n], &columns.a[k][..n], &columns.b[k][..n]);
                let (travel, x) = (&columns.travel[k][..n], ray.x[k]);
                let to = &mut columns.to[k][..n];
                for j in 0..n {
                    to[j] = centre[j] + u * a[j] + v * b[j] + ray.time * travel[j] - x;
                }
            }
            let [tx, ty, tz] = &mut columns.to;
            let [nx, ny, nz] = &columns.normal;
            let (tx, ty, tz) = (&mut tx[..n], &mut ty[..n], &mut tz[..n]);
            let (nx, ny, nz, weight) = (&nx[..n], &ny[..n], &nz[..n], &mut columns.weight[..n]);
            for j in 0..n {
                let inverse = 1.0 / (tx[j] * tx[j] + ty[j] * ty[j] + tz[j] * tz[j]).sqrt();
                tx[j] *= inverse;
                ty[j] *= inverse;
                tz[j] *= inverse;
                let facing = tx[j] * nx[j] + ty[j] * ny[j] + tz[j] * nz[j];
                weight[j] = tz[j].abs() * r2 * inverse * inverse * facing;
            }
            let mut rows: Vec<&mut [f64]> = columns.f.iter_mut().map(Vec::as_mut_slice).collect();
            let to = [&*tx, &*ty, &*tz];
            self.model
                .eval_f64(Directions::One(ray.wi), Directions::Each(to), &mut rows);
            for (s, f) in sum.iter_mut().zip(&columns.f) {
                s.iter_mut()
                    .zip(f.iter().zip(weight.iter()))
                    .for_each(|(s, (f, w))| *s += f * w);
            }
        }
    }

    /// Whether sums over fewer and more rays agree for every output to within the tolerance.
    fn agree(&self, (fewer, a): (&[Vec<f64>], usize), (more, b): (&[Vec<f64>], usize)) -> bool {
        let power = self.fill * self.power;
        let (a, b) = (power / a as f64, power / b as f64);
        self.outputs.iter().all(|o| {
            mixed(o, fewer)
                .into_iter()
                .zip(mixed(o, more))
                .all(|(fewer, more)| {
                    let (signal, change) = (b * more, (b * more - a * fewer).abs());
                    let range = self.detector.range(signal + self.detector.dark_level);
                    let sigma = self.detector.noise(range.noise_readout, signal);
                    change <= TOLERANCE * sigma + SILENT * signal.abs()
                })
        })
    }
}

impl Signal for SampleSignal<'_> {
    /// The signal of each output (rows) at receiver directions `ws` that travel by `travel` (chord, of unit distance)
    /// during a reading [source chapter, eqs 6.2 and 6.4, averaged]:
    /// `P mean(f(wi', ws') |cos theta_s'| r^2 cos psi / d^2)` over rays, `d` from lit point to aperture point and
    /// `psi` the angle at the aperture; on top of it the image of the beam that an ideal part leaves, in the share of the
    /// beam's axis.
    ///
    /// Means are over 64 to 4096 rays: the fewest that change the mean over a quarter of them by no more than 5 % of the
    /// standard deviation of the reading's noise. They are off by less than a tenth of it (tested for lobes of alpha .02 to .2).
    fn all(&self, ws: &[Direction], travel: &[DVec3]) -> Vec<Vec<f64>> {
        let mut out = vec![vec![0.0; ws.len()]; self.outputs.len()];
        let blocks: Vec<Vec<Vec<f64>>> = ws
            .par_chunks(BLOCK)
            .zip(travel.par_chunks(BLOCK))
            .map(|(ws, travel)| self.block(ws, travel))
            .collect();
        for (k, block) in blocks.into_iter().enumerate() {
            for (row, values) in out.iter_mut().zip(block) {
                row[k * BLOCK..k * BLOCK + values.len()].copy_from_slice(&values);
            }
        }
        out
    }
}

/// What an output sees of a block, given the signals per channel of the model.
pub(crate) fn mixed(output: &Output, signals: &[Vec<f64>]) -> Vec<f64> {
    let n = signals.first().map_or(0, Vec::len);
    let mut out = vec![0.0; n];
    for (w, row) in output.weights.iter().zip(signals) {
        if *w != 0.0 {
            out.iter_mut()
                .zip(row)
                .for_each(|(o, s)| *o += output.power * w * s);
        }
    }
    out
}

#[cfg(test)]
mod tests;
