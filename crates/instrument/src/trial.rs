//! Paths that are tried out: alternatives to each other after the same scans of the beam.

use gonio_bsdf::{Bsdf, Channel};
use gonio_geom::{Angles, Direction};
use gonio_scan::Scan;

use crate::readout::recorded;
use crate::session::{CHANGE, Session};
use crate::signal::SampleSignal;
use crate::{Campaign, Instrument, Output};

/// Directions to be read for one incidence.
pub(crate) struct Trial {
    pub(crate) incidence: Angles,
    pub(crate) directions: Vec<Direction>,
}

/// Stream of trials.
const TRIAL: u64 = 1 << 20;

/// An instrument with its reference scans done, ready for trials.
pub(crate) struct Trials<'a> {
    model: &'a dyn Bsdf,
    session: Session<'a>,
    /// Records of the beam and of the dark.
    reference: Vec<Scan>,
    begin: f64,
}

impl<'a> Trials<'a> {
    /// Takes the reference scans of a campaign, whose settings are checked.
    pub(crate) fn begun(
        model: &'a dyn Bsdf,
        instrument: &'a Instrument,
        outputs: &'a [Output],
        campaign: &'a Campaign,
    ) -> Self {
        let mut session = Session::begun(instrument, outputs, campaign);
        session.reference();
        Trials {
            model,
            begin: session.clock,
            reference: std::mem::take(&mut session.records),
            session,
        }
    }

    /// Records of the beam and of the dark.
    pub(crate) fn reference(&self) -> &[Scan] {
        &self.reference
    }

    /// Number of detectors that read at once.
    pub(crate) fn detectors(&self) -> usize {
        self.session.outputs.len()
    }

    /// Records of each trial in turn, one a detector, whatever the path of the instrument, without dark records between them.
    pub(crate) fn read(&mut self, trials: Vec<Trial>) -> Vec<Scan> {
        let session = &mut self.session;
        for trial in trials {
            // Trials are alternatives: each is the first after the scans of the beam, with the same noise.
            (session.clock, session.streams) = (self.begin, TRIAL);
            let wi = session.instrument.holder.to_sample(trial.incidence.direction());
            let image = SampleSignal::new(self.model, session.instrument, session.outputs, wi);
            let angles = trial.directions.into_iter().map(recorded).collect();
            let mut rng = session.stream();
            session.read_sample(&image, trial.incidence, angles, &mut rng);
        }
        std::mem::take(&mut session.records)
    }
}

/// Seconds of a campaign beside the readings of the sample.
pub(crate) fn overhead(instrument: &Instrument, campaign: &Campaign) -> f64 {
    let one = [Output {
        channel: Channel::Photopic,
        power: 1.0,
        weights: vec![1.0],
    }];
    let mut session = Session::begun(instrument, &one, campaign);
    session.reference();
    let dark = campaign.dark_readings as f64 / instrument.detector.rate + CHANGE;
    session.clock + campaign.incidences.len() as f64 * (CHANGE + dark)
}
