//! How the surfaces of a scene look from a direction.

use glam::Vec3;

use super::{Meeting, OFF, Scene};
use crate::material::{Local, Material};
use crate::pattern::Layer;

impl Scene {
    /// The material where a ray met it, seen from `to_eye`.
    #[inline(always)]
    pub(crate) fn local(&self, met: &Meeting, to_eye: Vec3) -> Local<'_> {
        let surface = &self.parts.surfaces[met.surface as usize];
        let layer = Layer {
            material: surface.material,
            paint: surface.paint,
            texture: surface.texture,
            mixture: surface.mixture,
            up: surface.up,
        };
        self.layer(&layer, met, to_eye)
    }

    #[inline(always)]
    fn layer(&self, layer: &Layer, met: &Meeting, to_eye: Vec3) -> Local<'_> {
        if let Some(k) = layer.mixture {
            return self.mixed(k, met, to_eye);
        }
        let material = &self.parts.materials[layer.material as usize];
        let local = if layer.texture.is_none() && layer.up.is_none() && met.smooth == met.normal {
            Local::new(material, met.normal, to_eye)
        } else {
            let up = layer
                .up
                .map(|k| self.parts.ups[k as usize].up(met.point, met.smooth, -to_eye));
            Local::bent(material, met.normal, self.turned(layer, met, to_eye), up, to_eye)
        };
        let local = match layer.paint {
            None => local,
            Some(k) => {
                let paint = &self.parts.paints[k as usize];
                let factor = paint.pattern.multiplier(met.point, met.normal, -to_eye);
                local.painted(factor, paint.bare.as_deref())
            }
        };
        match material {
            Material::Function(_) => local.placed(met.point, met.normal),
            _ => local,
        }
    }

    /// The two looks of a mixture.
    #[inline(never)]
    fn mixed(&self, k: u32, met: &Meeting, to_eye: Vec3) -> Local<'_> {
        let mixture = &self.parts.mixtures[k as usize];
        let share = mixture.share.multiplier(met.point, met.normal, -to_eye).x;
        let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
        let [first, second] = &mixture.layers;
        if share == 1.0 {
            return self.layer(first, met, to_eye);
        }
        let second = self.layer(second, met, to_eye);
        if share == 0.0 {
            return second;
        }
        self.layer(first, met, to_eye).mixed(share, second)
    }

    /// The normal that the material shows.
    #[inline(never)]
    fn turned(&self, layer: &Layer, met: &Meeting, to_eye: Vec3) -> Vec3 {
        let shift = layer.texture.map_or(Vec3::ZERO, |k| {
            self.parts.textures[k as usize].shift(met.point, met.smooth, -to_eye)
        });
        let turned = met.smooth + shift;
        if turned.is_finite() {
            turned.normalize_or(met.normal)
        } else {
            met.normal
        }
    }

    /// The normal of a smooth mesh at a point of a triangle.
    #[inline(always)]
    pub(crate) fn smoothed(&self, triangle: u32, at: Vec3) -> Option<Vec3> {
        if self.parts.normals.is_empty() {
            return None;
        }
        let ([a, b, c], _) = self.triangle(triangle);
        let (ab, ac, way) = (b - a, c - a, at - a);
        let across = ab.cross(ac);
        let at = [way.cross(ac), ab.cross(way)].map(|w| w.dot(across) / across.length_squared());
        let mut sum = Vec3::ZERO;
        let shares = [1.0 - at[0] - at[1], at[0], at[1]];
        for (k, share) in self.parts.triangles[triangle as usize].iter().zip(shares) {
            let normal = Vec3::from(*self.parts.normals.get(*k as usize)?);
            if normal == Vec3::ZERO {
                return None;
            }
            sum += share * normal;
        }
        sum.try_normalize()
    }

    /// The factor on the light of one that seems to come from farther away.
    #[inline(always)]
    pub(crate) fn spread(&self, k: u32, distance: f32) -> f32 {
        match self.parts.light_focus.get(k as usize) {
            Some(&focus) if focus > 0.0 => (distance / (distance + focus)).powi(2),
            _ => 1.0,
        }
    }

    /// What a light emits at a point of it against a ray.
    #[inline(always)]
    pub(crate) fn emission(&self, k: u32, point: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
        let radiance = self.lights.get(k).radiance();
        match self.parts.light_patterns.get(k as usize) {
            Some(Some(pattern)) => radiance * pattern.multiplier(point, normal, direction),
            _ => radiance,
        }
    }

    /// The point, moved off its surface to the side that `direction` goes to.
    #[inline(always)]
    pub(crate) fn off(&self, met: &Meeting, direction: Vec3) -> Vec3 {
        let side = 1.0_f32.copysign(met.normal.dot(direction));
        met.point + (OFF * self.extent * side) * met.normal
    }
}
