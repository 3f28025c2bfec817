//! What shines from infinity.

use std::sync::Arc;

use glam::Vec3;
use gonio_trace::light::{Distant, Light, Sky};
use gonio_trace::pattern::Pattern;

use super::Assembly;
use super::light::Kind;
use super::material::Look;
use crate::error::{Place, SceneError};

/// A cone of directions that shines.
#[derive(Clone)]
struct Zone {
    towards: Vec3,
    /// One less the cosine of half its angle.
    drop: f32,
    radiance: Vec3,
    pattern: Option<Arc<dyn Pattern>>,
}

/// All zones, the first of a direction counts.
#[derive(Default)]
pub(super) struct Heaven {
    zones: Vec<Zone>,
}

impl Heaven {
    pub(super) fn finish(&self) -> Option<Sky> {
        if self.zones.is_empty() {
            return None;
        }
        let zones = self.zones.clone();
        Some(Sky::new(Arc::new(move |direction: Vec3| {
            let holds = |z: &&Zone| 0.5 * (direction - z.towards).length_squared() <= z.drop;
            let Some(zone) = zones.iter().find(holds) else {
                return Vec3::ZERO;
            };
            match &zone.pattern {
                Some(p) => {
                    // A pattern may be negative or not a number where its formula ends.
                    let factor = p.multiplier(Vec3::ZERO, -direction, direction);
                    let factor = factor.map(|f| if f.is_finite() { f.max(0.0) } else { 0.0 });
                    zone.radiance * factor
                }
                None => zone.radiance,
            }
        })))
    }
}

/// Cones below this, in degrees, are drawn as they are rather than through the table of the sky.
const SMALL: f64 = 10.0;

impl Assembly<'_> {
    pub(super) fn source(
        &mut self,
        direction: Vec3,
        angle: f64,
        look: Option<Look>,
        place: &Place,
    ) -> Result<(), SceneError> {
        let Some(towards) = direction.try_normalize() else {
            return Err(place.fault("direction", "0 0 0", "a direction that is not zero"));
        };
        if !(angle > 0.0 && angle <= 360.0) {
            return Err(place.fault("angle", angle.to_string(), "above 0 and up to 360 degrees"));
        }
        let Some(emission) = look.and_then(|l| l.emission) else {
            self.warn(place, "source that does not shine: left out");
            return Ok(());
        };
        if emission.kind == Kind::Illum {
            self.warn(place, "illum at infinity: taken for a light");
        }
        if emission.kind == Kind::Shown {
            self.warn(
                place,
                "glow of negative radius at infinity: it lights the scene here",
            );
        }
        let pattern = emission.patterns();
        if pattern.is_none() && (emission.kind == Kind::Light || angle < SMALL) {
            let light = Distant::new(towards, angle.to_radians(), emission.radiance);
            self.parts.lights.extend(light.map(Light::Distant));
            return Ok(());
        }
        let half = (0.25 * angle).to_radians().sin();
        self.sky.zones.push(Zone {
            towards,
            drop: (2.0 * half * half) as f32,
            radiance: emission.radiance,
            pattern,
        });
        Ok(())
    }
}
