//! Paths that the pixels of a tile share [Bekaert2002].
//!
//! Every pixel follows one path: from the eye to a first point, and from there in a direction that the material draws to a
//! second point. Where that second point reflects as a Lambertian surface, its radiance is the same for all first points that
//! see it: each pixel takes its share of all of them. Every first point could have drawn each second point; the densities of
//! all of them, with visibility, weigh the samples by the balance heuristic [Veach1997, eq. 9.8], so that means stay what
//! they are without sharing. The paper shares whole paths by pairs of points; here the visibilities between first and second
//! points serve both the weights and the light. Where the second point is glossy, they share what arrives there.

mod glossy;
mod plain;

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;

use crate::lanes::LANES;
use crate::material::Local;
use crate::path::{Limits, Next, Origin, Path, Unscattering};
use crate::sampler::{Sampler, hash};
use crate::scene::{Meeting, Scene};
use crate::travel::Ground;
use glossy::Glossy;

/// Pixels that share, at most.
pub(crate) const MEMBERS: usize = 64;
/// First points, those behind panes and mirrors among them, at most.
const MOST: usize = 96;
/// How often the lights are drawn at the first point of a pixel: their noise is its own.
const DRAWS: u32 = 4;
/// Surfaces with ideal directions after the eye at which all ways are followed, not one by chance.
const ALL_WAYS: u32 = 3;
/// Told from the seed of the pixels' own numbers: numbers even over all pixels, and those of lights.
const COMMON: u64 = 0x9e37_79b9_7f4a_7c15;
const LAMPS: u64 = 0xd1b5_4a32_d192_ed03;

/// Where a path from the eye is scattered first.
struct First<'a> {
    pixel: usize,
    met: Meeting,
    local: Local<'a>,
    /// What the path still carries.
    left: Vec3,
    bounces: u32,
    /// Reflectance over pi and the normal on the side of the eye, of a Lambertian surface whose directions are its own.
    plain: Option<(Vec3, Vec3)>,
}

/// Where the next direction ends on a Lambertian surface.
struct Second {
    /// The first point that found it, and how many bounces it had.
    by: usize,
    bounces: u32,
    point: Vec3,
    /// On the side that was met.
    normal: Vec3,
    radiance: Vec3,
}

/// Who gets what a path finds.
#[derive(Clone, Copy)]
enum Heir {
    Pixel(usize),
    Second(usize),
    Glossy(usize),
}

/// The paths of one sample of some pixels.
pub(crate) struct Table<'a> {
    scene: &'a Scene,
    limits: &'a Limits,
    seed: u64,
    places: &'a [usize],
    index: u32,
    /// Numbers even over all pixels.
    common: Vec<Sampler>,
    firsts: Vec<First<'a>>,
    seconds: Vec<Second>,
    glossy: Vec<Glossy>,
    /// Paths that no other pixel can take a share of, or whose end all do.
    tails: Vec<Path>,
    heirs: Vec<Heir>,
    out: [Vec3; MEMBERS],
}

impl<'a> Table<'a> {
    /// Sample `index` of some pixels.
    #[inline(always)]
    pub(crate) fn new(
        scene: &'a Scene,
        limits: &'a Limits,
        seed: u64,
        places: &'a [usize],
        index: u32,
    ) -> Self {
        let all = places.len().next_power_of_two() as u32;
        // Who gets which of the common numbers changes from sample to sample.
        let turn = hash(index ^ hash(places[0] as u32)) & (all - 1);
        let first = index.wrapping_mul(all);
        let common = (0..places.len() as u32)
            .map(|k| Sampler::new(seed ^ COMMON, places[0] as u32, first.wrapping_add(k ^ turn)))
            .collect();
        Table {
            scene,
            limits,
            seed,
            places,
            index,
            common,
            firsts: Vec::with_capacity(MOST),
            seconds: Vec::with_capacity(MOST),
            glossy: Vec::new(),
            tails: Vec::with_capacity(2 * MOST),
            heirs: Vec::with_capacity(2 * MOST),
            out: [Vec3::ZERO; MEMBERS],
        }
    }

    /// The ray of a pixel.
    #[inline(always)]
    pub(crate) fn look(&mut self, pixel: usize, origin: Vec3, direction: Vec3, sampler: Sampler) {
        self.approach(pixel, Path::new(origin, direction, sampler));
    }

    /// The samples of the pixels.
    #[inline(always)]
    pub(crate) fn finish(mut self) -> [Vec3; MEMBERS] {
        let direct = self.firsts.len();
        let mut n = 0;
        // Those behind panes and mirrors that second directions find follow after all others.
        while n < self.firsts.len() {
            self.light(n, if n < direct { DRAWS } else { 1 });
            self.go_on(n, n < direct);
            n += 1;
        }
        self.light_glossy();
        for (paths, heirs) in self.tails.chunks_mut(LANES).zip(self.heirs.chunks(LANES)) {
            self.scene.follow(paths, self.limits);
            for (path, heir) in paths.iter().zip(heirs) {
                match *heir {
                    Heir::Pixel(k) => self.out[k] += path.sum,
                    Heir::Second(k) => self.seconds[k].radiance = path.sum,
                    Heir::Glossy(k) => self.glossy[k].arrives = path.sum,
                }
            }
        }
        self.share();
        self.share_glossy();
        self.out
    }

    fn tail(&mut self, path: Path, heir: Heir) {
        self.tails.push(path);
        self.heirs.push(heir);
    }

    /// Follows a path to the first point that scatters.
    #[inline(always)]
    fn approach(&mut self, pixel: usize, mut path: Path) {
        let mut ways = 0;
        loop {
            let Some(met) = self.scene.meet(path.origin, path.direction, f32::INFINITY) else {
                self.out[pixel] += path.left * self.scene.at_infinity(path.direction, path.came);
                return;
            };
            self.out[pixel] += path.left * self.scene.emitted(&met, path.direction, path.came);
            let concealed = self.scene.parts.surfaces[met.surface as usize].concealed;
            if concealed && matches!(path.came, Origin::Drawn { .. }) && met.normal.dot(path.direction) < 0.0
            {
                return;
            }
            if path.bounces >= self.limits.bounces {
                return;
            }
            let local = self.scene.local(&met, -path.direction);
            let all = local.ideal();
            if all.iter().all(Option::is_none) {
                self.arrive(pixel, &path, met, local);
                return;
            }
            if ways == ALL_WAYS {
                match Unscattering::choose(all, &mut path.sampler) {
                    Unscattering::Taken { way, weight } => {
                        path.left *= weight;
                        path = self.along(&path, &met, way.direction, way.straight);
                        self.tail(path, Heir::Pixel(pixel));
                    }
                    Unscattering::Passed { weight } => {
                        path.left *= weight;
                        self.arrive(pixel, &path, met, local);
                    }
                }
                return;
            }
            ways += 1;
            // The brightest way is followed here, what is left of the rest as paths of this pixel alone.
            let main = all.iter().flatten().find(|way| way.share.max_element() > 0.5);
            for way in all.iter().flatten() {
                if main.is_none_or(|m| m.direction != way.direction) {
                    let mut path = self.along(&path, &met, way.direction, way.straight);
                    path.left *= way.share;
                    self.tail(path, Heir::Pixel(pixel));
                }
            }
            let Some(way) = main else {
                self.arrive(pixel, &path, met, local);
                return;
            };
            let mut rest = path;
            rest.sum = Vec3::ZERO;
            if self.scene.scatter(&mut rest, &met, &local, self.limits) {
                self.tail(rest, Heir::Pixel(pixel));
            } else {
                self.out[pixel] += rest.sum;
            }
            path.sampler = rest.sampler;
            path = self.along(&path, &met, way.direction, way.straight);
            path.left *= way.share;
        }
    }

    /// The path, gone on in an ideal direction.
    #[inline(always)]
    fn along(&self, path: &Path, met: &Meeting, direction: Vec3, straight: bool) -> Path {
        let mut next = Path {
            origin: self.scene.off(met, direction),
            direction,
            ..*path
        };
        if !straight {
            next.came = self.scene.mirrored(path.came, met.surface);
            next.bounces += 1;
        }
        next
    }

    fn arrive(&mut self, pixel: usize, path: &Path, met: Meeting, local: Local<'a>) {
        let plain = match local.lambertian() {
            Some(reflectance) if self.scene.parts.screens.is_empty() => {
                let side = 1.0_f32.copysign(-met.normal.dot(path.direction));
                Some((reflectance * FRAC_1_PI, met.normal * side))
            }
            _ => None,
        };
        self.firsts.push(First {
            pixel,
            met,
            local,
            left: path.left,
            bounces: path.bounces,
            plain,
        });
    }

    /// Light straight from the lights at a first point.
    #[inline(always)]
    fn light(&mut self, n: usize, draws: u32) {
        let first = &self.firsts[n];
        // Numbers of their own for the points behind panes.
        let seed = self.seed ^ LAMPS ^ u64::from(draws == DRAWS);
        let mut sum = Vec3::ZERO;
        for k in 0..draws {
            let index = self.index.wrapping_mul(draws).wrapping_add(k);
            let mut sampler = Sampler::new(seed, self.places[first.pixel] as u32, index);
            let places = self.scene.places(&mut sampler);
            let which = sampler.one();
            sum += self.scene.lit_by_lights(
                &first.met,
                &first.local,
                which,
                places,
                draws as f32,
                &Ground::OPEN,
            );
            if first.bounces + 1 < self.limits.bounces {
                sum += self
                    .scene
                    .lit_by_mirrors(&first.met, &first.local, which, places[1], draws as f32);
            }
        }
        self.out[first.pixel] += first.left * sum;
    }

    /// Goes on from a first point. `bend`: behind panes and mirrors there may be more first points.
    #[inline(always)]
    fn go_on(&mut self, n: usize, bend: bool) {
        let scene = self.scene;
        let first = &self.firsts[n];
        let pixel = first.pixel;
        let sampler = &mut self.common[pixel];
        let [u, v] = sampler.two();
        let choice = sampler.one();
        let Some(mut next) = scene.scattered(&first.met, &first.local, [u, v, choice]) else {
            return;
        };
        if bend && let Origin::Drawn { draws, .. } = &mut next.came {
            *draws = DRAWS as f32;
        }
        if scene.veiled(&first.met, &first.local) {
            self.out[pixel] -= first.left * scene.known_of(&first.met, &first.local, &next);
        }
        let Next {
            direction,
            weight,
            came,
        } = next;
        let mut path = Path {
            left: first.left * weight,
            bounces: first.bounces + 1,
            came,
            ..Path::new(scene.off(&first.met, direction), direction, *sampler)
        };
        let Some(met) = scene.meet(path.origin, direction, f32::INFINITY) else {
            self.out[pixel] += path.left * scene.at_infinity(direction, came);
            return;
        };
        let local = scene.local(&met, -direction);
        let bend = bend && self.firsts.len() + 2 < MOST && local.ideal().iter().any(Option::is_some);
        let concealed = scene.parts.surfaces[met.surface as usize].concealed;
        let plain = local.lambertian().is_some();
        let glossy = !plain && self.shares_glossy(&met, &local);
        if concealed || !(bend || plain || glossy) {
            self.tail(path, Heir::Pixel(pixel));
            return;
        }
        self.out[pixel] += path.left * scene.emitted(&met, direction, came);
        if path.bounces >= self.limits.bounces {
            return;
        }
        if bend {
            for way in local.ideal().iter().flatten() {
                let mut path = self.along(&path, &met, way.direction, way.straight);
                path.left *= way.share;
                self.approach(pixel, path);
            }
            if scene.scatter(&mut path, &met, &local, self.limits) {
                self.tail(path, Heir::Pixel(pixel));
            } else {
                self.out[pixel] += path.sum;
            }
            self.common[pixel] = path.sampler;
            return;
        }
        if glossy {
            self.glossy
                .push(Glossy::new(n, path.bounces, met, direction, path.sampler));
            return;
        }
        let mut second = Second {
            by: n,
            bounces: path.bounces,
            point: met.point,
            normal: met.normal * 1.0_f32.copysign(-met.normal.dot(direction)),
            radiance: Vec3::ZERO,
        };
        path.left = Vec3::ONE;
        if scene.scatter(&mut path, &met, &local, self.limits) {
            self.tail(path, Heir::Second(self.seconds.len()));
        } else {
            second.radiance = path.sum;
        }
        self.seconds.push(second);
    }
}
