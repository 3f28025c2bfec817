//! A measurement campaign: dark, beam and sample records in the order they are taken.

use gonio_bsdf::{Bsdf, Quantity};
use gonio_geom::{Angles, Component, DVec3, Direction};
use gonio_scan::{Scan, ScanKind, ScanMeta};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::beam_signal::BeamSignal;
use crate::error::in_range;
use crate::path::beam_raster;
use crate::readout::{pointed, read, recorded};
use crate::signal::{SampleSignal, Signal, Specimen};
use crate::{Around, Beam, Detector, DetectorPath, Holder, InstrumentError, Lamp, Output, Region};

/// The virtual goniophotometer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Instrument {
    /// The lamp.
    pub lamp: Lamp,
    /// The beam.
    pub beam: Beam,
    /// The sample holder.
    pub holder: Holder,
    /// The detector.
    pub detector: Detector,
    /// The way of the detector over a sample.
    pub path: DetectorPath,
}

/// What to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Campaign {
    /// Directions of incidence, none within a degree of the sample plane.
    pub incidences: Vec<Angles>,
    /// Hemispheres to scan, relative to the side of incidence.
    pub components: Vec<Component>,
    /// Seed of the path, the noise and the drift: the same seed gives the same records.
    pub seed: u64,
    /// Number of reference scans of the bare beam, `1..=100`.
    pub beam_scans: usize,
    /// Readings with closed shutter before and after each record, `1..=1_000_000`.
    pub dark_readings: usize,
    /// Sample name written into the records.
    pub sample_name: Option<String>,
    /// Begin of the campaign, ISO 8601, written into the records; their times count from it.
    pub started: Option<String>,
}

impl Default for Campaign {
    /// 8, 20, 35, 50, 60, 70, 75 degrees in reflection, seed 1, three beam scans, 1000 dark readings each.
    fn default() -> Self {
        Campaign {
            incidences: [8.0, 20.0, 35.0, 50.0, 60.0, 70.0, 75.0]
                .map(|theta| Angles::from_degrees(theta, 0.0))
                .to_vec(),
            components: vec![Component::Reflection],
            seed: 1,
            beam_scans: 3,
            dark_readings: 1000,
            sample_name: None,
            started: None,
        }
    }
}

/// Measures `model`: dark, beam scans, dark, then each incidence followed by a dark record, every channel of the
/// model read at once. Records of one time come channel by channel. Beam scans are rasters fine enough for their sum
/// to be exact within 1e-4 but for noise: pitch .15 of the narrower of beam and aperture.
///
/// # Errors
/// [`InstrumentError::Domain`] for a setting out of range and a model whose ideal part ([`Bsdf::delta`]) is refracted:
/// only mirrored and unbent beams keep their focus on the detector sphere.
pub fn simulate(
    model: &dyn Bsdf,
    instrument: &Instrument,
    campaign: &Campaign,
) -> Result<Vec<Scan>, InstrumentError> {
    let records = simulate_watched(model, instrument, campaign, |_, _| true)?;
    Ok(records.unwrap_or_default())
}

/// [`simulate`] that calls `watch` with the number of incidences that are done and that there are, before the first and
/// after each; where `watch` returns false the campaign ends, and there are no records.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_watched(
    model: &dyn Bsdf,
    instrument: &Instrument,
    campaign: &Campaign,
    watch: impl FnMut(usize, usize) -> bool,
) -> Result<Option<Vec<Scan>>, InstrumentError> {
    check_model(model, instrument, campaign)?;
    let outputs = instrument.detector.outputs_for(model.channels())?;
    run(&model, instrument, &outputs, campaign, watch)
}

/// Dark, beam and sample records of a specimen; the settings are checked.
pub(crate) fn run(
    specimen: &dyn Specimen,
    instrument: &Instrument,
    outputs: &[Output],
    campaign: &Campaign,
    mut watch: impl FnMut(usize, usize) -> bool,
) -> Result<Option<Vec<Scan>>, InstrumentError> {
    let total = campaign.incidences.len();
    if !watch(0, total) {
        return Ok(None);
    }
    let mut session = Session::begun(instrument, outputs, campaign);
    session.reference();
    for (k, &incidence) in campaign.incidences.iter().enumerate() {
        session.sample(specimen, incidence);
        session.dark(incidence);
        if !watch(k + 1, total) {
            return Ok(None);
        }
    }
    Ok(Some(session.records))
}

/// Checks a campaign with a model.
pub(crate) fn check_model(
    model: &dyn Bsdf,
    instrument: &Instrument,
    campaign: &Campaign,
) -> Result<(), InstrumentError> {
    check(instrument, campaign)?;
    if campaign.incidences.iter().any(|i| refracts(model, i.direction())) {
        return Err(InstrumentError::Domain {
            field: "model",
            found: "an ideal part that bends the beam (refraction)".into(),
            allowed: "scattering of finite width, mirrored and unbent beams".into(),
        });
    }
    Ok(())
}

/// Directions to be read for one incidence.
pub(crate) struct Trial {
    pub(crate) incidence: Angles,
    pub(crate) directions: Vec<Direction>,
}

/// Records of the beam, of the dark and of each trial in turn, whatever the path of the instrument, as one campaign without dark
/// records between the trials.
pub(crate) fn trials(
    model: &dyn Bsdf,
    instrument: &Instrument,
    campaign: &Campaign,
    trials: Vec<Trial>,
) -> Result<Vec<Scan>, InstrumentError> {
    let outputs = instrument.detector.outputs_for(model.channels())?;
    let mut session = Session::begun(instrument, &outputs, campaign);
    session.reference();
    let begin = session.clock;
    for trial in trials {
        // Trials are alternatives: each is the first after the scans of the beam, with the same noise.
        (session.clock, session.streams) = (begin, TRIAL);
        let wi = instrument.holder.to_sample(trial.incidence.direction());
        let image = SampleSignal::new(model, instrument, &outputs, wi);
        let angles = trial.directions.into_iter().map(recorded).collect();
        let mut rng = session.stream();
        session.read_sample(&image, trial.incidence, angles, &mut rng);
    }
    Ok(session.records)
}

/// Stream of trials.
const TRIAL: u64 = 1 << 20;

/// Seconds of a campaign beside the readings of the sample.
pub(crate) fn overhead(instrument: &Instrument, campaign: &Campaign) -> f64 {
    let one = [Output {
        channel: gonio_bsdf::Channel::Photopic,
        power: 1.0,
        weights: vec![1.0],
    }];
    let mut session = Session::begun(instrument, &one, campaign);
    session.reference();
    let dark = campaign.dark_readings as f64 / instrument.detector.rate + CHANGE;
    session.clock + campaign.incidences.len() as f64 * (CHANGE + dark)
}

pub(crate) fn check(instrument: &Instrument, campaign: &Campaign) -> Result<(), InstrumentError> {
    instrument.lamp.check()?;
    instrument.beam.check()?;
    instrument.detector.check()?;
    instrument.holder.check(instrument.detector.distance)?;
    instrument.path.check()?;
    let domain = |field, found: String, allowed: &str| InstrumentError::Domain {
        field,
        found,
        allowed: allowed.into(),
    };
    if campaign.incidences.is_empty() {
        return Err(domain("incidences", "none".into(), "at least one"));
    }
    for incidence in &campaign.incidences {
        let (theta, phi) = incidence.to_degrees();
        let above = (90.0 - theta).abs();
        if !(phi.is_finite() && above >= 1.0) {
            return Err(domain(
                "incidences",
                format!("theta_i = {theta} degrees, phi_i = {phi} degrees"),
                "theta_i of 0 to 89 or 91 to 180 degrees, finite phi_i",
            ));
        }
        instrument
            .holder
            .check_spot(instrument.beam.spot_diameter, *incidence)?;
        if let Some(table) = &instrument.path.table
            && table.of(incidence.direction()).is_none()
        {
            return Err(domain(
                "incidences",
                format!("theta_i = {theta} degrees, phi_i = {phi} degrees"),
                "incidences of the path's table",
            ));
        }
    }
    let twice = campaign.components.len() == 2 && campaign.components[0] == campaign.components[1];
    if campaign.components.is_empty() || campaign.components.len() > 2 || twice {
        return Err(domain(
            "components",
            format!("{:?}", campaign.components),
            "reflection, transmission or both, each once",
        ));
    }
    in_range("beam_scans", campaign.beam_scans as f64, 1.0, 100.0, "")?;
    in_range("dark_readings", campaign.dark_readings as f64, 1.0, 1e6, "")
}

/// Whether light from `wi` is passed on unscattered in a direction that is neither the mirror nor the through direction.
fn refracts(model: &dyn Bsdf, wi: Direction) -> bool {
    let mut shares = vec![0.0; model.channels().len()];
    [
        (Component::Reflection, wi.mirror()),
        (Component::Transmission, wi.through()),
    ]
    .into_iter()
    .any(|(component, straight)| {
        model
            .delta(wi, component, &mut shares)
            .is_some_and(|to| to.angle_to(straight) > 1e-6)
    })
}

/// What the instrument knows of itself and writes into every record.
fn meta(instrument: &Instrument, campaign: &Campaign) -> ScanMeta {
    ScanMeta {
        sample_name: campaign.sample_name.clone(),
        instrument: Some("gonio virtual goniophotometer".into()),
        distance: Some(instrument.detector.distance),
        receiver_solid_angle: Some(instrument.detector.solid_angle()),
        beam_diameter: Some(instrument.beam.spot_diameter),
        saturation: Some(instrument.detector.highest()),
        started: campaign.started.clone(),
        ..ScanMeta::default()
    }
}

/// Seconds to drive to the next start.
const CHANGE: f64 = 10.0;

/// Times are recorded to the microsecond.
fn microseconds(seconds: f64) -> f64 {
    (seconds * 1e6).round() / 1e6
}

/// The state of a running campaign.
struct Session<'a> {
    instrument: &'a Instrument,
    outputs: &'a [Output],
    campaign: &'a Campaign,
    meta: ScanMeta,
    /// Seconds since the campaign began.
    clock: f64,
    /// Phase of the dark level's swing.
    phase: f64,
    records: Vec<Scan>,
    streams: u64,
}

/// Stream `k` of a campaign's seed. The seed is hashed: streams of a generator whose states lie close are correlated.
pub(crate) fn random_stream(seed: u64, k: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(k))
}

/// First stream of the lamp, beyond those of the records.
const LAMP: u64 = 1 << 40;

impl<'a> Session<'a> {
    fn begun(instrument: &'a Instrument, outputs: &'a [Output], campaign: &'a Campaign) -> Self {
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
    fn reference(&mut self) {
        let straight = Angles { theta: 0.0, phi: 0.0 };
        self.dark(straight);
        for _ in 0..self.campaign.beam_scans {
            self.beam(&self.instrument.beam, straight);
        }
        self.dark(straight);
    }

    /// A random stream of its own for the next record.
    fn stream(&mut self) -> Pcg64 {
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
    fn dark(&mut self, incidence: Angles) {
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
    fn sample(&mut self, specimen: &dyn Specimen, incidence: Angles) {
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
    fn read_sample(&mut self, image: &dyn Signal, incidence: Angles, angles: Vec<Angles>, rng: &mut Pcg64) {
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
