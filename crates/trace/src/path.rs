//! The radiance along a ray, by backward path tracing.

use glam::Vec3;

use crate::material::{Local, Material};
use crate::sampler::Sampler;
use crate::scene::{Meeting, Scene};
use crate::travel::{Ground, Travel};
use crate::unscattered::Unscattered;

/// How far paths are followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Reflections and transmissions after the first surface, at most; those straight through do not count.
    pub bounces: u32,
    /// Bounces after which a path may end by chance, in proportion to what it still carries.
    pub roulette: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Limits {
            bounces: 64,
            roulette: 3,
        }
    }
}

/// Mirrored and transmitted light with so much of all leave nothing to be scattered.
const ALL: f32 = 1.0 - 1e-5;

/// The balance heuristic [Veach1997, eq. 9.8]: how much the first of two ways to draw a direction counts.
#[inline]
pub(crate) fn balance(this: f32, other: f32) -> f32 {
    if this + other > 0.0 {
        this / (this + other)
    } else {
        0.0
    }
}

/// How the ray came about: what the light it meets counts.
#[derive(Clone, Copy)]
pub(crate) enum Origin {
    /// From the eye, or an ideal direction: no other way leads to the light.
    Alone,
    /// Drawn from a material at a point with this density, where lights were drawn this often.
    Drawn { from: Vec3, pdf: f32, draws: f32 },
    /// So drawn, and mirrored once by a plane mirror: suns were drawn through it as well, other lights were not.
    Mirrored { from: Vec3, pdf: f32, draws: f32 },
}

/// A way back from the eye, as far as it is followed.
#[derive(Clone, Copy)]
pub(crate) struct Path {
    pub(crate) origin: Vec3,
    /// Unit.
    pub(crate) direction: Vec3,
    /// What light that arrives along the ray counts.
    pub(crate) left: Vec3,
    pub(crate) came: Origin,
    /// Light found so far.
    pub(crate) sum: Vec3,
    pub(crate) bounces: u32,
    pub(crate) panes: u32,
    /// Boxes of a device that it has crossed.
    pub(crate) cells: u32,
    /// Whether it left the device that it was to pass.
    pub(crate) escaped: bool,
    pub(crate) sampler: Sampler,
    pub(crate) travel: Travel,
}

/// What becomes of a path at a surface.
pub(crate) enum Arrival<'a> {
    /// It ends.
    Ended,
    /// It went on without being scattered.
    Passed,
    /// It is scattered by a Lambertian reflector, without pattern.
    Plain(Vec3),
    /// It is scattered.
    Scattered(Local<'a>),
}

impl Path {
    /// A way that begins at the eye.
    #[inline(always)]
    pub(crate) fn new(origin: Vec3, direction: Vec3, sampler: Sampler) -> Self {
        Path {
            origin,
            direction,
            left: Vec3::ONE,
            came: Origin::Alone,
            sum: Vec3::ZERO,
            bounces: 0,
            panes: 0,
            cells: 0,
            escaped: false,
            sampler,
            travel: Travel::default(),
        }
    }

    /// A way on which there is no light.
    #[inline(always)]
    pub(crate) fn dark(sampler: Sampler) -> Self {
        Path {
            left: Vec3::ZERO,
            ..Path::new(Vec3::ZERO, Vec3::Z, sampler)
        }
    }

    /// Goes on from a scattering. Whether it does: it may end by chance.
    #[inline(always)]
    pub(crate) fn bounce(&mut self, origin: Vec3, next: Next, limits: &Limits) -> bool {
        self.origin = origin;
        self.direction = next.direction;
        self.came = next.came;
        self.left *= next.weight;
        self.bounces += 1;
        let carried = self.left.max_element();
        if self.bounces > limits.roulette && carried < 1.0 {
            let chance = carried.clamp(0.05, 0.95);
            if self.sampler.one() >= chance {
                return false;
            }
            self.left /= chance;
        }
        carried > 0.0 && carried.is_finite()
    }
}

impl Scene {
    /// Radiance that arrives at `origin` from the unit direction `direction`, W/(m2 sr) in red, green and blue: one sample.
    pub fn radiance(&self, origin: Vec3, direction: Vec3, limits: &Limits, sampler: &mut Sampler) -> Vec3 {
        let mut path = [Path::new(origin, direction, *sampler)];
        self.follow(&mut path, limits);
        *sampler = path[0].sampler;
        path[0].sum
    }

    /// What becomes of a path at what it meets. Where all light is mirrored or transmitted and each of both carries `fork`, the
    /// path goes one way and `branch` gets the other.
    #[inline(always)]
    pub(crate) fn arrive(
        &self,
        path: &mut Path,
        met: &Meeting,
        limits: &Limits,
        fork: f32,
        mut branch: impl FnMut(Path),
    ) -> Arrival<'_> {
        if self.travels {
            path.left *= self.travelled(&mut path.travel, met, path.direction);
            if path.panes < crate::scene::MOST_PANES
                && self.passes_proxy(met, path.direction, path.travel.scattered)
            {
                path.origin = self.off(met, path.direction);
                path.panes += 1;
                return Arrival::Passed;
            }
        }
        let surface = &self.parts.surfaces[met.surface as usize];
        path.sum += path.left * self.emitted(met, path.direction, path.came);
        if surface.concealed
            && matches!(path.came, Origin::Drawn { .. })
            && met.normal.dot(path.direction) < 0.0
        {
            // The light stands for all that comes through.
            return Arrival::Ended;
        }
        if path.bounces >= limits.bounces || path.panes >= crate::scene::MOST_PANES {
            return Arrival::Ended;
        }
        if let Material::Diffuse { reflectance } = &self.parts.materials[surface.material as usize]
            && surface.is_plain()
            && met.smooth == met.normal
        {
            return Arrival::Plain(*reflectance);
        }
        let local = self.local(met, -path.direction);
        let ways = local.ideal();
        if fork < f32::INFINITY
            && let [Some(mirrored), Some(transmitted)] = ways
            && (mirrored.share + transmitted.share).min_element() > ALL
            && (path.left * mirrored.share).max_element() >= fork
            && (path.left * transmitted.share).max_element() >= fork
        {
            let mut other = *path;
            other.sampler = path.sampler.forked();
            self.unscattered(&mut other, met, &mirrored, mirrored.share);
            branch(other);
            self.unscattered(path, met, &transmitted, transmitted.share);
            return Arrival::Passed;
        }
        match Unscattering::choose(ways, &mut path.sampler) {
            Unscattering::Taken { way, weight } => {
                self.unscattered(path, met, &way, weight);
                Arrival::Passed
            }
            Unscattering::Passed { weight } => {
                path.left *= weight;
                Arrival::Scattered(local)
            }
        }
    }

    /// Goes on without being scattered.
    #[inline(always)]
    fn unscattered(&self, path: &mut Path, met: &Meeting, way: &Unscattered, weight: Vec3) {
        path.left *= weight;
        if self.travels {
            path.left *= self.refracted(&mut path.travel, met, path.direction, way.direction);
        }
        path.direction = way.direction;
        path.origin = self.off(met, way.direction);
        if way.straight {
            // The ray goes on as it was: what it meets counts as without the pane.
            path.panes += 1;
        } else {
            path.came = self.mirrored(path.came, met.surface);
            path.bounces += 1;
        }
    }

    /// Lights a point of a path and goes on from there. Whether it does.
    #[inline(always)]
    pub(crate) fn scatter(&self, path: &mut Path, met: &Meeting, local: &Local<'_>, limits: &Limits) -> bool {
        let [which, choice] = path.sampler.two();
        let [u, v] = path.sampler.two();
        let places = self.places(&mut path.sampler);
        path.sum += path.left
            * match self.travels {
                true => self.lit_past_proxy(&path.travel, met, local, which, places),
                false => self.lit_by_lights(met, local, which, places, 1.0, &Ground::OPEN),
            };
        if path.bounces + 1 < limits.bounces {
            path.sum += path.left * self.lit_by_mirrors(met, local, which, places[1], 1.0);
        }
        let Some(mut next) = self.scattered(met, local, [u, v, choice]) else {
            return false;
        };
        // What is known of the sky beforehand and what it brings along the path cancel: none of it is left to chance.
        let veiled = self.veiled(met, local);
        if veiled {
            path.sum -= path.left * self.known_of(met, local, &next);
        }
        let mut origin = self.off(met, next.direction);
        if self.travels {
            let past = self.past_proxy(met, next.direction);
            origin += past;
            if let Origin::Drawn { from, .. } = &mut next.came {
                // Where lights are seen from.
                *from += past;
            }
            path.travel.scattered = true;
        }
        let roulette = if veiled { u32::MAX } else { limits.roulette };
        path.bounce(origin, next, &Limits { roulette, ..*limits })
    }

    /// What a surface emits towards the ray, as far as no other way to draw it counts.
    #[inline(always)]
    pub(crate) fn emitted(&self, met: &Meeting, direction: Vec3, came: Origin) -> Vec3 {
        let surface = &self.parts.surfaces[met.surface as usize];
        let alone = !matches!(came, Origin::Drawn { .. });
        let mut cos = -met.normal.dot(direction);
        if let (Some(_), Some(k)) = (self.veil(met.surface), surface.light) {
            cos = -self.lights.get(k).normal(met.point).dot(direction);
        }
        if cos <= 0.0 || (alone && surface.concealed) {
            return Vec3::ZERO;
        }
        let Some(k) = surface.light else {
            return if alone { surface.glow } else { Vec3::ZERO };
        };
        let light = self.lights.get(k);
        let weight = match came {
            Origin::Alone | Origin::Mirrored { .. } => 1.0,
            Origin::Drawn { from, pdf, draws } => {
                let distance = from.distance(met.point);
                let chance = self.lights.probability(from, k) * light.pdf(from, direction, distance, cos);
                balance(pdf, draws * chance) * self.spread(k, distance)
            }
        };
        weight * self.emission(k, met.point, met.normal, direction)
    }

    /// What comes from beyond everything.
    #[inline]
    pub(crate) fn at_infinity(&self, direction: Vec3, came: Origin) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for (k, light) in self.lights.distant() {
            if light.holds(direction) {
                let weight = match came {
                    Origin::Alone => 1.0,
                    Origin::Drawn { from, pdf, draws } | Origin::Mirrored { from, pdf, draws } => {
                        balance(pdf, draws * self.lights.probability(from, k) * light.pdf())
                    }
                };
                sum += weight * light.radiance;
            }
        }
        if let Some(sky) = &self.parts.sky {
            let weight = match came {
                Origin::Alone | Origin::Mirrored { .. } => 1.0,
                Origin::Drawn { from, pdf, draws } => {
                    balance(pdf, draws * self.sky_pdf(sky, from, direction))
                }
            };
            sum += weight * sky.radiance(direction);
        }
        sum
    }
}

/// The choice between unscattered light and the rest.
pub(crate) enum Unscattering {
    /// The path follows it.
    Taken { way: Unscattered, weight: Vec3 },
    /// The rest is drawn, and counts more by this.
    Passed { weight: f32 },
}

impl Unscattering {
    #[inline]
    pub(crate) fn choose(ways: [Option<Unscattered>; 2], sampler: &mut Sampler) -> Self {
        if ways.iter().all(Option::is_none) {
            return Unscattering::Passed { weight: 1.0 };
        }
        let chance = |way: &Option<Unscattered>| way.map_or(0.0, |w| w.share.max_element().min(1.0));
        let all: f32 = ways.iter().map(chance).sum();
        let scale = if all > 1.0 { 1.0 / all } else { 1.0 };
        let mut u = sampler.one();
        for way in &ways {
            let chance = scale * chance(way);
            if let Some(way) = way
                && u < chance
            {
                return Unscattering::Taken {
                    way: *way,
                    weight: way.share / chance,
                };
            }
            u -= chance;
        }
        Unscattering::Passed {
            weight: 1.0 / (1.0 - scale * all).max(f32::MIN_POSITIVE),
        }
    }
}

/// How a path goes on.
pub(crate) struct Next {
    pub(crate) direction: Vec3,
    pub(crate) weight: Vec3,
    pub(crate) came: Origin,
}
