//! Polygons become triangles [Radiance, common/face.c].

use earcut::Earcut;
use glam::{DVec3, Vec3};

use super::Assembly;
use super::body::Pane;
use super::material::Look;
use crate::error::{Place, SceneError};

/// A polygon in its plane.
pub(super) struct Face {
    /// Corners, without a last one that repeats the first.
    pub(super) corners: Vec<DVec3>,
    /// Unit normal of the front.
    normal: DVec3,
    area: f64,
    /// How far a corner lies off the plane, at most.
    bent: f64,
}

impl Face {
    /// `None` for a polygon without area.
    pub(super) fn new(mut corners: Vec<DVec3>) -> Option<Self> {
        if corners.len() > 3 && corners.first() == corners.last() {
            corners.pop();
        }
        let first = *corners.first()?;
        let double = corners
            .windows(2)
            .skip(1)
            .map(|w| (w[0] - first).cross(w[1] - first))
            .fold(DVec3::ZERO, |a, b| a + b);
        let normal = double.try_normalize()?;
        let centre = corners.iter().fold(DVec3::ZERO, |a, b| a + b) / corners.len() as f64;
        let bent = corners
            .iter()
            .map(|c| (c - centre).dot(normal).abs())
            .fold(0.0, f64::max);
        Some(Face {
            corners,
            normal,
            area: 0.5 * double.length(),
            bent,
        })
    }

    /// Whether all corners turn the same way and the outline goes round once.
    fn convex(&self) -> bool {
        let n = self.corners.len();
        let edge = |k: usize| self.corners[(k + 1) % n] - self.corners[k % n];
        let left = (0..n).all(|k| edge(k).cross(edge(k + 1)).dot(self.normal) >= 0.0);
        // Five corners or more may turn the same way twice round.
        left && (n <= 4 || {
            let first = self.corners[0];
            let fan = |k: usize| (self.corners[k] - first).cross(self.corners[k + 1] - first);
            (1..n - 1).all(|k| fan(k).dot(self.normal) >= 0.0)
        })
    }

    /// Triangles by corner, front as the polygon's; `None` when the outline crosses itself.
    pub(super) fn triangles(&self) -> Option<Vec<[u32; 3]>> {
        let n = self.corners.len() as u32;
        if self.convex() {
            return Some((1..n - 1).map(|k| [0, k, k + 1]).collect());
        }
        let (x, y) = self.normal.any_orthonormal_pair();
        let flat = self.corners.iter().map(|c| [c.dot(x), c.dot(y)]);
        let mut found: Vec<u32> = Vec::new();
        Earcut::new().earcut(flat, &[], &mut found);
        let mut sum = 0.0;
        let triangles: Vec<[u32; 3]> = found
            .as_chunks::<3>()
            .0
            .iter()
            .map(|&[a, b, c]| {
                let at = |k: u32| self.corners[k as usize];
                let twice = (at(b) - at(a)).cross(at(c) - at(a)).dot(self.normal);
                sum += 0.5 * twice.abs();
                if twice < 0.0 { [a, c, b] } else { [a, b, c] }
            })
            .collect();
        ((sum - self.area).abs() <= 1e-5 * self.area).then_some(triangles)
    }
}

impl Assembly<'_> {
    pub(super) fn polygon(
        &mut self,
        reals: &[f64],
        look: Option<(Look, usize)>,
        place: &Place,
    ) -> Result<(), SceneError> {
        if reals.len() < 9 || !reals.len().is_multiple_of(3) {
            return Err(place.fault(
                "real arguments",
                reals.len().to_string(),
                "x y z of three corners or more",
            ));
        }
        let corners: Vec<DVec3> = reals
            .as_chunks::<3>()
            .0
            .iter()
            .map(|c| DVec3::from_array(*c))
            .collect();
        for corner in &corners {
            super::surface::placed(*corner, place)?;
        }
        let Some(face) = Face::new(corners) else {
            self.warn(place, "polygon without area: left out");
            return Ok(());
        };
        let size = face
            .corners
            .iter()
            .map(|c| c.abs().max_element())
            .fold(0.0, f64::max);
        if face.corners.len() > 3 && face.bent > 1e-5 * size.max(1.0) {
            self.warn(
                place,
                format!("corners of the polygon lie up to {:.2e} off its plane", face.bent),
            );
        }
        let Some(triangles) = face.triangles() else {
            return Err(place.fault(
                "polygon",
                format!("{} corners whose edges cross", face.corners.len()),
                "an outline that does not cross itself; a seam leads to holes",
            ));
        };
        let Some((look, modifier)) = look else {
            return Ok(());
        };
        let points: Vec<Vec3> = face.corners.iter().map(|c| c.as_vec3()).collect();
        let surface = match look.emission.clone() {
            Some(emission) => {
                let corners: Vec<[Vec3; 3]> =
                    triangles.iter().map(|t| t.map(|k| points[k as usize])).collect();
                match self.flat_light(&corners, &look, &emission) {
                    Some(surface) => surface,
                    None => {
                        self.warn(place, "luminous polygon without area: left out");
                        return Ok(());
                    }
                }
            }
            None => match self.shared(&look, modifier) {
                Some(surface) => surface,
                None => return Ok(()),
            },
        };
        let openings = match look.pane {
            Some(Pane::Clear) => Some(&mut self.portals),
            Some(Pane::Scattering) => Some(&mut self.screens),
            None => None,
        };
        if let Some(openings) = openings {
            openings.extend(super::portal::parallelogram(&points));
        }
        self.push_indexed(&points, &triangles, surface);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn face(points: &[[f64; 2]]) -> Face {
        let corner = |p: &[f64; 2]| DVec3::new(p[0], p[1], 2.0);
        Face::new(points.iter().map(corner).collect()).unwrap()
    }

    fn area(face: &Face) -> f64 {
        let at = |k: u32| face.corners[k as usize];
        let each = |t: &[u32; 3]| 0.5 * (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).z;
        face.triangles().unwrap().iter().map(each).sum()
    }

    #[test]
    fn a_square_with_a_square_hole_by_a_seam_keeps_its_area_and_leaves_the_hole_open() {
        let ring = face(&[
            [0., 0.],
            [4., 0.],
            [4., 4.],
            [0., 4.],
            [0., 0.],
            [1., 1.],
            [1., 3.],
            [3., 3.],
            [3., 1.],
            [1., 1.],
        ]);
        assert!((area(&ring) - 12.0).abs() < 1e-12);
        let inside = |p: DVec3| {
            ring.triangles().unwrap().iter().any(|t| {
                let [a, b, c] = t.map(|k| ring.corners[k as usize]);
                [(a, b), (b, c), (c, a)]
                    .iter()
                    .all(|(a, b)| (b - a).cross(p - a).z > 1e-12)
            })
        };
        assert!(!inside(DVec3::new(2.0, 2.1, 2.0)));
        assert!(inside(DVec3::new(0.45, 2.1, 2.0)));
    }

    #[test]
    fn two_holes_and_concave_outlines_keep_their_area() {
        let two = face(&[
            [0., 0.],
            [9., 0.],
            [9., 4.],
            [0., 4.],
            [0., 0.],
            [1., 1.],
            [1., 3.],
            [3., 3.],
            [3., 1.],
            [5., 1.],
            [5., 3.],
            [7., 3.],
            [7., 1.],
            [5., 1.],
            [3., 1.],
            [1., 1.],
        ]);
        assert!((area(&two) - 28.0).abs() < 1e-12);
        assert!((area(&face(&[[0., 0.], [4., 0.], [4., 4.], [2., 1.], [0., 4.]])) - 10.0).abs() < 1e-12);
    }

    #[test]
    fn lines_have_no_face_and_bow_ties_no_triangles() {
        let line = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0];
        assert!(Face::new(line.to_vec()).is_none());
        assert!(
            face(&[[0., 0.], [4., 4.], [4., 0.], [0., 3.]])
                .triangles()
                .is_none()
        );
    }
}
