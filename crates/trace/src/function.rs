//! Materials told by functions of the place and both directions, such as RADIANCE's `BRTDfunc`.

use glam::Vec3;

use crate::material::{Drawn, Local, Material};
use crate::unscattered::Unscattered;
use crate::vector::cosine_weighted;

/// Where and how a surface is seen.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    /// The point, in the world.
    pub point: Vec3,
    /// Unit normal of the front.
    pub normal: Vec3,
    /// The same, turned by textures and smoothed over a mesh.
    pub shown: Vec3,
    /// Unit, leaves the surface.
    pub to_eye: Vec3,
    /// The factor of patterns.
    pub colour: Vec3,
}

impl Sight {
    /// 1 where the eye is before the surface, -1 where it is behind.
    #[inline]
    pub fn side(&self) -> f32 {
        1.0_f32.copysign(self.shown.dot(self.to_eye))
    }
}

/// A material that is another at each point. All values are in red, green and blue, at least 0 and finite.
pub trait Scattering: Send + Sync {
    /// Scattering function of light from `from` (unit, leaves the surface), 1/sr.
    fn eval(&self, sight: &Sight, from: Vec3) -> Vec3;

    /// Share of the light from the mirrored direction.
    fn mirrored(&self, sight: &Sight) -> Vec3;

    /// Share of the light that comes straight through.
    fn straight(&self, sight: &Sight) -> Vec3;

    /// Whether any light may come straight through anywhere.
    fn is_clear(&self) -> bool;

    /// How many of the drawn directions lie on the side of the eye, from 0 to 1; each side is drawn by the cosine. 1 only where nothing is
    /// transmitted but straight, 0 only where nothing is reflected.
    fn reflected(&self, sight: &Sight) -> f32;
}

impl Local<'_> {
    /// At a point of a surface of this normal, which materials of functions ask for; patterns are there already.
    pub(crate) fn placed(mut self, point: Vec3, normal: Vec3) -> Self {
        self.sight = Some(Box::new(Sight {
            point,
            normal,
            shown: self.frame.z,
            to_eye: self.frame.world(self.to_eye_local),
            colour: self.paint.map_or(Vec3::ONE, |p| p.0),
        }));
        self
    }

    /// A material of functions, and where it is seen.
    #[inline(always)]
    fn function(&self) -> Option<(&dyn Scattering, &Sight)> {
        match (self.material, &self.sight) {
            (Material::Function(f), Some(sight)) => Some((f.as_ref(), sight)),
            _ => None,
        }
    }

    /// [`Local::eval_one`] of functions.
    #[inline(never)]
    pub(crate) fn eval_function(&self, from: Vec3) -> (Vec3, f32) {
        let Some((function, sight)) = self.function() else {
            return (Vec3::ZERO, 0.0);
        };
        let cos = sight.side() * sight.shown.dot(from);
        let reflected = function.reflected(sight);
        let chance = if cos > 0.0 { reflected } else { 1.0 - reflected };
        let pdf = chance * cos.abs() * std::f32::consts::FRAC_1_PI;
        (function.eval(sight, from) * cos.abs(), pdf)
    }

    /// [`Local::draw`] of functions.
    #[inline(never)]
    pub(crate) fn draw_function(&self, u: [f32; 3]) -> Option<Drawn> {
        let (function, sight) = self.function()?;
        let side = match u[2] < function.reflected(sight) {
            true => sight.side(),
            false => -sight.side(),
        };
        let direction = self
            .frame
            .world(cosine_weighted([u[0], u[1]]) * Vec3::new(1.0, 1.0, side));
        let (f, pdf) = self.eval_function(direction);
        (pdf > 0.0).then(|| Drawn {
            direction,
            weight: f / pdf,
            pdf,
        })
    }

    /// What a mirror of functions shows.
    pub(crate) fn mirrored_function(&self) -> Option<Unscattered> {
        let (function, sight) = self.function()?;
        let direction = 2.0 * sight.shown.dot(sight.to_eye) * sight.shown - sight.to_eye;
        let share = function.mirrored(sight);
        (share.max_element() > 0.0 && self.agrees(direction)).then_some(Unscattered {
            direction,
            share,
            straight: false,
        })
    }

    /// What functions let through straight.
    pub(crate) fn straight_function(&self) -> Option<Unscattered> {
        let (function, sight) = self.function()?;
        let share = function.straight(sight);
        (share.max_element() > 0.0).then(|| Unscattered::straight(-sight.to_eye, share))
    }
}
