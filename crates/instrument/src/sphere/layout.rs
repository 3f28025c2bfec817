//! Where ports, beam and baffles of a sphere lie, and whether they leave each other room.

use gonio_geom::DVec3;

use super::plan::{Arrangement, Place, Plan, PortName};
use super::{Port, Screen, Sphere};
use crate::InstrumentError;

/// A straight way of light of some width.
pub(super) struct Way {
    pub(super) from: DVec3,
    /// Unit.
    pub(super) along: DVec3,
    pub(super) length: f64,
}

impl Sphere {
    /// The sphere of a plan.
    ///
    /// # Errors
    /// [`InstrumentError::Domain`] for a number out of its range, ports that overlap, a beam that does not fit through a port,
    /// a baffle in the way of the beam or beyond the wall, one between ports that are not there, and an auxiliary lamp that
    /// shines on no bare wall.
    pub fn new(plan: Plan) -> Result<Self, InstrumentError> {
        plan.check()?;
        let mut ports = Vec::new();
        let port = |name, axis: DVec3, radius: f64| Port {
            name,
            axis,
            half_angle: (radius / plan.radius).asin(),
        };
        let sample = port(PortName::Sample, -DVec3::Z, plan.sample_radius);
        ports.push(sample);
        let (sin, cos) = plan.theta_i.sin_cos();
        let middle = sample.middle();
        if plan.arrangement == Arrangement::Reflection {
            let axis = on_wall(middle, DVec3::new(sin, 0.0, cos));
            ports.push(port(PortName::Entrance, axis, plan.entrance_radius));
        }
        if let Some(trap) = &plan.trap {
            let axis = on_wall(middle, DVec3::new(-sin, 0.0, cos));
            ports.push(port(PortName::Trap, axis, trap.radius));
        }
        let placed = |name, place: &Place| port(name, towards(place), place.radius);
        ports.push(placed(PortName::Detector, &plan.detector.place));
        if let Some(place) = &plan.comparison {
            ports.push(placed(PortName::Comparison, place));
        }
        if let Some(place) = &plan.auxiliary {
            ports.push(placed(PortName::Auxiliary, place));
        }
        let mut sphere = Sphere {
            plan,
            ports,
            screens: Vec::new(),
        };
        sphere.check_ports()?;
        sphere.check_beam()?;
        sphere.add_screens()?;
        sphere.check_auxiliary()?;
        Ok(sphere)
    }

    /// Towards the source of the beam as the sample's middle sees it; in transmission it lies outside.
    pub(super) fn towards_source(&self) -> DVec3 {
        let (sin, cos) = self.plan.theta_i.sin_cos();
        match self.plan.arrangement {
            Arrangement::Reflection => DVec3::new(sin, 0.0, cos),
            Arrangement::Transmission => DVec3::new(sin, 0.0, -cos),
        }
    }

    /// Middle of the sample.
    pub(super) fn sample_middle(&self) -> DVec3 {
        self.port(PortName::Sample).map_or(-DVec3::Z, Port::middle)
    }

    fn check_ports(&self) -> Result<(), InstrumentError> {
        for (k, a) in self.ports.iter().enumerate() {
            for b in &self.ports[k + 1..] {
                let (apart, needed) = (a.axis.angle_between(b.axis), a.half_angle + b.half_angle);
                if apart < needed {
                    return Err(InstrumentError::Domain {
                        field: "ports",
                        found: format!(
                            "{} and {} {:.1} degrees apart, which overlap",
                            a.name,
                            b.name,
                            apart.to_degrees()
                        ),
                        allowed: format!("at least {:.1} degrees", needed.to_degrees()),
                    });
                }
            }
        }
        Ok(())
    }

    /// The beam, and its mirrored or unbent continuation to the wall.
    pub(super) fn ways(&self) -> Vec<Way> {
        let from = self.sample_middle();
        let (sin, cos) = self.plan.theta_i.sin_cos();
        let way = |along: DVec3| Way {
            from,
            along,
            length: (on_wall(from, along) - from).length(),
        };
        let onward = way(DVec3::new(-sin, 0.0, cos));
        match self.plan.arrangement {
            Arrangement::Reflection => vec![way(self.towards_source()), onward],
            Arrangement::Transmission => vec![onward],
        }
    }

    /// Radius of the beam at a distance from the sample.
    fn beam_at(&self, distance: f64) -> f64 {
        self.plan.beam_radius / self.plan.radius + distance * self.plan.divergence.tan()
    }

    fn check_beam(&self) -> Result<(), InstrumentError> {
        let fits = |name: PortName, across: f64| match self.port(name) {
            Some(port) if across > port.rim() => Err(InstrumentError::Domain {
                field: "beam.diameter",
                found: format!(
                    "a beam {:.2} mm across at the {name} port",
                    2e3 * across * self.plan.radius
                ),
                allowed: format!(
                    "at most {:.2} mm, the port's diameter",
                    2e3 * port.rim() * self.plan.radius
                ),
            }),
            _ => Ok(()),
        };
        fits(PortName::Sample, self.beam_at(0.0) / self.plan.theta_i.cos())?;
        for (way, name) in self.ways().iter().rev().zip([PortName::Trap, PortName::Entrance]) {
            // The port is seen at a slant.
            let slant = (way.from + way.length * way.along).dot(way.along);
            fits(name, self.beam_at(way.length) / slant.max(1e-3))?;
        }
        Ok(())
    }

    fn add_screens(&mut self) -> Result<(), InstrumentError> {
        for (k, baffle) in self.plan.baffles.iter().enumerate() {
            let domain = |field, found: String, allowed: &str| InstrumentError::Domain {
                field,
                found,
                allowed: allowed.into(),
            };
            let mut ends = [DVec3::ZERO; 2];
            for (end, name) in ends.iter_mut().zip(baffle.between) {
                let port = self.port(name).ok_or_else(|| {
                    let there: Vec<String> = self.ports.iter().map(|p| p.name.to_string()).collect();
                    domain(
                        "baffle.between",
                        format!("{name}"),
                        &format!("a port that is there: {}", there.join(", ")),
                    )
                })?;
                *end = port.middle();
            }
            let Some(normal) = (ends[1] - ends[0]).try_normalize() else {
                let found = format!("{} twice", baffle.between[0]);
                return Err(domain("baffle.between", found, "two ports"));
            };
            let middle = ends[0].lerp(ends[1], baffle.at);
            let radius = baffle.radius / self.plan.radius;
            let height = middle.dot(normal);
            let reach = (middle - height * normal).length() + radius;
            if height.hypot(reach) >= 1.0 {
                let found = format!("baffle {} through the wall", k + 1);
                return Err(domain("baffle.diameter", found, "a baffle inside the sphere"));
            }
            for way in self.ways() {
                let slant = way.along.dot(normal);
                let t = ((middle - way.from).dot(normal) / slant).clamp(0.0, way.length);
                if !t.is_finite() {
                    continue;
                }
                let off = (way.from + t * way.along - middle).length();
                if off < radius + self.beam_at(t) {
                    let found = format!(
                        "baffle {} in the beam: {:.1} mm from its axis",
                        k + 1,
                        1e3 * off * self.plan.radius
                    );
                    let needed = 1e3 * (radius + self.beam_at(t)) * self.plan.radius;
                    return Err(domain("baffle", found, &format!("at least {needed:.1} mm")));
                }
            }
            self.screens.push(Screen {
                middle,
                normal,
                radius,
                reflectance: baffle.reflectance,
            });
        }
        Ok(())
    }

    fn check_auxiliary(&self) -> Result<(), InstrumentError> {
        let Some(lamp) = self.port(PortName::Auxiliary) else {
            return Ok(());
        };
        let lit = -lamp.axis;
        let met = self
            .ports
            .iter()
            .find(|p| p.axis.angle_between(lit) < p.half_angle);
        let crossed = self.screens.iter().any(|s| {
            let t = s.middle.dot(s.normal) / lit.dot(s.normal);
            t.is_finite() && (t * lit - s.middle).length() < s.radius
        });
        let found = match met {
            Some(port) => format!("a lamp opposite to the {} port", port.name),
            None if crossed => "a lamp behind a baffle".into(),
            None => return Ok(()),
        };
        Err(InstrumentError::Domain {
            field: "auxiliary",
            found,
            allowed: "one opposite to bare wall".into(),
        })
    }
}

/// Where a ray from inside meets the wall of radius 1.
pub(super) fn on_wall(from: DVec3, along: DVec3) -> DVec3 {
    let b = from.dot(along);
    from + (-b + (b * b - from.length_squared() + 1.0).max(0.0).sqrt()) * along
}

fn towards(place: &Place) -> DVec3 {
    let (sin, cos) = place.theta.sin_cos();
    DVec3::new(sin * place.phi.cos(), sin * place.phi.sin(), cos)
}
