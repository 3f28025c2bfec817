//! The first data-driven model: measured slices, interpolated.

use gonio_bsdf::{Bsdf, Channel, FourComponents, Properties};
use gonio_geom::{Angles, Component, DVec3, Direction, Side};
use gonio_scan::{Measurement, Slice};

use crate::across::Candidate;
use crate::builder::{self, Built};
use crate::energy::Cap;
use crate::error::BuildError;
use crate::incidence::Part;
use crate::leave_one_out::LooError;
use crate::slice_surface::Coverage;
use crate::stated::{PartErrors, StatedError};
use crate::symmetry::{self, SymmetryChoice};

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
}

impl Default for BuildOptions {
    fn default() -> Self {
        BuildOptions {
            channel: None,
            symmetry: SymmetryChoice::Auto,
            smooth: true,
            candidate: None,
            without: Vec::new(),
        }
    }
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
    errors: FourComponents<PartErrors>,
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
    /// fewer than two incidences have usable readings, or when the readings of an incidence do not span a surface.
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
        let (slices, copied, notes) = without_copies(slices);
        let azimuth = symmetry::decide(&slices, options.symmetry);
        let mut model = DataDriven {
            channel: [channel],
            isotropic: azimuth.isotropic,
            energy_conserving: true,
            parts: FourComponents::default(),
            errors: FourComponents::default(),
            caps: [None, None],
            loo: Vec::new(),
            summary: Vec::new(),
            warnings: azimuth.note.into_iter().chain(notes).collect(),
        };
        let mut most = 0;
        for (side, component) in FourComponents::<Part>::KEYS {
            let built = builder::part(&slices, &copied, side, component, azimuth.isotropic, options)?;
            let Some(Built {
                part,
                errors,
                summary,
                loo,
                notes,
            }) = built
            else {
                model.warnings.push(format!(
                    "{side} {component} was not measured: the model answers 0 there"
                ));
                continue;
            };
            most = most.max(part.nodes().len());
            model.warnings.extend(notes);
            model.loo.extend(loo);
            model.summary.push(summary);
            model.parts.set(side, component, Some(part));
            model.errors.set(side, component, Some(errors));
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
            let cap = Cap::new(&parts, self.isotropic);
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

    /// How each side and component was built.
    pub fn summary(&self) -> &[PartSummary] {
        &self.summary
    }

    /// What a user must know: assumptions, components not measured, caps.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// How the value at `(wi, ws)` is known.
    pub fn coverage(&self, wi: Direction, ws: Direction) -> Coverage {
        let component = Component::between(wi.side(), ws.side());
        match self.parts.get(wi.side(), component) {
            Some(part) => part.coverage(up(wi), up(ws)),
            None => Coverage::Missing,
        }
    }

    /// Fraction of the light from `wi` that leaves on both sides, by quadrature (about 0.2 %).
    pub fn albedo(&self, wi: Direction) -> f64 {
        let i = up(wi);
        let parts: Vec<&Part> = [Component::Reflection, Component::Transmission]
            .into_iter()
            .filter_map(|c| self.parts.get(wi.side(), c))
            .collect();
        let scale = parts.first().map_or(1.0, |p| self.cap_factor(p, wi.side(), i));
        scale * crate::energy::albedo(&parts, i)
    }

    #[inline]
    fn cap_factor(&self, part: &Part, side: Side, i: DVec3) -> f64 {
        match &self.caps[side_index(side)] {
            None => 1.0,
            Some(cap) => cap.factor(i, part.distance(i)),
        }
    }
}

impl Bsdf for DataDriven {
    fn channels(&self) -> &[Channel] {
        &self.channel
    }

    fn properties(&self) -> Properties {
        Properties {
            reciprocal: false,
            energy_conserving: self.energy_conserving,
            isotropic: self.isotropic,
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        if let Some(first) = f.first_mut() {
            *first = self.eval_first(wi, ws);
        }
    }

    #[inline]
    fn eval_first(&self, wi: Direction, ws: Direction) -> f64 {
        let (side, to) = (wi.side(), ws.side());
        if ws.cos_theta() == 0.0 {
            return 0.0;
        }
        let Some(part) = self.parts.get(side, Component::between(side, to)) else {
            return 0.0;
        };
        let i = up(wi);
        let f = part.eval(i, up(ws)) * self.cap_factor(part, side, i);
        if f.is_finite() { f } else { 0.0 }
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

/// Two slices that hold the same readings.
type Copied<'a> = (&'a Slice, &'a Slice);

/// `slices` without those that repeat another one of the same incidence; the pairs that are left and hold the same readings
/// though their incidences differ; and what to say about both.
fn without_copies(slices: Vec<&Slice>) -> (Vec<&Slice>, Vec<Copied<'_>>, Vec<String>) {
    let mut dropped = vec![false; slices.len()];
    let (mut copied, mut notes) = (Vec::new(), Vec::new());
    for pair in gonio_scan::copies(&slices).into_iter().filter(|p| !p.noise_free) {
        let (a, b) = (slices[pair.first], slices[pair.second]);
        if dropped[pair.first] || dropped[pair.second] {
            continue;
        }
        let (theta, phi) = b.incidence.to_degrees();
        if a.incidence.direction().angle_to(b.incidence.direction()) < symmetry::SAME_DIRECTION {
            dropped[pair.second] = true;
            notes.push(format!(
                "the slice at theta_i {theta:.1}, phi_i {phi:.1} deg is there twice with the same readings: one is used"
            ));
        } else {
            copied.push((a, b));
            let (theta_a, phi_a) = a.incidence.to_degrees();
            notes.push(format!(
                "the slice at theta_i {theta:.1}, phi_i {phi:.1} deg holds the readings of that at theta_i {theta_a:.1}, phi_i \
                 {phi_a:.1} deg: both are used, and left out together where errors are estimated"
            ));
        }
    }
    let kept = slices
        .into_iter()
        .zip(dropped)
        .filter(|s| !s.1)
        .map(|s| s.0)
        .collect();
    (kept, copied, notes)
}

fn choose_channel(measurement: &Measurement, wanted: Option<Channel>) -> Result<Channel, BuildError> {
    let mut there: Vec<Channel> = Vec::new();
    for slice in &measurement.slices {
        if !there.contains(&slice.channel) {
            there.push(slice.channel);
        }
    }
    let found = match (wanted, there.as_slice()) {
        (Some(channel), all) if all.contains(&channel) => return Ok(channel),
        (None, [only]) => return Ok(*only),
        (Some(channel), _) => channel.to_string(),
        (None, _) => "none".to_owned(),
    };
    let names: Vec<String> = there.iter().map(Channel::to_string).collect();
    Err(BuildError::Channel {
        found,
        allowed: if names.is_empty() {
            "none (the measurement is empty)".into()
        } else {
            names.join(", ")
        },
    })
}

fn check_columns(slice: &Slice) -> Result<(), BuildError> {
    let needed = slice.len();
    let columns = [
        ("theta_s", slice.theta_s.len()),
        ("phi_s", slice.phi_s.len()),
        ("u_dsf", slice.u_dsf.len()),
        ("flags", slice.flags.len()),
    ];
    match columns.into_iter().find(|c| c.1 != needed) {
        Some((field, found)) => Err(BuildError::Columns { field, found, needed }),
        None => Ok(()),
    }
}
