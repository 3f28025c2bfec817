//! Instruments of the virtual goniophotometer from numbers and parts by name.

use gonio_bsdf::Channel;
use gonio_instrument::{
    Around, BeamProfile, Focus, GainRange, Instrument, Outline, Output, Patch, PathTable, Prescan,
    ProfileTable, Region,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::angles;
use crate::errors::{OrRaise, domain};

/// An incidence and where the detector reads then, (theta, phi) in degrees.
type Line = ((f64, f64), Vec<(f64, f64)>);

/// The instrument with the named numbers of `settings` in place of its defaults; angles in degrees.
pub(crate) fn instrument(settings: &Bound<'_, PyDict>) -> PyResult<Instrument> {
    let mut it = Instrument::default();
    let mut sample = [None; 3];
    for (key, value) in settings {
        let (key, value): (String, f64) = (key.extract()?, value.extract()?);
        let angle = value.to_radians();
        let d = &mut it.detector;
        let patch = it.path.patch.get_or_insert_default();
        match key.as_str() {
            "power" => it.beam.power = value,
            "beam_half_width" => it.beam.profile = BeamProfile::Gaussian { half_width: angle },
            "beam_radius" => it.beam.profile = BeamProfile::TopHat { radius: angle },
            "spot_diameter" => it.beam.spot_diameter = value,
            "lamp_drift" => it.lamp.drift = value,
            "lamp_flicker" => it.lamp.flicker = value,
            "lamp_flicker_time" => it.lamp.flicker_time = value,
            "sample_diameter" => sample[0] = Some(value),
            "sample_width" => sample[1] = Some(value),
            "sample_height" => sample[2] = Some(value),
            "overfill" => it.holder.overfill = value != 0.0,
            "tilt_x" => it.holder.tilt[0] = angle,
            "tilt_y" => it.holder.tilt[1] = angle,
            "offset" => it.holder.offset = value,
            "holder_radius" => it.holder.radius = value,
            "distance" => d.distance = value,
            "aperture" => d.aperture = angle,
            "noise_readout" => d.noise_readout = value,
            "noise_shot" => d.noise_shot = value,
            "noise_relative" => d.noise_relative = value,
            "dark_level" => d.dark_level = value,
            "dark_swing" => d.dark_swing = value,
            "dark_period" => d.dark_period = value,
            "saturation" => d.saturation = value,
            "bits" => d.bits = whole("bits", value, 32.0)?,
            "rate" => d.rate = value,
            "speed" => d.speed = Some(angle),
            "integration" => d.integration = value,
            "shadow" => d.shadow = angle,
            "pointing" => d.pointing = angle,
            "pitch_across" => it.path.pitch_across = angle,
            "pitch_along" => it.path.pitch_along = angle,
            "theta_max" => it.path.theta_max = angle,
            "jitter" => it.path.jitter = value,
            "patch_radius" => patch.radius = angle,
            "patch_pitch" => patch.pitch = angle,
            "patch_growth" => patch.growth = value,
            "patch_along" => patch.along = value,
            name => return Err(domain("instrument", format!("{name:?}"), SETTINGS)),
        }
    }
    it.holder.outline = outline(sample)?;
    Ok(it)
}

/// Names of the settings, as an error lists them.
const SETTINGS: &str = "power, beam_half_width, beam_radius, spot_diameter, lamp_drift, lamp_flicker, lamp_flicker_time, \
     sample_diameter, sample_width, sample_height, overfill, tilt_x, tilt_y, offset, holder_radius, distance, aperture, \
     noise_readout, noise_shot, noise_relative, dark_level, dark_swing, dark_period, saturation, bits, rate, speed, \
     integration, shadow, pointing, pitch_across, pitch_along, theta_max, jitter, patch_radius, patch_pitch, \
     patch_growth, patch_along";

fn whole(field: &'static str, value: f64, high: f64) -> PyResult<u32> {
    if value.fract() == 0.0 && (0.0..=high).contains(&value) {
        return Ok(value as u32);
    }
    Err(domain(
        field,
        value.to_string(),
        &format!("a whole number of 0 to {high}"),
    ))
}

/// The outline of diameter, or of width and height.
fn outline(sample: [Option<f64>; 3]) -> PyResult<Outline> {
    match sample {
        [None, None, None] => Ok(Outline::Unbounded),
        [Some(diameter), None, None] => Ok(Outline::Disk { diameter }),
        [None, Some(width), Some(height)] => Ok(Outline::Rectangle { width, height }),
        _ => Err(domain(
            "sample size",
            format!("diameter, width, height of {sample:?}"),
            "either sample_diameter or sample_width and sample_height",
        )),
    }
}

/// The parts of an instrument that are no single numbers, each taken out of `parts`.
pub(crate) fn add_parts(it: &mut Instrument, parts: &Bound<'_, PyDict>) -> PyResult<()> {
    for (key, value) in parts {
        let key: String = key.extract()?;
        match key.as_str() {
            "profile" => {
                let rows: Vec<(f64, f64)> = value.extract()?;
                let angle: Vec<f64> = rows.iter().map(|r| r.0.to_radians()).collect();
                let relative: Vec<f64> = rows.iter().map(|r| r.1).collect();
                it.beam.profile = BeamProfile::Table(ProfileTable::new(&angle, &relative).or_raise()?);
            }
            "focus" => {
                it.beam.focus = match value.extract::<String>()?.as_str() {
                    "detector" => Focus::Detector,
                    "sample" => Focus::Sample,
                    found => return Err(domain("focus", format!("{found:?}"), "detector, sample")),
                }
            }
            "ranges" => {
                let rows: Vec<(f64, f64, f64)> = value.extract()?;
                let range = |(full_scale, noise_readout, gain_error)| GainRange {
                    full_scale,
                    noise_readout,
                    gain_error,
                };
                it.detector.ranges = rows.into_iter().map(range).collect();
            }
            "outputs" => {
                let rows: Vec<(String, f64, Vec<f64>)> = value.extract()?;
                let output = |(name, power, weights): (String, f64, Vec<f64>)| {
                    let channel = name.parse::<Channel>().or_raise()?;
                    Ok(Output {
                        channel,
                        power,
                        weights,
                    })
                };
                it.detector.outputs = rows.into_iter().map(output).collect::<PyResult<_>>()?;
            }
            "planes" => {
                it.path.planes = value
                    .extract::<Vec<f64>>()?
                    .iter()
                    .map(|a| a.to_radians())
                    .collect()
            }
            "patch" => it.path.patch = value.extract::<Option<PatchRow>>()?.map(patch),
            "regions" => {
                let rows: Vec<(String, (f64, f64), PatchRow)> = value.extract()?;
                let region = |(around, (theta, phi), row): (String, (f64, f64), PatchRow)| {
                    let around = match around.as_str() {
                        "mirror" => Around::Mirror,
                        "through" => Around::Through,
                        "retro" => Around::Retro,
                        "direction" => Around::At(angles(["theta_s", "phi_s"], theta, phi)?),
                        _ => return Err(domain("region", around, "mirror, through, retro, direction")),
                    };
                    let patch = patch(row);
                    Ok(Region { around, patch })
                };
                it.path.regions = rows.into_iter().map(region).collect::<PyResult<_>>()?;
            }
            "prescan" => {
                let (pitch, threshold, count, row): (f64, f64, usize, PatchRow) = value.extract()?;
                it.path.prescan = Some(Prescan {
                    pitch: pitch.to_radians(),
                    threshold,
                    count,
                    patch: patch(row),
                });
            }
            "table" => {
                let rows: Vec<Line> = value.extract()?;
                let lines = rows.into_iter().map(|((theta, phi), row)| {
                    let row = row.into_iter();
                    let line = row.map(|(t, p)| Ok(angles(["theta_s", "phi_s"], t, p)?.direction()));
                    Ok((
                        angles(["theta_i", "phi_i"], theta, phi)?,
                        line.collect::<PyResult<_>>()?,
                    ))
                });
                it.path.table = Some(PathTable {
                    lines: lines.collect::<PyResult<_>>()?,
                });
            }
            _ => {
                return Err(domain(
                    "instrument",
                    format!("{key:?}"),
                    "profile, focus, ranges, outputs, planes, patch, regions, prescan, table",
                ));
            }
        }
    }
    Ok(())
}

/// Radius and pitch in degrees, growth, share along.
type PatchRow = (f64, f64, f64, f64);

fn patch((radius, pitch, growth, along): PatchRow) -> Patch {
    Patch {
        radius: radius.to_radians(),
        pitch: pitch.to_radians(),
        growth,
        along,
    }
}
