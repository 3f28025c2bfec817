//! Light that points scatter straight from the lights.

use glam::Vec3;

use crate::light::Towards;
use crate::material::Local;
use crate::path::balance;
use crate::reflect::SHORT;
use crate::sampler::Sampler;
use crate::scene::{Meeting, Passage, Scene};
use crate::travel::Ground;

impl Scene {
    /// Numbers that draw a place of a light, of one at infinity, and of the sky.
    #[inline(always)]
    pub(crate) fn places(&self, sampler: &mut Sampler) -> [[f32; 2]; 3] {
        let first = sampler.two();
        let [far, near] = self.lights.kinds();
        let mut places = [first; 3];
        if far && near {
            places[1] = sampler.two();
        }
        if (far || near) && self.parts.sky.is_some() {
            places[2] = sampler.two();
        }
        places
    }

    /// Light that a point scatters straight from the lights: one of them, one of those at infinity, and the sky. One of
    /// `draws` samples, which add up.
    #[inline(always)]
    pub(crate) fn lit_by_lights(
        &self,
        met: &Meeting,
        local: &Local<'_>,
        which: f32,
        places: [[f32; 2]; 3],
        draws: f32,
        ground: &Ground,
    ) -> Vec3 {
        let mut sum = Vec3::ZERO;
        if let Some((k, chance)) = self.lights.choose_near(met.point, which) {
            sum += self.lit_by(met, local, k, chance * draws, places[0], ground);
        }
        let veiled = self.veiled(met, local);
        if let Some((k, chance)) = self.lights.choose_far(which) {
            sum += match veiled {
                true => self.sun_beyond_veil(met, local, k, chance * draws, places[1]),
                false => self.lit_by(met, local, k, chance * draws, places[1], ground),
            };
        }
        if veiled {
            sum += self.beyond_veil(met, local, places[2], draws);
        } else if let Some(sky) = &self.parts.sky {
            let mut towards = self.draw_sky(sky, met.point, places[2]);
            towards.pdf *= draws;
            let shade = self.arriving(met, local, &towards, true, ground);
            if shade != Vec3::ZERO {
                sum += shade * sky.radiance(towards.direction);
            }
        }
        sum
    }

    /// Light that a point scatters of one light, which was chosen this often.
    #[inline(always)]
    fn lit_by(
        &self,
        met: &Meeting,
        local: &Local<'_>,
        k: u32,
        often: f32,
        place: [f32; 2],
        ground: &Ground,
    ) -> Vec3 {
        match self.towards(k, met.point, often, place) {
            Some(towards) => self.arriving(met, local, &towards, false, ground),
            None => Vec3::ZERO,
        }
    }

    /// A direction towards a light that was chosen this often, and its radiance.
    #[inline(always)]
    pub(crate) fn towards(&self, k: u32, from: Vec3, often: f32, place: [f32; 2]) -> Option<Towards> {
        let mut towards = self.lights.get(k).sample(from, place)?;
        towards.pdf *= often;
        if self
            .parts
            .light_patterns
            .get(k as usize)
            .is_some_and(Option::is_some)
        {
            let point = from + towards.distance * towards.direction;
            let normal = self.lights.get(k).normal(point);
            towards.radiance = self.emission(k, point, normal, towards.direction);
        }
        towards.radiance *= self.spread(k, towards.distance);
        Some(towards)
    }

    /// A direction towards a lamp, one towards a light at infinity, and one towards the sky, whose radiance is asked for when
    /// nothing is in the way.
    pub(crate) fn drawn_lights(
        &self,
        from: Vec3,
        which: f32,
        places: [[f32; 2]; 3],
    ) -> [Option<(Towards, bool)>; 3] {
        let of = |chosen: Option<(u32, f32)>, place| {
            chosen.and_then(|(k, often)| Some((self.towards(k, from, often, place)?, false)))
        };
        let sky = self.parts.sky.as_ref();
        [
            of(self.lights.choose_near(from, which), places[0]),
            of(self.lights.choose_far(which), places[1]),
            sky.map(|sky| (self.draw_sky(sky, from, places[2]), true)),
        ]
    }

    #[inline(always)]
    fn arriving(
        &self,
        met: &Meeting,
        local: &Local<'_>,
        towards: &Towards,
        from_sky: bool,
        ground: &Ground,
    ) -> Vec3 {
        let (f, pdf) = local.eval(towards.direction);
        if f == Vec3::ZERO || towards.pdf <= 0.0 || towards.radiance == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let pdf = self.with_screens(met.point - ground.past, towards.direction, pdf);
        if ground.only * met.normal.dot(towards.direction) < 0.0 {
            return Vec3::ZERO;
        }
        let (passage, far) = self.way_to(met, towards, from_sky);
        match passage {
            Some(passage) => {
                let weight = if passage.alone {
                    1.0
                } else {
                    balance(towards.pdf, pdf)
                };
                let left = passage.left * ground.transmittance(far);
                f * left * towards.radiance * (weight / towards.pdf)
            }
            None => Vec3::ZERO,
        }
    }

    /// What is left of light on its way from a light to a point, and the length of the way.
    #[inline(always)]
    pub(crate) fn way_to(&self, met: &Meeting, towards: &Towards, from_sky: bool) -> (Option<Passage>, f32) {
        let origin = self.off(met, towards.direction);
        let (mut direction, mut far) = (towards.direction, towards.distance);
        if far.is_finite() {
            // From where the ray begins: moved along with it, its end could lie beyond the light.
            let way = met.point + far * direction - origin;
            far = way.length();
            direction = way / far;
            far *= SHORT;
        }
        (self.passes(origin, direction, far, from_sky), far)
    }
}
