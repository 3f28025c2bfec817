//! Paths at Lambertian reflectors that flat lights shine on: all of a batch at once.

use std::f32::consts::FRAC_1_PI;

use crate::lanes::{Hits, LANES, Rays, Vectors, blocks};
use crate::path::{Limits, Next, Origin, Path};
use crate::sampler::{EVEN_PAIRS, Sampler};
use crate::scene::{OFF, Scene};
use crate::vector::{Frame, cosine_weighted};

/// What is known of the reflectors and comes of them.
pub(crate) struct Reflectors {
    count: usize,
    path: [u8; LANES],
    slot: [u8; LANES],
    reflectance: Vectors,
    numbers: [[f32; LANES]; 6],
    point: Vectors,
    normal: Vectors,
    /// Of the ray that met the surface; then of the one that goes on.
    direction: Vectors,
    /// Where the new rays begin.
    origin: Vectors,
    left: Vectors,
    lamp: Vectors,
    lamp_normal: Vectors,
    radiance: Vectors,
    /// The density of points on the lights.
    density: [f32; LANES],
    to_lamp: Vectors,
    distance: [f32; LANES],
    /// What the light brings to the paths, if nothing lies between.
    gain: Vectors,
    /// Density of the new direction.
    pdf: [f32; LANES],
}

impl Default for Reflectors {
    fn default() -> Self {
        Reflectors {
            count: 0,
            path: [0; LANES],
            slot: [0; LANES],
            reflectance: Vectors::default(),
            numbers: [[0.0; LANES]; 6],
            point: Vectors::default(),
            normal: Vectors::default(),
            direction: Vectors::default(),
            origin: Vectors::default(),
            left: Vectors::default(),
            lamp: Vectors::default(),
            lamp_normal: Vectors::default(),
            radiance: Vectors::default(),
            density: [0.0; LANES],
            to_lamp: Vectors::default(),
            distance: [0.0; LANES],
            gain: Vectors::default(),
            pdf: [0.0; LANES],
        }
    }
}

impl Reflectors {
    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }

    /// Path `path`, whose hit is in lane `slot`, meets a reflector.
    #[inline(always)]
    pub(crate) fn add(&mut self, path: u8, slot: usize, reflectance: glam::Vec3) {
        self.path[self.count] = path;
        self.slot[self.count] = slot as u8;
        self.reflectance.set(self.count, reflectance);
        self.count += 1;
    }

    /// The paths and the lanes of their hits.
    pub(crate) fn all(&self) -> impl Iterator<Item = (u8, usize)> {
        self.path
            .into_iter()
            .zip(self.slot.map(usize::from))
            .take(self.count)
    }

    /// Six numbers for each path: for the choices, the new direction and the place on a light.
    #[inline(always)]
    fn draw(&mut self, paths: &mut [Path]) {
        let mut samplers = [Sampler::new(0, 0, 0); LANES];
        let first = paths[self.path[0] as usize].sampler.taken;
        let (mut late, mut even) = (true, true);
        for j in 0..self.count {
            let sampler = &mut paths[self.path[j] as usize].sampler;
            samplers[j] = *sampler;
            late &= sampler.taken >= EVEN_PAIRS;
            even &= sampler.taken == first;
            sampler.taken += 3;
        }
        for pair in 0..3 {
            let k = first + pair as u32;
            let (low, high) = self.numbers.split_at_mut(2 * pair + 1);
            let (u, v) = (&mut low[2 * pair], &mut high[0]);
            if late {
                for j in 0..blocks(self.count) {
                    [u[j], v[j]] = samplers[j].random(samplers[j].taken + pair as u32);
                }
            } else if even && k < EVEN_PAIRS {
                for j in 0..blocks(self.count) {
                    [u[j], v[j]] = samplers[j].even(k);
                }
            } else {
                for j in 0..self.count {
                    [u[j], v[j]] = samplers[j].pair(samplers[j].taken + pair as u32);
                }
            }
        }
    }

    /// Light that could come from the lamps, and where the paths go on.
    #[inline(always)]
    fn compute(&mut self, off: f32) {
        for j in 0..blocks(self.count) {
            let (point, normal, direction) = (self.point.get(j), self.normal.get(j), self.direction.get(j));
            let outward = normal * 1.0_f32.copysign(-normal.dot(direction));
            let origin = point + off * outward;
            self.origin.set(j, origin);

            let way = self.lamp.get(j) - point;
            let distance2 = way.length_squared();
            let distance = distance2.sqrt();
            let cos_distance = -self.lamp_normal.get(j).dot(way);
            let cos = outward.dot(way) / distance;
            let lit = (cos_distance > 0.0) & (cos > 0.0);
            let light_pdf = distance2 * distance * self.density[j] / cos_distance;
            let pdf = cos * FRAC_1_PI;
            let share = if lit { pdf / (light_pdf + pdf) } else { 0.0 };
            let through = self.left.get(j) * self.reflectance.get(j);
            self.gain.set(j, share * through * self.radiance.get(j));
            // From where the ray begins: moved along with it, its end could lie beyond the light.
            let way = self.lamp.get(j) - origin;
            let far = way.length();
            self.to_lamp.set(j, way / far);
            self.distance[j] = far;

            let local = cosine_weighted([self.numbers[2][j], self.numbers[3][j]]);
            self.pdf[j] = local.z * FRAC_1_PI;
            self.direction.set(j, Frame::about(outward).world(local));
        }
    }
}

impl Scene {
    /// Lights the reflectors and goes on from them; `on` hears of the paths that do.
    #[inline(always)]
    pub(crate) fn reflect(
        &self,
        paths: &mut [Path],
        hits: &Hits,
        work: &mut Reflectors,
        rays: &mut Rays,
        limits: &Limits,
        mut on: impl FnMut(u8),
    ) {
        if work.count == 0 {
            return;
        }
        work.draw(paths);
        for j in 0..work.count {
            let path = &paths[work.path[j] as usize];
            let (point, normal) = hits.place(work.slot[j] as usize);
            work.point.set(j, point);
            work.normal.set(j, normal);
            work.direction.set(j, path.direction);
            work.left.set(j, path.left);
            let [u, v] = [work.numbers[4][j], work.numbers[5][j]];
            match self.lights.choose_flat(point, work.numbers[0][j]) {
                Some((flat, chance)) => {
                    work.lamp.set(j, flat.place([u, v]));
                    work.lamp_normal.set(j, flat.normal());
                    work.radiance.set(j, flat.radiance);
                    work.density[j] = chance / flat.area();
                }
                None => work.radiance.set(j, glam::Vec3::ZERO),
            }
        }
        work.compute(OFF * self.extent);
        let mut which = [0_u8; LANES];
        let mut count = 0;
        for j in 0..work.count {
            if work.gain.get(j).max_element() > 0.0 {
                let far = work.distance[j] * SHORT;
                rays.set(count, work.origin.get(j), work.to_lamp.get(j), far);
                which[count] = j as u8;
                count += 1;
            }
        }
        self.pass_all(rays, count, |k, colour| {
            let j = which[k] as usize;
            paths[work.path[j] as usize].sum += colour * work.gain.get(j);
        });
        for j in 0..work.count {
            let path = &mut paths[work.path[j] as usize];
            let origin = work.origin.get(j);
            let next = Next {
                direction: work.direction.get(j),
                weight: work.reflectance.get(j),
                came: Origin::Drawn {
                    from: work.point.get(j),
                    pdf: work.pdf[j],
                    draws: 1.0,
                },
            };
            if work.pdf[j] > 0.0 && path.bounce(origin, next, limits) {
                on(work.path[j]);
            }
        }
    }
}

/// Rays towards a light end short of it, by what its place and their beginning are rounded.
pub(crate) const SHORT: f32 = 1.0 - 1e-4;
