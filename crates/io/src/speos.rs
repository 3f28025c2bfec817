//! Anisotropic BSDF files of Ansys Speos (`.anisotropicbsdf`, text mode, docs/formats/speos-bsdf.md).
//!
//! Tables over the scattered direction, one an anisotropy angle and angle of incidence, proportional to the BSDF or to
//! the intensity; a spectrum of the reflectance at one incidence gives them their scale.

use std::path::Path;

use gonio_bsdf::{Channel, Quantity};
use gonio_geom::{Angles, Component};
use gonio_scan::{Scan, ScanKind, ScanMeta};

use crate::text::decode;
use crate::words::Words;
use crate::{IoError, ReadOptions, excerpt, read_bytes};

/// Beginning of the files; the version follows.
pub const MAGIC: &str = "OPTIS - Anisotropic BSDF surface file v";

const MOST: usize = 1 << 16;

/// Reads a file: one scan a component, anisotropy angle, incidence and wavelength of its spectrum; with a channel in
/// `options`, that one, interpolated in the spectrum.
///
/// # Errors
/// [`IoError`]: a binary file or another version, a word or number that the format does not allow, a file that ends
/// early, tables that reflect nothing where they are normalised, options that contradict the file.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    parse(&read_bytes(path)?, path, options)
}

/// [`read`] of content in memory; `path` is named in errors and kept as the source.
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    let mut words = Words::new(bytes, path);
    let first = words.next_line("file")?;
    let version = first.strip_prefix(MAGIC.as_bytes()).map(<[u8]>::trim_ascii);
    if version != Some(b"8.0") {
        return Err(words.fault("header", excerpt(first), format!("{MAGIC}8.0")));
    }
    if words.count_or_zero("mode", 1)? != 0 {
        return Err(words.fault("mode", "1, a binary file", "0, text"));
    }
    let comment = decode(words.next_line("comment")?);
    let length = words.count_or_zero("length of the description", MOST)?;
    let mut description = Vec::new();
    // the length counts line ends of one or two characters
    for lines in 1.. {
        description.extend_from_slice(words.next_line("description")?);
        if description.len() + lines > length {
            break;
        }
        description.push(b'\n');
    }
    words.numbers("anisotropy vector", 3)?;
    let there = [
        words.count_or_zero("reflection", 1)?,
        words.count_or_zero("transmission", 1)?,
    ];
    let quantity = match words.count_or_zero("type of values", 1)? {
        1 => Quantity::Bsdf,
        _ => Quantity::Dsf,
    };
    if let Some(stated) = options.quantity.filter(|q| *q != quantity) {
        return Err(words.fault(
            "quantity",
            format!("{quantity} in the file, {stated} stated"),
            "the same",
        ));
    }
    let mut meta = ScanMeta {
        source: Some(path.display().to_string()),
        ..ScanMeta::default()
    };
    for (name, text) in [("comment", comment), ("description", decode(&description))] {
        if !text.is_empty() {
            meta.other.insert(name.into(), text);
        }
    }
    let mut parts = Vec::new();
    for (component, _) in COMPONENTS.into_iter().zip(there).filter(|(_, n)| *n == 1) {
        parts.push(Part::angles(component, &mut words)?);
    }
    if parts.is_empty() {
        return Err(words.fault("reflection", "neither reflection nor transmission", "one of them"));
    }
    for part in &mut parts {
        part.spectrum(&mut words)?;
    }
    for part in &mut parts {
        part.tables(&mut words)?;
    }
    let mut scans = Vec::new();
    for part in &parts {
        part.scans(quantity, options, &meta, &words, &mut scans)?;
    }
    Ok(scans)
}

const COMPONENTS: [Component; 2] = [Component::Reflection, Component::Transmission];

impl Words<'_> {
    /// A whole number from 0 to `most`.
    fn count_or_zero(&mut self, field: &str, most: usize) -> Result<usize, IoError> {
        let x = self.number(field)?;
        if x.fract() == 0.0 && (0.0..=most as f64).contains(&x) {
            Ok(x as usize)
        } else {
            Err(self.fault(field, x.to_string(), format!("a whole number from 0 to {most}")))
        }
    }
}

/// One table: scattered directions in degrees and values `[theta][phi]`.
struct Table {
    theta: Vec<f64>,
    phi: Vec<f64>,
    values: Vec<f64>,
}

impl Table {
    fn read(words: &mut Words<'_>, component: Component) -> Result<Self, IoError> {
        let rows = words.count("number of theta", MOST)?;
        let columns = words.count("number of phi", MOST)?;
        let phi = words.ascending("phi", columns, 0.0, 360.0)?;
        let (low, high) = match component {
            Component::Reflection => (0.0, 90.0),
            Component::Transmission => (90.0, 180.0),
        };
        let (mut theta, mut values): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        for _ in 0..rows {
            let t = words.number("theta")?;
            if !((low..=high).contains(&t) && theta.last().is_none_or(|last| *last < t)) {
                let allowed = format!("ascending angles from {low} to {high}");
                return Err(words.fault("theta", t.to_string(), allowed));
            }
            theta.push(t);
            values.extend(words.numbers("value", columns)?);
        }
        Ok(Table { theta, phi, values })
    }

    /// Integral over the directions of the table by the trapezoid rule, with or without the cosine.
    fn integral(&self, cosine: bool) -> f64 {
        let node = |k: usize, j: usize| {
            let t = self.theta[k].to_radians();
            let weight = if cosine { t.cos().abs() } else { 1.0 };
            self.values[k * self.phi.len() + j] * t.sin() * weight
        };
        let mut sum = 0.0;
        for k in 1..self.theta.len() {
            let dt = (self.theta[k] - self.theta[k - 1]).to_radians();
            for j in 1..self.phi.len() {
                let dp = (self.phi[j] - self.phi[j - 1]).to_radians();
                sum += 0.25 * dt * dp * (node(k, j) + node(k - 1, j) + node(k, j - 1) + node(k - 1, j - 1));
            }
        }
        sum
    }
}

/// The tables of one component.
struct Part {
    component: Component,
    /// Anisotropy angles with their angles of incidence, degrees.
    incidences: Vec<(f64, Vec<f64>)>,
    /// Angle of incidence and anisotropy angle of the spectrum, degrees.
    reference: (f64, f64),
    /// Wavelength in nm and share of the light.
    spectrum: Vec<(f64, f64)>,
    /// One an anisotropy angle and angle of incidence.
    tables: Vec<Table>,
}

impl Part {
    fn angles(component: Component, words: &mut Words<'_>) -> Result<Self, IoError> {
        let n = words.count("number of anisotropy angles", MOST)?;
        let anisotropy = words.ascending("anisotropy angle", n, 0.0, 360.0)?;
        let mut incidences = Vec::new();
        for angle in anisotropy {
            let n = words.count("number of incidences", MOST)?;
            incidences.push((angle, words.ascending("angle of incidence", n, 0.0, 90.0)?));
        }
        Ok(Part {
            component,
            incidences,
            reference: (0.0, 0.0),
            spectrum: Vec::new(),
            tables: Vec::new(),
        })
    }

    fn spectrum(&mut self, words: &mut Words<'_>) -> Result<(), IoError> {
        let reference = words.numbers("incidence of the spectrum", 2)?;
        self.reference = (reference[0], reference[1]);
        words.next_line("description of the spectrum")?;
        let n = words.count("number of wavelengths", MOST)?;
        for _ in 0..n {
            let nm = words.number("wavelength")?;
            if !((100.0..=100_000.0).contains(&nm) && self.spectrum.last().is_none_or(|(last, _)| *last < nm))
            {
                return Err(words.fault("wavelength", nm.to_string(), "ascending, 100 to 100000 nm"));
            }
            self.spectrum
                .push((nm, words.number("share in percent")? / 100.0));
        }
        Ok(())
    }

    fn tables(&mut self, words: &mut Words<'_>) -> Result<(), IoError> {
        for _ in self.incidences.iter().flat_map(|(_, list)| list) {
            self.tables.push(Table::read(words, self.component)?);
        }
        Ok(())
    }

    /// Integral of the tables at the incidence of the spectrum: linear between the angles of incidence about it, at the
    /// anisotropy angle nearest to it, at the first or last angle of incidence beyond them.
    fn normalisation(&self, cosine: bool) -> f64 {
        let (theta, phi) = self.reference;
        let mut first = 0;
        let mut best: Option<(f64, usize, &[f64])> = None;
        for (angle, list) in &self.incidences {
            let distance = (angle - phi).abs();
            if best.is_none_or(|(d, _, _)| distance < d) {
                best = Some((distance, first, list));
            }
            first += list.len();
        }
        let Some((_, first, list)) = best else { return 0.0 };
        let after = list.partition_point(|t| *t < theta).clamp(0, list.len() - 1);
        let before = after.saturating_sub(1);
        let integral = |k: usize| self.tables[first + k].integral(cosine);
        if theta <= list[before] || after == before || theta >= list[after] {
            let k = if theta <= list[before] { before } else { after };
            return integral(k);
        }
        let share = (theta - list[before]) / (list[after] - list[before]);
        (1.0 - share) * integral(before) + share * integral(after)
    }

    /// Channels with their share of the light.
    fn channels(&self, options: &ReadOptions, words: &Words<'_>) -> Result<Vec<(Channel, f64)>, IoError> {
        let own = self
            .spectrum
            .iter()
            .map(|&(nm, share)| (Channel::Wavelength(nm), share));
        let Some(channel) = options.channel else {
            return Ok(own.collect());
        };
        let constant = self
            .spectrum
            .iter()
            .all(|(_, share)| *share == self.spectrum[0].1);
        let share = match channel {
            _ if constant => Some(self.spectrum[0].1),
            Channel::Wavelength(nm) => self.spectrum.windows(2).find_map(|w| {
                let ((a, x), (b, y)) = (w[0], w[1]);
                (a..=b).contains(&nm).then(|| x + (y - x) * (nm - a) / (b - a))
            }),
            _ => None,
        };
        match share {
            Some(share) => Ok(vec![(channel, share)]),
            None => {
                let (low, high) = (self.spectrum[0].0, self.spectrum[self.spectrum.len() - 1].0);
                let allowed = format!("a wavelength from {low}nm to {high}nm");
                Err(words.fault("channel", channel.to_string(), allowed))
            }
        }
    }

    fn scans(
        &self,
        quantity: Quantity,
        options: &ReadOptions,
        meta: &ScanMeta,
        words: &Words<'_>,
        scans: &mut Vec<Scan>,
    ) -> Result<(), IoError> {
        let scale = self.normalisation(quantity == Quantity::Bsdf);
        if scale <= 0.0 || !scale.is_finite() {
            let allowed = "tables of a positive integral at the incidence of the spectrum";
            return Err(words.fault("value", format!("an integral of {scale}"), allowed));
        }
        let channels = self.channels(options, words)?;
        let mut tables = self.tables.iter();
        for (anisotropy, list) in &self.incidences {
            for (theta, table) in list.iter().zip(&mut tables) {
                let incidence = Angles::from_degrees(*theta, anisotropy + 180.0);
                let cells = cells(table);
                let angles: Vec<Angles> = cells
                    .iter()
                    .map(|&(k, j)| Angles::from_degrees(table.theta[k], anisotropy + table.phi[j]))
                    .collect();
                for &(channel, share) in &channels {
                    let value =
                        |&(k, j): &(usize, usize)| table.values[k * table.phi.len() + j] * share / scale;
                    scans.push(Scan {
                        kind: options.kind.unwrap_or(ScanKind::Sample),
                        quantity,
                        channel,
                        incidence,
                        theta_s: angles.iter().map(|a| a.theta).collect(),
                        phi_s: angles.iter().map(|a| a.phi).collect(),
                        value: cells.iter().map(value).collect(),
                        time: None,
                        meta: meta.clone(),
                    });
                }
            }
        }
        Ok(())
    }
}

/// Row and column of the values that make readings: what repeats a direction with the same value (the pole, azimuth
/// 360) stands once.
fn cells(table: &Table) -> Vec<(usize, usize)> {
    let n = table.phi.len();
    let mut cells = Vec::with_capacity(table.values.len());
    for (k, &theta) in table.theta.iter().enumerate() {
        for (j, &phi) in table.phi.iter().enumerate() {
            let repeats = theta == 0.0 || theta == 180.0 || (phi == 360.0 && table.phi[0] == 0.0);
            if !(j > 0 && repeats && table.values[k * n + j] == table.values[k * n]) {
                cells.push((k, j));
            }
        }
    }
    cells
}

#[cfg(test)]
mod tests;
