//! A running campaign: its clock, its random streams and the records that it files.

use gonio_bsdf::Quantity;
use gonio_geom::{Angles, Component, DVec3, Direction};
use gonio_scan::{Scan, ScanKind, ScanMeta};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::beam_signal::BeamSignal;
use crate::path::beam_raster;
use crate::readout::{pointed, read, recorded};
use crate::signal::{Signal, Specimen};
use crate::{Around, Beam, Campaign, Detector, DetectorPath, Instrument, Lamp, Output, Region};

/// What the instrument knows of itself and writes into every record.
fn meta(instrument: &Instrument, campaign: &Campaign) -> ScanMeta {
    ScanMeta {
        sample_name: campaign.sample_name.clone(),
        instrument: Some("gonio virtual goniophotometer".into()),
        distance: Some(instrument.detector.distance),
        receiver_solid_angle: Some(instrument.detector.solid_angle()),
        beam_diameter: Some(instrument.beam.spot_diameter),
        integration: (instrument.detector.integration > 0.0).then_some(instrument.detector.integration),
        saturation: Some(instrument.detector.highest()),
        started: campaign.started.clone(),
        ..ScanMeta::default()
    }
}

/// Seconds to drive to the next start.
pub(crate) const CHANGE: f64 = 10.0;

/// Times are recorded to the microsecond.
fn microseconds(seconds: f64) -> f64 {
    (seconds * 1e6).round() / 1e6
}

/// The state of a running campaign.
pub(crate) struct Session<'a> {
    pub(crate) instrument: &'a Instrument,
    pub(crate) outputs: &'a [Output],
    campaign: &'a Campaign,
    meta: ScanMeta,
    /// Seconds since the campaign began.
    pub(crate) clock: f64,
    /// Phase of the dark level's swing.
    phase: f64,
    pub(crate) records: Vec<Scan>,
    pub(crate) streams: u64,
}

/// Stream `k` of a campaign's seed. The seed is hashed: streams of a generator whose states lie close are correlated.
pub(crate) fn random_stream(seed: u64, k: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(k))
}

/// First stream of the lamp, beyond those of the records.
const LAMP: u64 = 1 << 40;

impl<'a> Session<'a> {
    pub(crate) fn begun(instrument: &'a Instrument, outputs: &'a [Output], campaign: &'a Campaign) -> Self {
        Session {
            instrument,
            outputs,
            campaign,
            meta: meta(instrument, campaign),
            clock: 0.0,
            phase: random_stream(campaign.seed, 0).random_range(0.0..std::f64::consts::TAU),
            records: Vec::new(),
            streams: 0,
        }
    }

    /// Dark, scans of the bare beam, dark. No sample: the beam goes straight through from the front.
    pub(crate) fn reference(&mut self) {
        let straight = Angles { theta: 0.0, phi: 0.0 };
        self.dark(straight);
        for _ in 0..self.campaign.beam_scans {
            self.beam(&self.instrument.beam, straight);
        }
        self.dark(straight);
    }

    /// A random stream of its own for the next record.
    pub(crate) fn stream(&mut self) -> Pcg64 {
        self.streams += 1;
        random_stream(self.campaign.seed, self.streams)
    }

    /// When the readings at `angles` are taken, seconds since the campaign began: at the sampling rate, or later where the
    /// detector needs longer to get there.
    fn times(&self, angles: &[Angles]) -> Vec<f64> {
        let detector = &self.instrument.detector;
        let Some(speed) = detector.speed else {
            return (0..angles.len())
                .map(|j| microseconds(self.clock + j as f64 / detector.rate))
                .collect();
        };
        let mut now = self.clock;
        let mut before: Option<Direction> = None;
        angles
            .iter()
            .map(|a| {
                let d = a.direction();
                now += before.map_or(0.0, |b| (b.angle_to(d) / speed).max(1.0 / detector.rate));
                before = Some(d);
                microseconds(now)
            })
            .collect()
    }

    /// Reads the noise-free `signals` (row = output) at the recorded `angles` and files one record an output. The closed
    /// shutter of a dark record hides the lamp.
    fn file(
        &mut self,
        kind: ScanKind,
        incidence: Angles,
        angles: &[Angles],
        signals: &[Vec<f64>],
        rng: &mut Pcg64,
    ) {
        let detector = &self.instrument.detector;
        let time = self.times(angles);
        let flux = if self.instrument.lamp == Lamp::default() {
            vec![1.0; time.len()]
        } else {
            let mut lamp = random_stream(self.campaign.seed, LAMP + self.streams);
            self.instrument.lamp.flux(&time, &mut lamp)
        };
        for (output, signal) in self.outputs.iter().zip(signals) {
            let value = signal
                .iter()
                .zip(time.iter().zip(&flux))
                .map(|(&s, (&t, &l))| read(detector, s * l, detector.dark(t, self.phase), rng))
                .collect();
            self.records.push(Scan {
                kind,
                quantity: Quantity::Signal,
                channel: output.channel,
                incidence,
                theta_s: angles.iter().map(|a| a.theta).collect(),
                phi_s: angles.iter().map(|a| a.phi).collect(),
                value,
                time: Some(time.clone()),
                meta: self.meta.clone(),
            });
        }
        let end = time.last().copied().unwrap_or(self.clock) + 1.0 / detector.rate;
        self.clock = end + CHANGE;
    }

    /// Closed shutter, the detector parked at the front normal.
    pub(crate) fn dark(&mut self, incidence: Angles) {
        let mut rng = self.stream();
        let n = self.campaign.dark_readings;
        let parked = vec![Angles { theta: 0.0, phi: 0.0 }; n];
        let signals = vec![vec![0.0; n]; self.outputs.len()];
        self.file(ScanKind::Dark, incidence, &parked, &signals, &mut rng);
    }

    /// Raster over the bare beam.
    fn beam(&mut self, beam: &Beam, incidence: Angles) {
        let mut rng = self.stream();
        let wi = incidence.direction();
        let Detector {
            distance, aperture, ..
        } = self.instrument.detector;
        let spot = beam.spot_on_sphere(distance);
        let pitch = 0.15 * beam.profile.width().max(spot).min(aperture);
        let half = beam.profile.reach() + aperture + spot + 2.0 * pitch;
        let angles: Vec<Angles> = beam_raster(wi.through(), half, pitch, &mut rng)
            .into_iter()
            .map(recorded)
            .collect();
        let at = self.true_directions(&angles, &mut rng);
        let travel = self.travel(&angles);
        let image = BeamSignal::new(beam, &self.instrument.detector, wi.through());
        let signal: Vec<f64> = at
            .par_iter()
            .zip(&travel)
            .map(|(&ws, &t)| image.moving(ws, t))
            .collect();
        let signals: Vec<Vec<f64>> = self
            .outputs
            .iter()
            .map(|o| signal.iter().map(|s| o.power * s).collect())
            .collect();
        self.file(ScanKind::Beam, incidence, &angles, &signals, &mut rng);
    }

    /// The sample at one incidence.
    pub(crate) fn sample(&mut self, specimen: &dyn Specimen, incidence: Angles) {
        let mut rng = self.stream();
        let instrument = self.instrument;
        let wi = incidence.direction();
        let to_sample = |d: &Direction| instrument.holder.to_sample(*d);
        let image = specimen.signal(instrument, self.outputs, to_sample(&wi));
        let mut angles = Vec::new();
        for &component in &self.campaign.components {
            let found = self.prescan(image.as_ref(), wi, component, &mut rng);
            angles.extend(
                instrument
                    .path
                    .directions(wi, component, instrument.detector.shadow, &found, &mut rng)
                    .into_iter()
                    .map(recorded),
            );
        }
        self.read_sample(image.as_ref(), incidence, angles, &mut rng);
    }

    /// Reads the sample at `angles`.
    pub(crate) fn read_sample(
        &mut self,
        image: &dyn Signal,
        incidence: Angles,
        angles: Vec<Angles>,
        rng: &mut Pcg64,
    ) {
        let instrument = self.instrument;
        let to_sample = |d: &Direction| instrument.holder.to_sample(*d);
        let at: Vec<Direction> = self.true_directions(&angles, rng).iter().map(to_sample).collect();
        let travel: Vec<DVec3> = self
            .travel(&angles)
            .into_iter()
            .map(|t| {
                let turned = Direction::new(t).map(|d| instrument.holder.to_sample(d));
                turned.map_or(DVec3::ZERO, |d| t.length() * d.vec())
            })
            .collect();
        let signals = image.all(&at, &travel);
        self.file(ScanKind::Sample, incidence, &angles, &signals, rng);
    }

    /// Regions around the peaks of a fast scan, its first output; the clock goes on, the readings are not kept.
    fn prescan(
        &mut self,
        image: &dyn Signal,
        wi: Direction,
        component: Component,
        rng: &mut Pcg64,
    ) -> Vec<Region> {
        let instrument = self.instrument;
        let Some(prescan) = instrument.path.prescan else {
            return Vec::new();
        };
        let fast = DetectorPath {
            pitch_across: prescan.pitch,
            pitch_along: prescan.pitch,
            theta_max: instrument.path.theta_max,
            patch: None,
            ..DetectorPath::default()
        };
        let shadow = instrument.detector.shadow;
        let angles: Vec<Angles> = fast
            .directions(wi, component, shadow, &[], rng)
            .into_iter()
            .map(recorded)
            .collect();
        let at: Vec<Direction> = angles.iter().map(|a| a.direction()).collect();
        let turned: Vec<Direction> = at.iter().map(|d| instrument.holder.to_sample(*d)).collect();
        let signals = image.all(&turned, &vec![DVec3::ZERO; at.len()]);
        let detector = &instrument.detector;
        let times = self.times(&angles);
        let value: Vec<f64> = signals
            .iter()
            .take(1)
            .flatten()
            .zip(&times)
            .map(|(&s, &t)| {
                let dark = detector.dark(t, self.phase);
                read(detector, s, dark, rng) - dark
            })
            .collect();
        self.clock = times.last().copied().unwrap_or(self.clock) + CHANGE;
        let sigma = detector.range(detector.dark_level).noise_readout;
        let known = instrument.path.refined(wi, component);
        prescan
            .peaks(&at, &value, sigma, &known)
            .into_iter()
            .map(|peak| Region {
                around: Around::At(peak.angles()),
                patch: prescan.patch,
            })
            .collect()
    }

    /// The way of the detector during each reading as a chord of the unit sphere: the share of the shorter of the steps
    /// before and after it during which the reading lasts.
    fn travel(&self, angles: &[Angles]) -> Vec<DVec3> {
        let share = self.instrument.detector.integration;
        if share == 0.0 {
            return vec![DVec3::ZERO; angles.len()];
        }
        let at: Vec<DVec3> = angles.iter().map(|a| a.direction().vec()).collect();
        let step = |j: usize| Some(*at.get(j + 1)? - *at.get(j)?);
        (0..at.len())
            .map(|j| {
                let before = j.checked_sub(1).and_then(step);
                let both = [before, step(j)].into_iter().flatten();
                let shorter = both.min_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
                share * shorter.unwrap_or(DVec3::ZERO)
            })
            .collect()
    }

    /// Where the detector stands when it records `angles`.
    fn true_directions(&self, angles: &[Angles], rng: &mut Pcg64) -> Vec<Direction> {
        angles
            .iter()
            .map(|a| pointed(&self.instrument.detector, a.direction(), rng))
            .collect()
    }
}
