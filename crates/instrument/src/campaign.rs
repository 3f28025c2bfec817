//! A measurement campaign: dark, beam and sample records in the order they are taken.

use gonio_bsdf::Bsdf;
use gonio_geom::{Angles, Component};
use gonio_scan::Scan;

use crate::campaign_check::check_model;
use crate::session::Session;
use crate::signal::Specimen;
use crate::{Beam, Detector, DetectorPath, Holder, InstrumentError, Lamp, Output};

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
