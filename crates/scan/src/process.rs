//! From raw readings to DSF with its uncertainty.

use gonio_bsdf::{Channel, Quantity};
use rayon::prelude::*;

use crate::assemble::{Done, assemble};
use crate::assumed::{lacks_dark, no_calibration};
use crate::beam::beam_power;
use crate::blank::blank_match;
use crate::dark::{DarkOptions, DarkSummary, subtract};
use crate::flagging::{Apertures, half_angle, raw_flags};
use crate::local::gradient;
use crate::unresolved;
use crate::validate::{sample_records, well_formed};
use crate::weigh::weigh;
use crate::{Beam, Flags, Measurement, NoiseModel, Scan, ScanError, ScanKind, Slice};

/// Settings of [`process`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProcessOptions {
    /// How dark readings are assigned.
    pub dark: DarkOptions,
    /// Noise of a reading; `None` takes what the records state, else estimates it.
    pub noise: Option<NoiseModel>,
    /// Standard uncertainty of each receiver direction, radians, `>= 0`; enters with the gradient of the DSF.
    pub u_angle: f64,
    /// Relative standard uncertainty common to all values beyond that of the beam power (linearity, spectral
    /// mismatch, calibration), as a fraction `>= 0`.
    pub u_calibration: f64,
    /// Readings within this angle of the retro direction are in the detector's shadow, radians. `None`: those within
    /// the receiver aperture and the beam's 90 % radius, where both are known; a dip next to the retro direction
    /// counts in any case.
    pub shadow_radius: Option<f64>,
}

impl ProcessOptions {
    fn check(&self) -> Result<(), ScanError> {
        let fields = [
            ("u_angle", Some(self.u_angle)),
            ("u_calibration", Some(self.u_calibration)),
            ("shadow_radius", self.shadow_radius),
            ("dark tolerance", Some(self.dark.tolerance)),
        ];
        for (field, value) in fields {
            if let Some(v) = value
                && !(v.is_finite() && v >= 0.0)
            {
                return Err(ScanError::Domain {
                    field,
                    found: v.to_string(),
                    allowed: "a finite number >= 0".into(),
                });
            }
        }
        Ok(())
    }
}

/// [`process_owned`] of a copy of the sample records.
///
/// # Errors
/// As [`process_owned`].
pub fn process(
    sample: &[Scan],
    beam: &[Scan],
    dark: &[Scan],
    options: &ProcessOptions,
) -> Result<Measurement, ScanError> {
    process_owned(sample.to_vec(), beam, dark, options)
}

/// Raw readings to DSF: dark and blank subtracted, divided by the beam power
/// \[ApianBennewitz2010; eqs 6.2, 6.4 of the source chapter: `DSF_j = E_s,j / P_i`\], with flags, solid-angle weights, hemispherical integrals and
/// their uncertainty \[JCGM100\]. One slice a sample record, in their order, computed in parallel.
///
/// Records whose quantity is a BSDF, DSF or reflectance factor already keep their values (times the cosine where
/// that is missing) and need no beam; a beam given nevertheless states the resolution. Differing detector distances
/// of sample and reference scan are corrected by their squares.
///
/// The uncertainty of a value is `u^2 = (u_c f)^2 + u_0^2 + u_j^2`: `u_c` common and relative (beam power,
/// calibration), `u_0` common and absolute (dark level), `u_j` independent (noise, blank, direction, resolution);
/// docs/uncertainty.md.
///
/// # Errors
/// [`ScanError`] for no or an empty record, columns of different length, angles out of range, mixed quantities, a
/// record of another kind, a missing reference scan or one of another channel, aperture or gain, a reference scan
/// that does not hold the whole beam, a dark of another channel or quantity, an option out of range.
pub fn process_owned(
    sample: Vec<Scan>,
    beam: &[Scan],
    dark: &[Scan],
    options: &ProcessOptions,
) -> Result<Measurement, ScanError> {
    options.check()?;
    sample_records(&sample)?;
    for scan in beam {
        well_formed(scan)?;
    }
    for scan in dark {
        well_formed(scan)?;
        if scan.kind != ScanKind::Dark {
            return Err(ScanError::Mismatch {
                what: "kind of a dark record".into(),
                found: scan.kind.to_string(),
                needed: ScanKind::Dark.to_string(),
            });
        }
    }
    let mut warnings = Vec::new();
    let noise = noise_models(&sample, dark, options);
    let beams = beams(beam, dark, &noise, options, &mut warnings)?;
    for scan in sample.iter().filter(|s| s.quantity == Quantity::Signal) {
        beam_of(&beams, scan)?;
    }
    let sample_name = sample.iter().find_map(|s| s.meta.sample_name.clone());
    let without_dark = lacks_dark(&sample, dark);
    let mut assumed = Vec::new();
    if options.u_calibration == 0.0 {
        assumed.extend(sample.first().and_then(|s| no_calibration(s.quantity)));
    }
    let done: Vec<Done> = sample
        .into_par_iter()
        .map(|scan| {
            let model = model_of(&noise, &scan, options);
            one(scan, &beams, dark, model, options)
        })
        .collect::<Result<_, _>>()?;
    Ok(assemble(
        done,
        beams,
        sample_name,
        warnings,
        without_dark,
        assumed,
    ))
}

/// One noise model a channel that states none; records that state theirs use it.
pub(crate) fn noise_models(
    sample: &[Scan],
    dark: &[Scan],
    options: &ProcessOptions,
) -> Vec<(Channel, NoiseModel)> {
    let mut models: Vec<(Channel, NoiseModel)> = Vec::new();
    for scan in sample {
        if models.iter().any(|m| m.0 == scan.channel) {
            continue;
        }
        let model = options.noise.unwrap_or_else(|| {
            let of = |s: &&Scan| s.channel == scan.channel;
            let silent: Vec<&Scan> = sample
                .iter()
                .filter(of)
                .filter(|s| NoiseModel::stated(&s.meta).is_none())
                .collect();
            if silent.is_empty() {
                return NoiseModel::UNKNOWN;
            }
            let dark: Vec<&Scan> = dark.iter().filter(of).collect();
            NoiseModel::estimate(&silent, &dark)
        });
        models.push((scan.channel, model));
    }
    models
}

/// The noise of a record: as given, else as it states itself, else as estimated for its channel.
pub(crate) fn model_of(
    models: &[(Channel, NoiseModel)],
    scan: &Scan,
    options: &ProcessOptions,
) -> NoiseModel {
    let estimated = || models.iter().find(|m| m.0 == scan.channel).map(|m| m.1);
    options
        .noise
        .or_else(|| NoiseModel::stated(&scan.meta))
        .or_else(estimated)
        .unwrap_or(NoiseModel::UNKNOWN)
}

/// Beam power of every channel in `scans`; `sample` holds what is known of the noise of the sample's readings.
fn beams(
    scans: &[Scan],
    dark: &[Scan],
    sample: &[(Channel, NoiseModel)],
    options: &ProcessOptions,
    warnings: &mut Vec<String>,
) -> Result<Vec<Beam>, ScanError> {
    let mut channels: Vec<Channel> = Vec::new();
    for s in scans {
        if !channels.contains(&s.channel) {
            channels.push(s.channel);
        }
    }
    let mut out = Vec::new();
    for channel in channels {
        let mut of: Vec<Scan> = scans.iter().filter(|s| s.channel == channel).cloned().collect();
        let mut u_dark = 0.0_f64;
        let noise = options.noise.unwrap_or_else(|| {
            of.iter()
                .find_map(|s| NoiseModel::stated(&s.meta))
                .unwrap_or_else(|| {
                    let all: Vec<&Scan> = of.iter().collect();
                    let dark: Vec<&Scan> = dark.iter().filter(|d| d.channel == channel).collect();
                    let mut found = NoiseModel::estimate(&all, &dark);
                    // A steep raster counts the beam's structure as noise; the same detector on the sample does not.
                    if let Some((_, m)) = sample.iter().find(|m| m.0 == channel && m.1.relative > 0.0) {
                        found.relative = found.relative.min(m.relative);
                    }
                    found
                })
        });
        for scan in &mut of {
            // A blank scanned for the sample does not concern the beam: one level or the time course do.
            match subtract(scan, dark, &noise, &options.dark) {
                Ok(Some(found)) => u_dark = u_dark.max(found.u_common.hypot(found.u_independent)),
                Ok(None) => {}
                Err(error) => warnings.push(format!("reference scan without dark subtraction: {error}")),
            }
        }
        let beam = beam_power(&of, &noise, u_dark)?;
        if beam.rim > 1e-3 {
            warnings.push(format!(
                "the reference scan of {channel} still holds {:.2} % of its peak at the rim of the raster",
                100.0 * beam.rim
            ));
        }
        out.push(beam);
    }
    Ok(out)
}

/// The beam a signal record was lit by.
fn beam_of<'a>(beams: &'a [Beam], scan: &Scan) -> Result<&'a Beam, ScanError> {
    let Some(beam) = beams.iter().find(|b| b.channel == scan.channel) else {
        let found: Vec<String> = beams.iter().map(|b| b.channel.to_string()).collect();
        return Err(ScanError::Mismatch {
            what: "channel of the reference scan".into(),
            found: if found.is_empty() {
                "no reference scan".into()
            } else {
                found.join(", ")
            },
            needed: format!("{} as in the sample record", scan.channel),
        });
    };
    let gain = scan.meta.other.get("gain");
    if let (Some(a), Some(b)) = (gain, &beam.gain)
        && a != b
    {
        return Err(ScanError::Mismatch {
            what: "gain of the reference scan".into(),
            found: b.clone(),
            needed: format!("{a} as in the sample record, or readings already divided by their gain"),
        });
    }
    // Solid angle times distance squared is the aperture's area.
    let area = |omega: Option<f64>, r: Option<f64>| Some(omega? * r?.powi(2));
    let of_sample = area(scan.meta.receiver_solid_angle, scan.meta.distance);
    let of_beam = area(beam.receiver_solid_angle, beam.distance);
    if let (Some(a), Some(b)) = (of_sample, of_beam)
        && (a / b - 1.0).abs() > 0.02
    {
        return Err(ScanError::Mismatch {
            what: "receiver aperture of the reference scan".into(),
            found: format!("{b:.4e} m^2"),
            needed: format!("{a:.4e} m^2 as in the sample record"),
        });
    }
    Ok(beam)
}

/// One record: dark, flags, scale, uncertainty, weights, integrals. Columns of the record become those of the slice.
fn one(
    mut scan: Scan,
    beams: &[Beam],
    dark: &[Scan],
    noise: NoiseModel,
    options: &ProcessOptions,
) -> Result<Done, ScanError> {
    let any_beam = beams.iter().find(|b| b.channel == scan.channel);
    let flags = raw_flags(&scan, &noise, apertures(&scan, any_beam, options));
    let mut findings = Vec::new();
    let raw = (!dark.is_empty()).then(|| scan.value.clone());
    let found = subtract(&mut scan, dark, &noise, &options.dark)?;
    if let (Some(raw), Some(found)) = (raw, found) {
        findings.push(blank_match(&scan, &raw, &flags, &noise, &found));
    }
    let (factor, u_common) = if scan.quantity == Quantity::Signal {
        let beam = beam_of(beams, &scan)?;
        let squares = match (scan.meta.distance, beam.distance) {
            (Some(a), Some(b)) => (a / b).powi(2),
            _ => 1.0,
        };
        (squares / beam.power, beam.u_power().hypot(options.u_calibration))
    } else {
        (1.0, options.u_calibration)
    };
    let (quantity, integration) = (scan.quantity, scan.meta.integration);
    let to_dsf = move |theta_s: f64| factor * quantity.to_dsf(theta_s.cos()).unwrap_or(1.0);
    let mut slice = to_slice(scan, flags, &noise, found, u_common, to_dsf);
    let resolution = any_beam.map(|b| (b.signature.second_moment, b.signature.fwhm));
    add_direction_uncertainty(&mut slice, options.u_angle);
    let u_offset = found.map_or(0.0, |d| d.u_common) * factor.abs();
    combine(
        &mut slice,
        if quantity == Quantity::Signal {
            u_offset
        } else {
            0.0
        },
    )?;
    unresolved::add_uncertainty(&mut slice, resolution, integration);
    Ok(Done {
        slice,
        noise,
        dark: found,
        findings,
    })
}

pub(crate) fn apertures(scan: &Scan, beam: Option<&Beam>, options: &ProcessOptions) -> Apertures {
    let receiver = scan.meta.receiver_solid_angle.map(half_angle);
    let certain = || Some(receiver? + beam?.signature.radius_90);
    Apertures {
        receiver: receiver.unwrap_or(0.0),
        shadow: options.shadow_radius.or_else(certain),
    }
}

/// The record's columns as a slice: values times `to_dsf(theta_s)`, `u_dsf` holding the independent part so far.
pub(crate) fn to_slice(
    scan: Scan,
    mut flags: Vec<Flags>,
    noise: &NoiseModel,
    dark: Option<DarkSummary>,
    u_common: f64,
    to_dsf: impl Fn(f64) -> f64,
) -> Slice {
    let u_dark = dark.map_or(0.0, |d| d.u_independent);
    let mut dsf = scan.value;
    let mut u_dsf = Vec::with_capacity(dsf.len());
    for (j, v) in dsf.iter_mut().enumerate() {
        let scale = to_dsf(scan.theta_s[j]);
        let sigma = noise.sigma(*v).hypot(u_dark);
        if *v < 0.0 {
            flags[j] |= Flags::NEGATIVE;
        }
        if v.abs() < 2.0 * sigma {
            flags[j] |= Flags::BELOW_NOISE;
        }
        *v *= scale;
        u_dsf.push(if v.is_finite() { sigma * scale } else { f64::NAN });
    }
    Slice {
        incidence: scan.incidence,
        channel: scan.channel,
        theta_s: scan.theta_s,
        phi_s: scan.phi_s,
        dsf,
        u_dsf,
        omega: Vec::new(),
        flags,
        u_common,
        integrals: Vec::new(),
    }
}

/// Adds `|grad D| u_angle` to the independent part in `u_dsf`.
pub(crate) fn add_direction_uncertainty(slice: &mut Slice, u_angle: f64) {
    if u_angle > 0.0 {
        let slope = gradient(slice);
        for (u, g) in slice.u_dsf.iter_mut().zip(slope) {
            *u = u.hypot(g * u_angle);
        }
    }
}

/// Weights and integrals from the independent part, then the common parts on top of `u_dsf`.
pub(crate) fn combine(slice: &mut Slice, u_offset: f64) -> Result<(), ScanError> {
    let u_common = slice.u_common;
    for (u, d) in slice.u_dsf.iter_mut().zip(&slice.dsf) {
        *u = u.hypot(u_common * d);
    }
    weigh(slice, u_offset)?;
    if u_offset > 0.0 {
        for u in &mut slice.u_dsf {
            *u = u.hypot(u_offset);
        }
    }
    Ok(())
}
