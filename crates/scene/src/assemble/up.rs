//! Which way is up for materials with axes.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use gonio_trace::scene::Upward;

use super::field::Field;
use crate::error::{Place, SceneError};
use crate::text::Files;

/// A direction of the scene, or one for each point.
#[derive(Clone)]
pub(super) enum Up {
    Fixed(DVec3),
    Field(Arc<dyn Upward>),
}

impl Up {
    /// From `ux uy uz file transform…`: numbers, or functions.
    pub(super) fn read(
        strings: &[String],
        reals: &[f64],
        place: &Place,
        files: &Files,
    ) -> Result<Self, SceneError> {
        let number = |text: &String| text.parse::<f64>().is_ok_and(f64::is_finite);
        match strings {
            [x, y, z, _, ..] if ![x, y, z].into_iter().all(number) => {
                let field = Field::function(strings, reals, 3, place, files)?;
                Ok(Up::Field(Arc::new(Functions(field))))
            }
            _ => Ok(Up::Fixed(super::body::direction(strings, place)?)),
        }
    }

    /// The direction that is the same everywhere.
    pub(super) fn fixed(&self) -> Option<Vec3> {
        match self {
            Up::Fixed(up) => Some(up.as_vec3()),
            // The frame of a material needs one, which the field replaces at each point.
            Up::Field(_) => Some(Vec3::Z),
        }
    }

    pub(super) fn field(self) -> Option<Arc<dyn Upward>> {
        match self {
            Up::Fixed(_) => None,
            Up::Field(field) => Some(field),
        }
    }
}

struct Functions(Field);

impl Upward for Functions {
    fn up(&self, point: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
        let (values, _) = self.0.values(point, normal, direction);
        self.0.seat().world(DVec3::from(values)).as_vec3()
    }
}
