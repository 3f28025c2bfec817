//! The walk through a sphere against the path tracer of scenes.
//!
//! The tracer follows rays against the light: the detector is an even lamp of radiance 1, and what a ray of the beam sees is the
//! share of its light that reaches the detector.
#![allow(clippy::unwrap_used, missing_docs)]

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

use glam::Vec3;
use gonio_bsdf::analytic::{Sum, family};
use gonio_bsdf::{Bsdf, Channel};
use gonio_instrument::sphere::{
    Arrangement, Baffle, Detector, Effort, Filling, Place, Plan, Port, PortName, Source, Sphere, State, Trap,
    read,
};
use gonio_trace::light::{Flat, Light};
use gonio_trace::material::Material;
use gonio_trace::path::Limits;
use gonio_trace::pattern::Cone;
use gonio_trace::sampler::Sampler;
use gonio_trace::scene::{Parts, Scene, Surface};
use gonio_trace::shape::Shape;

/// Corners of the polygon that stands for the detector; it has the disk's area.
const CORNERS: u32 = 48;
const RUNS: u32 = 32;
const RAYS: u32 = 512;

fn place(theta: f64, phi: f64, diameter: f64) -> Place {
    Place {
        theta: theta.to_radians(),
        phi: phi.to_radians(),
        radius: 0.5e-3 * diameter,
    }
}

/// Wide ports, a dark wall and a detector that sees a part: everything shows in few bounces.
fn sphere(view: f64) -> Sphere {
    Sphere::new(Plan {
        arrangement: Arrangement::Reflection,
        radius: 0.1,
        wall: 0.8,
        standard: 0.9,
        plug: 0.7,
        theta_i: f64::to_radians(15.0),
        phi_i: 0.0,
        beam_radius: 0.005,
        divergence: 0.0,
        sample_radius: 0.02,
        entrance_radius: 0.015,
        trap: Some(Trap {
            radius: 0.02,
            residual: 0.02,
        }),
        detector: Detector {
            place: place(80.0, 90.0, 40.0),
            reflectance: 0.3,
            view,
        },
        comparison: Some(place(100.0, 270.0, 40.0)),
        auxiliary: None,
        baffles: vec![Baffle {
            between: [PortName::Sample, PortName::Detector],
            at: 0.6,
            radius: 0.02,
            reflectance: 0.5,
        }],
    })
    .unwrap()
}

struct Builder(Parts);

impl Builder {
    fn surface(&mut self, material: Material) -> u32 {
        self.0.surfaces.push(Surface {
            material: self.0.materials.len() as u32,
            ..Surface::default()
        });
        self.0.materials.push(material);
        self.0.surfaces.len() as u32 - 1
    }

    fn grey(&mut self, reflectance: f64) -> u32 {
        let reflectance = Vec3::splat(reflectance as f32);
        self.surface(Material::Diffuse { reflectance })
    }

    fn ring(&mut self, middle: glam::DVec3, normal: glam::DVec3, radius: f64, surface: u32) {
        let ring = Shape::Ring {
            centre: middle.as_vec3(),
            normal: normal.as_vec3(),
            radii: [0.0, radius as f32],
        };
        self.0.shapes.push((ring, surface));
    }

    fn lid(&mut self, port: &Port, surface: u32) {
        self.ring(port.middle(), -port.axis, port.rim(), surface);
    }

    fn detector(&mut self, port: &Port, detector: &Detector) {
        let surface = self.grey(detector.reflectance);
        let (x, y) = port.axis.any_orthonormal_pair();
        let n = f64::from(CORNERS);
        let radius = port.rim() * (TAU / (n * (TAU / n).sin())).sqrt();
        let corner = |k: u32| {
            let angle = -TAU * f64::from(k % CORNERS) / n;
            (port.middle() + radius * (angle.cos() * x + angle.sin() * y)).as_vec3()
        };
        let first = self.0.vertices.len() as u32;
        let middle = port.middle().as_vec3();
        self.0.vertices.push(middle.to_array());
        self.0.vertices.extend((0..CORNERS).map(|k| corner(k).to_array()));
        let mut triangles = Vec::new();
        for k in 0..CORNERS {
            self.0
                .triangles
                .push([first, first + 1 + k, first + 1 + (k + 1) % CORNERS]);
            self.0.triangle_surface.push(surface);
            triangles.push([middle, corner(k), corner(k + 1)]);
        }
        self.0.surfaces[surface as usize].light = Some(0);
        self.0
            .lights
            .push(Light::Flat(Flat::new(&triangles, Vec3::ONE).unwrap()));
        self.0.light_patterns.push((detector.view < FRAC_PI_2).then(|| {
            let axis = -port.axis.as_vec3();
            let cos = detector.view.cos() as f32;
            Arc::new(Cone { axis, cos }) as Arc<_>
        }));
    }
}

fn scene(sphere: &Sphere, sample: &Arc<dyn Bsdf>, trap_open: bool) -> Scene {
    let mut b = Builder(Parts::default());
    let wall = b.grey(sphere.plan.wall);
    let hollow = Shape::Sphere {
        centre: Vec3::ZERO,
        radius: 1.0,
        inward: true,
    };
    b.0.shapes.push((hollow, wall));
    for port in &sphere.ports {
        let lid = match port.name {
            PortName::Sample => b.surface(Material::model(sample.clone(), None)),
            PortName::Comparison => b.grey(sphere.plan.standard),
            PortName::Trap if trap_open => b.grey(sphere.plan.trap.unwrap().residual),
            PortName::Trap => b.grey(sphere.plan.plug),
            PortName::Detector => {
                b.detector(port, &sphere.plan.detector);
                continue;
            }
            _ => b.surface(Material::Black),
        };
        b.lid(port, lid);
    }
    for screen in &sphere.screens {
        let white = b.grey(screen.reflectance);
        b.ring(screen.middle, screen.normal, screen.radius, white);
    }
    Scene::new(b.0).unwrap()
}

fn traced(sphere: &Sphere, scene: &Scene) -> (f64, f64) {
    let limits = Limits {
        bounces: 200,
        roulette: 10,
    };
    let (sin, cos) = sphere.plan.theta_i.sin_cos();
    let towards = Vec3::new(sin as f32, 0.0, cos as f32);
    let middle = sphere.port(PortName::Sample).unwrap().middle().as_vec3();
    let spot = (sphere.plan.beam_radius / sphere.plan.radius) as f32;
    let runs: Vec<f64> = (0..RUNS)
        .map(|run| {
            let each = (0..RAYS).map(|ray| {
                let mut sampler = Sampler::new(9, run, ray);
                let [u, v] = sampler.two();
                let (r, angle) = (spot * u.sqrt(), std::f32::consts::TAU * v);
                let at = middle + r * Vec3::new(angle.cos() / cos as f32, angle.sin(), 0.0);
                f64::from(
                    scene
                        .radiance(at + 0.5 * towards, -towards, &limits, &mut sampler)
                        .x,
                )
            });
            each.sum::<f64>() / f64::from(RAYS)
        })
        .collect();
    let n = f64::from(RUNS);
    let mean = runs.iter().sum::<f64>() / n;
    let square: f64 = runs.iter().map(|x| (x - mean).powi(2)).sum();
    (mean, (square / (n * (n - 1.0))).sqrt())
}

#[test]
fn light_walks_as_the_path_tracer_says() {
    let parts = [("lambert", vec![0.4]), ("ward-gmd", vec![0.3, 0.15])].map(|(name, values)| {
        family(name)
            .unwrap()
            .model(&[(Channel::Photopic, values)])
            .unwrap()
    });
    let sample: Arc<dyn Bsdf> = Arc::new(Sum::new(parts.into()).unwrap());
    for (view, trap_open) in [(FRAC_PI_2, false), (FRAC_PI_2, true), (0.8, false)] {
        let sphere = sphere(view);
        let state = State {
            sample: Filling::Model {
                model: sample.clone(),
                channel: 0,
            },
            comparison: Filling::Lambert(sphere.plan.standard),
            trap_open,
        };
        let effort = Effort {
            rays: 1 << 15,
            seed: 2,
        };
        let walked = read(
            &sphere,
            &[(state, Source::Beam)],
            &effort,
            &Default::default(),
            &|_| {},
        );
        let walked = walked.unwrap().unwrap();
        let (value, error) = traced(&sphere, &scene(&sphere, &sample, trap_open));
        let off = (walked[0].value() - value).abs();
        let u = error.hypot(walked[0].error());
        assert!(u < 0.015 * value, "{u} {value}");
        assert!(
            off < 4.0 * u,
            "{view} {trap_open}: {} ± {u}, {value}",
            walked[0].value()
        );
    }
}
