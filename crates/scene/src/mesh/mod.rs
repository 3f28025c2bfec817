//! Meshes of triangles in files: OBJ, PLY, STL and glTF.

mod gltf;
mod obj;
mod ply;
#[cfg(test)]
mod tests;

use std::io::Cursor;
use std::path::Path;

use glam::{DVec3, Vec3};
use gonio_io::{IoError, read_bytes};

/// A mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Corners.
    pub points: Vec<DVec3>,
    /// Normals of the corners where the file has them: none at all, or one a corner, zero for one without.
    pub normals: Vec<Vec3>,
    /// Triangles by corner; the front is where they turn counterclockwise.
    pub triangles: Vec<[u32; 3]>,
    /// Which triangles are of which material, in order; none where the file names no materials.
    pub parts: Vec<Part>,
}

/// Triangles of one material.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Name of the material, empty for none.
    pub material: String,
    /// The first triangle; the last is before the next part's.
    pub first: usize,
}

impl Mesh {
    /// Adds a convex polygon by corner.
    fn polygon(&mut self, corners: &[u32]) {
        let fan = corners.windows(2).skip(1);
        self.triangles.extend(fan.map(|w| [corners[0], w[0], w[1]]));
    }

    /// The triangles that follow are of this material.
    fn begin(&mut self, material: &str) {
        if self.parts.last().is_none_or(|p| p.material != material) {
            self.parts.push(Part {
                material: material.into(),
                first: self.triangles.len(),
            });
        }
    }

    /// Names of materials and their triangles.
    pub fn pieces(&self) -> impl Iterator<Item = (&str, std::ops::Range<usize>)> {
        let ends = self.parts.iter().skip(1).map(|p| p.first);
        let ends = ends.chain(std::iter::once(self.triangles.len()));
        let named = self.parts.iter().zip(ends);
        named.map(|(part, end)| (part.material.as_str(), part.first..end))
    }
}

/// The mesh of a file, by its extension: `.obj`, `.ply`, `.stl`, `.gltf`, `.glb`. Polygons become fans of triangles. Materials are
/// read by their name alone, colours not at all. A glTF file is turned from its axes (y up) to those of RADIANCE (z up).
///
/// # Errors
/// [`IoError`] naming the file: one that cannot be read, is no mesh, refers to corners that it does not have, or has
/// coordinates that are not finite; the octrees and compiled meshes of RADIANCE.
pub fn read(path: &Path) -> Result<Mesh, IoError> {
    read_from(path, &read_bytes(path)?)
}

/// [`read`] of bytes in memory; the ending of `path` tells the format, and errors name it.
///
/// # Errors
/// As [`read`].
pub fn read_from(path: &Path, bytes: &[u8]) -> Result<Mesh, IoError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    let mut mesh = match extension.as_deref() {
        Some("obj") => obj::read(path, bytes)?,
        Some("ply") => ply::read(path, bytes)?,
        Some("stl") => stl(path, bytes)?,
        Some("gltf" | "glb") => gltf::read(path, bytes)?,
        Some("rtm" | "oct") => {
            let hint = "a mesh .obj .ply .stl .gltf .glb; include the scene text of an octree by !xform, and the .obj of an .rtm";
            return Err(fault(
                path,
                "file",
                format!("{:?}", path.display().to_string()),
                hint,
            ));
        }
        _ => {
            let found = format!("{:?}", path.display().to_string());
            return Err(fault(path, "file", found, "a mesh .obj .ply .stl .gltf .glb"));
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
    // A normal that is none leaves its triangles flat.
    for normal in &mut mesh.normals {
        *normal = if normal.is_finite() {
            normal.normalize_or_zero()
        } else {
            Vec3::ZERO
        };
    }
    if mesh.normals.len() != limit {
        mesh.normals.clear();
    }
    Ok(mesh)
}

fn fault(path: &Path, field: &str, found: impl Into<String>, allowed: impl Into<String>) -> IoError {
    IoError::format(path, None, field, found, allowed)
}

fn stl(path: &Path, bytes: &[u8]) -> Result<Mesh, IoError> {
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
