//! Surfaces that emit.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::Vec3;
use gonio_io::radiance_material::{Body, VOID};
use gonio_trace::light::{Ball, Flat, Light};
use gonio_trace::pattern::{Cone, Pattern, Product};

use super::Assembly;
use super::body::colour;
use super::material::Look;
use crate::error::{Place, SceneError};

/// What a light does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Light,
    Illum,
    Glow,
    /// A glow that lights nothing.
    Shown,
    Spot,
}

/// What a surface emits.
#[derive(Clone)]
pub(super) struct Emission {
    pub(super) radiance: Vec3,
    pub(super) kind: Kind,
    /// What an illum looks like.
    pub(super) alternate: Option<String>,
    pub(super) cone: Option<Cone>,
    /// How far behind the surface the light of a spotlight seems to come from.
    pub(super) focus: f32,
    pub(super) pattern: Option<Arc<dyn Pattern>>,
}

impl Emission {
    /// All that changes it from place to place.
    pub(super) fn patterns(&self) -> Option<Arc<dyn Pattern>> {
        let cone = self.cone.map(|c| Arc::new(c) as Arc<dyn Pattern>);
        match (cone, self.pattern.clone()) {
            (Some(a), Some(b)) => Some(Arc::new(Product(vec![a, b]))),
            (a, b) => a.or(b),
        }
    }
}

/// The emission of a modifier, `None` for one that emits nothing.
pub(super) fn emission(body: &Body, place: &Place) -> Result<Option<Emission>, SceneError> {
    let Body::Other {
        type_word,
        strings,
        reals,
        ..
    } = body
    else {
        return Ok(None);
    };
    let (count, allowed, kind) = match type_word.as_str() {
        "light" => (3, "3: red green blue", Kind::Light),
        "illum" => (3, "3: red green blue", Kind::Illum),
        "glow" => (4, "4: red green blue radius", Kind::Glow),
        "spotlight" => (7, "7: red green blue angle and direction", Kind::Spot),
        _ => return Ok(None),
    };
    if reals.len() != count {
        return Err(place.fault("real arguments", reals.len().to_string(), allowed));
    }
    let most = usize::from(matches!(kind, Kind::Light | Kind::Illum));
    if strings.len() > most {
        return Err(place.fault(
            "string arguments",
            strings.len().to_string(),
            format!("at most {most}"),
        ));
    }
    // Above this, products of single precision have no value.
    if let Some(bad) = reals[..3].iter().find(|v| !(0.0..=1e18).contains(*v)) {
        return Err(place.fault("red green blue", bad.to_string(), "radiance from 0 to 1e18"));
    }
    let cone = match kind {
        Kind::Spot => {
            let axis = super::surface::direction(reals, 4, "direction", place)?;
            if !(reals[3] > 0.0 && reals[3] <= 360.0) {
                return Err(place.fault("angle", reals[3].to_string(), "above 0 and up to 360 degrees"));
            }
            let cos = (0.5 * reals[3]).to_radians().cos() as f32;
            Some(Cone { axis, cos })
        }
        _ => None,
    };
    let alternate = match kind {
        Kind::Illum => Some(strings.first().map_or(VOID, String::as_str).to_owned()),
        // A light with an alternate material shows it only where RADIANCE does not look for lights.
        _ => None,
    };
    Ok(Some(Emission {
        radiance: colour([reals[0], reals[1], reals[2]]),
        kind: match kind {
            Kind::Glow if reals[3] < 0.0 => Kind::Shown,
            other => other,
        },
        alternate,
        cone,
        focus: match kind {
            Kind::Spot => glam::DVec3::new(reals[4], reals[5], reals[6]).length() as f32,
            _ => 0.0,
        },
        pattern: None,
    }))
}

/// Facets of a curved light around its axis, and of a sphere from pole to pole.
const AROUND: usize = 48;
const DOWN: usize = 24;

impl Assembly<'_> {
    /// A light of these triangles, and the index of its surface.
    pub(super) fn flat_light(
        &mut self,
        triangles: &[[Vec3; 3]],
        look: &Look,
        emission: &Emission,
    ) -> Option<u32> {
        let light = Flat::new(triangles, emission.radiance)?;
        Some(self.luminous(Some(Light::Flat(light)), look, emission))
    }

    pub(super) fn ball_light(
        &mut self,
        centre: Vec3,
        radius: f32,
        look: &Look,
        emission: &Emission,
    ) -> Option<u32> {
        let light = Ball::new(centre, radius, emission.radiance)?;
        Some(self.luminous(Some(Light::Ball(light)), look, emission))
    }

    /// The surface of a light; a glow that lights nothing is no light.
    fn luminous(&mut self, light: Option<Light>, look: &Look, emission: &Emission) -> u32 {
        let mut surface = gonio_trace::scene::Surface {
            material: look.material.unwrap_or(0),
            paint: look.paint,
            texture: look.texture,
            mixture: look.mixture,
            up: look.up,
            body: look.body,
            concealed: emission.kind == Kind::Illum,
            ..Default::default()
        };
        match light {
            Some(light) if emission.kind != Kind::Shown => {
                let k = self.parts.lights.len();
                self.parts.lights.push(light);
                if emission.focus > 0.0 {
                    self.parts.light_focus.resize(k, 0.0);
                    self.parts.light_focus.push(emission.focus);
                }
                if let Some(pattern) = emission.patterns() {
                    self.parts.light_patterns.resize(k, None);
                    self.parts.light_patterns.push(Some(pattern));
                }
                surface.light = Some(k as u32);
            }
            _ => surface.glow = emission.radiance,
        }
        self.push_surface(surface)
    }

    /// A luminous frustum as facets of the same area; each is a light.
    pub(super) fn frustum_light(
        &mut self,
        ends: [Vec3; 2],
        radii: [f32; 2],
        inward: bool,
        look: &Look,
        emission: &Emission,
    ) {
        let Some(axis) = (ends[1] - ends[0]).try_normalize() else {
            return;
        };
        let (x, y) = axis.any_orthonormal_pair();
        // Chords as long as the arcs they stand for.
        let half = PI / AROUND as f32;
        let wider = half / half.sin();
        let at = |end: usize, k: usize| {
            let (s, c) = (2.0 * half * k as f32).sin_cos();
            ends[end] + wider * radii[end] * (c * x + s * y)
        };
        for k in 0..AROUND {
            let mut quad = [at(0, k), at(0, k + 1), at(1, k + 1), at(1, k)];
            if inward {
                quad.reverse();
            }
            self.facet(&quad, look, emission);
        }
    }

    /// A sphere that emits inward, as facets.
    pub(super) fn bubble_light(&mut self, centre: Vec3, radius: f32, look: &Look, emission: &Emission) {
        let at = |i: usize, k: usize| {
            let (st, ct) = (PI * i as f32 / DOWN as f32).sin_cos();
            let (sp, cp) = (2.0 * PI * k as f32 / AROUND as f32).sin_cos();
            centre + radius * Vec3::new(st * cp, st * sp, ct)
        };
        for i in 0..DOWN {
            for k in 0..AROUND {
                self.facet(
                    &[at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)],
                    look,
                    emission,
                );
            }
        }
    }

    fn facet(&mut self, quad: &[Vec3; 4], look: &Look, emission: &Emission) {
        let [a, b, c, d] = *quad;
        let triangles: Vec<[Vec3; 3]> = [[a, b, c], [a, c, d]]
            .into_iter()
            .filter(|[a, b, c]| (b - a).cross(c - a).length_squared() > 0.0)
            .collect();
        if let Some(surface) = self.flat_light(&triangles, look, emission) {
            self.push_triangles(&triangles, surface);
        }
    }
}

/// Triangles of the same area as a ring.
pub(super) fn ring(centre: Vec3, normal: Vec3, radii: [f32; 2]) -> Vec<[Vec3; 3]> {
    let (x, y) = normal.any_orthonormal_pair();
    let angle = 2.0 * PI / AROUND as f32;
    let wider = (angle / angle.sin()).sqrt();
    let at = |r: f32, k: usize| {
        let (s, c) = (angle * k as f32).sin_cos();
        centre + wider * r * (c * x + s * y)
    };
    let mut triangles = Vec::with_capacity(2 * AROUND);
    for k in 0..AROUND {
        let [a, b] = [at(radii[1], k), at(radii[1], k + 1)];
        let [c, d] = [at(radii[0], k + 1), at(radii[0], k)];
        triangles.push([a, b, c]);
        if radii[0] > 0.0 {
            triangles.push([a, c, d]);
        }
    }
    triangles
}
