//! What ports do to light.

use gonio_geom::{DVec3, Direction};

use super::plan::{Arrangement, PortName};
use super::reading::{Filling, State};
use super::single::Single;
use super::{Port, Sphere};
use crate::InstrumentError;

/// What a port does to light.
pub(super) enum Fill {
    Open,
    Detector(f64),
    Lambert(f64),
    Model(Single),
}

/// A port with what fills it.
pub(super) struct Filled<'a> {
    pub(super) port: &'a Port,
    /// Cosine of its half angle.
    pub(super) cos: f64,
    pub(super) middle: DVec3,
    pub(super) fill: Fill,
    /// Axes of the sample's frame in the world.
    axes: [DVec3; 3],
}

impl<'a> Filled<'a> {
    pub(super) fn new(sphere: &'a Sphere, port: &'a Port, state: &State) -> Result<Self, InstrumentError> {
        Ok(Filled {
            port,
            cos: port.half_angle.cos(),
            middle: port.middle(),
            fill: sphere.fill(port.name, state)?,
            axes: sphere.axes(port),
        })
    }

    /// Where light that comes from `back` goes, and what is left of it.
    pub(super) fn scatter(
        &self,
        model: &Single,
        back: DVec3,
        (two, one): ([f64; 2], f64),
    ) -> Option<(DVec3, f64)> {
        let local = self.axes.map(|a| back.dot(a));
        let wi = Direction::new(DVec3::from_array(local))?;
        let (ws, weight) = model.scatter(wi, [two[0], two[1], one])?;
        let ws = ws.vec();
        let along = ws.x * self.axes[0] + ws.y * self.axes[1] + ws.z * self.axes[2];
        Some((along, weight))
    }
}

impl Sphere {
    fn fill(&self, name: PortName, state: &State) -> Result<Fill, InstrumentError> {
        let given = match name {
            PortName::Sample => &state.sample,
            PortName::Comparison => &state.comparison,
            PortName::Entrance | PortName::Auxiliary => return Ok(Fill::Open),
            PortName::Trap => {
                let residual = self.plan.trap.map_or(0.0, |t| t.residual);
                let reflectance = if state.trap_open { residual } else { self.plan.plug };
                return Ok(Fill::Lambert(reflectance));
            }
            PortName::Detector => return Ok(Fill::Detector(self.plan.detector.reflectance)),
        };
        Ok(match given {
            Filling::Open => Fill::Open,
            Filling::Plug => Fill::Lambert(self.plan.plug),
            Filling::Lambert(reflectance) => Fill::Lambert(*reflectance),
            Filling::Model { model, channel } => {
                let single = Single::new(model.clone(), *channel).ok_or_else(|| InstrumentError::Domain {
                    field: "channel",
                    found: channel.to_string(),
                    allowed: format!("below {}", model.channels().len()),
                })?;
                Fill::Model(single)
            }
        })
    }

    /// Axes of the frame of a sample in a port: its front is turned inward, in transmission that in the sample's port
    /// outward; at the sample's port the beam arrives at azimuth `phi_i`.
    pub(super) fn axes(&self, port: &Port) -> [DVec3; 3] {
        let z = match (self.plan.arrangement, port.name) {
            (Arrangement::Transmission, PortName::Sample) => port.axis,
            _ => -port.axis,
        };
        let x = if z.x.abs() < 0.9 { DVec3::X } else { DVec3::Y };
        let x = (x - x.dot(z) * z).normalize();
        let across = z.cross(x);
        let (sin, cos) = self.plan.phi_i.sin_cos();
        [cos * x - sin * across, sin * x + cos * across, z]
    }

    /// A point of the spot: at a share of the beam's radius and an angle in its cross-section.
    pub(super) fn spot_point(&self, share: f64, angle: f64) -> DVec3 {
        let r = share * self.plan.beam_radius / self.plan.radius;
        // The spot is longer in the plane of incidence.
        let stretched = angle.cos() / self.plan.theta_i.cos();
        self.sample_middle() + r * DVec3::new(stretched, angle.sin(), 0.0)
    }
}
