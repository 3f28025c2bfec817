//! Second points on glossy surfaces: all first points share what arrives there, each sees its own part of it.
//!
//! A glossy point is lit by directions towards the lights and by one that its first point draws there. Of the lights, a
//! direction counts by its density among both ways to draw it, the material's being the mean over all first points by their
//! densities of the second point: the same for all of them, so that the weights add up to one. What else arrives along the
//! drawn direction counts by the density of both points, over all first points that see the second [Veach1997, eq. 9.8].

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;

use super::{Heir, Table};
use crate::lanes::{LANES, Rays};
use crate::material::Local;
use crate::path::{Origin, Path};
use crate::reflect::SHORT;
use crate::sampler::Sampler;
use crate::scene::Meeting;

/// A second point on a glossy surface.
pub(super) struct Glossy {
    /// The first point that found it, and how many bounces it had.
    by: usize,
    bounces: u32,
    met: Meeting,
    /// Of the ray that found it.
    direction: Vec3,
    sampler: Sampler,
    /// What it is to the first points that may see it.
    parts: Vec<Part>,
    /// What arrives along the drawn direction.
    pub(super) arrives: Vec3,
}

/// What a glossy point is to a first one.
struct Part {
    first: usize,
    /// What the first point takes of unit radiance, and its density over the area.
    takes: Vec3,
    density: f32,
    /// Light straight from the lights, for unit density.
    lit: Vec3,
    /// `f |cos|` of the drawn direction, and its density.
    on: (Vec3, f32),
}

impl Glossy {
    pub(super) fn new(by: usize, bounces: u32, met: Meeting, direction: Vec3, sampler: Sampler) -> Self {
        Glossy {
            by,
            bounces,
            met,
            direction,
            sampler,
            parts: Vec::new(),
            arrives: Vec3::ZERO,
        }
    }
}

impl<'a> Table<'a> {
    /// Whether first points share a second point there.
    pub(super) fn shares_glossy(&self, met: &Meeting, local: &Local<'_>) -> bool {
        self.scene.parts.screens.is_empty()
            && self.scene.mirrors.is_empty()
            && self.scene.veil(met.surface).is_none()
            && local.ideal().iter().all(Option::is_none)
    }

    /// Lights the glossy points, and goes on from them.
    pub(super) fn light_glossy(&mut self) {
        for g in 0..self.glossy.len() {
            let (parts, next) = self.lit_parts(&self.glossy[g]);
            self.glossy[g].parts = parts;
            if let Some(path) = next {
                self.tail(path, Heir::Glossy(g));
            }
        }
    }

    /// The parts of a glossy point, with light straight from the lights, and the path that goes on from there.
    fn lit_parts(&self, glossy: &Glossy) -> (Vec<Part>, Option<Path>) {
        let (scene, met) = (self.scene, &glossy.met);
        let mut parts = Vec::with_capacity(self.firsts.len());
        let mut locals = Vec::with_capacity(self.firsts.len());
        for k in 0..self.firsts.len() {
            if let Some((part, direction)) = self.part(glossy, k) {
                parts.push(part);
                locals.push(scene.local(met, -direction));
            }
        }
        let total: f32 = parts.iter().map(|p| p.density).sum();
        let mut sampler = glossy.sampler;
        let [which, choice] = sampler.two();
        let [u, v] = sampler.two();
        let places = scene.places(&mut sampler);
        // `f |cos|` and densities of a direction for all parts, and the mean of the densities.
        let seen = |parts: &[Part], direction: Vec3| {
            let each: Vec<(Vec3, f32)> = locals.iter().map(|local| local.eval(direction)).collect();
            let mean = parts.iter().zip(&each).map(|(p, e)| p.density * e.1).sum::<f32>() / total;
            (each, mean)
        };
        let mut lit = vec![Vec3::ZERO; parts.len()];
        for (towards, from_sky) in scene.drawn_lights(met.point, which, places).into_iter().flatten() {
            let (each, pdf) = seen(&parts, towards.direction);
            if towards.pdf <= 0.0 || each.iter().all(|e| e.0 == Vec3::ZERO) {
                continue;
            }
            let Some(passage) = scene.way_to(met, &towards, from_sky).0 else {
                continue;
            };
            let mut radiance = passage.left * towards.radiance;
            if from_sky && let Some(sky) = &scene.parts.sky {
                radiance *= sky.radiance(towards.direction);
            }
            let chance = towards.pdf + if passage.alone { 0.0 } else { pdf };
            for (lit, (f, _)) in lit.iter_mut().zip(each) {
                *lit += f * radiance / chance;
            }
        }
        for (part, lit) in parts.iter_mut().zip(lit) {
            part.lit = lit;
        }
        let own = scene.local(met, -glossy.direction);
        let drawn = scene.scattered(met, &own, [u, v, choice]);
        let next = drawn.and_then(|next| {
            let (each, mean) = seen(&parts, next.direction);
            for (part, on) in parts.iter_mut().zip(each) {
                part.on = on;
            }
            let came = Origin::Drawn {
                from: met.point,
                pdf: mean,
                draws: 1.0,
            };
            (mean > 0.0).then(|| Path {
                bounces: glossy.bounces + 1,
                came,
                ..Path::new(scene.off(met, next.direction), next.direction, sampler)
            })
        });
        (parts, next)
    }

    /// What a glossy point is to first point `k`, and the direction to it; `None` where it is nothing.
    fn part(&self, glossy: &Glossy, k: usize) -> Option<(Part, Vec3)> {
        let (first, met) = (&self.firsts[k], &glossy.met);
        // The rest of the path has as many bounces to go as its own.
        if first.bounces + 1 != glossy.bounces {
            return None;
        }
        let way = met.point - first.met.point;
        let distance2 = way.length_squared();
        let direction = way / distance2.sqrt();
        let there = met.normal.dot(direction) * 1.0_f32.copysign(met.normal.dot(glossy.direction));
        if there.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
            return None;
        }
        let area = there / distance2;
        let (takes, density) = match first.plain {
            Some((reflectance, normal)) => {
                let here = normal.dot(direction).max(0.0) * area;
                (reflectance * here, FRAC_1_PI * here)
            }
            None => {
                let (f, pdf) = first.local.eval(direction);
                (f * area, pdf * area)
            }
        };
        (density > 0.0 || takes != Vec3::ZERO).then_some((
            Part {
                first: k,
                takes: first.left * takes,
                density,
                lit: Vec3::ZERO,
                on: (Vec3::ZERO, 0.0),
            },
            direction,
        ))
    }

    /// Gives all first points their share of all glossy points.
    pub(super) fn share_glossy(&mut self) {
        let mut rays = Rays::default();
        for glossy in &self.glossy {
            let mut seen = Vec::with_capacity(glossy.parts.len());
            for parts in glossy.parts.chunks(LANES) {
                for (slot, part) in parts.iter().enumerate() {
                    let met = &self.firsts[part.first].met;
                    let origin = self.scene.off(met, glossy.met.point - met.point);
                    let way = glossy.met.point - origin;
                    let far = way.length();
                    rays.set(slot, origin, way / far, far * SHORT);
                }
                let free = self.scene.free_of_many(&mut rays, parts.len());
                seen.extend(
                    parts
                        .iter()
                        .enumerate()
                        .filter(|(slot, part)| free >> slot & 1 == 1 || part.first == glossy.by)
                        .map(|(_, part)| part),
                );
            }
            let density: f32 = seen.iter().map(|p| p.density).sum();
            let both: f32 = seen.iter().map(|p| p.density * p.on.1).sum();
            for part in seen {
                let mut radiance = Vec3::ZERO;
                if density > 0.0 {
                    radiance += part.lit / density;
                }
                if both > 0.0 {
                    radiance += part.on.0 * glossy.arrives / both;
                }
                self.out[self.firsts[part.first].pixel] += part.takes * radiance;
            }
        }
    }
}
