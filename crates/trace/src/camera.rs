//! Views: which ray a point of the picture looks along.

use glam::Vec3;

/// How directions are laid out on the picture; the letters are those of RADIANCE's `-vt`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Projection {
    /// `v`: a plane picture.
    Perspective,
    /// `l`: parallel rays; sizes are lengths.
    Parallel,
    /// `h`: a hemisphere in orthographic projection: solid angle weighted with the cosine is area.
    Hemispherical,
    /// `a`: angle from the axis in proportion to the distance from the centre.
    Angular,
    /// `s`: stereographic.
    Planisphere,
    /// `c`: angle across, tangent up.
    Cylindrical,
}

/// A view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Layout of directions.
    pub projection: Projection,
    /// The eye.
    pub point: Vec3,
    /// Where it looks; its length does not matter but for parallel views with a clipping plane.
    pub direction: Vec3,
    /// What is upright in the picture.
    pub up: Vec3,
    /// Full size across: degrees, or lengths for a parallel view.
    pub horizontal: f32,
    /// Full size upright.
    pub vertical: f32,
    /// Shift to the right and lift by fractions of the size (`-vs`, `-vl`).
    pub shift: [f32; 2],
    /// Distance of the fore clipping plane: across the axis in plane pictures, about the eye in others.
    pub fore: f32,
    /// Distance of the aft clipping plane, alike: a ray that meets no surface before it sees nothing. 0 for none.
    pub aft: f32,
}

/// A view that shows nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("view {field}: found {found}, allowed {allowed}")]
pub struct ViewError {
    /// The option that is wrong.
    pub field: &'static str,
    /// Its value.
    pub found: String,
    /// What it may be.
    pub allowed: &'static str,
}

/// A view with its axes, for a picture of a given shape.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    view: View,
    axis: Vec3,
    right: Vec3,
    up: Vec3,
    /// Size across and upright of the plane in which the picture lies, in units of the projection.
    size: [f32; 2],
}

impl Camera {
    /// The axes of a view.
    ///
    /// # Errors
    /// [`ViewError`] for a zero direction, an up vector along it, and sizes out of range.
    pub fn new(view: View) -> Result<Self, ViewError> {
        let error = |field, found: String, allowed| ViewError {
            field,
            found,
            allowed,
        };
        let show = |v: Vec3| format!("{} {} {}", v.x, v.y, v.z);
        let Some(axis) = view.direction.try_normalize() else {
            return Err(error(
                "direction (-vd)",
                show(view.direction),
                "a direction that is not zero",
            ));
        };
        let Some(right) = axis.cross(view.up).try_normalize() else {
            return Err(error(
                "up (-vu)",
                show(view.up),
                "a direction that is not that of the view",
            ));
        };
        if view.aft != 0.0 && (view.aft.is_nan() || view.aft <= view.fore) {
            return Err(error(
                "aft clipping (-va)",
                view.aft.to_string(),
                "0, or a distance beyond the fore clipping plane (-vo)",
            ));
        }
        let size = |field, degrees: f32| {
            let plane = match view.projection {
                Projection::Perspective if 0.0 < degrees && degrees < 180.0 => {
                    2.0 * (0.5 * degrees.to_radians()).tan()
                }
                Projection::Parallel if degrees > 0.0 && degrees.is_finite() => degrees,
                Projection::Hemispherical if 0.0 < degrees && degrees <= 180.0 => {
                    2.0 * (0.5 * degrees.to_radians()).sin()
                }
                Projection::Angular | Projection::Cylindrical if 0.0 < degrees && degrees <= 360.0 => {
                    degrees.to_radians()
                }
                Projection::Planisphere if 0.0 < degrees && degrees < 360.0 => {
                    4.0 * (0.25 * degrees.to_radians()).tan()
                }
                _ => {
                    return Err(error(
                        field,
                        degrees.to_string(),
                        "a size above 0 and within that of the view type",
                    ));
                }
            };
            Ok(plane)
        };
        let across = size("size (-vh)", view.horizontal)?;
        let upright = match view.projection {
            Projection::Cylindrical if 0.0 < view.vertical && view.vertical < 180.0 => {
                2.0 * (0.5 * view.vertical.to_radians()).tan()
            }
            _ => size("size (-vv)", view.vertical)?,
        };
        Ok(Camera {
            view,
            axis,
            right,
            up: right.cross(axis),
            size: [across, upright],
        })
    }

    /// Width over height of a picture with square pixels.
    pub fn aspect(&self) -> f32 {
        self.size[0] / self.size[1]
    }

    /// Origin and unit direction of the ray at a point of the picture: `(0, 0)` lower left, `(1, 1)` upper right. `None` where
    /// the projection has no direction.
    #[inline]
    pub fn ray(&self, [u, v]: [f32; 2]) -> Option<(Vec3, Vec3)> {
        let view = &self.view;
        let x = (u - 0.5 + view.shift[0]) * self.size[0];
        let y = (v - 0.5 + view.shift[1]) * self.size[1];
        let (right, up, axis) = (self.right, self.up, self.axis);
        let aside = x * right + y * up;
        let direction = match view.projection {
            Projection::Perspective => axis + aside,
            Projection::Parallel => return Some((view.point + aside + view.fore * axis, axis)),
            Projection::Hemispherical => {
                let z2 = 1.0 - x * x - y * y;
                if z2 < 0.0 {
                    return None;
                }
                z2.sqrt() * axis + aside
            }
            Projection::Angular => {
                let angle = x.hypot(y);
                if angle > std::f32::consts::PI {
                    return None;
                }
                let along = if angle > 0.0 { angle.sin() / angle } else { 1.0 };
                angle.cos() * axis + along * aside
            }
            Projection::Planisphere => {
                let angle = 2.0 * (0.5 * x.hypot(y)).atan();
                let r = x.hypot(y);
                let along = if r > 0.0 { angle.sin() / r } else { 1.0 };
                angle.cos() * axis + along * aside
            }
            Projection::Cylindrical => x.cos() * axis + x.sin() * right + y * up,
        };
        // Not yet a unit vector: in plane pictures and on cylinders it ends at 1 along the axis, as RADIANCE's does
        // [Radiance, common/image.c].
        let origin = view.point + view.fore * direction;
        Some((origin, direction.try_normalize()?))
    }

    /// Whether there is an aft clipping plane.
    pub(crate) fn clips(&self) -> bool {
        self.view.aft != 0.0
    }

    /// The way from a point of a ray of the view to the aft clipping plane; `direction` is the unit direction of the ray.
    pub(crate) fn remaining(&self, origin: Vec3, direction: Vec3) -> f32 {
        let (aft, way) = (self.view.aft, origin - self.view.point);
        let left = match self.view.projection {
            Projection::Perspective | Projection::Parallel => {
                (aft - way.dot(self.axis)) / direction.dot(self.axis)
            }
            Projection::Cylindrical => {
                let level = |v: Vec3| v.reject_from_normalized(self.up).length();
                (aft - level(way)) / level(direction)
            }
            _ => aft - way.length(),
        };
        left.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(projection: Projection, horizontal: f32, vertical: f32) -> View {
        View {
            projection,
            point: Vec3::new(1.0, 2.0, 3.0),
            direction: Vec3::new(0.0, 2.0, 0.0),
            up: Vec3::Z,
            horizontal,
            vertical,
            shift: [0.0; 2],
            fore: 0.0,
            aft: 0.0,
        }
    }

    #[test]
    fn the_centre_looks_along_the_axis_and_the_edge_at_half_the_angle() {
        for (projection, angle) in [
            (Projection::Perspective, 60.0),
            (Projection::Hemispherical, 180.0),
            (Projection::Angular, 180.0),
            (Projection::Planisphere, 180.0),
            (Projection::Cylindrical, 300.0),
        ] {
            let camera = Camera::new(view(projection, angle, 60.0)).unwrap();
            let (o, d) = camera.ray([0.5, 0.5]).unwrap();
            assert_eq!(o, Vec3::new(1.0, 2.0, 3.0));
            assert!(d.distance(Vec3::Y) < 1e-6);
            let (_, edge) = camera.ray([1.0, 0.5]).unwrap();
            let wanted = (0.5_f32 * angle).to_radians();
            assert!(
                (edge.dot(Vec3::Y) - wanted.cos()).abs() < 1e-3,
                "{projection:?} {edge}"
            );
            assert!(edge.x > 0.0, "right of north is east");
            assert!(camera.ray([0.5, 0.9]).unwrap().1.z > 0.0);
        }
    }

    #[test]
    fn views_that_show_nothing_are_refused_by_the_name_of_their_option() {
        let ok = view(Projection::Perspective, 45.0, 45.0);
        for (bad, name) in [
            (
                View {
                    direction: Vec3::ZERO,
                    ..ok
                },
                "-vd",
            ),
            (View { up: Vec3::Y, ..ok }, "-vu"),
            (
                View {
                    horizontal: 180.0,
                    ..ok
                },
                "-vh",
            ),
            (View { vertical: 0.0, ..ok }, "-vv"),
            (
                View {
                    fore: 2.0,
                    aft: 1.0,
                    ..ok
                },
                "-va",
            ),
            (View { aft: -1.0, ..ok }, "-va"),
        ] {
            assert!(Camera::new(bad).unwrap_err().to_string().contains(name));
        }
    }

    #[test]
    fn the_fore_clipping_plane_lies_across_the_axis_or_about_the_eye() {
        for (projection, flat) in [(Projection::Perspective, true), (Projection::Angular, false)] {
            let view = View {
                fore: 2.0,
                ..view(projection, 80.0, 80.0)
            };
            let camera = Camera::new(view).unwrap();
            for at in [[0.5, 0.5], [0.9, 0.2]] {
                let begin = camera.ray(at).unwrap().0 - view.point;
                let depth = if flat { begin.dot(Vec3::Y) } else { begin.length() };
                assert!((depth - 2.0).abs() < 1e-5);
            }
        }
    }
}
