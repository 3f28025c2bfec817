//! Meshes of other files in a scene.

use super::Assembly;
use crate::error::{Place, SceneError};
use crate::text::Xform;

impl Assembly<'_> {
    /// `mesh` and `instance`: a file and a transform.
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
        if ![".obj", ".ply", ".stl"].iter().any(|e| lower.ends_with(e)) {
            return Err(place.fault(
                type_word,
                format!("{name:?}"),
                "a file .obj, .ply or .stl; include the scene text of an octree by !xform, and the .obj of an .rtm",
            ));
        }
        let (xform, used) = Xform::parse(transform).map_err(|(f, a)| place.fault("transform", f, a))?;
        if let Some(word) = transform.get(used) {
            return Err(place.fault("transform", format!("{word:?}"), "options of xform"));
        }
        let Some(modifier) = modifier else {
            return Err(place.fault(
                "modifier",
                "void",
                "the name of a material: those of the mesh are not read",
            ));
        };
        let path = self.files.find(name, place)?;
        let mut mesh = crate::mesh::read(&path)?;
        if xform.scale < 0.0 {
            mesh.triangles.iter_mut().for_each(|t| t.reverse());
        }
        let look = self.look(modifier)?;
        let mut points = Vec::with_capacity(mesh.points.len());
        for p in &mesh.points {
            let moved = xform.point(*p).as_vec3();
            if !moved.is_finite() {
                return Err(place.fault("transform", moved.to_string(), "finite coordinates"));
            }
            points.push(moved);
        }
        match look.emission.clone() {
            None => {
                if let Some(surface) = self.shared(&look, modifier) {
                    self.push_indexed(&points, &mesh.triangles, surface);
                }
            }
            Some(emission) => {
                for t in &mesh.triangles {
                    let corners = [t.map(|k| points[k as usize])];
                    if let Some(surface) = self.flat_light(&corners, &look, &emission) {
                        self.push_triangles(&corners, surface);
                    }
                }
            }
        }
        Ok(())
    }
}
