//! Meshes of other files in a scene.

use std::sync::Arc;

use glam::Vec3;

use super::Assembly;
use super::body::Pane;
use crate::error::{Place, SceneError};
use crate::mesh::Mesh;
use crate::text::Xform;

/// Endings of files of meshes.
const ENDINGS: [&str; 5] = [".obj", ".ply", ".stl", ".gltf", ".glb"];

/// A mesh in its place.
struct Placed {
    points: Vec<Vec3>,
    normals: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Assembly<'_> {
    /// The mesh of a file, read once.
    fn mesh_file(&mut self, name: &str, place: &Place) -> Result<Arc<Mesh>, SceneError> {
        let path = self.files.find(name, place)?;
        if let Some(mesh) = self.meshes.get(&path) {
            return Ok(mesh.clone());
        }
        let mesh = Arc::new(crate::mesh::read(&path)?);
        self.meshes.insert(path, mesh.clone());
        Ok(mesh)
    }

    /// `mesh` and `instance`: a file and a transform. Without a modifier the materials are those that the file names.
    pub(super) fn mesh(
        &mut self,
        type_word: &str,
        strings: &[String],
        modifier: Option<usize>,
        place: &Place,
    ) -> Result<(), SceneError> {
        let [name, transform @ ..] = strings else {
            return Err(place.fault("string arguments", "0", "a file and a transform"));
        };
        let lower = name.to_ascii_lowercase();
        if !ENDINGS.iter().any(|e| lower.ends_with(e)) {
            return Err(place.fault(
                type_word,
                format!("{name:?}"),
                "a file .obj, .ply, .stl, .gltf or .glb; include the scene text of an octree by !xform, and the .obj of an .rtm",
            ));
        }
        let (xform, used) = Xform::parse(transform).map_err(|(f, a)| place.fault("transform", f, a))?;
        if let Some(word) = transform.get(used) {
            return Err(place.fault("transform", format!("{word:?}"), "options of xform"));
        }
        let mesh = self.mesh_file(name, place)?;
        self.room(mesh.triangles.len().max(mesh.points.len() / 3), place)?;
        let pieces: Vec<(usize, std::ops::Range<usize>)> = match modifier {
            Some(k) => vec![(k, 0..mesh.triangles.len())],
            None => {
                let mut found = Vec::new();
                for (material, range) in mesh.pieces().filter(|(_, range)| !range.is_empty()) {
                    let field = format!("material of {name:?}");
                    found.extend(self.modifiers.find(material, &field, place)?.map(|k| (k, range)));
                }
                if mesh.parts.is_empty() {
                    let allowed = "the name of a material: the mesh names none";
                    return Err(place.fault("modifier", "void", allowed));
                }
                found
            }
        };
        let mut placed = Placed {
            points: Vec::with_capacity(mesh.points.len()),
            normals: Vec::with_capacity(mesh.normals.len()),
            triangles: mesh.triangles.clone(),
        };
        for p in &mesh.points {
            placed
                .points
                .push(super::surface::placed(xform.point(*p), place)?);
        }
        let turned = mesh.normals.iter().map(|n| xform.vector(n.as_dvec3()).as_vec3());
        placed.normals.extend(turned.map(Vec3::normalize_or_zero));
        if xform.scale < 0.0 {
            placed.triangles.iter_mut().for_each(|t| t.reverse());
        }
        // Corners once for all materials.
        let first = self.parts.vertices.len();
        self.parts
            .vertices
            .extend(placed.points.iter().map(|p| p.to_array()));
        if !placed.normals.is_empty() {
            self.parts.normals.resize(first, [0.0; 3]);
            self.parts
                .normals
                .extend(placed.normals.iter().map(|n| n.to_array()));
        }
        for (modifier, range) in pieces {
            self.piece(&placed, range, first as u32, modifier)?;
        }
        Ok(())
    }

    /// Triangles of one material.
    fn piece(
        &mut self,
        mesh: &Placed,
        range: std::ops::Range<usize>,
        first: u32,
        modifier: usize,
    ) -> Result<(), SceneError> {
        let look = self.look(modifier)?;
        let triangles = &mesh.triangles[range];
        match look.emission.clone() {
            None => {
                let openings = match look.pane {
                    Some(Pane::Clear) => Some(&mut self.portals),
                    Some(Pane::Scattering) => Some(&mut self.screens),
                    None => None,
                };
                if let Some(openings) = openings {
                    openings.extend(quads(mesh, triangles));
                }
                if let Some(surface) = self.shared(&look, modifier) {
                    let shifted = triangles.iter().map(|t| t.map(|k| k + first));
                    self.parts.triangles.extend(shifted);
                    let end = self.parts.triangles.len();
                    self.parts.triangle_surface.resize(end, surface);
                }
            }
            Some(emission) => {
                for t in triangles {
                    let corners = [t.map(|k| mesh.points[k as usize])];
                    if let Some(surface) = self.flat_light(&corners, &look, &emission) {
                        self.push_triangles(&corners, surface);
                    }
                }
            }
        }
        Ok(())
    }
}

/// The parallelograms that neighbours in a list of triangles make, for windows of few: what was a quadrangle before it was cut.
fn quads(mesh: &Placed, triangles: &[[u32; 3]]) -> Vec<[Vec3; 3]> {
    const MOST: usize = 256;
    if triangles.len() > MOST {
        return Vec::new();
    }
    let (pairs, _) = triangles.as_chunks::<2>();
    let made = pairs.iter().filter_map(|[first, second]| {
        // The corner of the second that the first has not lies between two that both have.
        let k = (0..3).find(|k| !first.contains(&second[*k]))?;
        let (far, after, before) = (second[k], second[(k + 1) % 3], second[(k + 2) % 3]);
        let j = (0..3).find(|j| first[*j] == before && first[(j + 1) % 3] == after)?;
        let corners = [before, far, after, first[(j + 2) % 3]].map(|k| mesh.points[k as usize]);
        super::portal::parallelogram(&corners)
    });
    made.collect()
}
