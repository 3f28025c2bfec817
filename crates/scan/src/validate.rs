//! Records that cannot be processed, named before anything is computed.

use std::f64::consts::PI;

use crate::{Scan, ScanError, ScanKind};

fn name_of(scan: &Scan) -> String {
    let (theta, phi) = scan.incidence.to_degrees();
    let place = format!("{} record at theta_i {theta:.2}, phi_i {phi:.2} deg", scan.kind);
    match &scan.meta.source {
        Some(source) => format!("{source}, {place}"),
        None => place,
    }
}

/// A record with readings, columns of one length and directions that exist.
///
/// # Errors
/// [`ScanError`] naming the record and the column.
pub(crate) fn well_formed(scan: &Scan) -> Result<(), ScanError> {
    let n = scan.len();
    let domain = |field: &'static str, found: String, allowed: &str| {
        Err(ScanError::Domain {
            field,
            found: format!("{}: {found}", name_of(scan)),
            allowed: allowed.into(),
        })
    };
    if n == 0 || scan.value.iter().all(|v| v.is_nan()) {
        return domain(
            "value",
            format!("{n} readings, none with a value"),
            "at least one reading",
        );
    }
    let lengths = [
        ("theta_s", scan.theta_s.len()),
        ("phi_s", scan.phi_s.len()),
        ("time", scan.time.as_ref().map_or(n, Vec::len)),
    ];
    for (field, length) in lengths {
        if length != n {
            return domain(field, format!("{length} entries"), &format!("{n}, one a reading"));
        }
    }
    let in_range = |t: &f64| (0.0..=PI + 1e-12).contains(t);
    if let Some(j) = scan.theta_s.iter().position(|t| !in_range(t)) {
        return domain(
            "theta_s",
            format!("reading {j}: {} rad", scan.theta_s[j]),
            "0 to pi",
        );
    }
    if let Some(j) = scan.phi_s.iter().position(|p| !p.is_finite()) {
        return domain(
            "phi_s",
            format!("reading {j}: {} rad", scan.phi_s[j]),
            "a finite angle",
        );
    }
    if !in_range(&scan.incidence.theta) || !scan.incidence.phi.is_finite() {
        return domain("theta_i", scan.incidence.theta.to_string(), "0 to pi");
    }
    let lengths = [
        ("distance", scan.meta.distance),
        ("receiver_solid_angle", scan.meta.receiver_solid_angle),
    ];
    for (field, value) in lengths {
        if let Some(v) = value
            && !(v.is_finite() && v > 0.0)
        {
            return domain(field, v.to_string(), "a finite number > 0, or left out");
        }
    }
    Ok(())
}

/// Sample records that may be processed together.
///
/// # Errors
/// [`ScanError`] for none, a malformed one, one of another kind, or mixed quantities.
pub(crate) fn sample_records(sample: &[Scan]) -> Result<(), ScanError> {
    let Some(first) = sample.first() else {
        return Err(ScanError::Domain {
            field: "sample",
            found: "no record".into(),
            allowed: "at least one sample record".into(),
        });
    };
    for scan in sample {
        well_formed(scan)?;
        if scan.kind != ScanKind::Sample {
            return Err(ScanError::Mismatch {
                what: format!("kind of the {}", name_of(scan)),
                found: scan.kind.to_string(),
                needed: ScanKind::Sample.to_string(),
            });
        }
        if scan.quantity != first.quantity {
            return Err(ScanError::Mismatch {
                what: format!("quantity of the {}", name_of(scan)),
                found: scan.quantity.to_string(),
                needed: format!("{} as in the first record", first.quantity),
            });
        }
    }
    Ok(())
}
