//! Light of the sky through the openings of rooms.

use glam::Vec3;

use super::{OFF, Scene};
use crate::light::{Openings, Seen, Sky, Towards};
use crate::sampler::Sampler;
use crate::vector::{Frame, cosine_weighted};

/// Rays that look how much of the sky is free before an opening.
const PROBES: u32 = 256;
/// Share of the directions towards the sky that are drawn without regard to the openings, from points that see some.
const PAST_OPENINGS: f32 = 0.1;

impl Scene {
    /// The portals, each with the side on which more of the sky is free.
    pub(super) fn find_openings(&self) -> Openings {
        let mut openings = Openings::default();
        let Some(sky) = &self.parts.sky else {
            return openings;
        };
        for portal in &self.parts.portals {
            let [_, a, b] = *portal;
            let Some(normal) = a.cross(b).try_normalize() else {
                continue;
            };
            let (front, back) = (self.free(portal, normal), self.free(portal, -normal));
            let (outward, clear) = if front >= back {
                (normal, front)
            } else {
                (-normal, back)
            };
            openings.add(&|d| sky.radiance(d).max_element(), *portal, outward, clear);
        }
        openings
    }

    /// How much of the sky is free before a side of an opening, of light that falls evenly on all directions of it.
    pub(crate) fn free(&self, [corner, a, b]: &[Vec3; 3], outward: Vec3) -> f32 {
        let frame = Frame::about(outward);
        let each = (0..PROBES).filter(|k| {
            let mut sampler = Sampler::new(0, 0, *k);
            let (at, towards) = (sampler.two(), sampler.two());
            let direction = frame.world(cosine_weighted(towards));
            let origin = *corner + at[0] * *a + at[1] * *b + (OFF * self.extent) * outward;
            self.passes(origin, direction, f32::INFINITY, true).is_some()
        });
        each.count() as f32 / PROBES as f32
    }

    /// Draws a direction towards the sky: most through the openings that a point sees from inside, if there are any.
    #[inline]
    pub(crate) fn draw_sky(&self, sky: &Sky, from: Vec3, [u, v]: [f32; 2]) -> Towards {
        if self.openings.is_empty() {
            return sky.sample([u, v]);
        }
        let seen = self.openings.seen(from);
        if seen.is_empty() {
            return sky.sample([u, v]);
        }
        let direction = if u < PAST_OPENINGS {
            sky.direction([u / PAST_OPENINGS, v])
        } else {
            let u = (u - PAST_OPENINGS) / (1.0 - PAST_OPENINGS);
            match self.openings.sample(&seen, [u, v]) {
                Some(direction) => direction,
                None => sky.direction([u, v]),
            }
        };
        Towards {
            direction,
            distance: f32::INFINITY,
            radiance: Vec3::ONE,
            pdf: self.pdf_past(sky, &seen, direction),
        }
    }

    fn pdf_past(&self, sky: &Sky, seen: &Seen, direction: Vec3) -> f32 {
        PAST_OPENINGS * sky.pdf(direction) + (1.0 - PAST_OPENINGS) * self.openings.pdf(seen, direction)
    }

    /// The density per solid angle with which [`Scene::draw_sky`] draws a unit direction.
    #[inline]
    pub(crate) fn sky_pdf(&self, sky: &Sky, from: Vec3, direction: Vec3) -> f32 {
        if self.openings.is_empty() {
            return sky.pdf(direction);
        }
        let seen = self.openings.seen(from);
        if seen.is_empty() {
            return sky.pdf(direction);
        }
        self.pdf_past(sky, &seen, direction)
    }
}
