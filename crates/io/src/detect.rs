//! Which format a file has, by its content.

use std::fmt;
use std::io::Read;
use std::path::Path;
use std::str::FromStr;

use gonio_scan::Scan;

use crate::error::open;
use crate::{
    IoError, ReadOptions, astm, excerpt, gonio_raw, mountain, nist_ptfe, speos, table, tensor_file, zemax,
};

/// A format of readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// pab-opto Mountain text.
    Mountain,
    /// gonio's own raw text.
    GonioRaw,
    /// The NIST table of sintered PTFE.
    NistPtfe,
    /// Zemax OpticStudio tabular BSDF.
    Zemax,
    /// Ansys Speos anisotropic BSDF, text.
    Speos,
    /// Text after ASTM E1392.
    Astm,
    /// A table with one row a reading.
    Table,
}

impl Format {
    /// Every format with the name the command line and Python use.
    pub const NAMES: [(Format, &'static str); 7] = [
        (Format::Mountain, "mountain"),
        (Format::GonioRaw, "gonio-raw"),
        (Format::NistPtfe, "nist-ptfe"),
        (Format::Zemax, "zemax-bsdf"),
        (Format::Speos, "speos-bsdf"),
        (Format::Astm, "astm"),
        (Format::Table, "table"),
    ];

    /// Name used on the command line and in Python.
    pub fn name(self) -> &'static str {
        Self::NAMES
            .iter()
            .find(|(f, _)| *f == self)
            .map_or("", |(_, name)| name)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that is no format.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("format: found {0:?}, allowed {list}", list = names())]
pub struct UnknownFormat(pub String);

fn names() -> String {
    Format::NAMES.map(|(_, name)| name).join(", ")
}

impl FromStr for Format {
    type Err = UnknownFormat;
    fn from_str(s: &str) -> Result<Self, Self::Err> {
        Format::NAMES
            .into_iter()
            .find(|(_, name)| name.eq_ignore_ascii_case(s))
            .map(|(f, _)| f)
            .ok_or_else(|| UnknownFormat(s.into()))
    }
}

/// How far into a file its format is looked for, in bytes.
const WINDOW: usize = 1 << 16;

/// The format of `bytes`, the beginning of a file; `path` is named in errors.
///
/// # Errors
/// Content that belongs to no format gonio reads as readings.
pub fn detect(bytes: &[u8], path: &Path) -> Result<Format, IoError> {
    let head = &bytes[..bytes.len().min(WINDOW)];
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let unknown = |found: String, allowed: &str| Err(IoError::format(path, None, "file", found, allowed));
    if head.is_empty() {
        return unknown("0 bytes".into(), "a file with readings");
    }
    if head.starts_with(gonio_raw::MAGIC.as_bytes()) {
        return Ok(Format::GonioRaw);
    }
    if head.starts_with(nist_ptfe::MAGIC.as_bytes()) {
        return Ok(Format::NistPtfe);
    }
    if head.starts_with(speos::MAGIC.as_bytes()) {
        return Ok(Format::Speos);
    }
    if astm::is_astm(head) {
        return Ok(Format::Astm);
    }
    if zemax::is_zemax(head) {
        return Ok(Format::Zemax);
    }
    let mut lines = head.split(|&b| b == b'\n');
    const KEYS: [&[u8]; 4] = [b"format", b"intheta", b"inphi", b"incident_angle"];
    let mut header = lines.clone().map_while(|l| l.strip_prefix(b"#"));
    if header.any(|l| KEYS.iter().any(|k| l.starts_with(k))) {
        return Ok(Format::Mountain);
    }
    // a header row with gonio's own names of columns
    let first = lines.find(|l| !l.is_empty() && l[0] != b'#').unwrap_or_default();
    let mut words = first.split(|b| b",;\t\r".contains(b)).map(<[u8]>::trim_ascii);
    if words.clone().any(|w| w == b"theta_s") && words.any(|w| w == b"value") {
        return Ok(Format::Table);
    }
    let kind = known_but_other(head).map_or_else(
        || {
            format!(
                "content that no format of readings matches, beginning {}",
                excerpt(head)
            )
        },
        str::to_string,
    );
    let allowed = format!(
        "{}, rt300s, bird-json and parquet (Python package); state the format of a table, its columns and its quantity \
         (--format table --column value=NAME --column theta_i=NAME --quantity bsdf)",
        names()
    );
    unknown(kind, &allowed)
}

/// What a file is that this module does not read, where its first bytes tell.
fn known_but_other(head: &[u8]) -> Option<&'static str> {
    const MAGICS: [(&[u8], &str); 7] = [
        (b"<?xml", "XML, perhaps a Radiance BSDF: a model, not readings"),
        (b"<WindowElement", "a Radiance BSDF XML: a model, not readings"),
        (
            tensor_file::MAGIC,
            "a tensor file, perhaps an RGL material: a model, not readings",
        ),
        (
            b"PAR1",
            "a Parquet file; gonio.read of the Python package reads it",
        ),
        (
            b"\xd0\xcf\x11\xe0",
            "an .xls workbook; gonio.read of the Python package reads those of the RT-300S",
        ),
        (b"PK\x03\x04", "a zip archive or .xlsx workbook; export it as CSV"),
        (b"\x89HDF", "an HDF5 or netCDF file"),
    ];
    MAGICS
        .into_iter()
        .find(|(magic, _)| head.starts_with(magic))
        .map(|(_, name)| name)
}

/// [`detect`] of a file.
///
/// # Errors
/// As [`detect`], and refusals of the operating system.
pub fn detect_file(path: &Path) -> Result<Format, IoError> {
    let mut head = Vec::with_capacity(WINDOW);
    let refused = |e| IoError::file(path, e);
    open(path)?
        .0
        .take(WINDOW as u64)
        .read_to_end(&mut head)
        .map_err(refused)?;
    detect(&head, path)
}

/// Reads the records of a file in the stated format, or in the one its content shows. A mapping of columns states a
/// table.
///
/// # Errors
/// Everything the reader of that format refuses, and content that no format matches.
pub fn read_any(path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    match stated(options).map_or_else(|| detect_file(path), Ok)? {
        Format::Mountain => mountain::read(path, options),
        Format::GonioRaw => gonio_raw::read(path, options),
        Format::NistPtfe => nist_ptfe::read(path, options),
        Format::Zemax => zemax::read(path, options),
        Format::Speos => speos::read(path, options),
        Format::Astm => astm::read(path, options),
        Format::Table => table::read(path, options),
    }
}

/// [`read_any`] of content in memory.
///
/// # Errors
/// As [`read_any`].
pub fn parse_any(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    match stated(options).map_or_else(|| detect(bytes, path), Ok)? {
        Format::Mountain => mountain::parse(bytes, path, options),
        Format::GonioRaw => gonio_raw::parse(bytes, path, options),
        Format::NistPtfe => nist_ptfe::parse(bytes, path, options),
        Format::Zemax => zemax::parse(bytes, path, options),
        Format::Speos => speos::parse(bytes, path, options),
        Format::Astm => astm::parse(bytes, path, options),
        Format::Table => table::parse(bytes, path, options),
    }
}

fn stated(options: &ReadOptions) -> Option<Format> {
    options
        .format
        .or_else(|| (!options.table.0.is_empty()).then_some(Format::Table))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(content: &[u8]) -> Result<Format, String> {
        detect(content, Path::new("a")).map_err(|e| e.to_string())
    }

    #[test]
    fn formats_are_recognised_by_content() {
        assert_eq!(found(b"#gonio raw 1\n"), Ok(Format::GonioRaw));
        assert_eq!(
            found(b"#sample_name x\r\n#format: theta phi DSF\r\n"),
            Ok(Format::Mountain)
        );
        assert_eq!(
            found(b"lambda,thetai,phi,thetar,phir,f_r11,x"),
            Ok(Format::NistPtfe)
        );
        assert_eq!(
            found(b"# by\r\n\r\nSource\tMeasured\r\nSymmetry PlaneSymmetrical"),
            Ok(Format::Zemax)
        );
        assert_eq!(found(b"theta_i;phi_i;theta_s;phi_s;value\r\n"), Ok(Format::Table));
    }

    #[test]
    fn other_content_is_named_with_the_formats_that_would_do() {
        for (content, what) in [
            (&b""[..], "0 bytes"),
            (b"<?xml version", "Radiance BSDF"),
            (b"\xd0\xcf\x11\xe0\xa1", ".xls workbook"),
            (b"\0\0\xff", "\\x00"),
            (b"# only a comment\n", "mountain, gonio-raw"),
        ] {
            let text = found(content).unwrap_err();
            assert!(text.contains(what), "{text}");
        }
    }

    #[test]
    fn refusals_of_the_operating_system_are_not_faults_of_the_format() {
        let dir = tempfile::tempdir().unwrap();
        let options = ReadOptions::default();
        for path in [dir.path().to_path_buf(), dir.path().join("nothing")] {
            for format in [None, Some(Format::Mountain), Some(Format::Table)] {
                let options = ReadOptions {
                    format,
                    ..options.clone()
                };
                assert!(matches!(read_any(&path, &options), Err(IoError::File { .. })));
            }
        }
    }

    #[test]
    fn a_name_that_is_no_format_lists_the_formats() {
        let text = "fits".parse::<Format>().unwrap_err().to_string();
        assert!(
            text.contains("mountain, gonio-raw, nist-ptfe, zemax-bsdf, speos-bsdf, astm, table"),
            "{text}"
        );
    }
}
