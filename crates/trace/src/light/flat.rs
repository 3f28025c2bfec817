//! A luminous polygon.

use glam::Vec3;

use super::Towards;

/// Triangles of one plane that emit on their front.
#[derive(Clone, Debug)]
pub struct Flat {
    /// W/(m2 sr), each channel.
    pub radiance: Vec3,
    normal: Vec3,
    /// A corner and two edges of each triangle.
    triangles: Vec<[Vec3; 3]>,
    /// Area up to and with each triangle.
    areas: Vec<f32>,
    centre: Vec3,
}

impl Flat {
    /// `None` for triangles without area.
    pub fn new(triangles: &[[Vec3; 3]], radiance: Vec3) -> Option<Self> {
        let mut sum = Vec3::ZERO;
        let mut centre = Vec3::ZERO;
        let mut total = 0.0;
        let mut areas = Vec::with_capacity(triangles.len());
        for [a, b, c] in triangles {
            let n = 0.5 * (b - a).cross(c - a);
            total += n.length();
            areas.push(total);
            sum += n;
            centre += (a + b + c) / 3.0 * n.length();
        }
        Some(Flat {
            radiance,
            normal: sum.try_normalize()?,
            triangles: triangles.iter().map(|[a, b, c]| [*a, b - a, c - a]).collect(),
            areas,
            centre: centre / total,
        })
    }

    #[inline]
    fn area(&self) -> f32 {
        self.areas.last().copied().unwrap_or(0.0)
    }

    #[inline(always)]
    pub(super) fn sample(&self, from: Vec3, [u, v]: [f32; 2]) -> Option<Towards> {
        let wanted = u * self.area();
        let k = self
            .areas
            .partition_point(|a| *a <= wanted)
            .min(self.areas.len() - 1);
        let below = if k == 0 { 0.0 } else { self.areas[k - 1] };
        let u = ((wanted - below) / (self.areas[k] - below)).clamp(0.0, 1.0);
        let root = u.sqrt();
        let [a, ab, ac] = self.triangles[k];
        let point = a + (root * (1.0 - v)) * ab + (root * v) * ac;
        let way = point - from;
        let distance = way.length();
        let direction = way / distance;
        let cos = -self.normal.dot(direction);
        (cos > 0.0 && distance > 0.0).then(|| Towards {
            direction,
            distance,
            radiance: self.radiance,
            pdf: self.pdf(distance, cos),
        })
    }

    #[inline(always)]
    pub(super) fn pdf(&self, distance: f32, cos: f32) -> f32 {
        distance * distance / (cos * self.area())
    }

    #[inline]
    pub(super) fn weight(&self, from: Vec3) -> f32 {
        let way = self.centre - from;
        let area = self.area();
        self.radiance.max_element() * area / (way.length_squared() + area)
    }
}
