//! A rectangle whose radiance depends on direction alone.

use std::sync::Arc;

use glam::Vec3;

use super::{Openings, Towards};

/// What a screen brings in: emitted on one side, drawn in proportion to its radiance by direction.
#[derive(Clone, Debug)]
pub struct Pane {
    corner: Vec3,
    /// Unit, on the side that emits.
    normal: Vec3,
    /// What a pattern multiplies.
    pub(super) radiance: Vec3,
    /// The rectangle, seen as an opening to what it emits.
    opening: Arc<Openings>,
}

impl Pane {
    /// A rectangle by corner and edges that emits on the side of `normal`, `bright` by the direction of a ray towards it;
    /// `None` for a parallelogram that is no rectangle.
    pub(crate) fn new(
        rectangle: [Vec3; 3],
        normal: Vec3,
        radiance: Vec3,
        bright: &dyn Fn(Vec3) -> f32,
    ) -> Option<Self> {
        let mut opening = Openings::default();
        opening.add(bright, rectangle, -normal, 1.0);
        (!opening.is_empty()).then(|| Pane {
            corner: rectangle[0],
            normal,
            radiance,
            opening: Arc::new(opening),
        })
    }

    pub(super) fn sample(&self, from: Vec3, u: [f32; 2]) -> Option<Towards> {
        let seen = self.opening.seen(from);
        let direction = self.opening.sample(&seen, u)?;
        let pdf = self.opening.pdf(&seen, direction);
        let distance = self.normal.dot(self.corner - from) / self.normal.dot(direction);
        (pdf > 0.0 && distance > 0.0 && distance.is_finite()).then_some(Towards {
            direction,
            distance,
            radiance: self.radiance,
            pdf,
        })
    }

    /// Density per solid angle of a unit direction.
    pub(super) fn pdf(&self, from: Vec3, direction: Vec3) -> f32 {
        self.opening.pdf(&self.opening.seen(from), direction)
    }

    pub(super) fn weight(&self, from: Vec3) -> f32 {
        self.opening.seen(from).brings()
    }

    pub(super) fn normal(&self) -> Vec3 {
        self.normal
    }
}
