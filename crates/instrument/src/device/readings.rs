//! Readings of a part that exists as geometry: rays from the beam through it to the detector.
//!
//! Light arrives in two ways. From where a surface scatters it, it goes straight to the aperture: every scattering of a ray is
//! joined with every reading. What a mirror or refraction sends out, or what comes straight through, is seen by the readings
//! whose aperture it happens to hit; where it was never scattered, rays from the apertures find it too ([`super::beamlet`]). All are
//! means over independent sets of rays, whose scatter is the error; more rays follow until it is below the noise of the instrument.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::Vec3;
use gonio_bsdf::Channel;
use gonio_geom::{DVec3, Direction};
use gonio_scan::Scan;
use gonio_trace::accumulate::LUMINANCE;
use gonio_trace::passage::{Entering, Leaving, Scattering};
use gonio_trace::path::Limits;
use gonio_trace::sampler::Sampler;
use rayon::prelude::*;

use super::Device;
use super::apertures::Apertures;
use super::beamlet::{Beamlet, FORWARD, SMALLEST, To};
use crate::campaign::{check, run};
use crate::nodes::{on_disk, shifted};
use crate::signal::{Signal, Specimen, Way, mixed};
use crate::{Campaign, Instrument, InstrumentError, Outline, Output};

/// How the readings of a part are computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadingEffort {
    /// Metres of a unit of the geometry, `[1e-9, 1e3]`.
    pub unit: f64,
    /// Rays are added until the standard error of every reading is below this share of its noise, `(0, 1]`.
    pub share: f64,
    /// Rays of one incidence whose scatterings are joined with the readings, at most.
    pub joined: u32,
    /// Rays of one incidence that are looked for in apertures, at most.
    pub met: u32,
    /// How far a ray is followed.
    pub limits: Limits,
}

impl Default for ReadingEffort {
    /// Metres, half the noise, 16 thousand joined, 4 million met.
    fn default() -> Self {
        ReadingEffort {
            unit: 1.0,
            share: 0.5,
            joined: 1 << 14,
            met: 1 << 22,
            limits: Limits {
                bounces: 1024,
                ..Limits::default()
            },
        }
    }
}

/// How well the readings of one path are known.
#[derive(Clone, Debug, PartialEq)]
pub struct MonteCarlo {
    /// Rays whose scatterings were joined with the readings.
    pub joined: u32,
    /// Rays that were looked for in apertures.
    pub met: u32,
    /// Standard error of each reading of the first output over the standard deviation of its noise.
    pub error_over_noise: Vec<f32>,
}

/// The records of a campaign, and how well each path over the sample is known, prescans included.
pub type Measured = (Vec<Scan>, Vec<MonteCarlo>);

/// Channels of a part.
pub const CHANNELS: [Channel; 3] = [Channel::Red, Channel::Green, Channel::Blue];

/// Measures a part as [`crate::simulate_watched`] measures a model: the middle of its window lies on the axis of the beam, its
/// plane `z = 0` where the holder puts the surface. Without outputs of its own the detector sees the luminance, as
/// `photopic`.
///
/// Of a part that repeats light is taken to leave where it fell on it.
///
/// # Errors
/// [`InstrumentError::Domain`] for a setting out of range, a part that does not repeat and is smaller than the spot where the
/// instrument does not allow it (`overfill`), and a period larger than the spot, of which readings would be of one place.
pub fn simulate_device(
    device: &Device,
    effort: &ReadingEffort,
    instrument: &Instrument,
    campaign: &Campaign,
    watch: impl FnMut(usize, usize) -> bool,
) -> Result<Option<Measured>, InstrumentError> {
    let domain = |field, found: String, allowed: &str| InstrumentError::Domain {
        field,
        found,
        allowed: allowed.into(),
    };
    if !(1e-9..=1e3).contains(&effort.unit) {
        return Err(domain("unit", format!("{} m", effort.unit), "1e-9 to 1000 m"));
    }
    if !(effort.share > 0.0 && effort.share <= 1.0) {
        return Err(domain("share", effort.share.to_string(), "above 0, at most 1"));
    }
    let [[x0, y0], [x1, y1]] = device.window.map(|corner| corner.map(f64::from));
    let size = [x1 - x0, y1 - y0].map(|x| x * effort.unit);
    let mut instrument = instrument.clone();
    if !device.cell.periodic {
        instrument.holder.outline = match instrument.holder.outline {
            Outline::Unbounded => Outline::Rectangle {
                width: size[0],
                height: size[1],
            },
            smaller => smaller,
        };
    } else if size[0].max(size[1]) > instrument.beam.spot_diameter {
        return Err(domain(
            "window",
            format!("a period of {} x {} mm", 1e3 * size[0], 1e3 * size[1]),
            &format!(
                "no more than the spot, {} mm",
                1e3 * instrument.beam.spot_diameter
            ),
        ));
    }
    if instrument.detector.outputs.is_empty() {
        let weights = (LUMINANCE / LUMINANCE.element_sum()).to_array().map(f64::from);
        instrument.detector.outputs = vec![Output {
            channel: Channel::Photopic,
            power: 1.0,
            weights: weights.to_vec(),
        }];
    }
    check(&instrument, campaign)?;
    let outputs = instrument.detector.outputs_for(&CHANNELS)?;
    let part = Part {
        device,
        effort,
        seed: campaign.seed,
        known: Mutex::default(),
    };
    let records = run(&part, &instrument, &outputs, campaign, watch)?;
    let known = part.known.into_inner().unwrap_or_else(|e| e.into_inner());
    Ok(records.map(|records| (records, known)))
}

/// A part on the holder.
struct Part<'a> {
    device: &'a Device,
    effort: &'a ReadingEffort,
    seed: u64,
    known: Mutex<Vec<MonteCarlo>>,
}

impl Specimen for Part<'_> {
    fn signal<'a>(
        &'a self,
        instrument: &'a Instrument,
        outputs: &'a [Output],
        wi: Direction,
    ) -> Box<dyn Signal + 'a> {
        let surface = instrument.holder.surface();
        Box::new(PartSignal {
            part: self,
            instrument,
            outputs,
            way: Way::new(wi, surface.z),
            surface,
        })
    }
}

/// A part lit from one direction.
struct PartSignal<'a> {
    part: &'a Part<'a>,
    instrument: &'a Instrument,
    outputs: &'a [Output],
    way: Way,
    surface: DVec3,
}

/// Independent sets of rays.
const REPLICATES: usize = 16;
/// Rays of each set at first.
const FIRST: u32 = 16;
/// Rays of each set that are looked for in apertures at first.
const FIRST_MET: u32 = 1024;
/// Readings that are computed together.
const BLOCK: usize = 64;

/// A ray of the beam on the part: where it meets the sample's plane, and what goes with it.
#[derive(Clone, Copy)]
struct Lit {
    /// Metres, in the sample's frame.
    x: DVec3,
    /// Towards the source.
    wi: DVec3,
    aperture: [f64; 2],
    time: f64,
}

/// Where light comes from to the readings.
struct Source {
    scattering: Scattering,
    lit: Lit,
    /// Metres, in the sample's frame.
    from: DVec3,
}

/// Sums over the rays of each set, `[set][reading]`, red, green and blue, and the rays of each set a reading.
struct Sums {
    sum: Vec<Vec<Vec3>>,
    rays: Vec<u32>,
}

impl Sums {
    fn new(readings: usize) -> Self {
        Sums {
            sum: vec![vec![Vec3::ZERO; readings]; REPLICATES],
            rays: vec![0; readings],
        }
    }

    /// Mean of a reading over all sets.
    fn mean(&self, j: usize) -> Vec3 {
        let sum: Vec3 = self.sum.iter().map(|s| s[j]).sum();
        sum / (self.rays[j].max(1) as f32 * REPLICATES as f32)
    }

    /// Square of the standard error of a mean, with these weights of the channels.
    fn square(&self, j: usize, weights: Vec3) -> f64 {
        let mean = weights.dot(self.mean(j));
        let per = 1.0 / self.rays[j].max(1) as f32;
        let squares = self.sum.iter().map(|s| (weights.dot(s[j]) * per - mean).powi(2));
        f64::from(squares.sum::<f32>()) / (REPLICATES * (REPLICATES - 1)) as f64
    }
}

impl PartSignal<'_> {
    /// Rays `range` of set `set`: those of the beam that fall on the sample, and what they are on the part. Rays beside it are left out.
    fn rays(&self, set: usize, range: std::ops::Range<u32>) -> (Vec<Lit>, Vec<Entering>) {
        let Instrument {
            beam,
            detector,
            holder,
            ..
        } = self.instrument;
        let seed = super::patches::seed(self.part.seed, set as u32);
        let mut numbers = Sampler::new(seed, u32::MAX, u32::MAX);
        let shift: [f32; 8] = std::array::from_fn(|_| numbers.one());
        let mut lit = Vec::new();
        let mut rays = Vec::new();
        for k in range {
            let u: [f64; 7] = shifted(k, &shift);
            let [sx, sy] = on_disk([u[0], u[1]]).map(|s| 0.5 * beam.spot_diameter.max(SMALLEST) * s);
            let x = self.way.lit(sx, sy);
            if !holder.holds(x) {
                continue;
            }
            let (bs, bc) = (std::f64::consts::TAU * u[3]).sin_cos();
            let chord = beam.profile.chord_of_share(u[2]);
            let Some(wi) = self.way.source(beam, detector.distance, x, chord, [bc, bs]) else {
                continue;
            };
            lit.push(Lit {
                x,
                wi: wi.vec(),
                aperture: on_disk([u[4], u[5]]),
                time: u[6] - 0.5,
            });
            rays.push(Entering {
                origin: self.before(x, wi.vec()),
                direction: -wi.vec().as_vec3(),
                sampler: Sampler::new(seed, 1, k),
            });
        }
        (lit, rays)
    }

    /// Where a ray through `x` of the sample's plane that comes from `from` meets the box of the part, in its frame.
    fn before(&self, x: DVec3, from: DVec3) -> Vec3 {
        let Device { cell, window, .. } = self.part.device;
        let z = match from.z > 0.0 {
            true => cell.high.z,
            false => cell.low.z,
        };
        let [low, high] = *window;
        let middle = DVec3::new(
            0.5 * f64::from(low[0] + high[0]),
            0.5 * f64::from(low[1] + high[1]),
            0.0,
        );
        let at = (x - self.surface) / self.part.effort.unit + middle;
        let at = at + (f64::from(z) - at.z) / from.z * from;
        let wrapped = |x: f64, low: f32, high: f32| match cell.periodic {
            true => f64::from(low) + (x - f64::from(low)).rem_euclid(f64::from(high - low)),
            false => x,
        };
        let (x, y) = (wrapped(at.x, low[0], high[0]), wrapped(at.y, low[1], high[1]));
        Vec3::new(x as f32, y as f32, z)
    }

    /// A point of the part's frame in that of the sample, metres; of a part that repeats, `fell`, where the light fell on it.
    fn place(&self, at: Vec3, fell: DVec3) -> DVec3 {
        let Device { cell, window, .. } = self.part.device;
        if cell.periodic {
            return fell;
        }
        let [low, high] = *window;
        let middle = 0.5 * (Vec3::new(low[0], low[1], 0.0) + Vec3::new(high[0], high[1], 0.0));
        self.surface + self.part.effort.unit * (at - middle).as_dvec3()
    }

    /// Where a ray passes the sample's plane, metres.
    fn passes(&self, at: DVec3, direction: DVec3) -> DVec3 {
        at + (self.surface.z - at.z) / direction.z * direction
    }

    /// Rays `range` of a set, as far as they are scattered.
    fn sources(&self, set: usize, range: std::ops::Range<u32>) -> Vec<Source> {
        let (lit, rays) = self.rays(set, range);
        let Part { device, effort, .. } = self.part;
        let mut found = Vec::new();
        device.scene.pass_heard(
            &device.cell,
            &rays,
            &effort.limits,
            &mut Vec::new(),
            &mut |scattering: Scattering| {
                let lit = lit[scattering.ray as usize];
                let from = self.place(scattering.point(), lit.x);
                found.push(Source {
                    scattering,
                    lit,
                    from,
                });
            },
        );
        found
    }

    /// What a reading has of a source: flux per unit solid angle of the aperture, seen from the middle.
    fn joined(&self, source: &Source, ws: Direction, (a, b): (DVec3, DVec3), travel: DVec3) -> Vec3 {
        let detector = &self.instrument.detector;
        let radius = detector.aperture.tan();
        let [u, v] = source.lit.aperture;
        let at = ws.vec() + radius * (u * a + v * b) + source.lit.time * travel;
        let way = detector.distance * at - source.from;
        let inverse = way.length_recip();
        let direction = way * inverse;
        let facing = direction.dot(ws.vec()) * (detector.distance * inverse).powi(2);
        let Part { device, .. } = self.part;
        let f = device
            .scene
            .scattered_to(&device.cell, &source.scattering, direction.as_vec3());
        f * facing as f32
    }

    /// Adds rays up to `goal` a set to the readings that are open.
    fn join(&self, sums: &mut Sums, open: &[usize], goal: u32, ws: &[Direction], travel: &[DVec3]) {
        let Some(first) = open.first().map(|j| sums.rays[*j]) else {
            return;
        };
        let sources: Vec<Vec<Source>> = (0..REPLICATES)
            .into_par_iter()
            .map(|set| self.sources(set, first..goal))
            .collect();
        let found: Vec<Vec<[Vec3; REPLICATES]>> = open
            .par_chunks(BLOCK)
            .map(|block| {
                let of = |j: &usize| {
                    let axes = ws[*j].vec().any_orthonormal_pair();
                    std::array::from_fn(|set| {
                        let each = sources[set].iter();
                        each.map(|s| self.joined(s, ws[*j], axes, travel[*j])).sum()
                    })
                };
                block.iter().map(of).collect()
            })
            .collect();
        for (j, sets) in open.iter().zip(found.iter().flatten()) {
            for (all, x) in sums.sum.iter_mut().zip(sets) {
                all[*j] += *x;
            }
            sums.rays[*j] = goal;
        }
    }

    /// Adds rays of the beam up to `goal` of each set to the open readings whose aperture they hit, and rays from these; whether any
    /// comes to the readings unscattered or from an ideal surface.
    fn meet(
        &self,
        sums: &mut Sums,
        apertures: &Apertures,
        open: &[usize],
        goal: u32,
        ways: &Ways<'_>,
    ) -> bool {
        let Some(first) = open.first().map(|j| sums.rays[*j]) else {
            return false;
        };
        let mut is_open = vec![false; sums.rays.len()];
        open.iter().for_each(|j| is_open[*j] = true);
        let any = AtomicBool::new(false);
        sums.sum.par_iter_mut().enumerate().for_each(|(set, sum)| {
            let mut from = first;
            while from < goal {
                let to = goal.min(from + 4096);
                if self.hit(set, from..to, apertures, &is_open, ways, sum) {
                    any.store(true, Ordering::Relaxed);
                }
                from = to;
            }
        });
        let any = any.into_inner() || first > 0;
        if any {
            let found: Vec<Vec<[Vec3; REPLICATES]>> = open
                .par_chunks(BLOCK)
                .map(|block| {
                    let each = block.iter();
                    each.map(|j| std::array::from_fn(|set| self.look(set, first..goal, *j, ways)))
                        .collect()
                })
                .collect();
            for (j, sets) in open.iter().zip(found.iter().flatten()) {
                sums.sum.iter_mut().zip(sets).for_each(|(all, x)| all[*j] += *x);
            }
        }
        open.iter().for_each(|j| sums.rays[*j] = goal);
        any
    }

    /// Rays `range` of a set from the beam; whether any left from an ideal surface or straight.
    fn hit(
        &self,
        set: usize,
        range: std::ops::Range<u32>,
        apertures: &Apertures,
        is_open: &[bool],
        ways: &Ways<'_>,
        sum: &mut [Vec3],
    ) -> bool {
        let Part { device, effort, .. } = self.part;
        let (lit, rays) = self.rays(set, range);
        let mut left: Vec<Leaving> = Vec::new();
        device
            .scene
            .pass_heard(&device.cell, &rays, &effort.limits, &mut left, &mut |_| ());
        let mut any = false;
        for ray in left.iter().filter(|ray| ray.ideal) {
            any = true;
            let lit = &lit[ray.ray as usize];
            let direction = ray.direction.as_dvec3();
            let from = self.place(ray.origin, lit.x);
            let y = self.passes(from, direction);
            apertures.hit(from, direction, lit.time, |j, at| {
                if !is_open[j] {
                    return;
                }
                let share = match ray.scattered {
                    true => 1.0,
                    false => {
                        let density = ways.beamlet.density(lit.x, lit.wi);
                        ways.beamlet
                            .forward_share(density, y, &To::new(y, at, ways.ws[j]))
                    }
                };
                sum[j] += ray.weight * share as f32 * apertures.per_solid_angle();
            });
        }
        any
    }

    /// Rays of a set from the aperture of reading `j`, one for [`FORWARD`] of those `range` from the beam.
    fn look(&self, set: usize, range: std::ops::Range<u32>, j: usize, ways: &Ways<'_>) -> Vec3 {
        let Part {
            device, effort, seed, ..
        } = self.part;
        let detector = &self.instrument.detector;
        let seed = super::patches::seed(*seed, set as u32);
        let mut numbers = Sampler::new(seed, u32::MAX - 1, j as u32);
        let shift: [f32; 5] = std::array::from_fn(|_| numbers.one());
        let ws = ways.ws[j];
        let (a, b) = ws.vec().any_orthonormal_pair();
        let radius = detector.aperture.tan();
        let mut to = Vec::new();
        let mut rays = Vec::new();
        for k in range.start / FORWARD..range.end / FORWARD {
            let u: [f64; 5] = shifted(k, &shift);
            let y = ways.beamlet.point(on_disk([u[0], u[1]]));
            let [s, t] = on_disk([u[2], u[3]]);
            let at = ws.vec() + radius * (s * a + t * b) + (u[4] - 0.5) * ways.travel[j];
            let way = To::new(y, detector.distance * at, ws);
            rays.push(Entering {
                origin: self.before(y, way.direction),
                direction: -way.direction.as_vec3(),
                sampler: Sampler::new(seed ^ 0x5bd1_e995, j as u32, k),
            });
            to.push((y, way));
        }
        let mut left: Vec<Leaving> = Vec::new();
        device
            .scene
            .pass_ideal(&device.cell, &rays, &effort.limits, &mut left);
        left.iter()
            .map(|ray| {
                let (y, way) = &to[ray.ray as usize];
                let wi = ray.direction.as_dvec3();
                let x = self.passes(self.place(ray.origin, *y), wi);
                let density = match wi.dot(self.way.through()) < 0.0 {
                    true => ways.beamlet.density(x, wi),
                    false => 0.0,
                };
                // Rays are counted as those of the beam.
                let found = ways.beamlet.backward(density, *y, way) * f64::from(FORWARD);
                ray.weight * found as f32
            })
            .sum()
    }
}

/// What goes from the beam to the readings without being scattered.
struct Ways<'a> {
    beamlet: Beamlet<'a>,
    ws: &'a [Direction],
    travel: &'a [DVec3],
}

impl Signal for PartSignal<'_> {
    fn all(&self, ws: &[Direction], travel: &[DVec3]) -> Vec<Vec<f64>> {
        let effort = self.part.effort;
        let detector = &self.instrument.detector;
        let (mut joined, mut met) = (Sums::new(ws.len()), Sums::new(ws.len()));
        let apertures = Apertures::new(detector, ws, travel);
        let sets = REPLICATES as u32;
        let most = [
            effort.joined.div_ceil(sets).max(FIRST),
            effort.met.div_ceil(sets).next_multiple_of(FORWARD).max(FIRST_MET),
        ];
        let power = self.instrument.beam.power;
        let output = &self.outputs[0];
        let weights = Vec3::from_slice(&[0, 1, 2].map(|k| output.weights[k] as f32));
        let scale = power * output.power;
        // Squares of the errors over that of the noise, of light that is scattered to a reading and that meets it.
        let state = |joined: &Sums, met: &Sums, j: usize| {
            let signal = scale * f64::from(weights.dot(joined.mean(j) + met.mean(j)));
            let range = detector.range(signal + detector.dark_level);
            let noise = (detector.noise(range.noise_readout, signal) / scale)
                .powi(2)
                .max(1e-12 * (signal / scale).powi(2))
                .max(f64::MIN_POSITIVE);
            [joined.square(j, weights) / noise, met.square(j, weights) / noise]
        };
        let all: Vec<usize> = (0..ws.len()).collect();
        let cell = &self.part.device.cell;
        // Light leaves a part that stands alone beside where it fell on it, by some of its thickness.
        let margin = match cell.periodic {
            true => 0.0,
            false => 2.0 * effort.unit * f64::from(cell.high.z - cell.low.z),
        };
        let ways = Ways {
            beamlet: Beamlet::new(self.instrument, &self.way, margin),
            ws,
            travel,
        };
        let mut goal = [FIRST, FIRST_MET];
        self.join(&mut joined, &all, goal[0], ws, travel);
        let ideal = self.meet(&mut met, &apertures, &all, goal[1], &ways);
        let limit = effort.share * effort.share;
        loop {
            let states: Vec<[f64; 2]> = all.iter().map(|j| state(&joined, &met, *j)).collect();
            let far = |j: &usize| states[*j][0] + states[*j][1] > limit;
            let open: Vec<usize> = all
                .iter()
                .copied()
                .filter(|j| far(j) && states[*j][0] > 0.3 * limit && joined.rays[*j] == goal[0])
                .collect();
            let more = goal[0] < most[0] && !open.is_empty();
            let unmet: Vec<usize> = all
                .iter()
                .copied()
                .filter(|j| far(j) && states[*j][1] > 0.3 * limit && met.rays[*j] == goal[1])
                .collect();
            let again = ideal && goal[1] < most[1] && !unmet.is_empty();
            if more {
                goal[0] = (4 * goal[0]).min(most[0]);
                self.join(&mut joined, &open, goal[0], ws, travel);
            }
            if again {
                goal[1] = (4 * goal[1]).min(most[1]);
                self.meet(&mut met, &apertures, &unmet, goal[1], &ways);
            }
            if !(more || again) {
                let known = MonteCarlo {
                    joined: sets * goal[0],
                    met: sets * goal[1],
                    error_over_noise: states.iter().map(|s| (s[0] + s[1]).sqrt() as f32).collect(),
                };
                self.part
                    .known
                    .lock()
                    .unwrap_or_else(|e| e.into_inner())
                    .push(known);
                break;
            }
        }
        let channels: Vec<Vec<f64>> = (0..3)
            .map(|c| {
                let of = |j: &usize| power * f64::from((joined.mean(*j) + met.mean(*j))[c]);
                all.iter().map(of).collect()
            })
            .collect();
        self.outputs.iter().map(|o| mixed(o, &channels)).collect()
    }
}
