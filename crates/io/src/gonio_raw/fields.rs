//! The fields of a record.

use std::path::Path;

use gonio_bsdf::{Channel, Quantity};
use gonio_geom::Angles;
use gonio_scan::{Scan, ScanKind, ScanMeta};

use crate::text::{HeaderLine, Receivers};
use crate::{IoError, ReadOptions};

/// Millimetres in a metre: lengths are millimetres in files and metres inside.
pub(super) const MM: f64 = 1000.0;

/// Which columns the rows have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Columns {
    Three,
    WithTime,
}

impl Columns {
    pub(super) fn parse(h: &HeaderLine, path: &Path) -> Result<Self, IoError> {
        match h.value.split_whitespace().collect::<Vec<_>>()[..] {
            ["theta_s", "phi_s", "value"] => Ok(Columns::Three),
            ["theta_s", "phi_s", "value", "time_s"] => Ok(Columns::WithTime),
            _ => Err(IoError::format(
                path,
                h.line,
                "#columns",
                format!("{:?}", h.value),
                "theta_s phi_s value, or theta_s phi_s value time_s",
            )),
        }
    }
}

/// Header fields read so far; a field may be given once among the common fields and once more in a record.
#[derive(Debug, Clone, Default)]
pub(super) struct Fields {
    kind: Option<ScanKind>,
    quantity: Option<Quantity>,
    channel: Option<Channel>,
    theta_i: Option<f64>,
    phi_i: Option<f64>,
    pub(super) readings: Option<usize>,
    meta: ScanMeta,
}

impl Fields {
    /// Takes one header line.
    pub(super) fn set(&mut self, h: &HeaderLine, path: &Path) -> Result<(), IoError> {
        let value = h.value.as_str();
        let fault = |allowed: &str| {
            IoError::format(path, h.line, format!("#{}", h.key), format!("{value:?}"), allowed)
        };
        let number = |low: f64, high: f64| match value.parse::<f64>() {
            Ok(x) if (low..=high).contains(&x) => Ok(x),
            _ => Err(fault(&if high == f64::MAX {
                format!("a finite number of at least {low}")
            } else {
                format!("a number of {low} to {high}")
            })),
        };
        match h.key.as_str() {
            "kind" => self.kind = Some(value.parse().map_err(|_| fault("sample, beam, dark, standard"))?),
            "quantity" => {
                self.quantity = Some(
                    value
                        .parse()
                        .map_err(|_| fault("signal, bsdf, dsf, reflectance_factor"))?,
                );
            }
            "channel" => {
                let allowed = "photopic, red, green, blue, or a wavelength such as 532nm";
                self.channel = Some(value.parse().map_err(|_| fault(allowed))?);
            }
            "theta_i" => self.theta_i = Some(number(0.0, 180.0)?),
            "phi_i" => self.phi_i = Some(number(-360.0, 720.0)?),
            "readings" => self.readings = Some(value.parse().map_err(|_| fault("a count"))?),
            "sample_name" => self.meta.sample_name = Some(value.into()),
            "instrument" => self.meta.instrument = Some(value.into()),
            "started" => self.meta.started = Some(value.into()),
            "distance_mm" => self.meta.distance = Some(number(0.0, f64::MAX)? / MM),
            "beam_diameter_mm" => self.meta.beam_diameter = Some(number(0.0, f64::MAX)? / MM),
            "receiver_solid_angle_sr" => {
                self.meta.receiver_solid_angle = Some(number(0.0, 4.0 * std::f64::consts::PI)?);
            }
            "noise_readout" => self.meta.noise_readout = Some(number(0.0, f64::MAX)?),
            "noise_relative" => self.meta.noise_relative = Some(number(0.0, f64::MAX)?),
            "integration" => self.meta.integration = Some(number(0.0, 1.0)?),
            "saturation" => self.meta.saturation = Some(number(0.0, f64::MAX)?),
            "" => {} // a comment: `# text`
            key => {
                self.meta.other.insert(key.to_string(), value.to_string());
            }
        }
        Ok(())
    }

    /// The record, once its rows are read. `line` is the line of `#columns`.
    pub(super) fn into_scan(
        self,
        path: &Path,
        line: u64,
        receivers: Receivers,
        value: Vec<f64>,
        time: Option<Vec<f64>>,
        options: &ReadOptions,
    ) -> Result<Scan, IoError> {
        let missing = |field: &str, allowed: &str| {
            let field = format!("#{field} of the record with #columns here");
            IoError::format(path, line, field, "nothing", allowed)
        };
        let contradicts = |field: &str, file: String, stated: String| {
            IoError::format(
                path,
                line,
                field,
                format!("{file} in the file, {stated} stated"),
                "the same",
            )
        };
        if let Some(promised) = self.readings
            && promised != value.len()
        {
            let found = format!("{promised}, but the record holds {}", value.len());
            return Err(IoError::format(
                path,
                line,
                "#readings",
                found,
                "the same; is the file truncated?",
            ));
        }
        if value.is_empty() {
            return Err(missing("readings", "at least one row"));
        }
        let kind = self
            .kind
            .ok_or_else(|| missing("kind", "sample, beam, dark, standard"))?;
        let quantity = self
            .quantity
            .ok_or_else(|| missing("quantity", "signal, bsdf, dsf, reflectance_factor"))?;
        let channel = self
            .channel
            .ok_or_else(|| missing("channel", "photopic, red, green, blue, or as 532nm"))?;
        let theta = self
            .theta_i
            .ok_or_else(|| missing("theta_i", "0 to 180 degrees"))?;
        let phi = self
            .phi_i
            .ok_or_else(|| missing("phi_i", "an azimuth in degrees"))?;
        if let Some(stated) = options.kind.filter(|&s| s != kind) {
            return Err(contradicts("kind", kind.to_string(), stated.to_string()));
        }
        if let Some(stated) = options.quantity.filter(|&s| s != quantity) {
            return Err(contradicts("quantity", quantity.to_string(), stated.to_string()));
        }
        if let Some(stated) = options.channel.filter(|&s| s != channel) {
            return Err(contradicts("channel", channel.to_string(), stated.to_string()));
        }
        let mut meta = self.meta;
        meta.source = Some(path.display().to_string());
        Ok(Scan {
            kind,
            quantity,
            channel,
            incidence: Angles::from_degrees(theta, phi),
            theta_s: receivers.theta,
            phi_s: receivers.phi,
            value,
            time,
            meta,
        })
    }
}

/// Keys that have a field of their own and so cannot be used as free keys.
pub(super) const RESERVED: [&str; 19] = [
    "gonio",
    "record",
    "columns",
    "readings",
    "kind",
    "quantity",
    "channel",
    "theta_i",
    "phi_i",
    "sample_name",
    "instrument",
    "started",
    "distance_mm",
    "beam_diameter_mm",
    "receiver_solid_angle_sr",
    "noise_readout",
    "noise_relative",
    "integration",
    "saturation",
];
