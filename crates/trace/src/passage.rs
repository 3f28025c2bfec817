//! Rays through a device, such as a blind or a film, to where they leave it.

use glam::Vec3;

use crate::follow::{Around, Event, Step};
use crate::lanes::LANES;
use crate::path::{Limits, Origin, Path};
use crate::sampler::Sampler;
use crate::scene::{Meeting, Scene};

/// The box about a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Its lowest corner.
    pub low: Vec3,
    /// Its highest corner.
    pub high: Vec3,
    /// Whether the device repeats along x and y: a ray that leaves by one side of the box comes in by the other. Otherwise
    /// it is alone, and rays leave it on all sides.
    pub periodic: bool,
}

/// A ray that left the device, or a branch of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaving {
    /// The place of the ray among those that entered.
    pub ray: u32,
    /// A point of its way out.
    pub origin: Vec3,
    /// Unit.
    pub direction: Vec3,
    /// What is left of it, red, green and blue.
    pub weight: Vec3,
    /// Whether it came from a mirror or refraction, or straight through, and not from where light is scattered.
    pub ideal: bool,
    /// Whether it was scattered anywhere, as far as [`Scene::pass_heard`] listens.
    pub scattered: bool,
}

/// Where a ray through a device is scattered.
#[derive(Clone, Copy, Debug)]
pub struct Scattering {
    /// The place of the ray among those that entered.
    pub ray: u32,
    met: Meeting,
    /// Unit, where it came from.
    to_source: Vec3,
    weight: Vec3,
}

impl Scattering {
    /// Where it is.
    pub fn point(&self) -> Vec3 {
        self.met.point
    }

    /// Unit normal of the surface there, on the side that the light came to.
    pub fn normal(&self) -> Vec3 {
        let n = self.met.normal;
        if n.dot(self.to_source) < 0.0 { -n } else { n }
    }

    /// Unit, where the light came from.
    pub fn to_source(&self) -> Vec3 {
        self.to_source
    }

    /// What is left of the ray, red, green and blue.
    pub fn weight(&self) -> Vec3 {
        self.weight
    }

    /// The same with another weight.
    pub fn weighing(self, weight: Vec3) -> Self {
        Scattering { weight, ..self }
    }
}

/// A cell in which scatterings are heard of, and end what is only ideal.
struct Listening<'a, const IDEAL: bool>(&'a Cell);

impl<const IDEAL: bool> Around for Listening<'_, IDEAL> {
    const FORK: f32 = Cell::FORK;
    const HEARD: bool = true;
    const IDEAL_ONLY: bool = IDEAL;

    #[inline(always)]
    fn reach(&self, path: &Path) -> f32 {
        self.0.reach(path)
    }

    #[inline(always)]
    fn outside(&self, scene: &Scene, path: &mut Path) -> bool {
        self.0.outside(scene, path)
    }
}

/// Boxes that a ray may cross: one that goes on is as good as parallel to the device.
const MOST_CELLS: u32 = 20_000;

impl Around for Cell {
    const FORK: f32 = 0.06;

    #[inline(always)]
    fn reach(&self, path: &Path) -> f32 {
        if !self.periodic {
            return f32::INFINITY;
        }
        let [x, y, z] = self.ways(path);
        x.min(y).min(z)
    }

    #[inline(always)]
    fn outside(&self, _: &Scene, path: &mut Path) -> bool {
        let [x, y, z] = self.ways(path);
        if !self.periodic || z <= x.min(y) {
            path.escaped = true;
            return false;
        }
        let at = path.origin + x.min(y) * path.direction;
        let mut at = at.clamp(self.low, self.high);
        // Exactly on the other side.
        if x <= y {
            at.x = if path.direction.x > 0.0 {
                self.low.x
            } else {
                self.high.x
            };
        }
        if y <= x {
            at.y = if path.direction.y > 0.0 {
                self.low.y
            } else {
                self.high.y
            };
        }
        path.origin = at;
        path.cells += 1;
        path.cells < MOST_CELLS
    }
}

impl Cell {
    /// Ways along a ray to the sides of the box, one an axis.
    #[inline(always)]
    fn ways(&self, path: &Path) -> [f32; 3] {
        let (o, d) = (path.origin, path.direction);
        let way = |o: f32, d: f32, low: f32, high: f32| {
            let side = if d > 0.0 { high } else { low };
            if d == 0.0 {
                f32::INFINITY
            } else {
                ((side - o) / d).max(0.0)
            }
        };
        [
            way(o.x, d.x, self.low.x, self.high.x),
            way(o.y, d.y, self.low.y, self.high.y),
            way(o.z, d.z, self.low.z, self.high.z),
        ]
    }
}

/// A ray to be followed through a device.
#[derive(Clone, Debug)]
pub struct Entering {
    /// Where it begins: on the box or before it.
    pub origin: Vec3,
    /// Unit.
    pub direction: Vec3,
    /// Numbers for its way.
    pub sampler: Sampler,
}

/// A ray and which of those that entered it comes from.
#[derive(Clone, Copy)]
struct Branch {
    path: Path,
    root: u32,
    scattered: bool,
}

/// Rays through a device: to be begun, and on their way.
struct Traffic<'a> {
    rays: &'a [Entering],
    begun: usize,
    /// Branches that wait.
    waiting: Vec<Branch>,
}

impl Traffic<'_> {
    /// What comes next.
    #[inline(always)]
    fn next(&mut self) -> Option<Branch> {
        self.waiting.pop().or_else(|| {
            let ray = self.rays.get(self.begun)?;
            let root = self.begun as u32;
            self.begun += 1;
            let path = Path::new(ray.origin, ray.direction, ray.sampler);
            Some(Branch {
                path,
                root,
                scattered: false,
            })
        })
    }
}

impl Scene {
    /// Follows rays through the device that the scene is to where they leave its box, and adds what left to `out`: of each
    /// ray as many branches as it became, none where it is absorbed, in no particular order.
    pub fn pass(&self, cell: &Cell, rays: &[Entering], limits: &Limits, out: &mut Vec<Leaving>) {
        self.pass_here(cell, rays, limits, out, &mut |_| ());
    }

    /// The same, and tells where the rays are scattered.
    pub fn pass_heard(
        &self,
        cell: &Cell,
        rays: &[Entering],
        limits: &Limits,
        out: &mut Vec<Leaving>,
        scatters: &mut impl FnMut(Scattering),
    ) {
        self.pass_here(&Listening::<false>(cell), rays, limits, out, scatters);
    }

    /// [`Scene::pass`] of what is mirrored, refracted or goes straight, to where it is scattered.
    pub fn pass_ideal(&self, cell: &Cell, rays: &[Entering], limits: &Limits, out: &mut Vec<Leaving>) {
        self.pass_here(&Listening::<true>(cell), rays, limits, out, &mut |_| ());
    }

    /// In the instructions that the processor has.
    fn pass_here<A: Around>(
        &self,
        around: &A,
        rays: &[Entering],
        limits: &Limits,
        out: &mut Vec<Leaving>,
        scatters: &mut impl FnMut(Scattering),
    ) {
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "avx2,fma,bmi2")]
            fn wide<A: Around>(
                scene: &Scene,
                around: &A,
                rays: &[Entering],
                limits: &Limits,
                out: &mut Vec<Leaving>,
                scatters: &mut impl FnMut(Scattering),
            ) {
                scene.pass_any(around, rays, limits, out, scatters);
            }
            if is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("fma")
                && is_x86_feature_detected!("bmi2")
            {
                // SAFETY: the processor has the instructions.
                return unsafe { wide(self, around, rays, limits, out, scatters) };
            }
        }
        self.pass_any(around, rays, limits, out, scatters);
    }

    #[inline(always)]
    fn pass_any<A: Around>(
        &self,
        around: &A,
        rays: &[Entering],
        limits: &Limits,
        out: &mut Vec<Leaving>,
        scatters: &mut impl FnMut(Scattering),
    ) {
        let mut traffic = Traffic {
            rays,
            begun: 0,
            waiting: Vec::new(),
        };
        let mut paths = [Path::dark(Sampler::new(0, 0, 0)); LANES];
        let mut roots = [0_u32; LANES];
        let mut scattered = [false; LANES];
        let mut live = [0_u8; LANES];
        let mut free: [u8; LANES] = std::array::from_fn(|k| k as u8);
        let (mut count, mut spare) = (0, LANES);
        let mut work = Step::default();
        loop {
            while spare > 0
                && let Some(branch) = traffic.next()
            {
                spare -= 1;
                let k = free[spare];
                paths[k as usize] = branch.path;
                roots[k as usize] = branch.root;
                scattered[k as usize] = branch.scattered;
                live[count] = k;
                count += 1;
            }
            if count == 0 {
                return;
            }
            let mut on = [0_u8; LANES];
            let mut going = 0;
            self.step(
                around,
                &mut paths,
                &live[..count],
                limits,
                &mut work,
                |k, event| match event {
                    Event::Goes => {
                        on[going] = k;
                        going += 1;
                    }
                    Event::Forks(path) => traffic.waiting.push(Branch {
                        path,
                        root: roots[k as usize],
                        scattered: scattered[k as usize],
                    }),
                    Event::Scatters(path, met) => {
                        scattered[k as usize] = true;
                        scatters(Scattering {
                            ray: roots[k as usize],
                            met: *met,
                            to_source: -path.direction,
                            weight: path.left,
                        });
                    }
                },
            );
            let mut stays = [false; LANES];
            on[..going].iter().for_each(|k| stays[*k as usize] = true);
            for &k in live[..count].iter().filter(|k| !stays[**k as usize]) {
                let path = &paths[k as usize];
                if path.escaped {
                    out.push(Leaving {
                        ray: roots[k as usize],
                        origin: path.origin,
                        direction: path.direction,
                        weight: path.left,
                        ideal: matches!(path.came, Origin::Alone),
                        scattered: scattered[k as usize],
                    });
                }
                free[spare] = k;
                spare += 1;
            }
            live = on;
            count = going;
        }
    }

    /// Light that goes from a scattering in a direction (unit) and leaves the device without being bent, per unit solid
    /// angle and light of the ray that entered, 1/sr in red, green and blue.
    pub fn scattered_to(&self, cell: &Cell, scattering: &Scattering, direction: Vec3) -> Vec3 {
        let met = &scattering.met;
        let f = self.local(met, scattering.to_source).eval(direction).0;
        if f == Vec3::ZERO {
            return f;
        }
        let mut way = Path::new(self.off(met, direction), direction, Sampler::new(0, 0, 0));
        loop {
            let Some(passage) = self.passes(way.origin, direction, cell.reach(&way), false) else {
                return Vec3::ZERO;
            };
            way.left *= passage.left;
            if !cell.outside(self, &mut way) {
                break;
            }
        }
        match way.escaped {
            true => scattering.weight * f * way.left,
            false => Vec3::ZERO,
        }
    }
}
