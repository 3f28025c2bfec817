//! The streaming reader.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use gonio_bsdf::klems::{Klems, KlemsBasis, KlemsMatrix};
use gonio_bsdf::tensor_tree::{TensorTree, Tree};
use gonio_bsdf::{BsdfError, Channel, FourComponents};
use gonio_geom::{Component, Side};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::stream::{Lines, Stop, skip_text, tokens};
use super::values::{MatrixValues, Structure, TreeValues};
use super::{Material, RadianceXml, Tabulated, channel_of, component_of};
use crate::{IoError, excerpt};

/// Deepest nesting of elements.
const MAX_NESTING: usize = 64;

/// Reads the data of `channel` ([`Channel::Photopic`] is the file's `Visible`) from a BSDF XML file: one layer, up to
/// four components. Data of other wavelengths, colour coordinates and absorptances are passed over.
///
/// # Errors
/// [`IoError`] with line and field: a file that cannot be opened, malformed XML, an unknown data structure or angle
/// basis, a value that is no BSDF, too few or too many values, two blocks for one component, or no data for `channel`
/// (the message lists the wavelengths that are there).
pub fn read(path: &Path, channel: Channel) -> Result<RadianceXml, IoError> {
    let refused = |e| IoError::file(path, e);
    let file = File::open(path).map_err(refused)?;
    if file.metadata().map_err(refused)?.is_dir() {
        return Err(refused(std::io::ErrorKind::IsADirectory.into()));
    }
    read_from(BufReader::with_capacity(1 << 16, file), path, channel)
}

/// [`read`] from any stream; `path` is only named in errors.
///
/// # Errors
/// As [`read`].
pub fn read_from(input: impl BufRead, path: &Path, channel: Channel) -> Result<RadianceXml, IoError> {
    let mut reader = Reader::from_reader(Lines::new(input));
    reader.config_mut().expand_empty_elements = true;
    let mut state = State::new(path, channel);
    let mut buffer = Vec::new();
    loop {
        buffer.clear();
        let line = reader.get_ref().line();
        let event = match reader.read_event_into(&mut buffer) {
            Err(quick_xml::Error::Io(e)) => {
                return Err(IoError::file(path, std::io::Error::new(e.kind(), e.to_string())));
            }
            Err(e) => {
                return Err(IoError::format(
                    path,
                    line,
                    "XML",
                    e.to_string(),
                    "well-formed XML in UTF-8",
                ));
            }
            Ok(event) => event,
        };
        match event {
            Event::Start(e) => {
                let name = e.local_name().into_inner().to_owned();
                state.start(&name, &e, line)?;
            }
            Event::End(_) => state.end(line)?,
            Event::Text(e) => state.text.push_str(&e.xml10_content()),
            Event::CData(e) => state.text.push_str(&e.into_inner()),
            Event::GeneralRef(e) => {
                let c = match e.resolve_char_ref() {
                    Ok(Some(c)) => Some(c),
                    _ => match &*e.xml10_content() {
                        "amp" => Some('&'),
                        "lt" => Some('<'),
                        "gt" => Some('>'),
                        "quot" => Some('"'),
                        "apos" => Some('\''),
                        _ => None,
                    },
                };
                match c {
                    Some(c) => state.text.push(c),
                    None => {
                        let found = excerpt(e.xml10_content().as_bytes());
                        return Err(IoError::format(
                            path,
                            line,
                            "entity",
                            found,
                            "amp, lt, gt, quot, apos or a number",
                        ));
                    }
                }
            }
            Event::Eof => return state.finish(line),
            Event::Empty(_) | Event::Comment(_) | Event::Decl(_) | Event::PI(_) | Event::DocType(_) => {}
        }
        if state.in_scattering_data() {
            let line = |r: &Reader<Lines<_>>| r.get_ref().line();
            let outcome = match state.sink.as_mut() {
                None => skip_text(&mut reader.stream()).map_err(Stop::Io),
                Some(Sink::Matrix(m)) => tokens(&mut reader.stream(), |t| m.push(t)),
                Some(Sink::Tree(t)) => tokens(&mut reader.stream(), |token| t.push(token)),
            };
            outcome.map_err(|stop| state.stopped(stop, line(&reader)))?;
        }
    }
}

/// Where the numbers of the block at hand go.
enum Sink {
    Matrix(MatrixValues),
    Tree(TreeValues),
}

/// A ring as the file is telling it.
#[derive(Default)]
struct Block {
    lower: Option<f64>,
    upper: Option<f64>,
    n_phi: Option<usize>,
}

struct State<'a> {
    path: &'a Path,
    channel: Channel,
    stack: Vec<String>,
    text: String,
    unit: String,
    layers: usize,
    material: Material,
    structure: Option<Structure>,
    bases: Vec<KlemsBasis>,
    basis_name: String,
    blocks: Vec<Block>,
    wavelength: Option<(String, Option<Channel>)>,
    seen: Vec<String>,
    direction: Option<(Side, Component)>,
    column: Option<KlemsBasis>,
    row: Option<KlemsBasis>,
    sink: Option<Sink>,
    matrices: FourComponents<KlemsMatrix>,
    trees: FourComponents<Tree>,
}

impl<'a> State<'a> {
    fn new(path: &'a Path, channel: Channel) -> Self {
        State {
            path,
            channel,
            stack: Vec::new(),
            text: String::new(),
            unit: String::new(),
            layers: 0,
            material: Material::default(),
            structure: None,
            bases: Vec::new(),
            basis_name: String::new(),
            blocks: Vec::new(),
            wavelength: None,
            seen: Vec::new(),
            direction: None,
            column: None,
            row: None,
            sink: None,
            matrices: FourComponents::default(),
            trees: FourComponents::default(),
        }
    }

    fn error(&self, line: u64, field: &str, found: impl Into<String>, allowed: impl Into<String>) -> IoError {
        IoError::format(self.path, line, field, found, allowed)
    }

    fn stopped(&self, stop: Stop, line: u64) -> IoError {
        match stop {
            Stop::Io(e) => IoError::file(self.path, e),
            Stop::Long(text) => self.error(
                line,
                "ScatteringData",
                excerpt(&text),
                "a number of at most 64 characters",
            ),
            Stop::Fault {
                field,
                found,
                allowed,
            } => self.error(line, field, found, allowed),
        }
    }

    fn inside(&self, name: &str) -> bool {
        self.stack.iter().any(|s| s == name)
    }

    fn in_scattering_data(&self) -> bool {
        self.stack.last().is_some_and(|s| s == "ScatteringData")
    }

    fn start(&mut self, name: &str, e: &BytesStart<'_>, line: u64) -> Result<(), IoError> {
        if self.stack.is_empty() && name != "WindowElement" {
            return Err(self.error(line, "root element", excerpt(name.as_bytes()), "WindowElement"));
        }
        if self.stack.len() >= MAX_NESTING || self.in_scattering_data() {
            return Err(self.error(
                line,
                "element",
                excerpt(name.as_bytes()),
                "the elements of a BSDF file",
            ));
        }
        self.stack.push(name.to_owned());
        self.text.clear();
        self.unit = match e.try_get_attribute("unit") {
            Ok(unit) => unit.map(|a| a.value.into_owned()).unwrap_or_default(),
            Err(e) => return Err(self.error(line, "attribute", e.to_string(), "well-formed XML")),
        };
        match name {
            "Layer" => {
                self.layers += 1;
                if self.layers > 1 {
                    return Err(self.error(line, "Layer", "a second layer", "one layer"));
                }
            }
            "AngleBasis" if self.inside("DataDefinition") => {
                self.basis_name.clear();
                self.blocks.clear();
            }
            "AngleBasisBlock" => self.blocks.push(Block::default()),
            "WavelengthData" => self.wavelength = None,
            "WavelengthDataBlock" => {
                self.direction = None;
                self.column = None;
                self.row = None;
            }
            "ScatteringData" => self.open_data(line)?,
            _ => {}
        }
        Ok(())
    }

    fn open_data(&mut self, line: u64) -> Result<(), IoError> {
        self.sink = None;
        let Some((_, channel)) = self.wavelength else {
            return Err(self.error(
                line,
                "Wavelength",
                "none before the data",
                "one for each WavelengthData",
            ));
        };
        let Some((side, component)) = self.direction else {
            return Ok(()); // absorptance and the like
        };
        if channel != Some(self.channel) {
            return Ok(());
        }
        if self.matrices.get(side, component).is_some() || self.trees.get(side, component).is_some() {
            return Err(self.error(
                line,
                "WavelengthDataDirection",
                format!("{:?} twice", super::direction_name(side, component)),
                "each direction once",
            ));
        }
        let none = |field| IoError::format(self.path, line, field, "none before the data", "one");
        self.sink = Some(match self.structure {
            None => return Err(none("IncidentDataStructure")),
            Some(Structure::Tree(rank)) => Sink::Tree(TreeValues::new(rank)),
            Some(structure) => Sink::Matrix(MatrixValues::new(
                structure,
                self.column.clone().ok_or_else(|| none("ColumnAngleBasis"))?,
                self.row.clone().ok_or_else(|| none("RowAngleBasis"))?,
            )),
        });
        Ok(())
    }

    fn end(&mut self, line: u64) -> Result<(), IoError> {
        let Some(name) = self.stack.pop() else {
            return Err(self.error(line, "XML", "an end without a start", "well-formed XML"));
        };
        let text = std::mem::take(&mut self.text);
        let text = text.trim();
        let parent = self.stack.last().map_or("", String::as_str);
        match (parent, name.as_str()) {
            ("Material", "Name") => self.material.name = text.to_owned(),
            ("Material", "Manufacturer") => self.material.manufacturer = text.to_owned(),
            ("Material", "DeviceType") => self.material.device_type = text.to_owned(),
            ("Material", "Thickness") => self.material.thickness = self.length("Thickness", text, line)?,
            ("Material", "Width") => self.material.width = self.length("Width", text, line)?,
            ("Material", "Height") => self.material.height = self.length("Height", text, line)?,
            (_, "IncidentDataStructure") => {
                let found = Structure::of(text)
                    .ok_or_else(|| self.error(line, &name, excerpt(text.as_bytes()), Structure::ALLOWED))?;
                self.structure = Some(found);
            }
            (_, "AngleBasisName") => self.basis_name = text.to_owned(),
            (_, "LowerTheta") => {
                let v = self.number(&name, text, line)?;
                if let Some(b) = self.blocks.last_mut() {
                    b.lower = Some(v);
                }
            }
            (_, "UpperTheta") => {
                let v = self.number(&name, text, line)?;
                if let Some(b) = self.blocks.last_mut() {
                    b.upper = Some(v);
                }
            }
            (_, "nPhis") => {
                let n = text
                    .parse()
                    .map_err(|_| self.error(line, &name, excerpt(text.as_bytes()), "a whole number"))?;
                if let Some(b) = self.blocks.last_mut() {
                    b.n_phi = Some(n);
                }
            }
            ("DataDefinition", "AngleBasis") => self.close_basis(line)?,
            ("WavelengthData", "Wavelength") => {
                self.wavelength = Some((text.to_owned(), channel_of(text, &self.unit)));
                if !self.seen.iter().any(|s| s == text) && self.seen.len() < 100 {
                    self.seen.push(text.to_owned());
                }
            }
            (_, "WavelengthDataDirection") => {
                self.direction = component_of(text);
                let known = ["absorptance", "emissivity"];
                let other = text.to_ascii_lowercase();
                if self.direction.is_none() && !known.iter().any(|k| other.starts_with(k)) {
                    return Err(self.error(
                        line,
                        &name,
                        excerpt(text.as_bytes()),
                        "Transmission Front, Transmission Back, Reflection Front, Reflection Back",
                    ));
                }
            }
            (_, "ColumnAngleBasis") => self.column = Some(self.basis(&name, text, line)?),
            (_, "RowAngleBasis") => self.row = Some(self.basis(&name, text, line)?),
            (_, "ScatteringData") => self.close_data(line)?,
            _ => {}
        }
        Ok(())
    }

    fn number(&self, field: &str, text: &str, line: u64) -> Result<f64, IoError> {
        text.parse::<f64>()
            .ok()
            .filter(|v| v.is_finite())
            .ok_or_else(|| self.error(line, field, excerpt(text.as_bytes()), "a number"))
    }

    /// A length in metres; empty is unknown.
    fn length(&self, field: &str, text: &str, line: u64) -> Result<Option<f64>, IoError> {
        if text.is_empty() {
            return Ok(None);
        }
        let value = self.number(field, text, line)?;
        let metres = match self.unit.to_ascii_lowercase().as_str() {
            "" | "meter" | "metre" => value,
            "centimeter" => value / 100.0,
            "millimeter" => value / 1000.0,
            "inch" => value * 0.0254,
            "foot" => value * 0.3048,
            other => {
                let allowed = "meter, centimeter, millimeter, inch, foot";
                return Err(self.error(
                    line,
                    &format!("unit of {field}"),
                    excerpt(other.as_bytes()),
                    allowed,
                ));
            }
        };
        Ok(Some(metres))
    }

    fn close_basis(&mut self, line: u64) -> Result<(), IoError> {
        if self.blocks.is_empty() {
            return Ok(()); // a name alone
        }
        let whole: Option<Vec<(f64, f64, usize)>> = self
            .blocks
            .iter()
            .map(|b| Some((b.lower?, b.upper?, b.n_phi?)))
            .collect();
        let Some(rings) = whole else {
            return Err(self.error(
                line,
                "AngleBasisBlock",
                "an incomplete ring",
                "LowerTheta, UpperTheta and nPhis",
            ));
        };
        let gapless = rings.windows(2).all(|w| w[0].1 == w[1].0);
        if !gapless {
            return Err(self.error(
                line,
                "ThetaBounds",
                "rings with a gap",
                "each ring begins where the last one ends",
            ));
        }
        let bounds: Vec<f64> = std::iter::once(rings[0].0)
            .chain(rings.iter().map(|r| r.1))
            .collect();
        let n_phi: Vec<usize> = rings.iter().map(|r| r.2).collect();
        let basis =
            KlemsBasis::new(self.basis_name.clone(), &bounds, &n_phi).map_err(|e| self.domain(e, line))?;
        if let Ok(standard) = KlemsBasis::by_name(&self.basis_name)
            && standard.rings() != basis.rings()
        {
            return Err(self.error(
                line,
                "AngleBasis",
                format!("rings that are not those of {}", standard.name()),
                "the standard rings under a standard name",
            ));
        }
        self.bases.push(basis);
        Ok(())
    }

    fn domain(&self, e: BsdfError, line: u64) -> IoError {
        let BsdfError::Domain {
            field,
            found,
            allowed,
        } = e;
        self.error(line, field, found, allowed)
    }

    fn basis(&self, field: &str, name: &str, line: u64) -> Result<KlemsBasis, IoError> {
        if matches!(self.structure, Some(Structure::Tree(_))) {
            return Ok(KlemsBasis::full()); // not used by trees
        }
        if let Some(b) = self.bases.iter().find(|b| b.name().eq_ignore_ascii_case(name)) {
            return Ok(b.clone());
        }
        KlemsBasis::by_name(name).map_err(|_| {
            let own: Vec<&str> = self.bases.iter().map(KlemsBasis::name).collect();
            self.error(
                line,
                field,
                excerpt(name.as_bytes()),
                format!(
                    "LBNL/Klems Full, Half, Quarter or a basis the file defines ({})",
                    own.join(", ")
                ),
            )
        })
    }

    fn close_data(&mut self, line: u64) -> Result<(), IoError> {
        let (Some(sink), Some((side, component))) = (self.sink.take(), self.direction) else {
            return Ok(());
        };
        match sink {
            Sink::Matrix(m) => {
                let m = m.finish().map_err(|s| self.stopped(s, line))?;
                self.matrices.set(side, component, Some(m));
            }
            Sink::Tree(t) => {
                let t = t.finish().map_err(|s| self.stopped(s, line))?;
                self.trees.set(side, component, Some(t));
            }
        }
        Ok(())
    }

    fn finish(self, line: u64) -> Result<RadianceXml, IoError> {
        if let Some(open) = self.stack.last() {
            return Err(self.error(line, open, "the end of the file", "the end of the element"));
        }
        let model = match (self.matrices.is_empty(), self.trees.is_empty()) {
            (false, true) => Tabulated::Klems(Klems::new(self.channel, self.matrices)),
            (true, false) => Tabulated::TensorTree(TensorTree::new(self.channel, self.trees)),
            (false, false) => {
                return Err(IoError::format(
                    self.path,
                    None,
                    "IncidentDataStructure",
                    "matrices and trees in one file",
                    "one of them",
                ));
            }
            (true, true) => {
                let there = if self.seen.is_empty() {
                    "a file without data".to_owned()
                } else {
                    format!("data for {} only", self.seen.join(", "))
                };
                return Err(IoError::format(
                    self.path,
                    None,
                    "Wavelength",
                    there,
                    format!("data for the channel asked for ({})", self.channel),
                ));
            }
        };
        Ok(RadianceXml {
            material: self.material,
            model,
        })
    }
}
