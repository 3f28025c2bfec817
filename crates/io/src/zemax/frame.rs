//! Scatter angles about the direction of specular reflection or of unbent transmission.

use gonio_geom::{Angles, Component, DVec3, Direction};

/// The frame of one incidence: pole in the specular or unbent direction, azimuth 0 towards the normal of the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pole: DVec3,
    towards_normal: DVec3,
    across: DVec3,
}

impl Frame {
    /// Of light that arrives from `incidence` on the front. In transmission the frame of reflection is mirrored at the
    /// surface, so that azimuths count counter-clockwise seen from the front in both.
    pub(super) fn new(incidence: Angles, component: Component) -> Self {
        let (st, ct) = incidence.theta.sin_cos();
        let (sp, cp) = incidence.phi.sin_cos();
        let z = match component {
            Component::Reflection => 1.0,
            Component::Transmission => -1.0,
        };
        Frame {
            pole: DVec3::new(-st * cp, -st * sp, z * ct),
            towards_normal: DVec3::new(ct * cp, ct * sp, z * st),
            across: DVec3::new(-sp, cp, 0.0),
        }
    }

    /// The direction at angle `radial` from the pole, at `azimuth`; radians.
    pub(super) fn direction(&self, azimuth: f64, radial: f64) -> DVec3 {
        let (sr, cr) = radial.sin_cos();
        let (sa, ca) = azimuth.sin_cos();
        cr * self.pole + sr * (ca * self.towards_normal + sa * self.across)
    }

    /// [`Frame::direction`] of degrees, where it lies on the pole's side of the surface; a grazing one within 1e-9 is
    /// taken for the horizon and left out.
    pub(super) fn on_its_side(&self, azimuth: f64, radial: f64) -> Option<Direction> {
        let v = self.direction(azimuth.to_radians(), radial.to_radians());
        (v.z * self.pole.z.signum() > 1e-9)
            .then(|| Direction::new(v))
            .flatten()
    }
}
