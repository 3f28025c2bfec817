//! Reading Zemax `.bsdf` files.

use std::path::Path;

use gonio_bsdf::{Channel, Quantity};
use gonio_geom::{Angles, Component};
use gonio_scan::{Scan, ScanKind, ScanMeta};

use super::frame::Frame;
use super::{MOST_ANGLES, SCATTER, SPECTRA, SYMMETRIES};
use crate::mountain::radiance_rgb;
use crate::text::decode;
use crate::words::Words;
use crate::{IoError, ReadOptions, read_bytes};

/// Reads a file: one scan a sample rotation and angle of incidence, four of them (photopic, red, green, blue) where the
/// file holds tristimulus values.
///
/// # Errors
/// [`IoError`]: a word or number that the format does not allow, a file that ends early, a monochrome file without a
/// channel in `options`, options that contradict the file.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    parse(&read_bytes(path)?, path, options)
}

/// [`read`] of content in memory; `path` is named in errors and kept as the source.
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    if bytes.is_empty() {
        return Err(IoError::format(path, None, "file", "0 bytes", "a Zemax BSDF"));
    }
    let mut words = Words::new(bytes, path);
    let header = Header::read(&mut words, options)?;
    let parts: &[&str] = match header.channel {
        Some(_) => &["Monochrome"],
        None => &["TristimulusX", "TristimulusY", "TristimulusZ"],
    };
    let blocks: Vec<Vec<Block>> = parts
        .iter()
        .map(|name| header.part(&mut words, name))
        .collect::<Result<_, _>>()?;
    if let Some(word) = words.next() {
        return Err(words.fault("DataEnd", crate::excerpt(word), "the end of the file after it"));
    }
    Ok(header.scans(&blocks, &words, path))
}

/// What stands before the values.
struct Header {
    symmetry: usize,
    /// `None`: tristimulus values.
    channel: Option<Channel>,
    component: Component,
    kind: ScanKind,
    rotations: Vec<f64>,
    incidences: Vec<f64>,
    azimuths: Vec<f64>,
    radials: Vec<f64>,
}

/// The values of one rotation and incidence.
struct Block {
    tis: Option<f64>,
    values: Vec<f64>,
}

fn key(words: &mut Words<'_>, name: &str) -> Result<(), IoError> {
    words.one_of(name, &[name]).map(|_| ())
}

impl Header {
    fn read(words: &mut Words<'_>, options: &ReadOptions) -> Result<Self, IoError> {
        key(words, "Source")?;
        if words.next().is_none() {
            return Err(words.fault("Source", "the end of the file", "Measured"));
        }
        key(words, "Symmetry")?;
        let symmetry = words.one_of("Symmetry", &SYMMETRIES)?;
        key(words, "SpectralContent")?;
        let monochrome = words.one_of("SpectralContent", &SPECTRA)? == 0;
        let channel = match (monochrome, options.channel) {
            (true, Some(channel)) => Some(channel),
            (true, None) => {
                let allowed = "a statement such as 650nm or photopic: the file does not tell";
                return Err(words.fault("channel", "none", allowed));
            }
            (false, Some(channel)) => {
                return Err(words.fault("channel", format!("{channel} for a file of XYZ"), "no channel"));
            }
            (false, None) => None,
        };
        key(words, "ScatterType")?;
        let component = match words.one_of("ScatterType", &SCATTER)? {
            0 => Component::Reflection,
            _ => Component::Transmission,
        };
        if let Some(stated) = options.quantity.filter(|q| *q != Quantity::Bsdf) {
            return Err(words.fault(
                "quantity",
                format!("bsdf in the file, {stated} stated"),
                "the same",
            ));
        }
        let mut list = |name: &str, low: f64, high: f64| {
            key(words, name)?;
            let n = words.count(name, MOST_ANGLES)?;
            words.ascending(name, n, low, high)
        };
        let header = Header {
            symmetry,
            channel,
            component,
            kind: options.kind.unwrap_or(ScanKind::Sample),
            rotations: list("SampleRotation", -360.0, 360.0)?,
            incidences: list("AngleOfIncidence", 0.0, 90.0)?,
            azimuths: list("ScatterAzimuth", 0.0, 360.0)?,
            radials: list("ScatterRadial", 0.0, 180.0)?,
        };
        if symmetry == 0
            && let Some(last) = header.azimuths.last().filter(|a| **a > 180.0)
        {
            let found = format!("{last} in a file that is PlaneSymmetrical");
            return Err(words.fault("ScatterAzimuth", found, "azimuths up to 180"));
        }
        Ok(header)
    }

    /// The blocks of one spectral part.
    fn part(&self, words: &mut Words<'_>, name: &str) -> Result<Vec<Block>, IoError> {
        key(words, name)?;
        key(words, "DataBegin")?;
        let mut blocks = Vec::new();
        for _ in 0..self.rotations.len() * self.incidences.len() {
            let tis = words.takes("TIS").then(|| words.number("TIS")).transpose()?;
            let n = self.azimuths.len() * self.radials.len();
            let values = words.numbers("BSDF", n)?;
            blocks.push(Block { tis, values });
        }
        key(words, "DataEnd")?;
        Ok(blocks)
    }

    fn scans(&self, parts: &[Vec<Block>], words: &Words<'_>, path: &Path) -> Vec<Scan> {
        let comments: Vec<String> = words
            .comments()
            .iter()
            .map(|c| decode(c).trim().to_owned())
            .collect();
        let mut meta = ScanMeta {
            source: Some(path.display().to_string()),
            ..ScanMeta::default()
        };
        meta.other
            .insert("symmetry".into(), SYMMETRIES[self.symmetry].into());
        let comments = comments.join("\n").trim().to_owned();
        if !comments.is_empty() {
            meta.other.insert("comments".into(), comments);
        }
        let mut scans = Vec::new();
        let mut k = 0;
        for &rotation in &self.rotations {
            for &theta in &self.incidences {
                let blocks: Vec<&Block> = parts.iter().map(|p| &p[k]).collect();
                k += 1;
                self.incidence(theta, rotation, &blocks, &meta, &mut scans);
            }
        }
        scans
    }

    /// Adds the scans of one incidence.
    fn incidence(
        &self,
        theta: f64,
        rotation: f64,
        blocks: &[&Block],
        meta: &ScanMeta,
        scans: &mut Vec<Scan>,
    ) {
        let incidence = Angles::from_degrees(theta, rotation);
        let frame = Frame::new(incidence, self.component);
        let cells = self.cells(blocks);
        let mut meta = meta.clone();
        let tis: Vec<String> = blocks
            .iter()
            .filter_map(|b| b.tis)
            .map(|t| t.to_string())
            .collect();
        if !tis.is_empty() {
            meta.other.insert("tis".into(), tis.join(" "));
        }
        let mut columns = [Vec::new(), Vec::new()];
        let mut values: [Vec<f64>; 4] = Default::default();
        let (mut beyond, mut mirrored) = (0usize, 0usize);
        for (cell, azimuth) in cells {
            let radial = self.radials[cell % self.radials.len()];
            let Some(direction) = frame.on_its_side(azimuth, radial) else {
                beyond += 1;
                continue;
            };
            mirrored += usize::from(self.symmetry == 0 && azimuth > 180.0);
            let angles = direction.angles();
            columns[0].push(angles.theta);
            columns[1].push(angles.phi);
            match blocks {
                [x, y, z] => {
                    let xyz = [x, y, z].map(|b| b.values[cell]);
                    let [r, g, b] = radiance_rgb(xyz);
                    for (column, v) in values.iter_mut().zip([xyz[1], r, g, b]) {
                        column.push(v);
                    }
                }
                _ => values[0].push(blocks[0].values[cell]),
            }
        }
        for (name, count) in [("cells_beyond_horizon", beyond), ("readings_mirrored", mirrored)] {
            if count > 0 {
                meta.other.insert(name.into(), count.to_string());
            }
        }
        let channels = match self.channel {
            Some(channel) => vec![channel],
            None => vec![Channel::Photopic, Channel::Red, Channel::Green, Channel::Blue],
        };
        let [theta_s, phi_s] = columns;
        scans.extend(channels.into_iter().zip(values).map(|(channel, value)| Scan {
            kind: self.kind,
            quantity: Quantity::Bsdf,
            channel,
            incidence,
            theta_s: theta_s.clone(),
            phi_s: phi_s.clone(),
            value,
            time: None,
            meta: meta.clone(),
        }));
    }

    /// The cells of a block that make readings, each with its azimuth: a plane-symmetrical file is completed by the
    /// mirrored azimuths; what repeats a direction with the same values (the pole, azimuth 360) stands once.
    fn cells(&self, blocks: &[&Block]) -> Vec<(usize, f64)> {
        let (n, width) = (self.azimuths.len(), self.radials.len());
        let same = |a: usize, b: usize| blocks.iter().all(|p| p.values[a] == p.values[b]);
        let mut cells = Vec::with_capacity(2 * n * width);
        for (row, &azimuth) in self.azimuths.iter().enumerate() {
            for (column, &radial) in self.radials.iter().enumerate() {
                let cell = row * width + column;
                let at_pole = radial == 0.0 && row > 0 && same(cell, column);
                let closes = azimuth == 360.0 && self.azimuths[0] == 0.0 && same(cell, column);
                if at_pole || closes {
                    continue;
                }
                cells.push((cell, azimuth));
                if self.symmetry == 0 && azimuth > 0.0 && azimuth < 180.0 && radial > 0.0 {
                    cells.push((cell, 360.0 - azimuth));
                }
            }
        }
        cells
    }
}
