//! pab-opto Mountain text: `#` header, then rows `theta phi value` of one incidence (docs/formats/mountain.md).
//!
//! Columns and header keys as `pabopto2bsdf` of RADIANCE reads them [Radiance]. Azimuths are turned by
//! `90 - upphi` degrees so that the sample's up mark lies on +y, as RADIANCE does; a file without `#upphi` has its up
//! mark at azimuth 0.

mod header;
mod write;

use std::path::Path;

use gonio_bsdf::{Channel, Quantity};
use gonio_scan::{Scan, ScanKind};

use crate::text::{Fault, Receivers, Text};
use crate::{IoError, ReadOptions, column};
use header::{Colorimetry, Header};
pub use write::write;

/// Reads one file: one scan, or four (photopic, red, green, blue) where the file holds CIE XYZ.
///
/// # Errors
/// [`IoError`] for everything the format does not allow; a header line that changes the meaning after data (where
/// RADIANCE stops reading) is one.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    from_text(Text::open(path)?, options)
}

/// [`read`] of content in memory; `path` is named in errors and kept as the source.
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    from_text(Text::of(bytes, path)?, options)
}

fn from_text(mut text: Text<'_>, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    let header = Header::read(&mut text, options)?;
    match header.colorimetry {
        Colorimetry::Y => one_channel(text, header),
        Colorimetry::Xyz => three_columns(text, header),
    }
}

fn one_channel(mut text: Text<'_>, header: Header) -> Result<Vec<Scan>, IoError> {
    let rows = text.expected_rows(3);
    let mut receivers = Receivers::new(rows, header.rotation);
    let mut value = column(rows);
    all_rows(&mut text, ["theta", "phi", "value"], |&[theta, phi, v]| {
        receivers.push(theta, phi)?;
        finite(v)?;
        value.push(v);
        Ok(())
    })?;
    header.check_count(&text, value.len())?;
    let channel = header.channel;
    Ok(vec![scan(header, &text, channel, receivers, value)])
}

/// Linear map from CIE XYZ to the RGB of RADIANCE: primaries (0.640, 0.330), (0.290, 0.600), (0.150, 0.060), white
/// (1/3, 1/3); rows scaled so that equal X, Y, Z give equal R, G, B [Radiance].
pub(crate) fn radiance_rgb([x, y, z]: [f64; 3]) -> [f64; 3] {
    // Columns of the inverse are the primaries' XYZ, each scaled by the white balance; the inverse of a 3x3 matrix by
    // cross products keeps the constants of the source visible.
    use gonio_geom::DVec3;
    let primary = |cx: f64, cy: f64| DVec3::new(cx, cy, 1.0 - cx - cy);
    let (r, g, b) = (
        primary(0.640, 0.330),
        primary(0.290, 0.600),
        primary(0.150, 0.060),
    );
    let xyz = DVec3::new(x, y, z);
    let white = DVec3::ONE;
    [g.cross(b), b.cross(r), r.cross(g)].map(|n| n.dot(xyz) / n.dot(white))
}

fn three_columns(mut text: Text<'_>, header: Header) -> Result<Vec<Scan>, IoError> {
    let rows = text.expected_rows(5);
    let mut receivers = Receivers::new(rows, header.rotation);
    let mut values: [Vec<f64>; 4] = std::array::from_fn(|_| column(rows));
    all_rows(
        &mut text,
        ["theta", "phi", "X", "Y", "Z"],
        |&[theta, phi, x, y, z]| {
            receivers.push(theta, phi)?;
            for v in [x, y, z] {
                finite(v)?;
            }
            let [r, g, b] = radiance_rgb([x, y, z]);
            for (column, v) in values.iter_mut().zip([y, r, g, b]) {
                column.push(v);
            }
            Ok(())
        },
    )?;
    header.check_count(&text, receivers.theta.len())?;
    let channels = [Channel::Photopic, Channel::Red, Channel::Green, Channel::Blue];
    Ok(channels
        .into_iter()
        .zip(values)
        .map(|(channel, value)| scan(header.clone(), &text, channel, receivers.clone(), value))
        .collect())
}

/// Rows to the end of the file; comments between them are passed over, header keys are not.
#[inline(always)]
fn all_rows<const N: usize>(
    text: &mut Text<'_>,
    names: [&'static str; N],
    mut sink: impl FnMut(&[f64; N]) -> Result<(), Fault>,
) -> Result<(), IoError> {
    loop {
        text.rows(names, &mut sink)?;
        let line = text.line;
        let Some(h) = text.header_line()? else {
            return Ok(());
        };
        if header::is_key(&h.key) {
            return Err(IoError::format(
                text.path,
                line,
                "header",
                format!("#{} after data", h.key),
                "header lines before the first reading only; one incidence a file",
            ));
        }
    }
}

#[inline(always)]
fn finite(v: f64) -> Result<(), Fault> {
    // NaN is a reading without data and stays
    if v.is_infinite() {
        Err(Fault::new("value", format!("{v}"), "a finite number or nan"))
    } else {
        Ok(())
    }
}

fn scan(header: Header, text: &Text<'_>, channel: Channel, receivers: Receivers, value: Vec<f64>) -> Scan {
    let mut meta = header.meta;
    meta.source = Some(text.path.display().to_string());
    if !text.ends_with_newline() {
        meta.other.insert(
            "reader_note".into(),
            "the last line has no line end; it may be cut short".into(),
        );
    }
    Scan {
        kind: header.kind.unwrap_or(ScanKind::Sample),
        quantity: header.quantity,
        channel,
        incidence: header.incidence,
        theta_s: receivers.theta,
        phi_s: receivers.phi,
        value,
        time: None,
        meta,
    }
}

/// The quantity named in a `#format` line, and the unit where it is a detector signal in brackets.
fn quantity_of(word: &str) -> Option<(Quantity, Option<&str>)> {
    match word.to_ascii_uppercase().as_str() {
        "DSF" => Some((Quantity::Dsf, None)),
        "BSDF" | "BRDF" | "BTDF" => Some((Quantity::Bsdf, None)),
        _ => {
            let unit = word.strip_prefix('[')?.strip_suffix(']')?.trim();
            (!unit.is_empty()).then_some((Quantity::Signal, Some(unit)))
        }
    }
}

#[cfg(test)]
mod tests;
