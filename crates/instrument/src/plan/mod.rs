//! The planner: the path that reaches given uncertainties with few readings.
//!
//! A material is known to some degree: a model, or one fitted to a fast scan. Over what the instrument would see of it the
//! lobes are found with their widths along and across, rings of a coarse base are laid over the hemisphere and lines across
//! the ridge over each lobe, densest at its top and growing until they are as coarse as the base. The path is then measured
//! with the virtual instrument and processed like a recording, and the pitch that helps most for its readings is refined, as
//! long as a claimed uncertainty exceeds its target and there is time.

mod chart;
mod field;
mod forecast;
mod lay;
mod lobe;
mod report;
mod search;
mod steps;
mod survey;

use gonio_bsdf::{Bsdf, Channel};
use gonio_geom::{Angles, Component, Direction};

use crate::error::in_range;
use crate::{Campaign, Instrument, InstrumentError, PathTable};

/// What a plan is to reach.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanOptions {
    /// Relative standard uncertainty of each hemispherical integral (DHR, DHT), `(0, 1)`.
    pub target_integral: f64,
    /// Relative standard uncertainty of the highest reading of each hemisphere as the height of its lobe, `(0, 1)`.
    pub target_peak: f64,
    /// Seconds that the campaign may take, dark records and scans of the beam included.
    pub time: Option<f64>,
    /// Largest pitch anywhere, radians, `[0.005, 0.5]`: a lobe that is not known is seen only if it is wider.
    pub largest_pitch: f64,
    /// Relative standard uncertainty that processing is told of, `[0, 0.5]`.
    pub u_calibration: f64,
    /// Further regions to be read: centre, radius and pitch, radians.
    pub regions: Vec<PlanRegion>,
}

impl Default for PlanOptions {
    /// .5 % of integrals, 1 % of peaks, as long as it takes, 10 degrees at most.
    fn default() -> Self {
        PlanOptions {
            target_integral: 0.005,
            target_peak: 0.01,
            time: None,
            largest_pitch: 10.0_f64.to_radians(),
            u_calibration: 0.0,
            regions: Vec::new(),
        }
    }
}

/// A region that is read whatever is known of the material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanRegion {
    /// Its centre.
    pub at: Angles,
    /// Its radius, radians, `(0, pi/2]`.
    pub radius: f64,
    /// Pitch, radians, `[0.0002, 0.5]`.
    pub pitch: f64,
}

/// A path and what it is expected to give.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The path, one line an incidence, both hemispheres one after the other.
    pub table: PathTable,
    /// One an incidence and hemisphere.
    pub scans: Vec<PlannedScan>,
    /// The detectors that read at once, each of which is to meet the targets.
    pub channels: Vec<Channel>,
    /// Readings of the sample.
    pub readings: usize,
    /// Seconds of the whole campaign, dark records and scans of the beam included.
    pub seconds: f64,
}

/// Forecast of one incidence and hemisphere. Uncertainties are standard and relative.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedScan {
    /// Direction of incidence.
    pub incidence: Angles,
    /// The hemisphere.
    pub component: Component,
    /// Readings.
    pub readings: usize,
    /// Seconds from its first reading to the last.
    pub seconds: f64,
    /// The detector whose integral is the least certain: the next five are its.
    pub channel_integral: Channel,
    /// DHR or DHT that processing would give.
    pub integral: f64,
    /// Its claimed uncertainty.
    pub u_integral: f64,
    /// By how much it is off, were the material what it is taken for.
    pub error: f64,
    /// The part of it that the path decides.
    pub u_quadrature: f64,
    /// The part of it that calibration and scans of the beam decide, as they do of that of the peak.
    pub u_common: f64,
    /// The detector whose peak is the least certain: the next four are its.
    pub channel_peak: Channel,
    /// Highest reading, 1/sr.
    pub peak: f64,
    /// Where.
    pub peak_at: Angles,
    /// Its claimed uncertainty.
    pub u_peak: f64,
    /// The part of it that the path decides.
    pub u_sampling: f64,
    /// By how much beam and aperture flatten the highest peak of the material, as a share of it.
    pub flattened: f64,
    /// Shares of the light that goes into the shadow of the detector and beyond the last polar angle.
    pub shaded: f64,
    /// See `shaded`.
    pub beyond: f64,
    /// Share of the hemisphere's solid angle that is not read.
    pub unread: f64,
    /// Pitch away from lobes, radians.
    pub base: f64,
    /// The lobes that are refined.
    pub lobes: Vec<PlannedLobe>,
    /// Why a target is missed; `None` where both are met.
    pub missed: Option<Missed>,
}

/// What keeps a scan from its targets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Missed {
    /// The time is used up.
    Time,
    /// Noise, calibration or scans of the beam: a denser path does not help.
    Instrument,
    /// The path cannot be refined any more.
    Pitch,
}

/// A lobe and the pitches at its top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedLobe {
    /// Where its top is.
    pub at: Angles,
    /// 1/e half widths, along and across, radians.
    pub width: [f64; 2],
    /// Pitches along and across at the top, radians.
    pub pitch: [f64; 2],
    /// Height as the instrument sees it, 1/sr; 0 for a region that was asked for.
    pub height: f64,
}

impl PlanOptions {
    fn check(&self) -> Result<(), InstrumentError> {
        let positive = |field, value: f64| {
            if value > 0.0 && value < 1.0 {
                return Ok(());
            }
            Err(InstrumentError::Domain {
                field,
                found: value.to_string(),
                allowed: "more than 0, less than 1".into(),
            })
        };
        positive("target_integral", self.target_integral)?;
        positive("target_peak", self.target_peak)?;
        if let Some(time) = self.time
            && !(time.is_finite() && time > 0.0)
        {
            return Err(InstrumentError::Domain {
                field: "time",
                found: format!("{time} s"),
                allowed: "more than 0 s".into(),
            });
        }
        in_range("largest_pitch", self.largest_pitch, 0.005, 0.5, " rad")?;
        in_range("u_calibration", self.u_calibration, 0.0, 0.5, "")?;
        for r in &self.regions {
            in_range(
                "region radius",
                r.radius,
                1e-3,
                std::f64::consts::FRAC_PI_2,
                " rad",
            )?;
            in_range("region pitch", r.pitch, 2e-4, 0.5, " rad")?;
        }
        Ok(())
    }
}

/// Plans the path of `campaign` with `instrument`, whose own path counts for nothing but `theta_max`, for a material that
/// scatters as `model`. Every detector that sees light is to meet the targets; the seed of the campaign decides the phases of the path. `watch` is
/// called with rounds done and rounds there may be; where it returns false there is no plan.
///
/// # Errors
/// [`InstrumentError::Domain`] for a setting out of range, a campaign or an instrument that [`crate::simulate`] refuses, and a time
/// that is too short for the coarsest path.
pub fn plan(
    model: &dyn Bsdf,
    instrument: &Instrument,
    campaign: &Campaign,
    options: &PlanOptions,
    watch: impl FnMut(usize, usize) -> bool,
) -> Result<Option<Plan>, InstrumentError> {
    options.check()?;
    search::search(model, instrument, campaign, options, watch)
}

/// Whether `d` lies on the hemisphere into which `component` scatters light from `wi`.
fn on(d: Direction, wi: Direction, component: Component) -> bool {
    d.side() == component.scattered_side(wi.side())
}
