//! glTF 2.0: the triangles of its scene with normals and names of materials, turned to z up. The library reads the document;
//! numbers are taken from the buffers here, each within its bounds.

use std::path::Path;

use base64::Engine;
use glam::{DMat4, DVec3, Vec3};
use gltf::accessor::{DataType, Dimensions};
use gltf::buffer::Source;
use gltf::mesh::{Mode, Semantic};
use gltf::{Accessor, Document, Gltf, Node, Primitive};
use gonio_io::{IoError, read_bytes};

use super::{Mesh, fault};

/// Corners and triangles, at most.
const MOST: usize = 1 << 28;

/// The library takes the length of the header off the one that a binary file states, however small that is.
fn check_length(path: &Path, bytes: &[u8]) -> Result<(), IoError> {
    match bytes {
        [b'g', b'l', b'T', b'F', _, _, _, _, a, b, c, d, ..] if u32::from_le_bytes([*a, *b, *c, *d]) < 12 => {
            let found = u32::from_le_bytes([*a, *b, *c, *d]).to_string();
            Err(fault(path, "length", found, "the bytes of the file, 12 at least"))
        }
        _ => Ok(()),
    }
}

pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Mesh, IoError> {
    let wrong = |e: gltf::Error| {
        fault(
            path,
            "glTF",
            e.to_string(),
            "a valid glTF 2.0 file, .gltf or .glb",
        )
    };
    check_length(path, bytes)?;
    let Gltf { document, blob } = Gltf::from_slice_without_validation(bytes).map_err(wrong)?;
    let root = document.into_json();
    // The library looks at the accessor of positions before it has checked that there is one.
    let primitives = root.meshes.iter().flat_map(|m| &m.primitives);
    let accessors = primitives.flat_map(|p| p.attributes.values());
    if let Some(k) = accessors.map(|a| a.value()).find(|k| *k >= root.accessors.len()) {
        let allowed = format!("below {}, the number of accessors", root.accessors.len());
        return Err(fault(path, "attributes", format!("accessor {k}"), &allowed));
    }
    let document = Document::from_json(root).map_err(wrong)?;
    let buffers = document
        .buffers()
        .map(|b| match b.source() {
            Source::Bin => blob
                .clone()
                .ok_or_else(|| fault(path, "buffer", "no binary chunk", "a .glb that holds it")),
            Source::Uri(uri) => buffer(path, uri),
        })
        .collect::<Result<Vec<_>, _>>()?;
    let mut reader = Reader {
        path,
        buffers,
        mesh: Mesh::default(),
    };
    let scene = document.default_scene().or_else(|| document.scenes().next());
    let Some(scene) = scene else {
        return Err(fault(path, "scene", "none", "a scene"));
    };
    let mut open: Vec<(Node<'_>, DMat4)> = scene.nodes().map(|n| (n, DMat4::IDENTITY)).collect();
    let mut seen = vec![false; document.nodes().len()];
    while let Some((node, above)) = open.pop() {
        if std::mem::replace(&mut seen[node.index()], true) {
            let found = format!("node {} twice", node.index());
            return Err(fault(
                path,
                "nodes",
                found,
                "a tree: every node below one other at most",
            ));
        }
        let own = node.transform().matrix().map(|column| column.map(f64::from));
        let here = above * DMat4::from_cols_array_2d(&own);
        for primitive in node.mesh().iter().flat_map(gltf::Mesh::primitives) {
            reader.primitive(&primitive, &here)?;
        }
        open.extend(node.children().map(|child| (child, here)));
    }
    Ok(reader.mesh)
}

/// The bytes of a buffer outside the file: `data:` or a file beside it.
fn buffer(path: &Path, uri: &str) -> Result<Vec<u8>, IoError> {
    let wrong = |found: String| fault(path, "buffer", found, "data in base64 or the name of a file");
    if let Some(data) = uri.strip_prefix("data:") {
        let Some((_, text)) = data.split_once(";base64,") else {
            return Err(wrong("data in another coding".into()));
        };
        let decoded = base64::engine::general_purpose::STANDARD.decode(text);
        return decoded.map_err(|e| wrong(e.to_string()));
    }
    let name = urlencoding::decode(uri).map_err(|e| wrong(e.to_string()))?;
    if name.contains("://") {
        return Err(wrong(format!("{uri:?}")));
    }
    read_bytes(&path.parent().unwrap_or(Path::new("")).join(name.as_ref()))
}

struct Reader<'a> {
    path: &'a Path,
    buffers: Vec<Vec<u8>>,
    mesh: Mesh,
}

impl Reader<'_> {
    fn primitive(&mut self, primitive: &Primitive<'_>, place: &DMat4) -> Result<(), IoError> {
        if !matches!(
            primitive.mode(),
            Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
        ) {
            return Ok(());
        }
        let Some(positions) = primitive.get(&Semantic::Positions) else {
            return Ok(());
        };
        let first = self.mesh.points.len();
        let points = self.vectors(&positions)?;
        let normals = match primitive.get(&Semantic::Normals) {
            Some(n) => self.vectors(&n)?,
            None => Vec::new(),
        };
        let count = points.len();
        if first + count > MOST {
            return Err(self.wrong("corners", (first + count).to_string(), "2^28"));
        }
        let upright = |v: DVec3| DVec3::new(v.x, -v.z, v.y);
        let points = points.into_iter().map(|p| upright(place.transform_point3(p)));
        self.mesh.points.extend(points);
        if !normals.is_empty() {
            if normals.len() != count {
                return Err(self.wrong("normals", normals.len().to_string(), &format!("{count}")));
            }
            // Normals stay upright on faces under any scaling by the inverse transposed.
            let turned = place.inverse().transpose();
            self.mesh.normals.resize(first, Vec3::ZERO);
            let normals = normals
                .into_iter()
                .map(|n| upright(turned.transform_vector3(n)).as_vec3());
            self.mesh.normals.extend(normals);
        } else if !self.mesh.normals.is_empty() {
            self.mesh.normals.resize(first + count, Vec3::ZERO);
        }
        let indices: Vec<u32> = match primitive.indices() {
            Some(accessor) => self.indices(&accessor)?,
            None => (0..count as u32).collect(),
        };
        if let Some(bad) = indices.iter().find(|k| **k as usize >= count) {
            return Err(self.wrong("index", bad.to_string(), &format!("below {count}")));
        }
        self.mesh.begin(primitive.material().name().unwrap_or(""));
        let first = first as u32;
        let mut push = |t: [u32; 3]| self.mesh.triangles.push(t.map(|k| k + first));
        // A place that mirrors turns faces round.
        let mirrored = place.determinant() < 0.0;
        let mut turned = |[a, b, c]: [u32; 3]| push(if mirrored { [a, c, b] } else { [a, b, c] });
        match primitive.mode() {
            Mode::TriangleStrip => {
                for (k, w) in indices.windows(3).enumerate() {
                    turned(if k % 2 == 0 {
                        [w[0], w[1], w[2]]
                    } else {
                        [w[1], w[0], w[2]]
                    });
                }
            }
            Mode::TriangleFan => indices
                .windows(2)
                .skip(1)
                .for_each(|w| turned([indices[0], w[0], w[1]])),
            _ => indices.as_chunks::<3>().0.iter().for_each(|t| turned(*t)),
        }
        Ok(())
    }

    /// The bytes of each element of an accessor.
    fn elements<'b>(&'b self, accessor: &Accessor<'_>) -> Result<impl Iterator<Item = &'b [u8]>, IoError> {
        let (size, count) = (accessor.size(), accessor.count());
        let field = format!("accessor {}", accessor.index());
        let Some(view) = accessor.view().filter(|_| accessor.sparse().is_none()) else {
            return Err(self.wrong(&field, "sparse or without data".into(), "a buffer view"));
        };
        let bytes = self.buffers.get(view.buffer().index()).and_then(|buffer| {
            let end = view.offset().checked_add(view.length())?;
            let part = buffer.get(view.offset()..end)?;
            part.get(accessor.offset()..)
        });
        let stride = view.stride().unwrap_or(size).max(1);
        let needed = match count {
            0 => Some(0),
            n => stride.checked_mul(n - 1).and_then(|last| last.checked_add(size)),
        };
        match (bytes, needed) {
            (Some(bytes), Some(needed)) if needed <= bytes.len() => {
                Ok((0..count).map(move |k| &bytes[k * stride..k * stride + size]))
            }
            _ => Err(self.wrong(&field, format!("{count} elements"), "as many as its buffer holds")),
        }
    }

    fn vectors(&self, accessor: &Accessor<'_>) -> Result<Vec<DVec3>, IoError> {
        if (accessor.data_type(), accessor.dimensions()) != (DataType::F32, Dimensions::Vec3) {
            let found = format!("{:?} {:?}", accessor.dimensions(), accessor.data_type());
            let field = format!("accessor {}", accessor.index());
            return Err(self.wrong(&field, found, "vectors of three in single precision"));
        }
        let each = self.elements(accessor)?.map(|b| {
            let part = |k: usize| f64::from(f32::from_le_bytes([b[k], b[k + 1], b[k + 2], b[k + 3]]));
            DVec3::new(part(0), part(4), part(8))
        });
        Ok(each.collect())
    }

    fn indices(&self, accessor: &Accessor<'_>) -> Result<Vec<u32>, IoError> {
        let known = matches!(accessor.data_type(), DataType::U8 | DataType::U16 | DataType::U32);
        if !known || accessor.dimensions() != Dimensions::Scalar {
            let found = format!("{:?} {:?}", accessor.dimensions(), accessor.data_type());
            let field = format!("accessor {}", accessor.index());
            return Err(self.wrong(&field, found, "whole numbers without sign"));
        }
        let number = |b: &[u8]| b.iter().rev().fold(0, |n, byte| n << 8 | u32::from(*byte));
        Ok(self.elements(accessor)?.map(number).collect())
    }

    fn wrong(&self, field: &str, found: String, allowed: &str) -> IoError {
        fault(self.path, field, found, allowed)
    }
}
