//! Meshes of triangles in files: OBJ, PLY and STL.

mod ply;

use std::fs::File;
use std::io::{BufReader, Cursor};
use std::path::Path;

use glam::{DVec3, Vec3};
use gonio_io::{IoError, read_bytes};

/// A mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Corners.
    pub points: Vec<DVec3>,
    /// Triangles by corner; the front is where they turn counterclockwise.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Adds a convex polygon by corner.
    fn polygon(&mut self, corners: &[u32]) {
        let fan = corners.windows(2).skip(1);
        self.triangles.extend(fan.map(|w| [corners[0], w[0], w[1]]));
    }
}

/// The mesh of a file, by its extension: `.obj`, `.ply`, `.stl`. Polygons become fans of triangles; normals, colours and
/// materials are not read.
///
/// # Errors
/// [`IoError`] naming the file: one that cannot be read, is no mesh, refers to corners that it does not have, or has
/// coordinates that are not finite; the octrees and compiled meshes of RADIANCE.
pub fn read(path: &Path) -> Result<Mesh, IoError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    let mesh = match extension.as_deref() {
        Some("obj") => obj(path)?,
        Some("ply") => ply::read(path)?,
        Some("stl") => stl(path)?,
        Some("rtm" | "oct") => {
            let hint = "a mesh .obj .ply .stl; include the scene text of an octree by !xform, and the .obj of an .rtm";
            return Err(fault(
                path,
                "file",
                format!("{:?}", path.display().to_string()),
                hint,
            ));
        }
        _ => {
            let found = format!("{:?}", path.display().to_string());
            return Err(fault(path, "file", found, "a mesh .obj .ply .stl"));
        }
    };
    if let Some(k) = mesh.points.iter().position(|p| !p.as_vec3().is_finite()) {
        let found = format!("corner {} at {}", k + 1, mesh.points[k]);
        return Err(fault(
            path,
            "coordinates",
            found,
            "finite numbers of single precision",
        ));
    }
    let limit = mesh.points.len();
    if let Some(bad) = mesh.triangles.iter().flatten().find(|k| **k as usize >= limit) {
        let allowed = format!("one of {limit} corners, counted from 0");
        return Err(fault(path, "corner", bad.to_string(), allowed));
    }
    Ok(mesh)
}

fn fault(path: &Path, field: &str, found: impl Into<String>, allowed: impl Into<String>) -> IoError {
    IoError::format(path, None, field, found, allowed)
}

fn obj(path: &Path) -> Result<Mesh, IoError> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..Default::default()
    };
    let file = File::open(path).map_err(|e| IoError::file(path, e))?;
    // Materials are those of the scene.
    let none = |_: &Path| Ok((Vec::new(), Default::default()));
    let (models, _) = tobj::load_obj_buf(&mut BufReader::new(file), &options, none)
        .map_err(|e| fault(path, "OBJ", e.to_string(), "a Wavefront OBJ file"))?;
    let mut mesh = Mesh::default();
    for model in models {
        let first = mesh.points.len() as u32;
        let points = model.mesh.positions.as_chunks::<3>().0;
        mesh.points
            .extend(points.iter().map(|p| Vec3::from_array(*p).as_dvec3()));
        let triangles = model.mesh.indices.as_chunks::<3>().0;
        mesh.triangles
            .extend(triangles.iter().map(|t| t.map(|k| k.saturating_add(first))));
    }
    Ok(mesh)
}

fn stl(path: &Path) -> Result<Mesh, IoError> {
    let bytes = read_bytes(path)?;
    let wrong = |e: std::io::Error| fault(path, "STL", e.to_string(), "an STL file, ASCII or binary");
    let mut cursor = Cursor::new(bytes);
    let mut mesh = Mesh::default();
    for triangle in stl_io::create_stl_reader(&mut cursor).map_err(wrong)? {
        let corners = triangle.map_err(wrong)?.vertices;
        let k = mesh.points.len() as u32;
        mesh.points.extend(
            corners
                .iter()
                .map(|v| DVec3::new(v[0].into(), v[1].into(), v[2].into())),
        );
        mesh.triangles.push([k, k + 1, k + 2]);
    }
    Ok(mesh)
}
