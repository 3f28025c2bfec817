//! The radiance along a ray, by backward path tracing.

use glam::Vec3;

use crate::light::{Light, Towards};
use crate::material::{Local, Unscattered};
use crate::sampler::Sampler;
use crate::scene::{Meeting, Scene};

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

/// Share of the directions after a scattering that go to the portals, where there are any.
const TO_PORTALS: f32 = 0.5;

/// The balance heuristic [Veach1997, eq. 9.8]: how much the first of two ways to draw a direction counts.
#[inline]
fn balance(this: f32, other: f32) -> f32 {
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
    /// Drawn from a material at a point with this density.
    Drawn { from: Vec3, pdf: f32 },
}

impl Scene {
    /// Radiance that arrives at `origin` from the unit direction `direction`, W/(m2 sr) in red, green and blue: one sample.
    #[inline(always)]
    pub fn radiance(&self, origin: Vec3, direction: Vec3, limits: &Limits, sampler: &mut Sampler) -> Vec3 {
        let start = Next {
            direction,
            weight: Vec3::ONE,
            came: Origin::Alone,
        };
        self.follow(origin, start, 0, limits, sampler)
    }

    /// Light that goes on from `origin` along a path, after `bounces` before.
    #[inline(always)]
    pub(crate) fn follow(
        &self,
        origin: Vec3,
        start: Next,
        bounces: u32,
        limits: &Limits,
        sampler: &mut Sampler,
    ) -> Vec3 {
        let mut origin = origin;
        let Next {
            mut direction,
            weight: mut left,
            mut came,
        } = start;
        let mut sum = Vec3::ZERO;
        let (mut bounces, mut panes) = (bounces, 0);
        loop {
            let Some(met) = self.meet(origin, direction, f32::INFINITY) else {
                return sum + left * self.at_infinity(direction, came);
            };
            sum += left * self.emitted(&met, direction, came);
            let concealed = self.parts.surfaces[met.surface as usize].concealed;
            if concealed && matches!(came, Origin::Drawn { .. }) && met.normal.dot(direction) < 0.0 {
                // The light stands for all that comes through.
                return sum;
            }
            let local = self.local(&met, -direction);
            if bounces >= limits.bounces || panes >= crate::scene::MOST_PANES {
                return sum;
            }
            match Unscattering::choose(&local, sampler) {
                Unscattering::Taken { way, weight } => {
                    left *= weight;
                    direction = way.direction;
                    origin = self.off(&met, direction);
                    if way.straight {
                        // The ray goes on as it was: what it meets counts as without the pane.
                        panes += 1;
                    } else {
                        came = Origin::Alone;
                        bounces += 1;
                    }
                    continue;
                }
                Unscattering::Passed { weight } => left *= weight,
            }
            let u = sampler.one();
            let v = sampler.two();
            sum += left * self.lit_by_lights(&met, &local, u, v);
            let choice = sampler.one();
            let u = sampler.two();
            let Some(next) = self.scattered(&met, &local, [u[0], u[1], choice]) else {
                return sum;
            };
            left *= next.weight;
            came = next.came;
            direction = next.direction;
            origin = self.off(&met, direction);
            bounces += 1;
            let carried = left.max_element();
            if bounces > limits.roulette && carried < 1.0 {
                let chance = carried.clamp(0.05, 0.95);
                if sampler.one() >= chance {
                    return sum;
                }
                left /= chance;
            }
            if carried <= 0.0 || !carried.is_finite() {
                return sum;
            }
        }
    }

    /// What a surface emits towards the ray, as far as no other way to draw it counts.
    #[inline(always)]
    fn emitted(&self, met: &Meeting, direction: Vec3, came: Origin) -> Vec3 {
        let surface = &self.parts.surfaces[met.surface as usize];
        let alone = matches!(came, Origin::Alone);
        let cos = -met.normal.dot(direction);
        if cos <= 0.0 || (alone && surface.concealed) {
            return Vec3::ZERO;
        }
        let Some(k) = surface.light else {
            return if alone { surface.glow } else { Vec3::ZERO };
        };
        let light = self.lights.get(k);
        let weight = match came {
            Origin::Alone => 1.0,
            Origin::Drawn { from, pdf } => {
                let distance = from.distance(met.point);
                balance(
                    pdf,
                    self.lights.probability(from, k) * light.pdf(from, distance, cos),
                )
            }
        };
        weight * self.emission(k, met.point, met.normal, direction)
    }

    /// What comes from beyond everything.
    #[inline]
    fn at_infinity(&self, direction: Vec3, came: Origin) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for (k, light) in self.lights.distant() {
            if light.holds(direction) {
                let weight = match came {
                    Origin::Alone => 1.0,
                    Origin::Drawn { from, pdf } => balance(
                        pdf,
                        self.lights.probability(from, k) * Light::Distant(light.clone()).pdf(from, 0.0, 1.0),
                    ),
                };
                sum += weight * light.radiance;
            }
        }
        if let Some(sky) = &self.parts.sky {
            let weight = match came {
                Origin::Alone => 1.0,
                Origin::Drawn { pdf, .. } => balance(pdf, sky.pdf(direction)),
            };
            sum += weight * sky.radiance(direction);
        }
        sum
    }

    /// Light that a point scatters straight from the lights: one of them, and the sky.
    #[inline(always)]
    pub(crate) fn lit_by_lights(&self, met: &Meeting, local: &Local<'_>, u: f32, v: [f32; 2]) -> Vec3 {
        let mut sum = Vec3::ZERO;
        if !self.lights.is_empty()
            && let Some((k, chance, _)) = self.lights.choose(met.point, u)
            && let Some(mut towards) = self.lights.get(k).sample(met.point, v)
        {
            towards.pdf *= chance;
            if self
                .parts
                .light_patterns
                .get(k as usize)
                .is_some_and(Option::is_some)
            {
                let point = met.point + towards.distance * towards.direction;
                let normal = self.lights.get(k).normal(point);
                towards.radiance = self.emission(k, point, normal, towards.direction);
            }
            sum += self.arriving(met, local, &towards, false);
        }
        if let Some(sky) = &self.parts.sky {
            // The same numbers, turned: the sky and the lights are two integrals.
            let v = [(v[0] + 0.5).fract(), (v[1] + u).fract()];
            sum += self.arriving(met, local, &sky.sample(v), true);
        }
        sum
    }

    #[inline(always)]
    fn arriving(&self, met: &Meeting, local: &Local<'_>, towards: &Towards, from_sky: bool) -> Vec3 {
        let (f, pdf) = local.eval(towards.direction);
        if f == Vec3::ZERO || towards.pdf <= 0.0 || towards.radiance == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let pdf = self.with_portals(met.point, towards.direction, pdf);
        let origin = self.off(met, towards.direction);
        let (mut direction, mut far) = (towards.direction, towards.distance);
        if far.is_finite() {
            // From where the ray begins: moved along with it, its end could lie beyond the light.
            let way = met.point + far * direction - origin;
            far = way.length();
            direction = way / far;
            // Short of the light itself, by what its place and the point are rounded.
            far *= 1.0 - 1e-4;
        }
        match self.passes(origin, direction, far, from_sky) {
            Some(left) => f * left * towards.radiance * (balance(towards.pdf, pdf) / towards.pdf),
            None => Vec3::ZERO,
        }
    }

    /// A direction in which the path goes on.
    #[inline(always)]
    pub(crate) fn scattered(&self, met: &Meeting, local: &Local<'_>, mut u: [f32; 3]) -> Option<Next> {
        let portals = &self.parts.portals;
        if !portals.is_empty() {
            if u[2] < TO_PORTALS {
                u[2] /= TO_PORTALS;
                let direction = self.towards_portal(met.point, u)?;
                let (f, pdf) = local.eval(direction);
                let pdf = self.with_portals(met.point, direction, pdf);
                return (pdf > 0.0 && f != Vec3::ZERO).then_some(Next {
                    direction,
                    weight: f / pdf,
                    came: Origin::Drawn { from: met.point, pdf },
                });
            }
            u[2] = ((u[2] - TO_PORTALS) / (1.0 - TO_PORTALS)).min(0.999_999_94);
        }
        let drawn = local.sample(u)?;
        let pdf = self.with_portals(met.point, drawn.direction, drawn.pdf);
        Some(Next {
            direction: drawn.direction,
            weight: drawn.weight * (drawn.pdf / pdf),
            came: Origin::Drawn { from: met.point, pdf },
        })
    }

    /// The density of a direction when some of them go to the portals.
    #[inline(always)]
    fn with_portals(&self, from: Vec3, direction: Vec3, pdf: f32) -> f32 {
        let portals = &self.parts.portals;
        if portals.is_empty() {
            return pdf;
        }
        let sum: f32 = portals.iter().map(|p| portal_pdf(p, from, direction)).sum();
        (1.0 - TO_PORTALS) * pdf + TO_PORTALS * sum / portals.len() as f32
    }

    fn towards_portal(&self, from: Vec3, u: [f32; 3]) -> Option<Vec3> {
        let portals = &self.parts.portals;
        let k = ((u[2] * portals.len() as f32) as usize).min(portals.len() - 1);
        let [corner, a, b] = portals[k];
        (corner + u[0] * a + u[1] * b - from).try_normalize()
    }
}

/// The choice between unscattered light and the rest.
enum Unscattering {
    /// The path follows it.
    Taken { way: Unscattered, weight: Vec3 },
    /// The rest is drawn, and counts more by this.
    Passed { weight: f32 },
}

impl Unscattering {
    #[inline]
    fn choose(local: &Local<'_>, sampler: &mut Sampler) -> Self {
        let ways = local.ideal();
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

/// Density per solid angle of a direction to a point drawn evenly from a parallelogram; zero where it misses it.
fn portal_pdf([corner, a, b]: &[Vec3; 3], from: Vec3, direction: Vec3) -> f32 {
    let normal = a.cross(*b);
    let along = normal.dot(direction);
    if along == 0.0 {
        return 0.0;
    }
    let t = normal.dot(*corner - from) / along;
    let p = from + t * direction - *corner;
    let area2 = normal.length_squared();
    let (u, v) = (p.cross(*b).dot(normal) / area2, a.cross(p).dot(normal) / area2);
    if t <= 0.0 || !(0.0..=1.0).contains(&u) || !(0.0..=1.0).contains(&v) {
        return 0.0;
    }
    t * t / along.abs()
}
