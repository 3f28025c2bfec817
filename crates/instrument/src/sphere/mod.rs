//! The virtual integrating sphere [DIN5036]: ports, gloss trap, detector and baffles in a diffuse wall.
//!
//! Lengths are in radii of the sphere once a [`Plan`] has become a [`Sphere`]. The frame has its origin in the middle; the
//! sample lies at -z, the beam comes from azimuth 0. What closes a port lies in the plane of its rim: light from anywhere
//! in the sphere meets that disk where it would meet the cap behind it, so ports take exactly the share of their caps.

mod cone;
mod fill;
mod layout;
mod plan;
mod procedure;
mod reading;
mod single;
mod walk;

pub use cone::PortCone;
pub use plan::{Arrangement, Baffle, Detector, Place, Plan, PortName, Trap};
pub use procedure::{Estimate, Method, Reading, SphereResult, measure};
pub use reading::{Effort, Filling, Means, Source, State, read};

use gonio_geom::DVec3;

/// A port as it lies in the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Port {
    /// What it is for.
    pub name: PortName,
    /// From the middle of the sphere to that of the port, unit.
    pub axis: DVec3,
    /// Half the angle that it subtends at the middle of the sphere, radians.
    pub half_angle: f64,
}

impl Port {
    /// Middle of the plane of the rim.
    pub fn middle(&self) -> DVec3 {
        self.half_angle.cos() * self.axis
    }

    /// Radius of the rim.
    pub fn rim(&self) -> f64 {
        self.half_angle.sin()
    }

    /// Share of the port's cap in the area of the whole sphere.
    pub fn fraction(&self) -> f64 {
        (0.5 * self.half_angle).sin().powi(2)
    }
}

/// A screen as it lies in the sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screen {
    /// Its middle.
    pub middle: DVec3,
    /// Unit normal.
    pub normal: DVec3,
    /// Its radius.
    pub radius: f64,
    /// Its reflectance.
    pub reflectance: f64,
}

/// An integrating sphere that can be built; lengths in radii.
#[derive(Clone, Debug, PartialEq)]
pub struct Sphere {
    /// As described.
    pub plan: Plan,
    /// Its ports, each once.
    pub ports: Vec<Port>,
    /// Its baffles.
    pub screens: Vec<Screen>,
}

impl Sphere {
    /// The port of that name, if there is one.
    pub fn port(&self, name: PortName) -> Option<&Port> {
        self.ports.iter().find(|p| p.name == name)
    }

    /// How many times the flux of a beam, evenly spread over the wall, is its mean irradiance, by the balance of flux
    /// [Goebel1967, eq. 4]: `rho_0 / (1 - rho_w (1 - sum f_j) - sum f_j rho_j)` with the shares `f_j` of the ports in the area.
    ///
    /// `first` is the reflectance of what the beam meets, `filled` that of what fills ports; others are open (0). Baffles are left
    /// out.
    pub fn multiplier(&self, first: f64, filled: &[(PortName, f64)]) -> f64 {
        let reflected: f64 = self
            .ports
            .iter()
            .map(|p| p.fraction() * filled.iter().find(|f| f.0 == p.name).map_or(0.0, |f| f.1))
            .sum();
        let free = 1.0 - self.ports.iter().map(Port::fraction).sum::<f64>();
        first / (1.0 - self.plan.wall * free - reflected)
    }
}
