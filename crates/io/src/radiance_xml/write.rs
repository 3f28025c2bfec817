//! The writer.

use std::io::{self, Write};
use std::path::Path;

use gonio_bsdf::klems::{KlemsBasis, KlemsMatrix};
use gonio_bsdf::tensor_tree::{Node, Rank, Tree};
use quick_xml::escape::escape;

use super::{RadianceXml, Tabulated, direction_name, wavelength_name};
use crate::{IoError, write_atomic};

/// Writes a BSDF XML file that Radiance and WINDOW-based tools read; the file appears whole or not at all.
///
/// # Errors
/// [`IoError`] when the file cannot be written or the model cannot be said in this format: no component, a channel
/// other than photopic, solar or a wavelength, trees of different rank, or angle bases of one name with different
/// rings.
pub fn write(path: &Path, xml: &RadianceXml) -> Result<(), IoError> {
    check(xml).map_err(|(field, found, allowed)| IoError::format(path, None, field, found, allowed))?;
    write_atomic(path, |out| write_to(out, xml))
}

type Refusal = (&'static str, String, &'static str);

fn check(xml: &RadianceXml) -> Result<(), Refusal> {
    if xml.model.components().is_empty() {
        return Err(("model", "no component".into(), "at least one of four"));
    }
    let channel = xml.model.channel();
    if wavelength_name(channel).is_none() {
        return Err(("channel", channel.to_string(), "photopic, solar or a wavelength"));
    }
    match &xml.model {
        Tabulated::Klems(k) => {
            let bases: Vec<&KlemsBasis> = k
                .matrices()
                .iter()
                .flat_map(|(_, _, m)| [m.incident(), m.exit()])
                .collect();
            for a in &bases {
                if let Some(b) = bases
                    .iter()
                    .find(|b| b.name() == a.name() && b.rings() != a.rings())
                {
                    return Err((
                        "angle basis",
                        format!("two bases named {:?}", b.name()),
                        "one definition a name",
                    ));
                }
            }
        }
        Tabulated::TensorTree(t) => {
            let ranks: Vec<Rank> = t.trees().iter().map(|(_, _, t)| t.rank()).collect();
            if ranks.iter().any(|r| *r != ranks[0]) {
                return Err(("rank", "trees of rank 3 and 4".into(), "one rank in a file"));
            }
        }
    }
    Ok(())
}

/// [`write`] into any stream.
///
/// # Errors
/// What the stream reports; [`io::ErrorKind::InvalidInput`] for a model [`write`] refuses.
pub fn write_to(out: &mut dyn Write, xml: &RadianceXml) -> io::Result<()> {
    check(xml).map_err(|(field, found, allowed)| {
        io::Error::new(
            io::ErrorKind::InvalidInput,
            format!("{field}: found {found}, allowed {allowed}"),
        )
    })?;
    head(out, xml)?;
    match &xml.model {
        Tabulated::Klems(k) => {
            writeln!(out, "\t\t<IncidentDataStructure>Columns</IncidentDataStructure>")?;
            let mut done: Vec<&str> = Vec::new();
            for (_, _, m) in k.matrices().iter() {
                for basis in [m.incident(), m.exit()] {
                    if !done.contains(&basis.name()) {
                        done.push(basis.name());
                        angle_basis(out, basis)?;
                    }
                }
            }
            writeln!(out, "\t</DataDefinition>")?;
            for (side, component, m) in k.matrices().iter() {
                let bases = format!(
                    "<ColumnAngleBasis>{}</ColumnAngleBasis>\n\t\t\t<RowAngleBasis>{}</RowAngleBasis>",
                    escape(m.incident().name()),
                    escape(m.exit().name())
                );
                block(out, xml, direction_name(side, component), &bases, |out| {
                    matrix(out, m)
                })?;
            }
        }
        Tabulated::TensorTree(t) => {
            let rank = t.trees().iter().next().map_or(Rank::Three, |(_, _, t)| t.rank());
            writeln!(
                out,
                "\t\t<IncidentDataStructure>TensorTree{}</IncidentDataStructure>\n\t</DataDefinition>",
                rank.dimensions()
            )?;
            for (side, component, t) in t.trees().iter() {
                let basis = "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>";
                block(out, xml, direction_name(side, component), basis, |out| {
                    tree(out, t)
                })?;
            }
        }
    }
    out.write_all(b"</Layer>\n</Optical>\n</WindowElement>\n")
}

fn head(out: &mut dyn Write, xml: &RadianceXml) -> io::Result<()> {
    let m = &xml.material;
    writeln!(
        out,
        r#"<?xml version="1.0" encoding="UTF-8"?>
<!-- File produced by: gonio {} -->
<WindowElement xmlns="http://windows.lbl.gov" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:schemaLocation="http://windows.lbl.gov/BSDF-v1.4.xsd">
<WindowElementType>System</WindowElementType>
<FileType>BSDF</FileType>
<Optical>
<Layer>
	<Material>
		<Name>{}</Name>
		<Manufacturer>{}</Manufacturer>"#,
        env!("CARGO_PKG_VERSION"),
        escape(&m.name),
        escape(&m.manufacturer)
    )?;
    for (name, length) in [
        ("Thickness", m.thickness),
        ("Width", m.width),
        ("Height", m.height),
    ] {
        if let Some(metres) = length {
            writeln!(out, "\t\t<{name} unit=\"Meter\">{metres}</{name}>")?;
        }
    }
    let device = if m.device_type.is_empty() {
        "Other"
    } else {
        &m.device_type
    };
    writeln!(
        out,
        "\t\t<DeviceType>{}</DeviceType>\n\t</Material>\n\t<Geometry></Geometry>\n\t<DataDefinition>",
        escape(device)
    )
}

fn angle_basis(out: &mut dyn Write, basis: &KlemsBasis) -> io::Result<()> {
    writeln!(
        out,
        "\t\t<AngleBasis>\n\t\t\t<AngleBasisName>{}</AngleBasisName>",
        escape(basis.name())
    )?;
    for r in basis.rings() {
        // the centre patch is named by its own centre, the normal
        let theta = if r.theta_lo == 0.0 {
            0.0
        } else {
            0.5 * (r.theta_lo + r.theta_hi)
        };
        writeln!(
            out,
            "\t\t\t<AngleBasisBlock>\n\t\t\t\t<Theta>{theta}</Theta>\n\t\t\t\t<nPhis>{}</nPhis>\n\t\t\t\t<ThetaBounds>\n\
             \t\t\t\t\t<LowerTheta>{}</LowerTheta>\n\t\t\t\t\t<UpperTheta>{}</UpperTheta>\n\t\t\t\t</ThetaBounds>\n\
             \t\t\t</AngleBasisBlock>",
            r.n_phi, r.theta_lo, r.theta_hi
        )?;
    }
    writeln!(out, "\t\t</AngleBasis>")
}

fn block(
    out: &mut dyn Write,
    xml: &RadianceXml,
    direction: &str,
    basis: &str,
    data: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let (unit, wavelength) = wavelength_name(xml.model.channel()).unwrap_or_default();
    writeln!(
        out,
        r#"	<WavelengthData>
		<LayerNumber>System</LayerNumber>
		<Wavelength unit="{unit}">{wavelength}</Wavelength>
		<SourceSpectrum>CIE Illuminant D65 1nm.ssp</SourceSpectrum>
		<DetectorSpectrum>ASTM E308 1931 Y.dsp</DetectorSpectrum>
		<WavelengthDataBlock>
			<WavelengthDataDirection>{direction}</WavelengthDataDirection>
			{basis}
			<ScatteringDataType>BTDF</ScatteringDataType>
			<ScatteringData>"#
    )?;
    data(out)?;
    writeln!(
        out,
        "\t\t\t</ScatteringData>\n\t\t</WavelengthDataBlock>\n\t</WavelengthData>"
    )
}

/// The shortest text that reads back as the same number.
fn number(out: &mut dyn Write, v: f32) -> io::Result<()> {
    if v == 0.0 || (1e-4..1e6).contains(&v) {
        write!(out, "{v}")
    } else {
        write!(out, "{v:e}")
    }
}

fn matrix(out: &mut dyn Write, m: &KlemsMatrix) -> io::Result<()> {
    for row in m.values().chunks(m.incident().len()) {
        for v in row {
            out.write_all(b"\t")?;
            number(out, *v)?;
        }
        out.write_all(b"\n")?;
    }
    Ok(())
}

/// Depth first, children in order.
fn tree(out: &mut dyn Write, t: &Tree) -> io::Result<()> {
    enum Step {
        Node(usize),
        Close,
    }
    let mut stack = vec![Step::Node(0)];
    while let Some(step) = stack.pop() {
        match step {
            Step::Close => out.write_all(b"}\n")?,
            Step::Node(k) => match t.nodes()[k] {
                Node::Branch { first } => {
                    out.write_all(b"{\n")?;
                    stack.push(Step::Close);
                    let first = first as usize;
                    stack.extend((first..first + t.rank().children()).rev().map(Step::Node));
                }
                Node::Block { first, log2_side } => {
                    let n = 1usize << (usize::from(log2_side) * t.rank().dimensions());
                    out.write_all(b"{")?;
                    for v in &t.values()[first as usize..first as usize + n] {
                        write!(out, " {}", Tree::text(*v))?;
                    }
                    out.write_all(b" }\n")?;
                }
            },
        }
    }
    Ok(())
}
