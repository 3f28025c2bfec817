//! Readings of a part that exists as geometry: rays from the beam through it to the detector.
//!
//! Light arrives in two ways. From where a surface scatters it, it goes straight to the aperture: every scattering of a ray is
//! joined with every reading. What a mirror or refraction sends out, or what comes straight through, is seen by the readings
//! whose aperture it happens to hit; where it was never scattered, rays from the apertures find it too ([`super::beamlet`]). All are
//! means over independent sets of rays, whose scatter is the error; more rays follow until it is below the noise of the instrument.

use std::sync::Mutex;

use glam::Vec3;
use gonio_bsdf::Channel;
use gonio_geom::{DVec3, Direction};
use gonio_scan::Scan;
use gonio_trace::accumulate::LUMINANCE;
use gonio_trace::path::Limits;

use super::Device;
use super::apertures::Apertures;
use super::beamlet::{Beamlet, FORWARD};
use super::contributions::Ways;
use super::part::{Part, PartSignal};
use super::sums::{REPLICATES, Sums};
use crate::campaign::run;
use crate::campaign_check::check;
use crate::signal::{Signal, Specimen, mixed};
use crate::way::Way;
use crate::{Campaign, Instrument, InstrumentError, Outline, Output};

/// How the readings of a part are computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadingEffort {
    /// Metres of a unit of the geometry, `[1e-9, 1e3]`.
    pub unit: f64,
    /// Rays are added until the standard error of every reading is below this share of its noise, `(0, 1]`.
    pub share: f64,
    /// Scatterings of one incidence that are joined with the readings, at most; they stand for those of 64 times as many rays. No more
    /// than 2^24 are.
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

/// Rays of each set at first.
const FIRST: u32 = 16;
/// Joined, of all sets: the rays behind them are counted in 32 bits.
const MOST_JOINED: u32 = 1 << 24;
/// Rays of each set that are looked for in apertures at first.
const FIRST_MET: u32 = 1024;
impl Signal for PartSignal<'_> {
    fn all(&self, ws: &[Direction], travel: &[DVec3]) -> Vec<Vec<f64>> {
        let effort = self.part.effort;
        let detector = &self.instrument.detector;
        let (mut joined, mut met) = (Sums::new(ws.len()), Sums::new(ws.len()));
        let apertures = Apertures::new(detector, ws, travel);
        let sets = REPLICATES as u32;
        let most = [
            effort.joined.min(MOST_JOINED).div_ceil(sets).max(FIRST),
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
