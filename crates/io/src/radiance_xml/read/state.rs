//! What the reader knows between two events: the open elements and what they have said so far.

use std::path::Path;

use gonio_bsdf::klems::{Klems, KlemsBasis, KlemsMatrix};
use gonio_bsdf::tensor_tree::{TensorTree, Tree};
use gonio_bsdf::{Channel, FourComponents};
use gonio_geom::{Component, Side};
use quick_xml::events::BytesStart;

use super::super::values::{MatrixValues, Structure, TreeValues};
use super::super::{Material, RadianceXml, Tabulated, channel_of, component_of, direction_name};
use super::basis::Block;
use crate::{IoError, excerpt};

/// Deepest nesting of elements.
const MAX_NESTING: usize = 64;

/// Where the numbers of the block at hand go.
pub(super) enum Sink {
    Matrix(MatrixValues),
    Tree(TreeValues),
}

/// The reader's state.
pub(super) struct State<'a> {
    pub(super) path: &'a Path,
    /// The channel whose data are kept; None keeps none and only lists what is there.
    pub(super) channel: Option<Channel>,
    pub(super) stack: Vec<String>,
    pub(super) text: String,
    pub(super) unit: String,
    pub(super) layers: usize,
    pub(super) material: Material,
    pub(super) structure: Option<Structure>,
    pub(super) bases: Vec<KlemsBasis>,
    pub(super) basis_name: String,
    pub(super) blocks: Vec<Block>,
    pub(super) wavelength: Option<(String, Option<Channel>)>,
    pub(super) seen: Vec<String>,
    pub(super) channels: Vec<Channel>,
    pub(super) direction: Option<(Side, Component)>,
    pub(super) column: Option<KlemsBasis>,
    pub(super) row: Option<KlemsBasis>,
    pub(super) sink: Option<Sink>,
    pub(super) matrices: FourComponents<KlemsMatrix>,
    pub(super) trees: FourComponents<Tree>,
}

impl<'a> State<'a> {
    pub(super) fn new(path: &'a Path, channel: Option<Channel>) -> Self {
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
            channels: Vec::new(),
            direction: None,
            column: None,
            row: None,
            sink: None,
            matrices: FourComponents::default(),
            trees: FourComponents::default(),
        }
    }

    pub(super) fn inside(&self, name: &str) -> bool {
        self.stack.iter().any(|s| s == name)
    }

    pub(super) fn in_scattering_data(&self) -> bool {
        self.stack.last().is_some_and(|s| s == "ScatteringData")
    }

    pub(super) fn start(&mut self, name: &str, e: &BytesStart<'_>, line: u64) -> Result<(), IoError> {
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

    pub(super) fn open_data(&mut self, line: u64) -> Result<(), IoError> {
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
        if let Some(there) = channel.filter(|c| !self.channels.contains(c)) {
            self.channels.push(there);
        }
        if channel.is_none() || channel != self.channel {
            return Ok(());
        }
        if self.matrices.get(side, component).is_some() || self.trees.get(side, component).is_some() {
            return Err(self.error(
                line,
                "WavelengthDataDirection",
                format!("{:?} twice", direction_name(side, component)),
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

    pub(super) fn end(&mut self, line: u64) -> Result<(), IoError> {
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

    pub(super) fn close_data(&mut self, line: u64) -> Result<(), IoError> {
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

    /// All elements are closed at the end of the file.
    pub(super) fn closed(&self, line: u64) -> Result<(), IoError> {
        match self.stack.last() {
            Some(open) => Err(self.error(line, open, "the end of the file", "the end of the element")),
            None => Ok(()),
        }
    }

    /// The model of `channel`, the one the data were kept of.
    pub(super) fn finish(self, channel: Channel) -> Result<RadianceXml, IoError> {
        let model = match (self.matrices.is_empty(), self.trees.is_empty()) {
            (false, true) => Tabulated::Klems(Klems::new(channel, self.matrices)),
            (true, false) => Tabulated::TensorTree(TensorTree::new(channel, self.trees)),
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
                    format!("data for the channel asked for ({channel})"),
                ));
            }
        };
        Ok(RadianceXml {
            material: self.material,
            model,
        })
    }
}
