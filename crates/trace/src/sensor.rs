//! Irradiance at points.

use std::sync::atomic::AtomicBool;

use glam::Vec3;

use crate::accumulate::{Draw, Effort, Pixel, Report, Round, accumulate};
use crate::material::{Local, Material};
use crate::path::{Limits, Path};
use crate::sampler::Sampler;
use crate::scene::{Meeting, Scene};

/// A point that looks along a normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Where.
    pub point: Vec3,
    /// Unit normal: light from its side counts.
    pub normal: Vec3,
}

impl Sensor {
    /// `None` for coordinates that are not finite and a normal of no length.
    pub fn new(point: Vec3, normal: Vec3) -> Option<Self> {
        let normal = normal.try_normalize()?;
        point.is_finite().then_some(Sensor { point, normal })
    }
}

impl Scene {
    /// Irradiance of a sensor, W/m2 in red, green and blue: one sample. A white Lambertian reflector in its place has the
    /// radiance `E / pi`; the lights are drawn as from any other surface, the paths begin with a cosine-weighted direction
    /// or go to the portals. The sensor counts as the first surface of the paths: with one bounce only light straight from
    /// the sources counts, with `n + 1` what RADIANCE's `rtrace -I -ab n` follows.
    pub fn irradiance(&self, sensor: &Sensor, limits: &Limits, sampler: &mut Sampler) -> Vec3 {
        let mut path = [self.leave_sensor(sensor, limits, *sampler)];
        self.follow(&mut path, limits);
        *sampler = path[0].sampler;
        path[0].sum
    }

    #[inline(always)]
    fn leave_sensor(&self, sensor: &Sensor, limits: &Limits, sampler: Sampler) -> Path {
        let white = Material::Diffuse {
            reflectance: Vec3::splat(std::f32::consts::PI),
        };
        let met = Meeting {
            distance: 0.0,
            point: sensor.point,
            normal: sensor.normal,
            smooth: sensor.normal,
            surface: u32::MAX,
        };
        let mut path = Path::new(sensor.point, -sensor.normal, sampler);
        let local = Local::new(&white, sensor.normal, sensor.normal);
        if limits.bounces == 0 || !self.scatter(&mut path, &met, &local, limits) {
            path.left = Vec3::ZERO;
        }
        path
    }
}

/// What sensors read.
#[derive(Clone, Debug, PartialEq)]
pub struct Readings {
    /// The sensors.
    pub sensors: Vec<Sensor>,
    /// Their samples, in the same order.
    pub pixels: Vec<Pixel>,
    /// Where the samples stand.
    pub round: Round,
}

/// Sensors that one thread takes at a time.
const GROUP: usize = 4;

impl Readings {
    /// Sensors without samples.
    pub fn new(sensors: Vec<Sensor>) -> Self {
        let pixels = vec![Pixel::default(); sensors.len()];
        Readings {
            sensors,
            pixels,
            round: Round::default(),
        }
    }

    /// Adds samples until the effort is reached, as [`crate::render::Picture::render`] does.
    pub fn measure(
        &mut self,
        scene: &Scene,
        effort: &Effort,
        stop: &AtomicBool,
        report: &(dyn Fn(Report) + Sync),
    ) {
        let places: Vec<usize> = (0..self.sensors.len()).collect();
        let groups: Vec<Vec<usize>> = places.chunks(GROUP).map(<[usize]>::to_vec).collect();
        let field = Field {
            scene,
            sensors: &self.sensors,
            limits: effort.limits,
        };
        accumulate(
            &mut self.pixels,
            &mut self.round,
            &groups,
            &field,
            effort,
            stop,
            report,
        );
    }
}

struct Field<'a> {
    scene: &'a Scene,
    sensors: &'a [Sensor],
    limits: Limits,
}

impl Draw for Field<'_> {
    #[inline(always)]
    fn start(&self, place: usize, sampler: Sampler) -> Path {
        self.scene
            .leave_sensor(&self.sensors[place], &self.limits, sampler)
    }

    fn scene(&self) -> (&Scene, &Limits) {
        (self.scene, &self.limits)
    }

    fn shared(&self, _places: &[usize], _seed: u64, _first: u32, _sums: &mut [[f64; 3]]) -> bool {
        false
    }
}
