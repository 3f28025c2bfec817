//! Writing RGL materials.

use std::path::Path;

use gonio_bsdf::Channel;
use gonio_bsdf::rgl::{RglTables, Table};

use crate::IoError;
use crate::tensor_file::{Data, NewField, write as write_fields};

/// Writes the tables of a material; `RglTables::of` makes them of any model. Channels red, green and blue, in this order,
/// are written as `rgb`, two or more ascending wavelengths as `spectra`.
///
/// # Errors
/// [`IoError::Format`] for other channels or a table that does not fit its shape; refusals of the operating system.
pub fn write(path: &Path, tables: &RglTables, description: &str) -> Result<(), IoError> {
    let wavelengths: Vec<f32> = tables
        .channels
        .iter()
        .filter_map(|c| match c {
            Channel::Wavelength(nm) => Some(*nm as f32),
            _ => None,
        })
        .collect();
    let n = tables.channels.len();
    let spectral = n >= 2 && wavelengths.len() == n && wavelengths.windows(2).all(|w| w[0] < w[1]);
    if !spectral && tables.channels != [Channel::Red, Channel::Green, Channel::Blue] {
        let found: Vec<String> = tables.channels.iter().map(ToString::to_string).collect();
        let allowed = "red, green, blue, or two and more ascending wavelengths";
        return Err(IoError::format(path, None, "channels", found.join(", "), allowed));
    }
    let single = |values: &[f64]| -> Vec<f32> { values.iter().map(|v| *v as f32).collect() };
    let (theta_i, phi_i) = (single(&tables.theta_i), single(&tables.phi_i));
    let jacobian = [u8::from(tables.jacobian)];
    let mask = tables.valid.as_ref().map(|valid| packed(valid));
    let list = |name, values, shape| NewField {
        name,
        shape,
        data: Data::Floats(values),
    };
    let bytes = |name, values, shape| NewField {
        name,
        shape,
        data: Data::Bytes(values),
    };
    fn table<'a>(name: &'a str, table: &'a Table) -> NewField<'a> {
        NewField {
            name,
            shape: &table.shape,
            data: Data::Floats(&table.values),
        }
    }
    // readers expect a description that is not empty
    let text = if description.is_empty() { " " } else { description };
    let shapes = [
        text.len(),
        theta_i.len(),
        phi_i.len(),
        wavelengths.len(),
        mask.as_ref().map_or(0, Vec::len),
    ];
    let mut fields = vec![
        bytes("description", text.as_bytes(), &shapes[0..1]),
        list("phi_i", &phi_i, &shapes[2..3]),
        list("theta_i", &theta_i, &shapes[1..2]),
        table("sigma", &tables.sigma),
        table("ndf", &tables.ndf),
        table("vndf", &tables.vndf),
        table("luminance", &tables.luminance),
        table(if spectral { "spectra" } else { "rgb" }, &tables.spectra),
        bytes("jacobian", &jacobian, &[1]),
    ];
    if spectral {
        fields.push(list("wavelengths", &wavelengths, &shapes[3..4]));
    }
    if let Some(mask) = &mask {
        fields.push(bytes("valid", mask, &shapes[4..5]));
    }
    write_fields(path, &fields)
}

/// One bit a node, the highest bit of a byte first.
fn packed(valid: &[bool]) -> Vec<u8> {
    valid
        .chunks(8)
        .map(|eight| (0..8).fold(0, |byte, k| byte << 1 | u8::from(eight.get(k) == Some(&true))))
        .collect()
}
