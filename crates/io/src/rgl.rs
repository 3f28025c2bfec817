//! RGL materials: the fields that a tensor file needs to be one, made into a model.

mod write;

use std::path::Path;

use gonio_bsdf::rgl::{Rgl, RglTables, Table};
use gonio_bsdf::{BsdfError, Channel};

use crate::error::read_bytes;
use crate::tensor_file::{Field, TensorFile};
use crate::{IoError, column};
pub use write::write;

/// A material of the RGL database with what its file says of it.
#[derive(Clone, Debug)]
pub struct RglFile {
    /// The material.
    pub model: Rgl,
    /// What the file says of it; empty when it says nothing.
    pub description: String,
    /// Share of the values of each channel that are negative.
    pub negative_share: Vec<f64>,
}

/// Reads an RGL material, in RGB or spectral.
///
/// # Errors
/// [`IoError::File`] for refusals of the operating system, [`IoError::Format`] for a file that is no tensor file, lacks a
/// field, or holds one of another type, shape or range than the format allows.
pub fn read(path: &Path) -> Result<RglFile, IoError> {
    parse(&read_bytes(path)?, path)
}

/// [`read`] of content in memory; `path` is named in errors.
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], path: &Path) -> Result<RglFile, IoError> {
    let file = TensorFile::parse(bytes, path)?;
    let fields = Fields { file: &file, path };
    let (spectra, channels) = fields.spectra()?;
    let luminance = fields.table("luminance")?;
    let valid = fields.valid(luminance.values.len())?;
    let negative_share = negative_share(&spectra, channels.len());
    let tables = RglTables {
        theta_i: fields.list("theta_i")?,
        phi_i: fields.list("phi_i")?,
        ndf: fields.table("ndf")?,
        sigma: fields.table("sigma")?,
        vndf: fields.table("vndf")?,
        luminance,
        spectra,
        channels,
        valid,
        jacobian: fields.flag("jacobian")?,
    };
    let model = Rgl::new(tables).map_err(
        |BsdfError::Domain {
             field,
             found,
             allowed,
         }| {
            // the model calls spectra what an RGB file calls rgb
            let field = if field == "spectra" {
                fields.colours()
            } else {
                field
            };
            IoError::format(path, None, field, found, allowed)
        },
    )?;
    Ok(RglFile {
        model,
        description: fields.text("description"),
        negative_share,
    })
}

/// Share of negative values in each channel of `[n_p, n_t, channels, h, w]`; zeros for another shape.
fn negative_share(spectra: &Table, channels: usize) -> Vec<f64> {
    let mut count = vec![0usize; channels];
    let nodes: usize = spectra.shape.iter().rev().take(2).product();
    if spectra.shape.len() == 5 && nodes > 0 && channels > 0 {
        for (k, table) in spectra.values.chunks(nodes).enumerate() {
            count[k % channels] += table.iter().filter(|v| **v < 0.0).count();
        }
    }
    let each = (spectra.values.len() / channels.max(1)).max(1) as f64;
    count.iter().map(|&n| n as f64 / each).collect()
}

/// The fields of a file by name.
struct Fields<'a> {
    file: &'a TensorFile<'a>,
    path: &'a Path,
}

impl Fields<'_> {
    fn wrong(&self, field: &str, found: impl Into<String>, allowed: impl Into<String>) -> IoError {
        IoError::format(self.path, None, field, found, allowed)
    }

    fn field(&self, name: &str) -> Result<&Field<'_>, IoError> {
        self.file.field(name).ok_or_else(|| {
            let there: Vec<&str> = self.file.fields.iter().map(|f| f.name.as_str()).collect();
            let found = format!("no such field among {}", there.join(", "));
            self.wrong(
                name,
                found,
                "an RGL material: theta_i, phi_i, ndf, sigma, vndf, luminance, rgb or spectra, jacobian",
            )
        })
    }

    fn floats(&self, name: &str) -> Result<(&Field<'_>, Vec<f32>), IoError> {
        let field = self.field(name)?;
        match field.floats() {
            Some(values) => Ok((field, values)),
            None => Err(self.wrong(name, field.number.name(), "float32")),
        }
    }

    fn table(&self, name: &str) -> Result<Table, IoError> {
        let (field, values) = self.floats(name)?;
        Ok(Table {
            shape: field.shape.clone(),
            values,
        })
    }

    /// A list of numbers.
    fn list(&self, name: &str) -> Result<Vec<f64>, IoError> {
        let (field, values) = self.floats(name)?;
        if field.shape.len() != 1 {
            return Err(self.wrong(name, format!("shape {:?}", field.shape), "one dimension"));
        }
        let mut list = column(values.len());
        list.extend(values.into_iter().map(f64::from));
        Ok(list)
    }

    fn flag(&self, name: &str) -> Result<bool, IoError> {
        let field = self.field(name)?;
        match field.bytes() {
            Some([byte @ 0..=1]) => Ok(*byte == 1),
            Some([byte]) => Err(self.wrong(name, byte.to_string(), "0 or 1")),
            _ => {
                let found = format!("{} of shape {:?}", field.number.name(), field.shape);
                Err(self.wrong(name, found, "one uint8"))
            }
        }
    }

    /// Name of the field that holds the colours.
    fn colours(&self) -> &'static str {
        if self.file.field("rgb").is_some() {
            "rgb"
        } else {
            "spectra"
        }
    }

    fn spectra(&self) -> Result<(Table, Vec<Channel>), IoError> {
        if self.colours() == "rgb" {
            return Ok((
                self.table("rgb")?,
                vec![Channel::Red, Channel::Green, Channel::Blue],
            ));
        }
        let table = self.table("spectra")?;
        let wavelengths = self.list("wavelengths")?;
        // channels are named in nm: as many digits as single precision has, not those of its conversion
        let channels = wavelengths
            .iter()
            .map(|&nm| (nm as f32).to_string().parse())
            .collect::<Result<Vec<Channel>, _>>();
        let ascend = wavelengths.windows(2).all(|w| w[0] < w[1]);
        match channels {
            Ok(channels) if ascend => Ok((table, channels)),
            _ => Err(self.wrong(
                "wavelengths",
                format!("{wavelengths:?}").chars().take(60).collect::<String>(),
                "ascending wavelengths of 100 to 100000 nm",
            )),
        }
    }

    /// The packed mask of `n` nodes, when the file has one: the highest bit of a byte is its first node.
    fn valid(&self, n: usize) -> Result<Option<Vec<bool>>, IoError> {
        let Some(field) = self.file.field("valid") else {
            return Ok(None);
        };
        match field.bytes() {
            Some(bytes) if bytes.len() == n.div_ceil(8) => Ok(Some(
                (0..n).map(|k| bytes[k / 8] >> (7 - k % 8) & 1 == 1).collect(),
            )),
            _ => {
                let found = format!("{} of shape {:?}", field.number.name(), field.shape);
                let allowed = format!("{} uint8, one bit a node of luminance", n.div_ceil(8));
                Err(self.wrong("valid", found, allowed))
            }
        }
    }

    fn text(&self, name: &str) -> String {
        let bytes = self.file.field(name).and_then(|f| f.bytes()).unwrap_or_default();
        String::from_utf8_lossy(bytes)
            .trim_matches(|c: char| c == '\0' || c.is_whitespace())
            .to_owned()
    }
}

#[cfg(test)]
mod tests;
