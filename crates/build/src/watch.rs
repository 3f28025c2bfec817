//! Watching a build from another thread: how far it is, and the wish to stop it.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use crate::error::BuildError;

/// What a build is doing. Sides and components are built one after the other, each from the first stage on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Nothing yet.
    #[default]
    Waiting,
    /// Readings of each incidence are triangulated.
    Reading,
    /// Parametric bases are fitted to all incidences.
    Bases,
    /// Slices are filled, and their errors estimated.
    Slices,
    /// Slices are compared with their images.
    Symmetry,
    /// Slices are resampled.
    Resampling,
    /// Bases are fitted again without each incidence that is left out.
    Refits,
    /// Incidences left out are predicted by each candidate.
    LeaveOneOut,
    /// The best candidate is taken, errors are stated.
    Choice,
}

impl Stage {
    /// Name used in reports and Python.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Waiting => "waiting",
            Stage::Reading => "reading",
            Stage::Bases => "fitting bases",
            Stage::Slices => "slices",
            Stage::Symmetry => "symmetry",
            Stage::Resampling => "resampling",
            Stage::Refits => "refitting bases",
            Stage::LeaveOneOut => "leaving incidences out",
            Stage::Choice => "choosing",
        }
    }
}

/// How far a build is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// What it is doing.
    pub stage: Stage,
    /// Steps of the stage that are done.
    pub done: usize,
    /// Steps of the stage.
    pub total: usize,
}

#[derive(Default)]
struct State {
    progress: Mutex<Progress>,
    stopped: AtomicBool,
}

/// A handle on a build; clones share it. One that nobody asks costs nothing.
#[derive(Clone, Default)]
pub struct Watch(Arc<State>);

impl fmt::Debug for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Watch").field(&self.progress()).finish()
    }
}

impl Watch {
    /// How far the build is.
    pub fn progress(&self) -> Progress {
        *self.0.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets the build end with [`BuildError::Stopped`] at its next step, within a fraction of a second.
    pub fn stop(&self) {
        self.0.stopped.store(true, Ordering::Relaxed);
    }

    /// Whether somebody wants the build to stop.
    pub(crate) fn stopped(&self) -> bool {
        self.0.stopped.load(Ordering::Relaxed)
    }

    /// Begins a stage of `total` steps.
    pub(crate) fn stage(&self, stage: Stage, total: usize) -> Result<(), BuildError> {
        *self.0.progress.lock().unwrap_or_else(PoisonError::into_inner) = Progress {
            stage,
            done: 0,
            total,
        };
        self.check()
    }

    /// One step is done.
    pub(crate) fn step(&self) {
        let mut progress = self.0.progress.lock().unwrap_or_else(PoisonError::into_inner);
        progress.done = (progress.done + 1).min(progress.total);
    }

    /// [`BuildError::Stopped`] once somebody wants that.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        if self.stopped() {
            Err(BuildError::Stopped)
        } else {
            Ok(())
        }
    }
}
