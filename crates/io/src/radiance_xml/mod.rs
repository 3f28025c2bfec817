//! Radiance and WINDOW BSDF XML: Klems matrices and tensor trees (docs/formats/radiance-xml.md).
//!
//! The files name sides after WINDOW, whose front is the exterior: "Reflection Back" and "Transmission Back" are the
//! light that arrives on gonio's (and Radiance's) front. Reader and writer convert; nothing else has to know.

mod read;
mod stream;
#[cfg(test)]
mod tests;
mod values;
mod write;

use gonio_bsdf::klems::Klems;
use gonio_bsdf::tensor_tree::TensorTree;
use gonio_bsdf::{Bsdf, Channel};
use gonio_geom::{Component, Side};

pub use read::{channels, read, read_from};
pub use write::{write, write_to};

/// A model as the file holds it.
#[derive(Clone, Debug, PartialEq)]
pub enum Tabulated {
    /// Klems matrices.
    Klems(Klems),
    /// Tensor trees.
    TensorTree(TensorTree),
}

impl Tabulated {
    /// The model behind the common interface.
    pub fn as_bsdf(&self) -> &dyn Bsdf {
        match self {
            Tabulated::Klems(k) => k,
            Tabulated::TensorTree(t) => t,
        }
    }

    /// The channel of the model.
    pub fn channel(&self) -> Channel {
        self.as_bsdf().channels()[0]
    }

    /// The components that are there, as (side of incidence, component).
    pub fn components(&self) -> Vec<(Side, Component)> {
        match self {
            Tabulated::Klems(k) => k.matrices().iter().map(|(s, c, _)| (s, c)).collect(),
            Tabulated::TensorTree(t) => t.trees().iter().map(|(s, c, _)| (s, c)).collect(),
        }
    }
}

/// What a file says of the material. Empty text and `None` mean unknown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Material {
    /// Name.
    pub name: String,
    /// Manufacturer.
    pub manufacturer: String,
    /// Device type as WINDOW has it ("Other" when empty).
    pub device_type: String,
    /// Thickness in metres.
    pub thickness: Option<f64>,
    /// Width in metres.
    pub width: Option<f64>,
    /// Height in metres.
    pub height: Option<f64>,
}

/// One wavelength of a BSDF XML file.
#[derive(Clone, Debug, PartialEq)]
pub struct RadianceXml {
    /// The material.
    pub material: Material,
    /// The model.
    pub model: Tabulated,
}

/// Name of a component in the file.
fn direction_name(side: Side, component: Component) -> &'static str {
    match (component, side) {
        (Component::Reflection, Side::Front) => "Reflection Back",
        (Component::Reflection, Side::Back) => "Reflection Front",
        (Component::Transmission, Side::Front) => "Transmission Back",
        (Component::Transmission, Side::Back) => "Transmission Front",
    }
}

/// The component of a name in the file, in any case.
fn component_of(name: &str) -> Option<(Side, Component)> {
    gonio_bsdf::FourComponents::<()>::KEYS
        .into_iter()
        .find(|(s, c)| direction_name(*s, *c).eq_ignore_ascii_case(name))
}

/// Text of the `Wavelength` element and its `unit`; `None` for channels the format does not have.
fn wavelength_name(channel: Channel) -> Option<(&'static str, String)> {
    match channel {
        Channel::Photopic => Some(("Integral", "Visible".into())),
        Channel::Solar => Some(("Integral", "Solar".into())),
        Channel::Wavelength(nm) => Some(("Nanometer", nm.to_string())),
        Channel::Red | Channel::Green | Channel::Blue => None,
    }
}

/// The channel of a `Wavelength` element; `None` for integral wavelengths gonio has no channel for.
fn channel_of(text: &str, unit: &str) -> Option<Channel> {
    if text.eq_ignore_ascii_case("Visible") {
        return Some(Channel::Photopic);
    }
    if text.eq_ignore_ascii_case("Solar") {
        return Some(Channel::Solar);
    }
    let metres = match unit.to_ascii_lowercase().as_str() {
        "nanometer" | "nm" => 1.0,
        "micron" | "micrometer" => 1000.0,
        _ => return None,
    };
    let nm = text.trim().parse::<f64>().ok()? * metres;
    (100.0..=100_000.0)
        .contains(&nm)
        .then_some(Channel::Wavelength(nm))
}
