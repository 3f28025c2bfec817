//! The header of a Mountain file.

use gonio_bsdf::{Channel, Quantity};
use gonio_geom::Angles;
use gonio_scan::{ScanKind, ScanMeta};

use super::quantity_of;
use crate::text::{HeaderLine, Text};
use crate::{IoError, ReadOptions};

const FORMATS: &str = "theta phi DSF, BSDF, BRDF, BTDF, or a detector unit in brackets such as [uA]";

/// Which columns follow the angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Colorimetry {
    /// One column.
    Y,
    /// Three columns.
    Xyz,
}

/// What the header says, checked and in the project's units.
#[derive(Debug, Clone)]
pub(super) struct Header {
    pub(super) quantity: Quantity,
    pub(super) incidence: Angles,
    /// Degrees added to azimuths.
    pub(super) rotation: f64,
    pub(super) colorimetry: Colorimetry,
    pub(super) channel: Channel,
    pub(super) kind: Option<ScanKind>,
    pub(super) meta: ScanMeta,
    /// `#datapoints_in_file`, with its line.
    count: Option<(usize, u64)>,
}

/// Whether `key` means something in this format, so that it may not stand after data.
pub(super) fn is_key(key: &str) -> bool {
    const KEYS: [&str; 8] = [
        "format",
        "intheta",
        "inphi",
        "incident_angle",
        "upphi",
        "colorimetry",
        "sample_name",
        "datapoints_in_file",
    ];
    KEYS.contains(&key)
}

/// A value with the line it stands on; a second, different value is an error.
struct Once<T> {
    key: &'static str,
    value: Option<(T, u64)>,
}

impl<T: PartialEq + std::fmt::Debug> Once<T> {
    fn new(key: &'static str) -> Self {
        Once { key, value: None }
    }

    fn set(&mut self, text: &Text<'_>, line: u64, value: T) -> Result<(), IoError> {
        if let Some((old, at)) = &self.value
            && *old != value
        {
            return Err(IoError::format(
                text.path,
                line,
                self.key,
                format!("{value:?}, but line {at} says {old:?}"),
                "one value",
            ));
        }
        self.value = Some((value, line));
        Ok(())
    }

    fn get(&self) -> Option<&T> {
        self.value.as_ref().map(|(v, _)| v)
    }
}

fn fault(text: &Text<'_>, h: &HeaderLine, allowed: &str) -> IoError {
    IoError::format(
        text.path,
        h.line,
        format!("#{}", h.key),
        format!("{:?}", h.value),
        allowed,
    )
}

fn number(text: &Text<'_>, h: &HeaderLine, word: &str, range: (f64, f64)) -> Result<f64, IoError> {
    match word.parse::<f64>() {
        Ok(x) if (range.0..=range.1).contains(&x) => Ok(x),
        _ => Err(fault(text, h, &format!("{} to {} degrees", range.0, range.1))),
    }
}

const THETA: (f64, f64) = (0.0, 180.0);
const PHI: (f64, f64) = (-360.0, 720.0);

impl Header {
    /// Reads the leading `#` lines.
    pub(super) fn read(text: &mut Text<'_>, options: &ReadOptions) -> Result<Header, IoError> {
        let mut format = Once::new("#format");
        let mut theta = Once::new("theta_i (#intheta, #incident_angle)");
        let mut phi = Once::new("phi_i (#inphi, #incident_angle)");
        let mut upphi = Once::new("#upphi");
        let mut colorimetry = Once::new("#colorimetry");
        let mut name = Once::new("#sample_name");
        let mut count = Once::new("#datapoints_in_file");
        let mut channel = options.channel.map(|c| (c, "stated"));
        let mut meta = ScanMeta::default();
        while let Some(h) = text.header_line()? {
            let line = h.line;
            let value = h.value.as_str();
            match h.key.as_str() {
                "format" => {
                    let words: Vec<&str> = value.split_whitespace().collect();
                    let found = match words[..] {
                        [t, p, q] if t.eq_ignore_ascii_case("theta") && p.eq_ignore_ascii_case("phi") => {
                            quantity_of(q)
                        }
                        _ => None,
                    };
                    let (quantity, unit) = found.ok_or_else(|| fault(text, &h, FORMATS))?;
                    if let Some(unit) = unit {
                        meta.other.insert("unit".into(), unit.into());
                    }
                    format.set(text, line, quantity)?;
                }
                "intheta" => theta.set(text, line, number(text, &h, value, THETA)?)?,
                "inphi" => phi.set(text, line, number(text, &h, value, PHI)?)?,
                "incident_angle" => {
                    let mut words = value.split_whitespace();
                    let (Some(t), Some(p), None) = (words.next(), words.next(), words.next()) else {
                        return Err(fault(text, &h, "two angles: theta phi"));
                    };
                    theta.set(text, line, number(text, &h, t, THETA)?)?;
                    phi.set(text, line, number(text, &h, p, PHI)?)?;
                }
                "upphi" => upphi.set(text, line, number(text, &h, value, PHI)?)?,
                "colorimetry" => {
                    let c = match value.to_ascii_uppercase().as_str() {
                        "CIE-Y" => Colorimetry::Y,
                        "CIE-XYZ" => Colorimetry::Xyz,
                        _ => return Err(fault(text, &h, "CIE-Y, CIE-XYZ")),
                    };
                    colorimetry.set(text, line, c)?;
                }
                "sample_name" => name.set(text, line, value.trim_matches('"').to_string())?,
                "datapoints_in_file" => {
                    let n: usize = value
                        .parse()
                        .map_err(|_| fault(text, &h, "a count of readings"))?;
                    count.set(text, line, n)?;
                }
                // gonio's own key; another program's meaning of the word is kept as text
                "channel" if value.parse::<Channel>().is_ok() => {
                    let found = value
                        .parse::<Channel>()
                        .map_err(|_| fault(text, &h, "a channel"))?;
                    if let Some((other, how)) = channel
                        && other != found
                    {
                        return Err(fault(text, &h, &format!("{other}, as {how}")));
                    }
                    channel = Some((found, "an earlier line says"));
                }
                key => {
                    let kept = meta.other.entry(key.to_string()).or_default();
                    if !kept.is_empty() {
                        kept.push('\n');
                    }
                    kept.push_str(value);
                }
            }
        }
        let quantity = *format.get().ok_or_else(|| text.missing("#format", FORMATS))?;
        if let Some(stated) = options.quantity
            && stated != quantity
        {
            return Err(text.fault(
                "quantity",
                format!("{quantity} in the file, {stated} stated"),
                "the same",
            ));
        }
        let degrees = "an angle in degrees";
        let theta = *theta
            .get()
            .ok_or_else(|| text.missing("#intheta or #incident_angle", degrees))?;
        let phi = *phi
            .get()
            .ok_or_else(|| text.missing("#inphi or #incident_angle", degrees))?;
        let up = options.upphi.or(upphi.get().copied());
        if let Some(up) = up {
            meta.other.insert("upphi".into(), up.to_string());
        }
        let rotation = 90.0 - up.unwrap_or(0.0);
        if !rotation.is_finite() {
            return Err(text.fault("upphi", rotation.to_string(), "a finite angle in degrees"));
        }
        let colorimetry = colorimetry.get().copied().unwrap_or(Colorimetry::Y);
        let channel = channel.map_or(Channel::Photopic, |(c, _)| c);
        if colorimetry == Colorimetry::Xyz && channel != Channel::Photopic {
            return Err(text.fault(
                "channel",
                format!("{channel} for a file of CIE-XYZ"),
                "no channel",
            ));
        }
        meta.sample_name = name.get().cloned();
        Ok(Header {
            quantity,
            incidence: Angles::from_degrees(theta, (phi + rotation).rem_euclid(360.0)),
            rotation,
            colorimetry,
            channel,
            kind: options.kind,
            meta,
            count: count.value,
        })
    }

    /// Compares the number of rows with the one the header promises, and refuses a file without rows.
    pub(super) fn check_count(&self, text: &Text<'_>, rows: usize) -> Result<(), IoError> {
        if let Some((promised, line)) = self.count
            && promised != rows
        {
            let found = format!("{promised}, but the file holds {rows} readings");
            return Err(IoError::format(
                text.path,
                line,
                "#datapoints_in_file",
                found,
                "the same; is the file truncated?",
            ));
        }
        if rows == 0 {
            return Err(text.missing("readings", "at least one row theta phi value"));
        }
        Ok(())
    }
}
