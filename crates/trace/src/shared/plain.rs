//! Second points on Lambertian surfaces: their radiance is one for all first points.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;

use super::{First, MOST, Second, Table};
use crate::lanes::{LANES, Rays};
use crate::reflect::SHORT;

/// The first points, coordinate by coordinate.
struct Points {
    place: [[f32; MOST]; 3],
    /// Zero of those that are not plain.
    normal: [[f32; MOST]; 3],
}

impl Table<'_> {
    /// Gives all first points their share of all second points.
    #[inline(always)]
    pub(super) fn share(&mut self) {
        let n = self.firsts.len();
        let mut points = Points {
            place: [[0.0; MOST]; 3],
            normal: [[0.0; MOST]; 3],
        };
        for (k, first) in self.firsts.iter().enumerate() {
            let normal = first.plain.map_or(Vec3::ZERO, |p| p.1);
            for axis in 0..3 {
                points.place[axis][k] = first.met.point[axis];
                points.normal[axis][k] = normal[axis];
            }
        }
        // What Lambertian first points take, before their reflectance.
        let mut taken = [Vec3::ZERO; MOST];
        let mut rays = Rays::default();
        for second in &self.seconds {
            if second.radiance == Vec3::ZERO {
                continue;
            }
            // cos cos / distance^2 of plain ones; of others the light they take of unit radiance, and density over area.
            let mut kernel = points.kernel(second);
            let mut values = [(Vec3::ZERO, 0.0); MOST];
            let mut wanted = [0_u8; MOST];
            let mut count = 0;
            for (k, first) in self.firsts.iter().enumerate() {
                // The rest of the path has as many bounces to go as its own.
                if first.bounces + 1 != second.bounces {
                    kernel[k] = 0.0;
                    continue;
                }
                if first.plain.is_none() {
                    values[k] = self.value(first, second);
                }
                if kernel[k] > 0.0 || values[k].1 > 0.0 || values[k].0 != Vec3::ZERO {
                    wanted[count] = k as u8;
                    count += 1;
                }
            }
            let mut density = 0.0;
            for wanted in wanted[..count].chunks(LANES) {
                for (slot, k) in wanted.iter().enumerate() {
                    let met = &self.firsts[usize::from(*k)].met;
                    let origin = self.scene.off(met, second.point - met.point);
                    let way = second.point - origin;
                    let far = way.length();
                    rays.set(slot, origin, way / far, far * SHORT);
                }
                let free = self.scene.free_of_many(&mut rays, wanted.len());
                for (slot, k) in wanted.iter().enumerate() {
                    let k = usize::from(*k);
                    if free >> slot & 1 == 1 || k == second.by {
                        density += FRAC_1_PI * kernel[k] + values[k].1;
                    } else {
                        kernel[k] = 0.0;
                        values[k].0 = Vec3::ZERO;
                    }
                }
            }
            if density <= 0.0 {
                continue;
            }
            let each = second.radiance / density;
            for k in 0..n {
                taken[k] += kernel[k] * each;
            }
            for (first, (value, _)) in self.firsts.iter().zip(&values) {
                if first.plain.is_none() {
                    self.out[first.pixel] += first.left * value * each;
                }
            }
        }
        for (first, taken) in self.firsts.iter().zip(taken) {
            if let Some((reflectance, _)) = first.plain {
                self.out[first.pixel] += first.left * reflectance * taken;
            }
        }
    }

    /// What a first point takes of a second one of unit radiance, and its density over the area there.
    fn value(&self, first: &First<'_>, second: &Second) -> (Vec3, f32) {
        let way = second.point - first.met.point;
        let distance = way.length();
        let direction = way / distance;
        let there = -second.normal.dot(direction);
        if there > 0.0 {
            let (f, pdf) = first.local.eval(direction);
            let pdf = self.scene.with_screens(first.met.point, direction, pdf);
            let area = there / (distance * distance);
            (f * area, pdf * area)
        } else {
            (Vec3::ZERO, 0.0)
        }
    }
}

impl Points {
    /// cos cos / distance^2 between plain first points and a second one.
    #[inline(always)]
    fn kernel(&self, second: &Second) -> [f32; MOST] {
        let mut kernel = [0.0; MOST];
        let (p, m) = (second.point, second.normal);
        for (k, out) in kernel.iter_mut().enumerate() {
            let d = [
                p.x - self.place[0][k],
                p.y - self.place[1][k],
                p.z - self.place[2][k],
            ];
            let r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            let here = self.normal[0][k] * d[0] + self.normal[1][k] * d[1] + self.normal[2][k] * d[2];
            let there = -(m.x * d[0] + m.y * d[1] + m.z * d[2]);
            *out = here.max(0.0) * there.max(0.0) / (r2 * r2).max(f32::MIN_POSITIVE);
        }
        kernel
    }
}
