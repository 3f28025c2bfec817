//! Surfaces.

use glam::{DVec3, Vec3};
use gonio_io::radiance_material::Body;
use gonio_trace::scene::Surface;
use gonio_trace::shape::Shape;

use super::Assembly;
use super::light::Emission;
use super::material::Look;
use crate::error::{Place, SceneError};
use crate::text::{Entry, SURFACES};

/// The arguments of a surface.
pub(super) struct Arguments<'a> {
    type_word: &'a str,
    strings: &'a [String],
    reals: &'a [f64],
}

/// The arguments of an item that is a surface.
pub(super) fn arguments(entry: &Entry) -> Option<Arguments<'_>> {
    match &entry.item.body {
        Body::Other {
            type_word,
            strings,
            reals,
            ..
        } if SURFACES.contains(&type_word.as_str()) => Some(Arguments {
            type_word,
            strings,
            reals,
        }),
        _ => None,
    }
}

/// Largest coordinate: squares of areas stay within single precision.
const FARTHEST: f64 = 1e9;
/// Smallest radius and length: so do squares of them.
const LEAST: f32 = 1e-15;

/// A point of the scene.
pub(super) fn placed(p: DVec3, place: &Place) -> Result<Vec3, SceneError> {
    // What is not a number fails as well.
    if p.abs().max_element() <= FARTHEST && p.is_finite() {
        return Ok(p.as_vec3());
    }
    let found = format!("{} {} {}", p.x, p.y, p.z);
    Err(place.fault("coordinates", found, "numbers from -1e9 to 1e9"))
}

/// The three numbers from `k` on as a point of the scene.
fn point(reals: &[f64], k: usize, place: &Place) -> Result<Vec3, SceneError> {
    placed(DVec3::new(reals[k], reals[k + 1], reals[k + 2]), place)
}

/// The three numbers from `k` on as a direction.
pub(super) fn direction(reals: &[f64], k: usize, field: &str, place: &Place) -> Result<Vec3, SceneError> {
    let d = DVec3::new(reals[k], reals[k + 1], reals[k + 2]);
    // By its largest component first: squares have their limits as well.
    let unit = (d / d.abs().max_element()).try_normalize();
    unit.map(|u| u.as_vec3()).ok_or_else(|| {
        let found = format!("{} {} {}", d.x, d.y, d.z);
        place.fault(field, found, "a direction that is not zero")
    })
}

impl Assembly<'_> {
    pub(super) fn surface(&mut self, entry: &Entry, arguments: Arguments<'_>) -> Result<(), SceneError> {
        let Arguments {
            type_word,
            strings,
            reals,
        } = arguments;
        let place = &entry.place;
        // A luminous bubble is the most of a single item.
        self.room(reals.len().max(1 << 14), place)?;
        let modifier = self.modifiers.find(&entry.item.modifier, "modifier", place)?;
        if type_word == "mesh" || type_word == "instance" {
            return self.mesh(type_word, strings, modifier, place);
        }
        if !strings.is_empty() {
            return Err(place.fault("string arguments", strings.len().to_string(), "0"));
        }
        let (count, allowed) = match type_word {
            "polygon" => (reals.len(), ""),
            "sphere" | "bubble" => (4, "4: centre and radius"),
            "cylinder" | "tube" => (7, "7: ends and radius"),
            "cone" | "cup" => (8, "8: ends and radii"),
            "ring" => (8, "8: centre, normal and radii"),
            _ => (4, "4: direction and angle"),
        };
        if reals.len() != count {
            return Err(place.fault("real arguments", reals.len().to_string(), allowed));
        }
        let look = match modifier {
            Some(k) => Some((self.look(k)?, k)),
            None => None,
        };
        match type_word {
            "polygon" => self.polygon(reals, look, place),
            "source" => {
                let direction = direction(reals, 0, "direction", place)?;
                self.source(direction, reals[3], look.map(|l| l.0), place)
            }
            _ => self.curved(type_word, reals, look, place),
        }
    }

    fn curved(
        &mut self,
        type_word: &str,
        reals: &[f64],
        look: Option<(Look, usize)>,
        place: &Place,
    ) -> Result<(), SceneError> {
        let shape = match type_word {
            "sphere" | "bubble" => {
                let radius = reals[3] as f32;
                if radius < 0.0 {
                    self.warn(place, "negative radius: turned inside out");
                }
                if !(LEAST..=FARTHEST as f32).contains(&radius.abs()) {
                    let allowed = "a radius that is not zero, up to 1e9";
                    return Err(place.fault("radius", reals[3].to_string(), allowed));
                }
                Shape::Sphere {
                    centre: point(reals, 0, place)?,
                    radius: radius.abs(),
                    inward: (type_word == "bubble") != (radius < 0.0),
                }
            }
            "ring" => {
                let normal = direction(reals, 3, "normal", place)?;
                let mut radii = [reals[6] as f32, reals[7] as f32];
                if radii[0] > radii[1] {
                    radii.reverse();
                }
                if !(radii[0] >= 0.0 && radii[1] > radii[0].max(LEAST) && radii[1] <= FARTHEST as f32) {
                    return Err(place.fault(
                        "radii",
                        format!("{} {}", reals[6], reals[7]),
                        "two different ones from 0 to 1e9",
                    ));
                }
                Shape::Ring {
                    centre: point(reals, 0, place)?,
                    normal,
                    radii,
                }
            }
            _ => {
                let (from, to) = (point(reals, 0, place)?, point(reals, 3, place)?);
                let mut radii = [reals[6] as f32, reals[reals.len() - 1] as f32];
                let mut inward = matches!(type_word, "tube" | "cup");
                if radii.iter().all(|r| *r <= 0.0) && radii.iter().any(|r| *r < 0.0) {
                    self.warn(place, "negative radius: turned inside out");
                    radii = radii.map(f32::abs);
                    inward = !inward;
                }
                let sizes = 0.0..=FARTHEST as f32;
                if radii.iter().any(|r| !sizes.contains(r)) || radii.iter().all(|r| *r < LEAST) {
                    let found: Vec<String> = reals[6..].iter().map(f64::to_string).collect();
                    let allowed = "radii from 0 to 1e9, not all zero";
                    return Err(place.fault("radius", found.join(" "), allowed));
                }
                if from.distance(to) < LEAST {
                    if radii[0] == radii[1] {
                        return Err(place.fault("ends", "no length", "two different points"));
                    }
                    return Err(place.fault("ends", "no length", "two different points, or a ring"));
                }
                Shape::Cone {
                    from,
                    to,
                    radii,
                    inward,
                }
            }
        };
        let Some((look, modifier)) = look else {
            return Ok(());
        };
        let Some(emission) = look.emission.clone() else {
            if let Some(surface) = self.shared(&look, modifier) {
                self.parts.shapes.push((shape, surface));
            }
            return Ok(());
        };
        self.luminous_shape(shape, &look, &emission);
        Ok(())
    }

    fn luminous_shape(&mut self, shape: Shape, look: &Look, emission: &Emission) {
        match shape {
            Shape::Sphere {
                centre,
                radius,
                inward: false,
            } => {
                if let Some(surface) = self.ball_light(centre, radius, look, emission) {
                    self.parts.shapes.push((shape, surface));
                }
            }
            Shape::Sphere { centre, radius, .. } => self.bubble_light(centre, radius, look, emission),
            Shape::Cone {
                from,
                to,
                radii,
                inward,
            } => self.frustum_light([from, to], radii, inward, look, emission),
            Shape::Ring {
                centre,
                normal,
                radii,
            } => {
                let triangles = super::light::ring(centre, normal, radii);
                if let Some(surface) = self.flat_light(&triangles, look, emission) {
                    self.parts.shapes.push((shape, surface));
                }
            }
        }
    }

    /// The surface that all of a look share that does not emit; `None` where there is nothing to see.
    pub(super) fn shared(&mut self, look: &Look, modifier: usize) -> Option<u32> {
        let material = look.material?;
        if let Some(surface) = look.surface {
            return Some(surface);
        }
        let surface = self.push_surface(Surface {
            material,
            paint: look.paint,
            texture: look.texture,
            mixture: look.mixture,
            up: look.up,
            body: look.body,
            proxy: look.proxy,
            ..Surface::default()
        });
        self.materials.share(modifier, surface);
        Some(surface)
    }

    pub(super) fn push_surface(&mut self, surface: Surface) -> u32 {
        self.parts.surfaces.push(surface);
        (self.parts.surfaces.len() - 1) as u32
    }

    pub(super) fn push_triangles(&mut self, triangles: &[[Vec3; 3]], surface: u32) {
        for t in triangles {
            let k = self.parts.vertices.len() as u32;
            self.parts.vertices.extend(t.map(|p| p.to_array()));
            self.parts.triangles.push([k, k + 1, k + 2]);
            self.parts.triangle_surface.push(surface);
        }
    }

    /// Triangles by corner of a list of points.
    pub(super) fn push_indexed(&mut self, points: &[Vec3], triangles: &[[u32; 3]], surface: u32) {
        let k = self.parts.vertices.len() as u32;
        self.parts.vertices.extend(points.iter().map(|p| p.to_array()));
        self.parts
            .triangles
            .extend(triangles.iter().map(|t| t.map(|i| i + k)));
        let end = self.parts.triangles.len();
        self.parts.triangle_surface.resize(end, surface);
    }
}
