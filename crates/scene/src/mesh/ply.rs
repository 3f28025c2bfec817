//! PLY: corners `x y z`, with normals `nx ny nz`, and faces `vertex_index` or `vertex_indices`.

use std::borrow::Cow;
use std::io::Cursor;
use std::path::Path;

use glam::DVec3;
use gonio_io::IoError;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, Property, PropertyAccess, PropertyAccessResult};

use super::{Mesh, fault};

/// Place and normal.
struct Corner(DVec3, DVec3);

impl PropertyAccess for Corner {
    fn new() -> Self {
        // A coordinate that is missing shows as one that is not finite.
        Corner(DVec3::NAN, DVec3::ZERO)
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let k = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            "nx" => 3,
            "ny" => 4,
            "nz" => 5,
            _ => return PropertyAccessResult::Ignored,
        };
        let slot = if k < 3 { &mut self.0[k] } else { &mut self.1[k - 3] };
        *slot = match property {
            Property::Float(v) => v.into(),
            Property::Double(v) => v,
            Property::Char(v) => v.into(),
            Property::UChar(v) => v.into(),
            Property::Short(v) => v.into(),
            Property::UShort(v) => v.into(),
            Property::Int(v) => v.into(),
            Property::UInt(v) => v.into(),
            _ => return PropertyAccessResult::Ignored,
        };
        PropertyAccessResult::Set
    }
}

/// Corners of a face; `u32::MAX` for one that cannot be.
struct Face(Vec<u32>);

impl PropertyAccess for Face {
    fn new() -> Self {
        Face(Vec::new())
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if name != "vertex_index" && name != "vertex_indices" {
            return PropertyAccessResult::Ignored;
        }
        fn wide<T: TryInto<u32>>(list: Vec<T>) -> Vec<u32> {
            list.into_iter()
                .map(|k| k.try_into().unwrap_or(u32::MAX))
                .collect()
        }
        self.0 = match property {
            Property::ListChar(v) => wide(v),
            Property::ListUChar(v) => wide(v),
            Property::ListShort(v) => wide(v),
            Property::ListUShort(v) => wide(v),
            Property::ListInt(v) => wide(v),
            Property::ListUInt(v) => v,
            _ => return PropertyAccessResult::Ignored,
        };
        PropertyAccessResult::Set
    }
}

pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Mesh, IoError> {
    let wrong = |e: &dyn std::fmt::Display| fault(path, "PLY", e.to_string(), "a PLY file");
    let plain = with_leading_zeros(bytes);
    let mut reader = Reader::new(Cursor::new(&*plain));
    let corners = Parser::<Corner>::new();
    let header = corners.read_header(&mut reader).map_err(|e| wrong(&e))?;
    let mut mesh = Mesh::default();
    for (_, element) in &header.elements {
        match element.name.as_str() {
            "vertex" => {
                let all = corners
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(|e| wrong(&e))?;
                if all.iter().any(|c| c.1 != DVec3::ZERO) {
                    mesh.normals = all.iter().map(|c| c.1.as_vec3()).collect();
                }
                mesh.points = all.into_iter().map(|c| c.0).collect();
            }
            "face" => {
                let faces = Parser::<Face>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(|e| wrong(&e))?;
                for face in &faces {
                    if face.0.len() < 3 {
                        let found = format!("a face of {} corners", face.0.len());
                        return Err(fault(path, "vertex_indices", found, "three corners or more"));
                    }
                    mesh.polygon(&face.0);
                }
            }
            _ => {
                Parser::<DefaultElement>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(|e| wrong(&e))?;
            }
        }
    }
    Ok(mesh)
}

/// The text of an ASCII file, numbers such as `.5` written `0.5`, which the parser takes; other files as they are.
fn with_leading_zeros(bytes: &[u8]) -> Cow<'_, [u8]> {
    let ascii = bytes[..bytes.len().min(256)]
        .windows(12)
        .any(|w| w == b"format ascii");
    if !ascii {
        return Cow::Borrowed(bytes);
    }
    let mut out = Vec::with_capacity(bytes.len() + bytes.len() / 8);
    let mut before = b' ';
    for &b in bytes {
        if b == b'.' && (before.is_ascii_whitespace() || before == b'-') {
            out.push(b'0');
        }
        out.push(b);
        before = b;
    }
    Cow::Owned(out)
}
