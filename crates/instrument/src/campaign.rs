//! A measurement campaign: dark, beam and sample records in the order they are taken.

use gonio_bsdf::{Bsdf, Channel, Quantity};
use gonio_geom::{Angles, Component, Direction};
use gonio_scan::{Scan, ScanKind, ScanMeta};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::error::in_range;
use crate::path::beam_raster;
use crate::readout::{Columns, pointed, read, recorded};
use crate::signal::{BeamSignal, SampleSignal};
use crate::{Beam, Detector, DetectorPath, InstrumentError};

/// The virtual goniophotometer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instrument {
    /// The beam.
    pub beam: Beam,
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
    check(instrument, campaign)?;
    if campaign.incidences.iter().any(|i| refracts(model, i.direction())) {
        return Err(InstrumentError::Domain {
            field: "model",
            found: "an ideal part that bends the beam (refraction)".into(),
            allowed: "scattering of finite width, mirrored and unbent beams".into(),
        });
    }
    let mut session = Session {
        detector: instrument.detector,
        channels: model.channels().to_vec(),
        campaign,
        meta: meta(instrument, campaign),
        clock: 0.0,
        phase: random_stream(campaign.seed, 0).random_range(0.0..std::f64::consts::TAU),
        records: Vec::new(),
        streams: 0,
    };
    // No sample: the beam goes straight through from the front.
    let straight = Angles { theta: 0.0, phi: 0.0 };
    session.dark(straight);
    for _ in 0..campaign.beam_scans {
        session.beam(&instrument.beam, straight);
    }
    session.dark(straight);
    for &incidence in &campaign.incidences {
        session.sample(model, instrument, incidence);
        session.dark(incidence);
    }
    Ok(session.records)
}

fn check(instrument: &Instrument, campaign: &Campaign) -> Result<(), InstrumentError> {
    instrument.beam.check()?;
    instrument.detector.check()?;
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
        saturation: Some(instrument.detector.saturation),
        started: campaign.started.clone(),
        ..ScanMeta::default()
    }
}

/// Times are recorded to the microsecond.
fn microseconds(seconds: f64) -> f64 {
    (seconds * 1e6).round() / 1e6
}

/// The state of a running campaign.
struct Session<'a> {
    detector: Detector,
    channels: Vec<Channel>,
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
fn random_stream(seed: u64, k: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(k))
}

impl Session<'_> {
    /// A random stream of its own for the next record.
    fn stream(&mut self) -> Pcg64 {
        self.streams += 1;
        random_stream(self.campaign.seed, self.streams)
    }

    /// Reads the noise-free `signals` (row = channel) at the recorded `angles` and files one record a channel.
    fn file(
        &mut self,
        kind: ScanKind,
        incidence: Angles,
        angles: &[Angles],
        signals: &[Vec<f64>],
        rng: &mut Pcg64,
    ) {
        let time: Vec<f64> = (0..angles.len())
            .map(|j| microseconds(self.clock + j as f64 / self.detector.rate))
            .collect();
        for (k, signal) in signals.iter().enumerate() {
            let value = signal
                .iter()
                .zip(&time)
                .map(|(&s, &t)| read(&self.detector, s, self.detector.dark(t, self.phase), rng))
                .collect();
            let columns = Columns {
                theta_s: angles.iter().map(|a| a.theta).collect(),
                phi_s: angles.iter().map(|a| a.phi).collect(),
                value,
                time: time.clone(),
            };
            self.records.push(Scan {
                kind,
                quantity: Quantity::Signal,
                channel: self.channels[k],
                incidence,
                theta_s: columns.theta_s,
                phi_s: columns.phi_s,
                value: columns.value,
                time: Some(columns.time),
                meta: self.meta.clone(),
            });
        }
        // Ten seconds to drive to the next start.
        self.clock += angles.len() as f64 / self.detector.rate + 10.0;
    }

    /// Closed shutter, the detector parked at the front normal.
    fn dark(&mut self, incidence: Angles) {
        let mut rng = self.stream();
        let n = self.campaign.dark_readings;
        let parked = vec![Angles { theta: 0.0, phi: 0.0 }; n];
        let signals = vec![vec![0.0; n]; self.channels.len()];
        self.file(ScanKind::Dark, incidence, &parked, &signals, &mut rng);
    }

    /// Raster over the bare beam.
    fn beam(&mut self, beam: &Beam, incidence: Angles) {
        let mut rng = self.stream();
        let wi = incidence.direction();
        let pitch = 0.15 * beam.profile.width().min(self.detector.aperture);
        let half = beam.profile.reach() + self.detector.aperture + 2.0 * pitch;
        let angles: Vec<Angles> = beam_raster(wi.through(), half, pitch, &mut rng)
            .into_iter()
            .map(recorded)
            .collect();
        let at = self.true_directions(&angles, &mut rng);
        let image = BeamSignal::new(beam, &self.detector, wi.through());
        let signal: Vec<f64> = at.par_iter().map(|&ws| image.at(ws)).collect();
        let signals = vec![signal; self.channels.len()];
        self.file(ScanKind::Beam, incidence, &angles, &signals, &mut rng);
    }

    /// The sample at one incidence.
    fn sample(&mut self, model: &dyn Bsdf, instrument: &Instrument, incidence: Angles) {
        let mut rng = self.stream();
        let wi = incidence.direction();
        let mut angles = Vec::new();
        for &component in &self.campaign.components {
            angles.extend(
                instrument
                    .path
                    .directions(wi, component, self.detector.shadow, &mut rng)
                    .into_iter()
                    .map(recorded),
            );
        }
        let at = self.true_directions(&angles, &mut rng);
        let image = SampleSignal::new(model, &instrument.beam, &self.detector, wi);
        let n = self.channels.len();
        let flat: Vec<f64> = at
            .par_iter()
            .with_min_len(256)
            .flat_map_iter(|&ws| {
                let (mut scratch, mut out) = (vec![0.0; n], vec![0.0; n]);
                image.at(ws, &mut scratch, &mut out);
                out
            })
            .collect();
        let signals: Vec<Vec<f64>> = (0..n)
            .map(|k| flat.iter().skip(k).step_by(n).copied().collect())
            .collect();
        self.file(ScanKind::Sample, incidence, &angles, &signals, &mut rng);
    }

    /// Where the detector stands when it records `angles`.
    fn true_directions(&self, angles: &[Angles], rng: &mut Pcg64) -> Vec<Direction> {
        angles
            .iter()
            .map(|a| pointed(&self.detector, a.direction(), rng))
            .collect()
    }
}
