//! The file: header, slices, transports.

use std::path::Path;

use gonio_geom::{DVec3, Side};

use super::grid::{Grid, radius};
use super::mesh::{Edge, Node, Transport};
use super::model::{Frame, Interpolant, Symmetry};
use super::slice::Lobe;
use super::{FORMAT, MAGIC};
use crate::{IoError, excerpt};

/// Begins the binary part.
const BEGIN: u64 = 0x5a3c;
/// Bytes of a lobe: a number, then four of two bytes.
const LOBE: usize = 13;
/// Most incidences; a file has some tens.
const MOST_NODES: usize = 4096;
/// What a mesh without crossings has at most, times the incidences.
const MOST_EDGES: usize = 3;
/// A run of zeros of this length has more after it.
const LONG_RUN: usize = 0xff;

/// Reads the whole of a file.
pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<Interpolant, IoError> {
    let (frame, start) = header(bytes, path)?;
    let mut data = Bytes {
        bytes,
        at: start,
        path,
    };
    let begin = data.unsigned(2, "magic number")?;
    if begin != BEGIN {
        return Err(data.wrong("magic number", format!("{begin:#06x}"), format!("{BEGIN:#06x}")));
    }
    let nodes = nodes(&mut data, &frame)?;
    let edges = edges(&mut data, &nodes)?;
    if data.at != bytes.len() {
        let left = bytes.len() - data.at;
        return Err(data.wrong(
            "end",
            format!("{left} more bytes"),
            "nothing after the transports".into(),
        ));
    }
    Interpolant::new(frame, nodes, edges)
        .map_err(|(field, found, allowed)| IoError::format(path, None, field, found, allowed))
}

/// What the header says, and where it ends.
fn header(bytes: &[u8], path: &Path) -> Result<(Frame, usize), IoError> {
    let wrong = |line: usize, field: &str, found: String, allowed: &str| {
        Err(IoError::format(path, line as u64, field, found, allowed))
    };
    if !bytes.starts_with(MAGIC) {
        let first = bytes.split(|b| *b == b'\n').next().unwrap_or_default();
        return wrong(1, "first line", excerpt(first), "#?RADIANCE");
    }
    let (mut sides, mut symmetry, mut cells, mut floor) = (None, None, 256u16, 0.0);
    let (mut named, mut spectral) = (false, false);
    let (mut name, mut manufacturer, mut peak) = (String::new(), String::new(), None);
    let mut at = 0;
    for line in 1.. {
        let rest = &bytes[at..];
        let Some(end) = rest.iter().position(|b| *b == b'\n') else {
            return wrong(
                line,
                "header",
                "no empty line after it".into(),
                "a header and an empty line",
            );
        };
        at += end + 1;
        let text = String::from_utf8_lossy(&rest[..end]).trim_end().to_owned();
        if text.is_empty() {
            break;
        }
        let Some((key, value)) = text.split_once('=') else {
            continue;
        };
        let value = value.trim();
        let numbers: Vec<Option<f64>> = value
            .split_whitespace()
            .map(|w| w.parse::<f64>().ok().filter(|v| v.is_finite()))
            .collect();
        let found = || excerpt(value.as_bytes());
        match key {
            "FORMAT" if value == FORMAT => named = true,
            "FORMAT" => return wrong(line, "FORMAT", found(), FORMAT),
            "NAME" => name = value.to_owned(),
            "MANUFACT" => manufacturer = value.to_owned(),
            "COLORIMETRY" => match value {
                "CIE-Y" | "CIE-XYZ" | "Unknown" => spectral = false,
                _ => return wrong(line, "COLORIMETRY", found(), "CIE-Y, CIE-XYZ"),
            },
            "SYMMETRY" => match value.parse().ok().and_then(Symmetry::of_quadrants) {
                Some(known) => symmetry = Some(known),
                None => return wrong(line, "SYMMETRY", found(), "0 to 4, 6, 8, 9, 12 or 15"),
            },
            "IO_SIDES" => match numbers[..] {
                [Some(a), Some(b)] if a.abs() == 1.0 && b.abs() == 1.0 => sides = Some([a, b]),
                _ => return wrong(line, "IO_SIDES", found(), "two of 1 and -1"),
            },
            "GRIDRES" => match value.parse().ok().filter(|n| *n >= 16) {
                Some(n) => cells = n,
                None => return wrong(line, "GRIDRES", found(), "16 to 65535"),
            },
            "BSDFMIN" => match numbers[..] {
                [Some(v)] if v >= 0.0 => floor = v,
                _ => return wrong(line, "BSDFMIN", found(), "a number of 0 or more"),
            },
            "BSDFSPEC" => match numbers[..] {
                [Some(v), Some(r)] if v >= 0.0 && r > 0.0 => peak = Some([v, r]),
                _ => {
                    return wrong(
                        line,
                        "BSDFSPEC",
                        found(),
                        "a value of 0 or more and a width above 0",
                    );
                }
            },
            _ => {}
        }
    }
    let missing = |field: &str, allowed: &str| IoError::format(path, None, field, "nothing", allowed);
    if !named || spectral {
        return Err(missing("FORMAT", FORMAT));
    }
    let side = |sign: f64| if sign > 0.0 { Side::Front } else { Side::Back };
    let sides = sides.ok_or_else(|| missing("IO_SIDES", "two of 1 and -1"))?;
    let symmetry = symmetry.ok_or_else(|| missing("SYMMETRY", "0 to 4, 6, 8, 9, 12 or 15"))?;
    let frame = Frame {
        name,
        manufacturer,
        symmetry,
        from: side(sides[0]),
        to: side(sides[1]),
        grid: Grid {
            cells,
            sign: sides[1],
        },
        floor,
        peak,
    };
    Ok((frame, at))
}

/// The slices.
fn nodes(data: &mut Bytes<'_>, frame: &Frame) -> Result<Vec<Node>, IoError> {
    let mut nodes: Vec<Node> = Vec::new();
    loop {
        let ordinal = data.signed("incidence")?;
        if ordinal < 0 {
            break;
        }
        let what = format!("incidence {}", nodes.len());
        if ordinal as usize != nodes.len() || nodes.len() == MOST_NODES {
            let allowed = format!("{} (in order, up to {MOST_NODES})", nodes.len());
            return Err(data.wrong(&what, format!("number {ordinal}"), allowed));
        }
        let v = DVec3::new(data.float(&what)?, data.float(&what)?, data.float(&what)?);
        let found = format!("({}, {}, {})", v.x, v.y, v.z);
        let Some(incidence) = v
            .try_normalize()
            .filter(|v| Side::of_z(v.z) == frame.from && v.z != 0.0)
        else {
            return Err(data.wrong(&what, found, format!("a direction on the {} side", frame.from)));
        };
        let light = data.float(&what)?;
        if light < 0.0 {
            return Err(data.wrong(&what, format!("light {light}"), "0 or more".into()));
        }
        let count = data.signed(&what)?;
        let left = (data.bytes.len() - data.at) / LOBE;
        let Some(count) = usize::try_from(count).ok().filter(|n| *n <= left) else {
            let allowed = format!("0 to {left}, for which there are bytes; is the file cut short?");
            return Err(data.wrong(&what, format!("{count} lobes"), allowed));
        };
        let mut lobes = Vec::with_capacity(count);
        for _ in 0..count {
            let peak = data.float(&what)?;
            if peak < 0.0 {
                return Err(data.wrong(&what, format!("a lobe of {peak} /sr"), "0 or more".into()));
            }
            let _chroma = data.unsigned(2, &what)?;
            let width = data.unsigned(2, &what)? as u16;
            let (x, y) = (data.unsigned(2, &what)? as u16, data.unsigned(2, &what)? as u16);
            if x.max(y) >= frame.grid.cells {
                let allowed = format!("0 to {} each", frame.grid.cells - 1);
                return Err(data.wrong(&what, format!("a lobe in cell {x}, {y}"), allowed));
            }
            lobes.push(Lobe {
                peak,
                radius: radius(width),
                axis: frame.grid.direction(x, y),
            });
        }
        nodes.push(Node {
            incidence,
            light,
            lobes,
        });
    }
    if nodes.is_empty() {
        return Err(data.wrong("incidences", "none".into(), "one at least".into()));
    }
    Ok(nodes)
}

/// The transports.
fn edges(data: &mut Bytes<'_>, nodes: &[Node]) -> Result<Vec<Edge>, IoError> {
    let mut edges: Vec<Edge> = Vec::new();
    loop {
        let ends = [data.signed("transport")?, data.signed("transport")?];
        if ends == [-1, -1] {
            return Ok(edges);
        }
        let what = format!("transport {}", edges.len());
        let end = |k: i32| usize::try_from(k).ok().filter(|k| *k < nodes.len());
        let (Some(from), Some(to)) = (end(ends[0]), end(ends[1])) else {
            let found = format!("incidences {} and {}", ends[0], ends[1]);
            return Err(data.wrong(&what, found, format!("0 to {} each", nodes.len() - 1)));
        };
        let known = |e: &Edge| [e.from, e.to] == [from, to] || [e.to, e.from] == [from, to];
        if from == to || edges.iter().any(known) {
            let found = format!("incidences {from} and {to}");
            return Err(data.wrong(&what, found, "two that no other transport joins".into()));
        }
        if edges.len() == MOST_EDGES * nodes.len() {
            let allowed = format!("at most {} (a mesh without crossings)", edges.len());
            return Err(data.wrong("transports", format!("{} and more", edges.len() + 1), allowed));
        }
        let (rows, columns) = (nodes[from].lobes.len(), nodes[to].lobes.len());
        let whole = rows * columns;
        let mut shares = Vec::new();
        let mut at = 0usize;
        loop {
            let zeros = data.unsigned(1, &what)? as usize;
            at += zeros;
            if at >= whole {
                break;
            }
            if zeros == LONG_RUN {
                continue;
            }
            let share = data.float(&what)?;
            shares.push(((at / columns) as u32, (at % columns) as u32, share as f32));
            at += 1;
        }
        if at > whole {
            return Err(data.wrong(&what, format!("{at} entries"), format!("{whole}")));
        }
        edges.push(Edge {
            from,
            to,
            transport: Transport::new(shares, rows),
        });
    }
}

/// A cursor over big-endian numbers.
struct Bytes<'a> {
    bytes: &'a [u8],
    at: usize,
    path: &'a Path,
}

impl Bytes<'_> {
    fn wrong(&self, field: &str, found: String, allowed: String) -> IoError {
        IoError::format(
            self.path,
            None,
            format!("{field} (before byte {})", self.at),
            found,
            allowed,
        )
    }

    fn unsigned(&mut self, n: usize, field: &str) -> Result<u64, IoError> {
        let Some(bytes) = self.bytes[self.at..].get(..n) else {
            return Err(self.wrong(
                field,
                "the end of the file".into(),
                "more; is the file cut short?".into(),
            ));
        };
        self.at += n;
        Ok(bytes.iter().fold(0, |v, b| v << 8 | u64::from(*b)))
    }

    fn signed(&mut self, field: &str) -> Result<i32, IoError> {
        Ok(self.unsigned(4, field)? as u32 as i32)
    }

    /// Four bytes of mantissa in units of `2^31 - 1`, from the middle of the unit; one of a binary exponent.
    fn float(&mut self, field: &str) -> Result<f64, IoError> {
        let mantissa = f64::from(self.signed(field)?);
        let exponent = self.unsigned(1, field)? as u8 as i8;
        if mantissa == 0.0 {
            return Ok(0.0);
        }
        let middle = mantissa + 0.5f64.copysign(mantissa);
        Ok(middle / f64::from(i32::MAX) * f64::from(exponent).exp2())
    }
}
