//! The noise-free signal: the model averaged over beam, spot and aperture.

use std::f64::consts::TAU;

use gonio_bsdf::Bsdf;
use gonio_geom::{Component, DVec3, Direction};

use crate::{Beam, Detector};

/// Nodes in the average over beam, spot and aperture (six dimensions), each taken in four quarter turns.
const NODES: usize = 16;
/// Nodes of the average of the bare beam over the aperture (two dimensions).
const APERTURE_NODES: usize = 256;

/// Node `k` of the additive recurrence in `D` dimensions whose steps are powers of the generalised golden ratio
/// [Roberts2018]; every coordinate in `[0, 1)`.
fn node<const D: usize>(k: usize) -> [f64; D] {
    // The ratio is the root of x^(D+1) = x + 1 above 1.
    let mut ratio = 1.5_f64;
    for _ in 0..60 {
        ratio = (1.0 + ratio).powf(1.0 / (D as f64 + 1.0));
    }
    std::array::from_fn(|d| (0.5 + (k as f64 + 1.0) * ratio.powi(-(d as i32 + 1))).fract())
}

/// A point of the unit disk, even in area.
fn on_disk(u: f64, v: f64) -> (f64, f64) {
    let (s, c) = (TAU * v).sin_cos();
    (u.sqrt() * c, u.sqrt() * s)
}

/// One way from the source over a point of the spot.
struct Ray {
    /// Point of the sample that is lit, metres.
    x: DVec3,
    /// Direction towards the source there.
    wi: Direction,
    /// Point of the aperture in units of its radius.
    aperture: (f64, f64),
}

/// Everything about one incidence that does not depend on the reading.
pub(crate) struct SampleSignal<'a> {
    model: &'a dyn Bsdf,
    rays: Vec<Ray>,
    distance: f64,
    aperture_radius: f64,
    power: f64,
    unscattered: Vec<Unscattered>,
}

/// What an ideal part leaves of the beam: its image, mirrored or straight through, since the focus is on the detector
/// sphere.
struct Unscattered {
    image: BeamSignal,
    /// Share of the beam, one a channel.
    shares: Vec<f64>,
}

impl Unscattered {
    fn of(model: &dyn Bsdf, beam: &Beam, detector: &Detector, wi: Direction) -> Vec<Self> {
        let one = |component| {
            let mut shares = vec![0.0; model.channels().len()];
            let to = model.delta(wi, component, &mut shares)?;
            Some(Unscattered {
                image: BeamSignal::new(beam, detector, to),
                shares,
            })
        };
        [Component::Reflection, Component::Transmission]
            .into_iter()
            .filter_map(one)
            .collect()
    }
}

impl<'a> SampleSignal<'a> {
    pub(crate) fn new(model: &'a dyn Bsdf, beam: &Beam, detector: &Detector, wi: Direction) -> Self {
        let through = wi.through().vec();
        let (a, b) = through.any_orthonormal_pair();
        let spot = 0.5 * beam.spot_diameter;
        let mut rays = Vec::with_capacity(4 * NODES);
        for k in 0..NODES {
            let u = node::<6>(k);
            let (sx, sy) = on_disk(u[0], u[1]);
            let chord = beam.profile.chord_of_share(u[2]);
            let (bs, bc) = (TAU * u[3]).sin_cos();
            let (dx, dy) = on_disk(u[4], u[5]);
            // Quarter turns of each node: gradients of the model cancel exactly and curvatures weigh alike in all
            // azimuths, as they do in the average itself.
            for (c, s) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
                let turn = |x: f64, y: f64| (c * x - s * y, s * x + c * y);
                // The beam's cross-section, carried along the beam into the sample plane.
                let (sx, sy) = turn(sx, sy);
                let cross = spot * (sx * a + sy * b);
                let x = cross - through * (cross.z / through.z);
                // All rays through this point of the beam's image on the detector sphere, reached from x.
                let sin = chord * (1.0 - 0.25 * chord * chord).sqrt();
                let (bx, by) = turn(bc, bs);
                let aim = (1.0 - 0.5 * chord * chord) * through + sin * (bx * a + by * b);
                let ray = detector.distance * aim - x;
                rays.extend(Direction::new(-ray).map(|wi| Ray {
                    x,
                    wi,
                    aperture: turn(dx, dy),
                }));
            }
        }
        SampleSignal {
            model,
            rays,
            distance: detector.distance,
            aperture_radius: detector.distance * detector.aperture.tan(),
            power: beam.power,
            unscattered: Unscattered::of(model, beam, detector, wi),
        }
    }

    /// The signal of each channel at receiver direction `ws` [source chapter, eqs 6.2 and 6.4, averaged]:
    /// `P mean(f(wi', ws') |cos theta_s'| r^2 cos psi / d^2)` over rays, `d` from lit point to aperture point and
    /// `psi` the angle at the aperture; on top of it the image of the beam that an ideal part leaves, in the share of the
    /// beam's axis. `scratch` and `out` have one entry a channel.
    pub(crate) fn at(&self, ws: Direction, scratch: &mut [f64], out: &mut [f64]) {
        let (a, b) = ws.vec().any_orthonormal_pair();
        let centre = self.distance * ws.vec();
        out.fill(0.0);
        for ray in &self.rays {
            let (u, v) = ray.aperture;
            let way = centre + self.aperture_radius * (u * a + v * b) - ray.x;
            let d2 = way.length_squared();
            let d = d2.sqrt();
            let to = Direction::from_unit(way / d);
            self.model.eval(ray.wi, to, scratch);
            let geometry = to.cos_theta().abs() * self.distance * self.distance / d2 * to.dot(ws);
            out.iter_mut()
                .zip(scratch.iter())
                .for_each(|(o, f)| *o += f * geometry);
        }
        let scale = self.power / self.rays.len() as f64;
        out.iter_mut().for_each(|o| *o *= scale);
        for part in &self.unscattered {
            let image = part.image.at(ws);
            out.iter_mut()
                .zip(&part.shares)
                .for_each(|(o, share)| *o += share * image);
        }
    }
}

/// The beam on the detector sphere, averaged over the aperture.
pub(crate) struct BeamSignal {
    beam: Beam,
    centre: DVec3,
    aperture: f64,
    /// Chord from the centre beyond which there is no signal.
    reach: f64,
    nodes: Vec<(f64, f64)>,
}

impl BeamSignal {
    /// The beam that arrives in direction `to`, seen from the sample.
    pub(crate) fn new(beam: &Beam, detector: &Detector, to: Direction) -> Self {
        BeamSignal {
            beam: *beam,
            centre: to.vec(),
            aperture: detector.aperture.tan(),
            reach: beam.profile.reach() + detector.aperture.tan(),
            nodes: (0..APERTURE_NODES)
                .map(|k| {
                    let u = node::<2>(k);
                    on_disk(u[0], u[1])
                })
                .collect(),
        }
    }

    /// The signal at receiver direction `ws`; its integral over the sphere is the beam power.
    pub(crate) fn at(&self, ws: Direction) -> f64 {
        if (ws.vec() - self.centre).length() > self.reach {
            return 0.0;
        }
        let (a, b) = ws.vec().any_orthonormal_pair();
        let sum: f64 = self
            .nodes
            .iter()
            .map(|&(u, v)| {
                let point = (ws.vec() + self.aperture * (u * a + v * b)).normalize();
                self.beam.profile.density((point - self.centre).length())
            })
            .sum();
        self.beam.power * sum / self.nodes.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BeamProfile;
    use gonio_bsdf::analytic::{Lambert, Spectrum, WardGmd};

    fn signal_at(model: &dyn Bsdf, beam: &Beam, detector: &Detector, wi: Direction, ws: Direction) -> f64 {
        let (mut scratch, mut out) = ([0.0], [0.0]);
        SampleSignal::new(model, beam, detector, wi).at(ws, &mut scratch, &mut out);
        out[0]
    }

    #[test]
    fn a_lambertian_spot_is_biased_by_no_more_than_its_size_over_the_distance_squared() {
        let model = Lambert::reflection(&Spectrum::photopic("rho", 0.8).unwrap()).unwrap();
        let (mut beam, detector) = (Beam::default(), Detector::default());
        beam.spot_diameter = 0.05;
        for deg in [0.0, 40.0, 80.0] {
            let ws = Direction::from_degrees(deg, 70.0);
            let got = signal_at(&model, &beam, &detector, Direction::NORMAL, ws);
            let dsf = beam.power * 0.8 / std::f64::consts::PI * ws.cos_theta();
            // (a/r)^2 = 6.0e-4; the factor in front stays below 2 for all polar angles.
            assert!((got / dsf - 1.0).abs() < 1.2e-3, "{deg} deg: {}", got / dsf);
        }
    }

    #[test]
    fn a_small_aperture_and_beam_leave_the_model_as_it_is() {
        let model = WardGmd::isotropic(&Spectrum::photopic("rho", 0.5).unwrap(), 0.15).unwrap();
        let beam = Beam {
            spot_diameter: 0.0,
            profile: BeamProfile::TopHat { radius: 1e-4 },
            ..Beam::default()
        };
        let detector = Detector {
            aperture: 1e-5,
            ..Detector::default()
        };
        let wi = Direction::from_degrees(45.0, 10.0);
        for (theta, phi) in [(45.0, 190.0), (30.0, 180.0), (70.0, 200.0)] {
            let ws = Direction::from_degrees(theta, phi);
            let got = signal_at(&model, &beam, &detector, wi, ws);
            let dsf = beam.power * model.eval_first(wi, ws) * ws.cos_theta();
            assert!((got / dsf - 1.0).abs() < 1e-5, "{}", got / dsf);
        }
    }

    #[test]
    fn the_peak_of_a_lobe_falls_by_the_variance_of_the_signature() {
        // A lobe exp(-g^2/w^2), w = 2 alpha, under a kernel of variance s^2 an axis: peak down by 2 s^2/w^2 at normal
        // incidence. Gaussian beam: w_b^2/2 an axis; disk aperture: a^2/4 an axis.
        let alpha = 0.05;
        let model = WardGmd::isotropic(&Spectrum::photopic("rho", 0.5).unwrap(), alpha).unwrap();
        let (w_b, a) = (0.01, 0.012);
        let beam = Beam {
            spot_diameter: 0.0,
            profile: BeamProfile::Gaussian { half_width: w_b },
            ..Beam::default()
        };
        let detector = Detector {
            aperture: a,
            ..Detector::default()
        };
        let got = signal_at(&model, &beam, &detector, Direction::NORMAL, Direction::NORMAL);
        let dsf = beam.power * model.eval_first(Direction::NORMAL, Direction::NORMAL);
        let w = 2.0 * alpha;
        let disk = (w * w / (a * a)) * (1.0 - (-a * a / (w * w)).exp());
        let expected = disk * w * w / (w * w + w_b * w_b);
        assert!(
            (got / dsf - expected).abs() < 1e-3,
            "{} expected {expected}",
            got / dsf
        );
    }

    #[test]
    fn the_bare_beam_integrates_to_its_power() {
        let detector = Detector::default();
        for profile in [
            BeamProfile::Gaussian { half_width: 0.002 },
            BeamProfile::TopHat { radius: 0.005 },
        ] {
            let beam = Beam {
                profile,
                ..Beam::default()
            };
            let signal = BeamSignal::new(&beam, &detector, Direction::NORMAL.through());
            let (n, half) = (200, 0.012);
            let pitch = 2.0 * half / f64::from(n);
            let mut sum = 0.0;
            for i in 0..n {
                for j in 0..n {
                    let v = DVec3::new(
                        -half + (f64::from(i) + 0.5) * pitch,
                        -half + (f64::from(j) + 0.5) * pitch,
                        -1.0,
                    );
                    // Solid angle of a tangent-plane element.
                    sum += signal.at(Direction::new(v).unwrap()) * pitch * pitch / v.length().powi(3);
                }
            }
            assert!((sum / beam.power - 1.0).abs() < 2e-4, "{profile:?}: {sum}");
        }
    }
}
