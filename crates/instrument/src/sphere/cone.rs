//! The cone of directions that leave through the trap, as the lit spot of the sample sees it.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use gonio_bsdf::Bsdf;
use gonio_bsdf::cone::within;
use gonio_bsdf::directional_albedo;
use gonio_geom::{Component, DVec3, Direction};

use super::plan::{Arrangement, PortName};
use super::{Port, Sphere};

/// Halvings that find the edge of the port: to 1e-12 rad.
const HALVINGS: u32 = 42;
/// Points of the spot: radii of equal area and even angles.
const RADII: [f64; 2] = [0.459_700_843_380_983_1, 0.888_073_833_977_115_3];
const ANGLES: u32 = 6;

/// What leaves through the trap, by integration over its directions from all of the spot.
#[derive(Clone, Debug)]
pub struct PortCone<'a> {
    sphere: &'a Sphere,
    trap: &'a Port,
}

impl Sphere {
    /// The cone of the trap; `None` of a sphere without one.
    pub fn cone(&self) -> Option<PortCone<'_>> {
        self.port(PortName::Trap)
            .map(|trap| PortCone { sphere: self, trap })
    }

    /// Which light of the sample is measured.
    pub fn component(&self) -> Component {
        match self.plan.arrangement {
            Arrangement::Reflection => Component::Reflection,
            Arrangement::Transmission => Component::Transmission,
        }
    }

    /// The incidence in the frame of the sample.
    pub fn incidence(&self) -> Direction {
        Direction::from_spherical(self.plan.theta_i, self.plan.phi_i)
    }

    /// All light that the sample scatters into the hemisphere that is measured.
    pub fn whole(&self, model: &dyn Bsdf, channel: usize) -> f64 {
        directional_albedo(model, self.incidence(), self.component(), channel)
    }
}

impl PortCone<'_> {
    /// Share of the beam's light that a model sends through the trap, the mean over the spot.
    pub fn integral(&self, model: &dyn Bsdf, channel: usize) -> f64 {
        let (wi, component, axes) = self.frame();
        self.over_spot(|at| {
            within(model, wi, component, channel, &|across| {
                self.edge(&axes, at, across)
            })
        })
    }

    /// Share of Lambertian light that leaves through the trap.
    pub fn diffuse_share(&self) -> f64 {
        let (wi, component, axes) = self.frame();
        self.over_spot(|at| within(&Even, wi, component, 0, &|across| self.edge(&axes, at, across)))
    }

    fn frame(&self) -> (Direction, Component, [DVec3; 3]) {
        let sample = self.sphere.port(PortName::Sample).unwrap_or(self.trap);
        (
            self.sphere.incidence(),
            self.sphere.component(),
            self.sphere.axes(sample),
        )
    }

    /// Half angle of the round cone about the ideal direction that takes the same share of Lambertian light, radians.
    pub fn half_angle(&self) -> f64 {
        let cos = self.sphere.plan.theta_i.cos();
        (self.diffuse_share() / cos).clamp(0.0, 1.0).sqrt().asin()
    }

    /// Gauss points in the square of the radius [AbramowitzStegun1964, 25.4.30], even ones in angle.
    fn over_spot(&self, value: impl Fn(DVec3) -> f64) -> f64 {
        let mut sum = 0.0;
        for share in RADII {
            for k in 0..ANGLES {
                sum += value(
                    self.sphere
                        .spot_point(share, TAU * (f64::from(k) + 0.5) / f64::from(ANGLES)),
                );
            }
        }
        sum / (RADII.len() as f64 * f64::from(ANGLES))
    }

    /// The angle from the ideal direction at which a direction towards `across` (in the sample's frame) meets the rim.
    fn edge(&self, axes: &[DVec3; 3], at: DVec3, across: DVec3) -> f64 {
        let world = |v: DVec3| v.x * axes[0] + v.y * axes[1] + v.z * axes[2];
        let (sin, cos) = self.sphere.plan.theta_i.sin_cos();
        let (axis, across) = (DVec3::new(-sin, 0.0, cos), world(across));
        let inside = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let d = cos * axis + sin * across;
            let towards = d.dot(self.trap.axis);
            if towards <= 0.0 {
                return false;
            }
            let t = (self.trap.middle() - at).dot(self.trap.axis) / towards;
            (at + t * d - self.trap.middle()).length() <= self.trap.rim()
        };
        let (mut low, mut high) = (0.0, FRAC_PI_2);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if inside(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// White and Lambertian to both sides.
struct Even;

impl Bsdf for Even {
    fn channels(&self) -> &[gonio_bsdf::Channel] {
        &[gonio_bsdf::Channel::Photopic]
    }

    fn properties(&self) -> gonio_bsdf::Properties {
        gonio_bsdf::Properties {
            reciprocal: true,
            energy_conserving: false,
            isotropic: true,
        }
    }

    fn eval(&self, _: Direction, _: Direction, f: &mut [f64]) {
        f.fill(1.0 / PI);
    }
}
