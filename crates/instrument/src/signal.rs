//! The noise-free signal of a sample: the model averaged over beam, spot, aperture and motion.

use gonio_bsdf::Bsdf;
use gonio_bsdf::batch::Directions;
use gonio_geom::{Component, DVec3, Direction};
use rayon::prelude::*;

use crate::beam_signal::BeamSignal;
use crate::detector::Output;
use crate::nodes::{node, on_disk};
use crate::{Beam, Detector, Focus, Holder, Instrument};

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
/// Points of the spot of which the share on the sample is counted.
const FILL_POINTS: usize = 16_384;

/// One way from the source over a point of the spot, in the frame of the sample.
struct Ray {
    /// Point of the sample that is lit, metres.
    x: DVec3,
    /// Direction towards the source there.
    wi: [f64; 3],
    /// Point of the aperture in units of its radius.
    aperture: [f64; 2],
    /// When it is read, in units of the time of integration, `[-0.5, 0.5]`.
    time: f64,
}

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

/// The beam's cross-section and where it goes.
pub(crate) struct Way {
    through: DVec3,
    a: DVec3,
    b: DVec3,
    /// Height of the sample's surface over the origin.
    height: f64,
}

impl Way {
    /// Of a beam from `wi` onto a sample whose surface lies at `height`.
    pub(crate) fn new(wi: Direction, height: f64) -> Self {
        let through = wi.through().vec();
        let (a, b) = through.any_orthonormal_pair();
        Way {
            through,
            a,
            b,
            height,
        }
    }

    /// The point of the sample plane that point (`x`, `y`) of the cross-section lights.
    pub(crate) fn lit(&self, x: f64, y: f64) -> DVec3 {
        let cross = x * self.a + y * self.b;
        cross + self.through * ((self.height - cross.z) / self.through.z)
    }

    /// Where the beam goes, unit.
    pub(crate) fn through(&self) -> DVec3 {
        self.through
    }

    /// A point in the cross-section of the beam, from its axis.
    pub(crate) fn across(&self, x: DVec3) -> DVec3 {
        x - x.dot(self.through) * self.through
    }

    /// Towards the source from `x`, for the part of the beam at `chord` from its centre in direction (`bx`, `by`) of its
    /// cross-section.
    pub(crate) fn source(
        &self,
        beam: &Beam,
        distance: f64,
        x: DVec3,
        chord: f64,
        [bx, by]: [f64; 2],
    ) -> Option<Direction> {
        let sin = chord * (1.0 - 0.25 * chord * chord).sqrt();
        let aim = (1.0 - 0.5 * chord * chord) * self.through + sin * (bx * self.a + by * self.b);
        Direction::new(match beam.focus {
            // All rays through this point of the beam's image on the detector sphere, reached from x.
            Focus::Detector => x - distance * aim,
            Focus::Sample => -aim,
        })
    }
}

/// `wanted` rays over the part of the spot that lies on the sample, and the share of the beam that does.
fn rays(beam: &Beam, distance: f64, holder: &Holder, way: &Way, wanted: usize) -> (Vec<Ray>, f64) {
    let spot = 0.5 * beam.spot_diameter;
    let on_sample = |x: DVec3| holder.holds(x);
    let inside = (0..FILL_POINTS)
        .filter(|&k| {
            let [x, y] = on_disk(node::<2>(k));
            on_sample(way.lit(spot * x, spot * y))
        })
        .count();
    let fill = inside as f64 / FILL_POINTS as f64;
    let mut rays = Vec::with_capacity(wanted);
    if inside == 0 {
        return (rays, 0.0);
    }
    for k in 0.. {
        let u = node::<7>(k);
        let [sx, sy] = on_disk([u[0], u[1]]);
        let chord = beam.profile.chord_of_share(u[2]);
        let (bs, bc) = (std::f64::consts::TAU * u[3]).sin_cos();
        let [dx, dy] = on_disk([u[4], u[5]]);
        // Quarter turns of each node: gradients of the model cancel exactly and curvatures weigh alike in all
        // azimuths, as they do in the average itself.
        for (q, (c, s)) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
            .into_iter()
            .enumerate()
        {
            if rays.len() == wanted {
                return (rays, fill);
            }
            let turn = |x: f64, y: f64| [c * x - s * y, s * x + c * y];
            let [sx, sy] = turn(sx, sy);
            let x = way.lit(spot * sx, spot * sy);
            if !on_sample(x) {
                continue;
            }
            let time = if q % 2 == 0 { u[6] - 0.5 } else { 0.5 - u[6] };
            rays.extend(way.source(beam, distance, x, chord, turn(bc, bs)).map(|wi| Ray {
                x,
                wi: wi.vec().to_array(),
                aperture: turn(dx, dy),
                time,
            }));
        }
    }
    (rays, fill)
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
mod tests {
    use super::*;
    use crate::BeamProfile;
    use gonio_bsdf::analytic::{Lambert, Spectrum, WardGmd};

    fn signal_at(model: &dyn Bsdf, beam: &Beam, detector: &Detector, wi: Direction, ws: Direction) -> f64 {
        let instrument = Instrument {
            beam: beam.clone(),
            detector: detector.clone(),
            ..Instrument::default()
        };
        let outputs = detector.outputs_for(model.channels()).unwrap();
        SampleSignal::new(model, &instrument, &outputs, wi).all(&[ws], &[DVec3::ZERO])[0][0]
    }

    #[test]
    fn a_lambertian_spot_is_biased_by_no_more_than_its_size_over_the_distance_squared() {
        let model = Lambert::reflection(&Spectrum::photopic("rho", 0.8).unwrap()).unwrap();
        let (mut beam, detector) = (Beam::default(), Detector::default());
        beam.spot_diameter = 0.05;
        for deg in [0.0, 40.0, 80.0] {
            let ws = Direction::from_degrees(deg, 70.0);
            let got = signal_at(&model, &beam, &detector, Direction::NORMAL, ws);
            let dsf = beam.power * 0.8 / std::f64::consts::PI * ws.cos_theta();
            // (a/r)^2 = 6.0e-4; the factor in front stays below 2 for all polar angles.
            assert!((got / dsf - 1.0).abs() < 1.2e-3, "{deg} deg: {}", got / dsf);
        }
    }

    #[test]
    fn a_small_aperture_and_beam_leave_the_model_as_it_is() {
        let model = WardGmd::isotropic(&Spectrum::photopic("rho", 0.5).unwrap(), 0.15).unwrap();
        let beam = Beam {
            spot_diameter: 0.0,
            profile: BeamProfile::TopHat { radius: 1e-4 },
            ..Beam::default()
        };
        let detector = Detector {
            aperture: 1e-5,
            ..Detector::default()
        };
        let wi = Direction::from_degrees(45.0, 10.0);
        for (theta, phi) in [(45.0, 190.0), (30.0, 180.0), (70.0, 200.0)] {
            let ws = Direction::from_degrees(theta, phi);
            let got = signal_at(&model, &beam, &detector, wi, ws);
            let dsf = beam.power * model.eval_first(wi, ws) * ws.cos_theta();
            assert!((got / dsf - 1.0).abs() < 1e-5, "{}", got / dsf);
        }
    }

    #[test]
    fn the_peak_of_a_lobe_falls_by_the_variance_of_the_signature() {
        // A lobe exp(-g^2/w^2), w = 2 alpha, under a kernel of variance s^2 an axis: peak down by 2 s^2/w^2 at normal
        // incidence. Gaussian beam: w_b^2/2 an axis; disk aperture: a^2/4 an axis.
        let alpha = 0.05;
        let model = WardGmd::isotropic(&Spectrum::photopic("rho", 0.5).unwrap(), alpha).unwrap();
        let (w_b, a) = (0.01, 0.012);
        let beam = Beam {
            spot_diameter: 0.0,
            profile: BeamProfile::Gaussian { half_width: w_b },
            ..Beam::default()
        };
        let detector = Detector {
            aperture: a,
            ..Detector::default()
        };
        let got = signal_at(&model, &beam, &detector, Direction::NORMAL, Direction::NORMAL);
        let dsf = beam.power * model.eval_first(Direction::NORMAL, Direction::NORMAL);
        let w = 2.0 * alpha;
        let disk = (w * w / (a * a)) * (1.0 - (-a * a / (w * w)).exp());
        let expected = disk * w * w / (w * w + w_b * w_b);
        assert!(
            (got / dsf - expected).abs() < 1e-3,
            "{} expected {expected}",
            got / dsf
        );
    }

    #[test]
    fn means_over_few_rays_are_off_by_less_than_a_tenth_of_the_noise() {
        // Lobes from narrow to broad, near their peaks and far from them, against 65_536 rays.
        for alpha in [0.02, 0.05, 0.2] {
            let model = WardGmd::isotropic(&Spectrum::photopic("rho", 0.5).unwrap(), alpha).unwrap();
            let instrument = Instrument::default();
            let outputs = instrument.detector.outputs_for(model.channels()).unwrap();
            for theta in [5.0, 50.0, 75.0] {
                let wi = Direction::from_degrees(theta, 30.0);
                let (a, b) = wi.mirror().vec().any_orthonormal_pair();
                let ws: Vec<Direction> = (0..200)
                    .filter_map(|k| {
                        let (radius, turn) = (0.0025 * f64::from(k), 2.4 * f64::from(k));
                        Direction::new(wi.mirror().vec() + radius * (turn.cos() * a + turn.sin() * b))
                    })
                    .filter(|d| d.cos_theta() > 0.05)
                    .collect();
                let still = vec![DVec3::ZERO; ws.len()];
                let mut signal = SampleSignal::new(&model, &instrument, &outputs, wi);
                let found = signal.all(&ws, &still).remove(0);
                let way = Way {
                    through: wi.through().vec(),
                    a: wi.through().vec().any_orthonormal_pair().0,
                    b: wi.through().vec().any_orthonormal_pair().1,
                    height: 0.0,
                };
                let distance = instrument.detector.distance;
                signal.rays = rays(&instrument.beam, distance, &instrument.holder, &way, 65_536).0;
                let mut columns = signal.columns(&ws, &still);
                let mut sum = vec![vec![0.0; ws.len()]];
                signal.accumulate(0..65_536, &mut columns, &mut sum);
                for (j, (found, sum)) in found.iter().zip(&sum[0]).enumerate() {
                    let truth = signal.power * sum / 65_536.0;
                    let noise = instrument
                        .detector
                        .noise(instrument.detector.noise_readout, truth);
                    let off = (found - truth).abs() / noise;
                    assert!(
                        off < 0.1,
                        "alpha {alpha}, {theta} deg, reading {j}: {off} of the noise"
                    );
                }
            }
        }
    }

    #[test]
    fn the_bare_beam_integrates_to_its_power() {
        let detector = Detector::default();
        for profile in [
            BeamProfile::Gaussian { half_width: 0.002 },
            BeamProfile::TopHat { radius: 0.005 },
        ] {
            let beam = Beam {
                profile: profile.clone(),
                ..Beam::default()
            };
            let signal = BeamSignal::new(&beam, &detector, Direction::NORMAL.through());
            let (n, half) = (200, 0.012);
            let pitch = 2.0 * half / f64::from(n);
            let mut sum = 0.0;
            for i in 0..n {
                for j in 0..n {
                    let v = DVec3::new(
                        -half + (f64::from(i) + 0.5) * pitch,
                        -half + (f64::from(j) + 0.5) * pitch,
                        -1.0,
                    );
                    // Solid angle of a tangent-plane element.
                    sum += signal.at(Direction::new(v).unwrap()) * pitch * pitch / v.length().powi(3);
                }
            }
            assert!((sum / beam.power - 1.0).abs() < 2e-4, "{profile:?}: {sum}");
        }
    }
}
