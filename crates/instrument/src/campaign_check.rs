//! Whether a campaign can be run.

use gonio_bsdf::Bsdf;
use gonio_geom::{Component, Direction};

use crate::error::in_range;
use crate::{Campaign, Instrument, InstrumentError};

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
