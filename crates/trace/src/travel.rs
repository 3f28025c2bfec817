//! What a ray goes through between surfaces: bodies that absorb and refract, and proxies that stand for geometry.

use glam::Vec3;

use crate::material::Local;
use crate::scene::{Meeting, Scene};

/// The two sides of a boundary, such as that of a glass body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Extinction behind the surface, 1/length: the negative logarithm of what a unit length leaves.
    pub inside: Vec3,
    /// Extinction before it; `None` for air, which leaves everything.
    pub outside: Option<Vec3>,
    /// Index of refraction behind the surface over that before it.
    pub index: f32,
}

/// The state of a path that surfaces of such kinds change.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Travel {
    /// Extinction of what the ray is in.
    medium: Vec3,
    /// Whether it has been scattered: the eye sees what a proxy hides, scattered light sees the proxy.
    pub(crate) scattered: bool,
}

/// What lights are seen through from a point, and on which side.
pub(crate) struct Ground {
    /// Extinction about the point.
    medium: Vec3,
    /// The side of the surface that lights count on, by its sign along the normal; both for 0.
    pub(crate) only: f32,
    /// The way from the surface to the point.
    pub(crate) past: Vec3,
}

impl Ground {
    /// Through nothing, on both sides.
    pub(crate) const OPEN: Self = Ground {
        medium: Vec3::ZERO,
        only: 0.0,
        past: Vec3::ZERO,
    };

    /// What is left of the light of a lamp at a distance; none lies beyond everything.
    #[inline(always)]
    pub(crate) fn transmittance(&self, distance: f32) -> Vec3 {
        if distance.is_finite() {
            transmittance(self.medium, distance)
        } else {
            Vec3::ONE
        }
    }
}

impl Scene {
    /// What is left of the light on the way to a surface.
    pub(crate) fn travelled(&self, travel: &mut Travel, met: &Meeting, direction: Vec3) -> Vec3 {
        if let Some(k) = self.parts.surfaces[met.surface as usize].body {
            let body = &self.parts.bodies[k as usize];
            // The surface says what lies on the side that the ray comes from, as in RADIANCE.
            if met.normal.dot(direction) > 0.0 {
                travel.medium = body.inside;
            } else if let Some(outside) = body.outside {
                travel.medium = outside;
            }
        }
        transmittance(travel.medium, met.distance)
    }

    /// The factor on radiance where a ray goes on in another direction behind a boundary: the squared ratio of the indices.
    pub(crate) fn refracted(&self, travel: &mut Travel, met: &Meeting, direction: Vec3, onward: Vec3) -> f32 {
        let Some(k) = self.parts.surfaces[met.surface as usize].body else {
            return 1.0;
        };
        let body = &self.parts.bodies[k as usize];
        let (enters, goes_in) = (met.normal.dot(direction) < 0.0, met.normal.dot(onward) < 0.0);
        if enters != goes_in {
            return 1.0;
        }
        if goes_in {
            travel.medium = body.inside;
            1.0 / (body.index * body.index)
        } else {
            travel.medium = body.outside.unwrap_or(Vec3::ZERO);
            body.index * body.index
        }
    }

    /// The thickness of a proxy; a sensor is no surface.
    fn thickness(&self, met: &Meeting) -> f32 {
        let surface = self.parts.surfaces.get(met.surface as usize);
        surface.map_or(0.0, |s| s.proxy)
    }

    /// Whether a ray passes a proxy as if it were not there: from the eye, and out of what it hides.
    pub(crate) fn passes_proxy(&self, met: &Meeting, direction: Vec3, scattered: bool) -> bool {
        let thickness = self.thickness(met);
        thickness != 0.0 && (!scattered || (thickness > 0.0) != (met.normal.dot(direction) < 0.0))
    }

    /// The way from a surface to where light goes on in a direction: past what a proxy hides, otherwise none.
    pub(crate) fn past_proxy(&self, met: &Meeting, direction: Vec3) -> Vec3 {
        let thickness = self.thickness(met);
        if thickness != 0.0 && (thickness > 0.0) == (met.normal.dot(direction) < 0.0) {
            return -thickness * met.normal;
        }
        Vec3::ZERO
    }

    /// [`Scene::lit_by_lights`], of a proxy once from the surface and once from past what it hides.
    #[inline(never)]
    pub(crate) fn lit_past_proxy(
        &self,
        travel: &Travel,
        met: &Meeting,
        local: &Local<'_>,
        which: f32,
        places: [[f32; 2]; 3],
    ) -> Vec3 {
        let medium = travel.medium;
        let thickness = self.thickness(met);
        let lit = |past: Vec3, only| {
            let point = met.point + past;
            let ground = Ground { medium, only, past };
            self.lit_by_lights(&Meeting { point, ..*met }, local, which, places, 1.0, &ground)
        };
        if thickness == 0.0 {
            return lit(Vec3::ZERO, 0.0);
        }
        let side = 1.0_f32.copysign(thickness);
        lit(Vec3::ZERO, side) + lit(-thickness * met.normal, -side)
    }
}

/// What a length of a medium leaves, by Beer's law.
pub(crate) fn transmittance(extinction: Vec3, length: f32) -> Vec3 {
    if extinction == Vec3::ZERO {
        return Vec3::ONE;
    }
    (-extinction * length).map(f32::exp)
}
