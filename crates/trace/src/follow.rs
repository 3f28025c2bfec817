//! Paths followed side by side, as many as a batch has samples.

use crate::camera::Camera;
use crate::lanes::{Hits, LANES, Rays};
use crate::path::{Arrival, Limits, Origin, Path};
use crate::reflect::Reflectors;
use crate::scene::{Found, Meeting, Scene};

/// What lies around the surfaces.
pub(crate) trait Around {
    /// Paths are followed both ways, mirrored and transmitted, as long as each carries so much.
    const FORK: f32 = f32::INFINITY;
    /// Whether somebody wants to hear where paths are scattered.
    const HEARD: bool = false;
    /// Whether paths end where they are scattered.
    const IDEAL_ONLY: bool = false;

    /// How far a ray goes before it is outside.
    fn reach(&self, path: &Path) -> f32;

    /// A ray is outside. Whether it goes on, from where it is now.
    fn outside(&self, scene: &Scene, path: &mut Path) -> bool;
}

/// The sky, and what else is at infinity.
pub(crate) struct Infinity;

impl Around for Infinity {
    #[inline(always)]
    fn reach(&self, _: &Path) -> f32 {
        f32::INFINITY
    }

    #[inline(always)]
    fn outside(&self, scene: &Scene, path: &mut Path) -> bool {
        path.sum += path.left * scene.at_infinity(path.direction, path.came);
        false
    }
}

/// The same beyond what the aft clipping plane of a view leaves: what the eye sees, through panes as well, ends there; what is
/// mirrored or scattered does not, as in RADIANCE.
pub(crate) struct Clipped<'a>(pub(crate) &'a Camera);

impl Clipped<'_> {
    fn ends(path: &Path) -> bool {
        path.bounces == 0 && matches!(path.came, Origin::Alone)
    }
}

impl Around for Clipped<'_> {
    fn reach(&self, path: &Path) -> f32 {
        match Clipped::ends(path) {
            true => self.0.remaining(path.origin, path.direction),
            false => f32::INFINITY,
        }
    }

    fn outside(&self, scene: &Scene, path: &mut Path) -> bool {
        !Clipped::ends(path) && Infinity.outside(scene, path)
    }
}

/// What a path does in a step.
pub(crate) enum Event<'a> {
    /// It goes on.
    Goes,
    /// Another branches off.
    Forks(Path),
    /// It arrives where it is scattered, if [`Around::HEARD`].
    Scatters(&'a Path, &'a Meeting),
}

/// Room for what a step computes.
#[derive(Default)]
pub(crate) struct Step {
    rays: Rays,
    hits: Hits,
    reflectors: Reflectors,
}

impl Scene {
    /// Follows paths, [`LANES`] at most, to their ends: each of them finds what it would find alone.
    #[inline(always)]
    pub(crate) fn follow(&self, paths: &mut [Path], limits: &Limits) {
        self.follow_in(&Infinity, paths, limits);
    }

    /// [`Scene::follow`] of a view with an aft clipping plane.
    #[inline(never)]
    pub(crate) fn follow_clipped(&self, camera: &Camera, paths: &mut [Path], limits: &Limits) {
        self.follow_in(&Clipped(camera), paths, limits);
    }

    /// Follows paths within something.
    #[inline(always)]
    pub(crate) fn follow_in(&self, around: &impl Around, paths: &mut [Path], limits: &Limits) {
        let mut live = [0_u8; LANES];
        let mut count = 0;
        for (k, path) in paths.iter().enumerate().take(LANES) {
            if path.left.max_element() > 0.0 {
                live[count] = k as u8;
                count += 1;
            }
        }
        let mut work = Step::default();
        while count > 0 {
            let mut on = [0_u8; LANES];
            let mut going = 0;
            self.step(around, paths, &live[..count], limits, &mut work, |k, _| {
                on[going] = k;
                going += 1;
            });
            live = on;
            count = going;
        }
    }

    /// Takes paths to what they meet next, and tells what they do there.
    #[inline(always)]
    pub(crate) fn step<A: Around>(
        &self,
        around: &A,
        paths: &mut [Path],
        live: &[u8],
        limits: &Limits,
        work: &mut Step,
        mut tell: impl FnMut(u8, Event<'_>),
    ) {
        let Step {
            rays,
            hits,
            reflectors,
        } = work;
        self.meet_all(around, paths, live, rays, hits);
        reflectors.clear();
        for (slot, &k) in live.iter().enumerate() {
            let path = &mut paths[k as usize];
            let Some(met) = hits.meeting(slot, self) else {
                if around.outside(self, path) {
                    tell(k, Event::Goes);
                }
                continue;
            };
            let arrival = self.arrive(path, &met, limits, A::FORK, |branch| {
                tell(k, Event::Forks(branch))
            });
            if A::HEARD && matches!(arrival, Arrival::Plain(_) | Arrival::Scattered(_)) {
                tell(k, Event::Scatters(path, &met));
            }
            let goes = match arrival {
                Arrival::Ended => false,
                Arrival::Plain(_) | Arrival::Scattered(_) if A::IDEAL_ONLY => false,
                Arrival::Passed => true,
                Arrival::Plain(reflectance) => {
                    reflectors.add(k, slot, reflectance);
                    false
                }
                Arrival::Scattered(local) => self.scatter(path, &met, &local, limits),
            };
            if goes {
                tell(k, Event::Goes);
            }
        }
        if self.flat_lights_only {
            self.reflect(paths, hits, reflectors, rays, limits, |k| tell(k, Event::Goes));
        } else {
            for (k, slot) in reflectors.all() {
                let path = &mut paths[k as usize];
                if hits.meeting(slot, self).is_some_and(|met| {
                    let local = self.local(&met, -path.direction);
                    self.scatter(path, &met, &local, limits)
                }) {
                    tell(k, Event::Goes);
                }
            }
        }
    }

    /// What the paths meet.
    #[inline(always)]
    fn meet_all(&self, around: &impl Around, paths: &[Path], live: &[u8], rays: &mut Rays, hits: &mut Hits) {
        for (slot, &k) in live.iter().enumerate() {
            let path = &paths[k as usize];
            rays.set(slot, path.origin, path.direction, around.reach(path));
        }
        self.find_all(rays, live.len(), |slot, found| match found {
            Found::Nothing => hits.nothing(slot),
            Found::Curved(met) => hits.curved(slot, &met),
            Found::Flat(distance, triangle) => {
                let (corners, surface) = self.triangle(triangle);
                hits.flat(slot, triangle, corners, distance, surface);
            }
        });
        hits.compute(rays, live.len());
    }
}
