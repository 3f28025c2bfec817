//! Tables of readings whose columns the user names (docs/formats/table.md): one row a reading, a header row, any of
//! the separators comma, semicolon and tab.

use std::collections::BTreeMap;
use std::path::Path;

use gonio_bsdf::{Channel, Quantity};
use gonio_scan::{Scan, ScanKind, ScanMeta};

use crate::grouping::{Key, Scans, angles};
use crate::text::decode;
use crate::{IoError, ReadOptions, excerpt, read_bytes};

/// Which column of a table is what: gonio's name of a column to the name in the file, or to a number that holds for
/// every row (`theta_i`, `phi_i` of a table of one incidence). A name that is not given stands for itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TableMapping(pub BTreeMap<String, String>);

/// gonio's names of columns.
pub const NAMES: [&str; 9] = [
    "theta_i", "phi_i", "theta_s", "phi_s", "value", "kind", "quantity", "channel", "time",
];

/// Reads a table. Rows that share kind, quantity, channel and incidence make one scan, in the order of their first row.
///
/// # Errors
/// [`IoError`]: a column that is missing, a row of another width, a field that is no number, angles out of range, a
/// quantity or channel that neither the table nor `options` state.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    parse(&read_bytes(path)?, path, options)
}

/// [`read`] of content in memory; `path` is named in errors and kept as the source.
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    let mut rows = Rows::new(bytes, path)?;
    let columns = Columns::resolve(&rows.header, path, options)?;
    let mut scans = Scans::default();
    while let Some(row) = rows.next()? {
        let key = Key {
            kind: columns.kind.get(&row)?,
            quantity: columns.quantity.get(&row)?,
            channel: columns.channel.get(&row)?,
            incidence: angles(
                &row,
                ["theta_i", "phi_i"],
                columns.theta_i.get(&row)?,
                columns.phi_i.get(&row)?,
            )?,
        };
        let receiver = angles(
            &row,
            ["theta_s", "phi_s"],
            columns.theta_s.get(&row)?,
            columns.phi_s.get(&row)?,
        )?;
        let time = columns.time.as_ref().map(|c| c.get(&row)).transpose()?;
        scans.push(key, receiver, columns.value.get(&row)?, time);
    }
    let meta = ScanMeta {
        source: Some(path.display().to_string()),
        ..ScanMeta::default()
    };
    scans.finish(path, &meta)
}

/// The header and the rows of a table of text.
pub(crate) struct Rows<'a> {
    reader: csv::Reader<&'a [u8]>,
    pub(crate) header: Vec<String>,
    record: csv::ByteRecord,
    path: &'a Path,
    /// Lines of the file before the header row.
    before: u64,
}

/// One row with its place.
pub(crate) struct Row<'a> {
    record: &'a csv::ByteRecord,
    line: u64,
    path: &'a Path,
}

impl<'a> Rows<'a> {
    /// Reads the header row. The separator is the one of tab, semicolon and comma that the header row holds; lines
    /// that start with `#` are passed over.
    pub(crate) fn new(bytes: &'a [u8], path: &'a Path) -> Result<Self, IoError> {
        Rows::after(0, bytes, path)
    }

    /// [`Rows::new`] of a table that begins after `before` lines of the file.
    pub(crate) fn after(before: u64, bytes: &'a [u8], path: &'a Path) -> Result<Self, IoError> {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        if bytes.is_empty() {
            return Err(IoError::format(
                path,
                None,
                "file",
                "0 bytes",
                "a header row and readings",
            ));
        }
        if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
            let allowed = "UTF-8 or Latin-1; save the file as plain text";
            return Err(IoError::format(path, 1, "encoding", "UTF-16", allowed));
        }
        let first = bytes
            .split(|&b| b == b'\n')
            .find(|l| !l.is_empty() && l[0] != b'#')
            .unwrap_or_default();
        let separator = [b'\t', b';']
            .into_iter()
            .find(|s| first.contains(s))
            .unwrap_or(b',');
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(separator)
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_reader(bytes);
        let header = reader.byte_headers().map_err(|e| fault(path, before, &e))?;
        let header: Vec<String> = header.iter().map(decode).collect();
        Ok(Rows {
            reader,
            header,
            record: csv::ByteRecord::new(),
            path,
            before,
        })
    }

    /// The next row.
    pub(crate) fn next(&mut self) -> Result<Option<Row<'_>>, IoError> {
        if !self
            .reader
            .read_byte_record(&mut self.record)
            .map_err(|e| fault(self.path, self.before, &e))?
        {
            return Ok(None);
        }
        let line = self.before + self.record.position().map_or(0, csv::Position::line);
        Ok(Some(Row {
            record: &self.record,
            line,
            path: self.path,
        }))
    }
}

fn fault(path: &Path, before: u64, error: &csv::Error) -> IoError {
    let line = |position: &csv::Position| before + position.line();
    match error.kind() {
        csv::ErrorKind::UnequalLengths {
            pos,
            expected_len,
            len,
        } => IoError::format(
            path,
            pos.as_ref().map(line),
            "row",
            format!("{len} columns"),
            format!("{expected_len} columns, as the header row; is the file truncated?"),
        ),
        _ => IoError::format(
            path,
            error.position().map(line),
            "row",
            error.to_string(),
            "a table",
        ),
    }
}

impl Row<'_> {
    /// A fault in this row.
    pub(crate) fn fault(&self, field: &str, found: impl Into<String>, allowed: impl Into<String>) -> IoError {
        IoError::format(self.path, self.line, field, found, allowed)
    }

    /// The number in column `index`, called `name` in errors.
    pub(crate) fn number(&self, index: usize, name: &str) -> Result<f64, IoError> {
        let field = self.record.get(index).unwrap_or_default();
        let value = std::str::from_utf8(field)
            .ok()
            .and_then(|f| f.parse::<f64>().ok());
        match value {
            Some(x) if !x.is_infinite() => Ok(x),
            _ => Err(self.fault(
                name,
                excerpt(field),
                "a finite decimal number with a point, or nan",
            )),
        }
    }

    fn word(&self, index: usize) -> String {
        decode(self.record.get(index).unwrap_or_default())
    }
}

/// Where a number comes from.
enum Number {
    Column(usize, &'static str),
    Constant(f64),
}

impl Number {
    fn get(&self, row: &Row<'_>) -> Result<f64, IoError> {
        match *self {
            Number::Column(index, name) => row.number(index, name),
            Number::Constant(x) => Ok(x),
        }
    }
}

/// Where a name comes from.
enum Word<T> {
    Column(usize, &'static str, &'static str),
    Constant(T),
}

impl<T: std::str::FromStr + Copy> Word<T> {
    fn get(&self, row: &Row<'_>) -> Result<T, IoError> {
        match self {
            Word::Constant(value) => Ok(*value),
            Word::Column(index, name, allowed) => {
                let word = row.word(*index);
                word.parse()
                    .map_err(|_| row.fault(name, format!("{word:?}"), *allowed))
            }
        }
    }
}

struct Columns {
    theta_i: Number,
    phi_i: Number,
    theta_s: Number,
    phi_s: Number,
    value: Number,
    time: Option<Number>,
    kind: Word<ScanKind>,
    quantity: Word<Quantity>,
    channel: Word<Channel>,
}

impl Columns {
    fn resolve(header: &[String], path: &Path, options: &ReadOptions) -> Result<Self, IoError> {
        let mapping = &options.table.0;
        let fault =
            |field: &str, found: String, allowed: String| IoError::format(path, None, field, found, allowed);
        let columns = || format!("a column of the table ({})", header.join(", "));
        if let Some(unknown) = mapping.keys().find(|k| !NAMES.contains(&k.as_str())) {
            return Err(fault("columns", format!("{unknown:?}"), NAMES.join(", ")));
        }
        let index = |name: &str| -> Result<Option<usize>, IoError> {
            let in_file = mapping.get(name).map_or(name, String::as_str);
            let mut hits = header.iter().enumerate().filter(|(_, h)| *h == in_file);
            let first = hits.next();
            if hits.next().is_some() {
                return Err(fault(name, format!("two columns {in_file:?}"), "one".into()));
            }
            Ok(first.map(|(k, _)| k))
        };
        let number = |name: &'static str| -> Result<Option<Number>, IoError> {
            if let Some(k) = index(name)? {
                return Ok(Some(Number::Column(k, name)));
            }
            match mapping.get(name) {
                None => Ok(None),
                Some(given) => match given.parse::<f64>() {
                    Ok(x) if x.is_finite() => Ok(Some(Number::Constant(x))),
                    _ => Err(fault(
                        name,
                        format!("{given:?}"),
                        format!("{}, or a number", columns()),
                    )),
                },
            }
        };
        let needed = |name: &'static str| {
            number(name)?.ok_or_else(|| {
                fault(
                    name,
                    "no column of that name".into(),
                    format!("{}, mapped", columns()),
                )
            })
        };
        let word = |name: &'static str| -> Result<Option<usize>, IoError> {
            match (index(name)?, mapping.get(name)) {
                (None, Some(given)) => Err(fault(name, format!("{given:?}"), columns())),
                (found, _) => Ok(found),
            }
        };
        let quantities = "signal, bsdf, dsf, reflectance_factor";
        let channels = "photopic, red, green, blue, or a wavelength such as 532nm";
        let unstated = |name: &str, allowed: &str| {
            fault(name, "neither a column nor a statement".into(), allowed.into())
        };
        Ok(Columns {
            theta_i: needed("theta_i")?,
            phi_i: needed("phi_i")?,
            theta_s: needed("theta_s")?,
            phi_s: needed("phi_s")?,
            value: needed("value")?,
            time: number("time")?,
            kind: match word("kind")? {
                Some(k) => Word::Column(k, "kind", "sample, beam, dark, standard"),
                None => Word::Constant(options.kind.unwrap_or(ScanKind::Sample)),
            },
            quantity: match word("quantity")? {
                Some(k) => Word::Column(k, "quantity", quantities),
                None => Word::Constant(options.quantity.ok_or_else(|| unstated("quantity", quantities))?),
            },
            channel: match word("channel")? {
                Some(k) => Word::Column(k, "channel", channels),
                None => Word::Constant(options.channel.ok_or_else(|| unstated("channel", channels))?),
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn options(pairs: &[(&str, &str)]) -> ReadOptions {
        ReadOptions {
            quantity: Some(Quantity::Bsdf),
            channel: Some(Channel::Photopic),
            table: TableMapping(
                pairs
                    .iter()
                    .map(|(a, b)| (a.to_string(), b.to_string()))
                    .collect(),
            ),
            ..ReadOptions::default()
        }
    }

    fn parsed(content: &str, pairs: &[(&str, &str)]) -> Result<Vec<Scan>, IoError> {
        parse(content.as_bytes(), Path::new("a.csv"), &options(pairs))
    }

    const PLAIN: &str = "theta_i,phi_i,theta_s,phi_s,value\n10,0,20,30,1\n40,0,20,30,2\n10,0,30,30,3\n";

    #[test]
    fn rows_of_one_incidence_make_one_scan() {
        let scans = parsed(PLAIN, &[]).unwrap();
        assert_eq!(
            scans.iter().map(|s| s.value.clone()).collect::<Vec<_>>(),
            [vec![1.0, 3.0], vec![2.0]]
        );
    }

    #[test]
    fn columns_are_mapped_and_constants_fill_the_rest() {
        let content = "# bench 2\nIncident_angle; Measure_angle ; 390nm\n10;-78;0.7\n10;0;0.8\n";
        let mapping = [
            ("theta_i", "Incident_angle"),
            ("theta_s", "Measure_angle"),
            ("value", "390nm"),
            ("phi_i", "180"),
            ("phi_s", "0"),
        ];
        let scans = parsed(content, &mapping).unwrap();
        assert_eq!(scans.len(), 1);
        let (theta, phi) = scans[0].direction(0).angles().to_degrees();
        assert!((theta - 78.0).abs() < 1e-9 && (phi - 180.0).abs() < 1e-9);
    }

    #[test]
    fn names_in_columns_beat_statements() {
        let content = "theta_i\tphi_i\ttheta_s\tphi_s\tvalue\tchannel\tquantity\tkind\ttime\n0\t0\t1\t0\t1\t532nm\tdsf\tdark\t5\n";
        let scan = parsed(content, &[]).unwrap().remove(0);
        assert_eq!((scan.kind, scan.quantity), (ScanKind::Dark, Quantity::Dsf));
        assert_eq!(
            (scan.channel, scan.time),
            (Channel::Wavelength(532.0), Some(vec![5.0]))
        );
    }

    #[test]
    fn faults_name_column_and_line() {
        for (content, pairs, what) in [
            ("a,b\n1,2\n", &[][..], "theta_i: found no column"),
            (PLAIN, &[("theta_q", "x")][..], "theta_q"),
            (PLAIN, &[("value", "x")][..], "\"x\""),
            (PLAIN, &[("kind", "x")][..], "\"x\""),
            (
                "theta_i,phi_i,theta_s,phi_s,value\n10,0,20\n",
                &[],
                "line 2: row: found 3 columns",
            ),
            (
                "theta_i,phi_i,theta_s,phi_s,value\n10,0,20,30,x\n",
                &[],
                "line 2: value: found \"x\"",
            ),
            (
                "theta_i,phi_i,theta_s,phi_s,value\n10,0,20,30,inf\n",
                &[],
                "\"inf\"",
            ),
            (
                "theta_i,phi_i,theta_s,phi_s,value\n10,0,nan,30,1\n",
                &[],
                "theta_s: found NaN",
            ),
            (
                "theta_i,phi_i,theta_s,phi_s,value\n10,0,2000,30,1\n",
                &[],
                "theta_s: found 2000",
            ),
            (
                "theta_i,phi_i,theta_s,phi_s,value,value\n10,0,20,30,1,1\n",
                &[],
                "two columns",
            ),
            ("theta_i,phi_i,theta_s,phi_s,value\n", &[], "readings"),
            ("", &[], "0 bytes"),
        ] {
            let text = parsed(content, pairs).unwrap_err().to_string();
            assert!(text.contains(what), "{content:?}: {text}");
        }
    }

    #[test]
    fn quantity_and_channel_are_never_assumed() {
        let text = parse(PLAIN.as_bytes(), Path::new("a"), &ReadOptions::default())
            .unwrap_err()
            .to_string();
        assert!(
            text.contains("quantity: found neither a column nor a statement"),
            "{text}"
        );
    }

    proptest! {
        #[test]
        fn no_content_panics(tail in prop::collection::vec(any::<u8>(), 0..200)) {
            let content = ["theta_i,phi_i,theta_s,phi_s,value\n".as_bytes(), &tail].concat();
            let _ = parse(&content, Path::new("a"), &options(&[]));
            let _ = parse(&tail, Path::new("a"), &options(&[]));
        }
    }
}
