//! Which slices of a measurement a model is built from.

use gonio_bsdf::Channel;
use gonio_scan::{Measurement, Slice};

use crate::error::BuildError;
use crate::symmetry;

/// Two slices that hold the same readings.
pub(crate) type Copied<'a> = (&'a Slice, &'a Slice);

/// `slices` without those that repeat another one of the same incidence; the pairs that are left and hold the same readings
/// though their incidences differ; and what to say about both.
pub(crate) fn without_copies(slices: Vec<&Slice>) -> (Vec<&Slice>, Vec<Copied<'_>>, Vec<String>) {
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

/// The channel that is wanted, or the only one.
pub(crate) fn choose_channel(
    measurement: &Measurement,
    wanted: Option<Channel>,
) -> Result<Channel, BuildError> {
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

/// Refuses columns of unequal length.
pub(crate) fn check_columns(slice: &Slice) -> Result<(), BuildError> {
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
