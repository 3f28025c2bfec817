//! Wavefront OBJ: corners, normals and faces, and the names of materials (`usemtl`); the files of materials are not read.

use std::io::{BufReader, Cursor, Read};
use std::path::Path;

use glam::Vec3;
use gonio_io::{IoError, excerpt};

use super::{Mesh, fault};

pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Mesh, IoError> {
    let lines = || bytes.split(|b| *b == b'\n').map(<[u8]>::trim_ascii);
    let smooth = lines().any(|l| l.starts_with(b"vn "));
    let mut names: Vec<String> = lines()
        .filter_map(|l| l.strip_prefix(b"usemtl"))
        .map(|n| String::from_utf8_lossy(n.trim_ascii()).into_owned())
        .collect();
    names.sort_unstable();
    names.dedup();
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        single_index: smooth,
    };
    // The library names materials only that it was told of.
    let materials = |_: &Path| {
        let all: Vec<tobj::Material> = names
            .iter()
            .map(|name| tobj::Material {
                name: name.clone(),
                ..Default::default()
            })
            .collect();
        Ok((all, names.iter().cloned().zip(0..).collect()))
    };
    let source = Cursor::new(b"mtllib names\n").chain(Cursor::new(bytes));
    let loaded = tobj::load_obj_buf(&mut BufReader::new(source), &options, materials);
    let (models, materials) = loaded.map_err(|e| match first_fault(bytes) {
        Some((line, text)) => IoError::format(
            path,
            line,
            "OBJ",
            excerpt(text),
            "numbers, and corners that stand above",
        ),
        None => fault(path, "OBJ", e.to_string(), "a Wavefront OBJ file"),
    })?;
    let materials = materials.unwrap_or_default();
    let mut mesh = Mesh::default();
    for model in models {
        if !names.is_empty() {
            let material = model.mesh.material_id.and_then(|k| materials.get(k));
            mesh.begin(material.map_or("", |m| m.name.as_str()));
        }
        let first = mesh.points.len() as u32;
        let points = model.mesh.positions.as_chunks::<3>().0;
        mesh.points
            .extend(points.iter().map(|p| Vec3::from_array(*p).as_dvec3()));
        if smooth {
            let normals = model.mesh.normals.as_chunks::<3>().0;
            mesh.normals.extend(normals.iter().map(|n| Vec3::from_array(*n)));
            mesh.normals.resize(mesh.points.len(), Vec3::ZERO);
        }
        let triangles = model.mesh.indices.as_chunks::<3>().0;
        mesh.triangles
            .extend(triangles.iter().map(|t| t.map(|k| k.saturating_add(first))));
    }
    Ok(mesh)
}

/// The first line, from 1, with a corner that is no place or a face of corners that do not stand above it.
fn first_fault(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let mut corners = 0_i64;
    for (number, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let text = String::from_utf8_lossy(line);
        let mut words = text.split_whitespace();
        let good = match words.next() {
            Some("v") => {
                corners += 1;
                words
                    .by_ref()
                    .take(3)
                    .filter(|w| w.parse::<f32>().is_ok())
                    .count()
                    == 3
            }
            Some("f") => {
                let indices: Vec<Option<i64>> = words
                    .map(|w| w.split('/').next().and_then(|k| k.parse().ok()))
                    .collect();
                let stands = |k: &Option<i64>| k.is_some_and(|k| k != 0 && k.abs() <= corners);
                indices.len() >= 3 && indices.iter().all(stands)
            }
            _ => true,
        };
        if !good {
            return Some((number as u64 + 1, line));
        }
    }
    None
}
