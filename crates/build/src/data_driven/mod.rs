//! The data-driven model: measured slices, interpolated.

mod scattering;

use std::sync::{Arc, OnceLock};

use gonio_bsdf::{Channel, FourComponents};
use gonio_fit::profile::Profile;
use gonio_geom::{Angles, Component, DVec3, Direction, Side};
use gonio_scan::{Measurement, Slice};

use crate::across::Candidate;
use crate::base::Base;
use crate::builder;
use crate::built::Built;
use crate::direct::{self, Direct, DirectPeak, Separated};
use crate::energy::Cap;
use crate::error::BuildError;
use crate::incidence::Part;
use crate::intake::{check_columns, choose_channel, without_copies};
use crate::leave_one_out::LooError;
use crate::local_error::LocalError;
use crate::sampling::Proposal;
use crate::slice_surface::Coverage;
use crate::stated::{PartErrors, StatedError};
use crate::symmetry::{self, SymmetryChoice};
use crate::uncertainty::{self, Uncertainty};
use crate::watch::Watch;

/// Fewest distinct incidences a model is built from.
const LEAST_INCIDENCES: usize = 2;

/// What to build.
#[derive(Clone, Debug)]
pub struct BuildOptions {
    /// The channel; `None` takes the only one there is.
    pub channel: Option<Channel>,
    /// What to assume about azimuth.
    pub symmetry: SymmetryChoice,
    /// Whether readings are smoothed within their stated noise.
    pub smooth: bool,
    /// The interpolation over incidence; `None` chooses by leave-one-incidence-out error.
    pub candidate: Option<Candidate>,
    /// Analytic models (names of the registry) that no parametric base may contain.
    pub without: Vec<String>,
    /// Whether peaks as narrow as the beam become the ideal part of the model, where the measurement knows its beam.
    pub direct: bool,
    /// Tells how far the build is, and stops it.
    pub watch: Watch,
}

impl Default for BuildOptions {
    fn default() -> Self {
        BuildOptions {
            channel: None,
            symmetry: SymmetryChoice::Auto,
            smooth: true,
            candidate: None,
            without: Vec::new(),
            direct: true,
            watch: Watch::default(),
        }
    }
}

/// A peak narrower than what is around it that is interpolated apart: light that is reflected or passes unscattered, as wide as
/// the instrument's signature shows it.
#[derive(Clone, Debug)]
pub struct PeakSummary {
    /// It lies within this angle of the mirror (through) direction, radians.
    pub radius: f64,
    /// Its share of the incident light at every measured incidence.
    pub shares: Vec<(Angles, f64)>,
    /// The interpolation over incidence.
    pub candidate: Candidate,
    /// The parametric base it uses.
    pub base: Option<String>,
    /// Mean leave-one-incidence-out relative L1 error of every candidate tried for it.
    pub scores: Vec<(Candidate, f64)>,
}

/// How one side and component was built.
#[derive(Clone, Debug)]
pub struct PartSummary {
    /// Side of incidence.
    pub side: Side,
    /// Reflection or transmission.
    pub component: Component,
    /// Number of incidences.
    pub incidences: usize,
    /// Readings used.
    pub readings: usize,
    /// Values the slices were resampled to.
    pub table_values: usize,
    /// Error of each slice between and at its readings (noise left after smoothing, interpolation); relative L1 of the DSF.
    pub slice_errors: Vec<(Angles, f64)>,
    /// Distance of the readings of each slice over the narrow half width (1/e) of its lobe, as its base or its own fall-off shows
    /// it; 0 where there is neither. Readings more than half a width apart undersample the lobe.
    pub spacings: Vec<f64>,
    /// Relative L1 difference of readings with source and receiver exchanged; `None` where none can be compared.
    pub reciprocity: Option<f64>,
    /// Whether source and receiver are exchanged past the measured incidences.
    pub exchange: bool,
    /// Whether both halves about the plane of incidence were averaged.
    pub bilateral: bool,
    /// Symmetry about the normal that the slices show: isotropic, quadrilateral (both mirror planes), bilateral, half-turn,
    /// anisotropic (none).
    pub symmetry: &'static str,
    /// The interpolation over incidence.
    pub candidate: Candidate,
    /// The parametric base it uses; `None` where it uses none.
    pub base: Option<String>,
    /// The interpolation past the measured incidences.
    pub beyond: Candidate,
    /// The parametric base that uses.
    pub beyond_base: Option<String>,
    /// Mean leave-one-incidence-out relative L1 error of every candidate tried (the cubic of the best one only); empty with fewer than three incidences.
    pub scores: Vec<(Candidate, f64)>,
    /// A narrow peak that was taken apart; it is left out of the slice errors and scores.
    pub peak: Option<PeakSummary>,
}

/// A BSDF interpolated from a measurement; see docs/models/data-driven.md.
///
/// One channel. Sides and components that were not measured answer 0 and are named in [`DataDriven::warnings`].
/// At a measured incidence it is the slice as read (smoothed within its noise, negative values as 0); beyond the data
/// see [`DataDriven::coverage`]. Not reciprocal by construction.
#[derive(Clone, Debug)]
pub struct DataDriven {
    channel: [Channel; 1],
    isotropic: bool,
    energy_conserving: bool,
    parts: FourComponents<Part>,
    bases: FourComponents<Arc<Base>>,
    proposals: [OnceLock<Arc<Proposal>>; 2],
    errors: FourComponents<PartErrors>,
    local: FourComponents<Vec<LocalError>>,
    direct: FourComponents<Direct>,
    peaks: Vec<DirectPeak>,
    caps: [Option<Cap>; 2],
    loo: Vec<LooError>,
    summary: Vec<PartSummary>,
    warnings: Vec<String>,
}

impl DataDriven {
    /// Builds the model of one channel of `measurement`.
    ///
    /// # Errors
    /// [`BuildError`] when the channel is not there or not named among several, when columns differ in length, when
    /// fewer than two incidences have usable readings, when the readings of an incidence do not span a surface, and when
    /// [`BuildOptions::watch`] was stopped.
    pub fn build(measurement: &Measurement, options: &BuildOptions) -> Result<Self, BuildError> {
        let channel = choose_channel(measurement, options.channel)?;
        let slices: Vec<&Slice> = measurement
            .slices
            .iter()
            .filter(|s| s.channel == channel)
            .collect();
        for slice in &slices {
            check_columns(slice)?;
        }
        let profile = options
            .direct
            .then(|| Profile::of_measurement(measurement, channel))
            .flatten();
        let resolution = measurement.resolutions.iter().find(|r| r.channel == channel);
        let separated = profile.map(|profile| direct::separate(&slices, &profile, resolution));
        let (slices, peaks, unscattered) = match &separated {
            Some(Separated { slices, peaks, notes }) => {
                (slices.iter().collect(), peaks.clone(), notes.clone())
            }
            None => (slices, FourComponents::default(), Vec::new()),
        };
        let (slices, copied, notes) = without_copies(slices);
        let azimuth = symmetry::decide(&slices, options.symmetry);
        let mut model = DataDriven {
            channel: [channel],
            isotropic: azimuth.isotropic,
            energy_conserving: true,
            parts: FourComponents::default(),
            bases: FourComponents::default(),
            proposals: [OnceLock::new(), OnceLock::new()],
            errors: FourComponents::default(),
            local: FourComponents::default(),
            direct: FourComponents::default(),
            peaks: peaks.iter().flat_map(|(_, _, p)| p.clone()).collect(),
            caps: [None, None],
            loo: Vec::new(),
            summary: Vec::new(),
            warnings: unscattered.into_iter().chain(azimuth.note).chain(notes).collect(),
        };
        let mut most = 0;
        let mut missing = Vec::new();
        for (side, component) in FourComponents::<Part>::KEYS {
            let built = builder::part(&slices, &copied, side, component, azimuth.isotropic, options)?;
            let Some(Built {
                part,
                base,
                errors,
                local,
                summary,
                loo,
                notes,
            }) = built
            else {
                missing.push(format!("{side} {component}"));
                continue;
            };
            most = most.max(part.nodes().len());
            model.warnings.extend(notes);
            model.loo.extend(loo);
            model.summary.push(summary);
            let direct = peaks.get(side, component);
            model
                .direct
                .set(side, component, direct.map(|p| Direct::new(p, part.symmetry())));
            model.parts.set(side, component, Some(part));
            model.bases.set(side, component, base);
            model.errors.set(side, component, Some(errors));
            model.local.set(side, component, Some(local));
        }
        if !missing.is_empty() {
            model.warnings.push(format!(
                "not measured, the model answers 0 there: {}",
                missing.join(", ")
            ));
        }
        if most < LEAST_INCIDENCES {
            return Err(BuildError::TooFewIncidences {
                found: most,
                needed: LEAST_INCIDENCES,
            });
        }
        model.cap();
        Ok(model)
    }

    /// Caps the albedo where nothing was measured, and says so.
    fn cap(&mut self) {
        for side in Side::BOTH {
            let parts: Vec<&Part> = [Component::Reflection, Component::Transmission]
                .into_iter()
                .filter_map(|c| self.parts.get(side, c))
                .collect();
            if parts.is_empty() {
                continue;
            }
            let cap = Cap::new(&parts, |i| direct::both(&self.direct, side, i), self.isotropic);
            let (factor, at) = cap.worst;
            if cap.acts() {
                self.warnings.push(format!(
                    "{side}: between or beyond the measured incidences the model is scaled by down to {factor:.3} \
                     (theta_i {:.0} deg) to keep its albedo at 1; measured incidences are left as they are",
                    at.to_degrees()
                ));
            }
            let (highest, at) = cap.highest;
            if highest * factor > 1.0 + 1e-3 {
                self.energy_conserving = false;
                self.warnings.push(format!(
                    "{side}: the albedo reaches {highest:.3} (theta_i {:.0} deg)",
                    at.to_degrees()
                ));
            }
            self.caps[side_index(side)] = cap.acts().then_some(cap);
        }
    }

    /// Error of predicting each interior incidence from the others, every component.
    pub fn loo(&self) -> &[LooError] {
        &self.loo
    }

    /// The error the model states for light from `wi` into `component`; `None` where that was not measured.
    pub fn stated_error(&self, wi: Direction, component: Component) -> Option<StatedError> {
        let part = self.parts.get(wi.side(), component)?;
        let errors = self.errors.get(wi.side(), component)?;
        Some(errors.at(part.layout(), up(wi)))
    }

    /// Standard uncertainty of the value at `(wi, ws)` by its sources; `None` where the component was not measured.
    pub fn uncertainty(&self, wi: Direction, ws: Direction) -> Option<Uncertainty> {
        let key = (wi.side(), Component::between(wi.side(), ws.side()));
        let part = self.parts.get(key.0, key.1)?;
        let errors = self.errors.get(key.0, key.1)?;
        let local = self.local.get(key.0, key.1)?;
        Some(uncertainty::at(part, local, errors, up(wi), up(ws)))
    }

    /// How each side and component was built.
    pub fn summary(&self) -> &[PartSummary] {
        &self.summary
    }

    /// What a user must know: assumptions, components not measured, caps.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The light that passes or is mirrored unscattered: one entry an incidence and component that has such a peak; empty
    /// where none was found.
    pub fn direct(&self) -> &[DirectPeak] {
        &self.peaks
    }

    /// How the value at `(wi, ws)` is known.
    pub fn coverage(&self, wi: Direction, ws: Direction) -> Coverage {
        let component = Component::between(wi.side(), ws.side());
        match self.parts.get(wi.side(), component) {
            Some(part) => part.coverage(up(wi), up(ws)),
            None => Coverage::Missing,
        }
    }

    /// Fraction of the light from `wi` that leaves on both sides, scattered and unscattered, by quadrature (about 0.2 %).
    pub fn albedo(&self, wi: Direction) -> f64 {
        let i = up(wi);
        let parts: Vec<&Part> = [Component::Reflection, Component::Transmission]
            .into_iter()
            .filter_map(|c| self.parts.get(wi.side(), c))
            .collect();
        let scale = parts.first().map_or(1.0, |p| self.cap_factor(p, wi.side(), i));
        scale * (crate::energy::albedo(&parts, i) + direct::both(&self.direct, wi.side(), i))
    }

    #[inline]
    fn cap_factor(&self, part: &Part, side: Side, i: DVec3) -> f64 {
        match &self.caps[side_index(side)] {
            None => 1.0,
            Some(cap) => cap.factor(i, part.distance(i)),
        }
    }
}

/// The local frame of both sides and components: folded to the upper hemisphere.
#[inline]
fn up(d: Direction) -> DVec3 {
    let v = d.vec();
    DVec3::new(v.x, v.y, v.z.abs())
}

fn side_index(side: Side) -> usize {
    usize::from(side == Side::Back)
}
