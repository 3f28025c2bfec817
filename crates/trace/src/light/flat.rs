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
    area: f32,
    /// A corner and two edges, if the triangles are the halves of a parallelogram.
    parallelogram: Option<[Vec3; 3]>,
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
            area: total,
            parallelogram: parallelogram(triangles),
            centre: centre / total,
        })
    }

    pub(crate) fn normal(&self) -> Vec3 {
        self.normal
    }

    pub(crate) fn area(&self) -> f32 {
        self.area
    }

    /// A point drawn evenly from it.
    #[inline(always)]
    pub(crate) fn place(&self, u: [f32; 2]) -> Vec3 {
        match self.parallelogram {
            Some([corner, a, b]) => corner + u[0] * a + u[1] * b,
            None => self.point(u),
        }
    }

    #[inline(always)]
    pub(super) fn sample(&self, from: Vec3, u: [f32; 2]) -> Option<Towards> {
        let way = self.place(u) - from;
        let distance2 = way.length_squared();
        let cos_distance = -self.normal.dot(way);
        if cos_distance <= 0.0 {
            return None;
        }
        let distance = distance2.sqrt();
        Some(Towards {
            direction: way / distance,
            distance,
            radiance: self.radiance,
            pdf: distance2 * distance / (cos_distance * self.area),
        })
    }

    /// A point drawn evenly from the triangles.
    fn point(&self, [u, v]: [f32; 2]) -> Vec3 {
        let wanted = u * self.area;
        let k = self
            .areas
            .partition_point(|a| *a <= wanted)
            .min(self.areas.len() - 1);
        let below = if k == 0 { 0.0 } else { self.areas[k - 1] };
        let u = ((wanted - below) / (self.areas[k] - below)).clamp(0.0, 1.0);
        let root = u.sqrt();
        let [a, ab, ac] = self.triangles[k];
        a + (root * (1.0 - v)) * ab + (root * v) * ac
    }

    #[inline(always)]
    pub(super) fn pdf(&self, distance: f32, cos: f32) -> f32 {
        distance * distance / (cos * self.area)
    }

    #[inline]
    pub(super) fn weight(&self, from: Vec3) -> f32 {
        let way = self.centre - from;
        if self.normal.dot(way) >= 0.0 {
            return 0.0;
        }
        let area = self.area;
        self.radiance.max_element() * area / (way.length_squared() + area)
    }
}

/// The corner and edges of the parallelogram that two triangles with a common diagonal make.
fn parallelogram(triangles: &[[Vec3; 3]]) -> Option<[Vec3; 3]> {
    let [first, second] = triangles else { return None };
    // The corner of the first that the second has not, and its neighbours.
    let k = (0..3).find(|&k| !second.contains(&first[k]))?;
    let [p, q, r] = [first[k], first[(k + 1) % 3], first[(k + 2) % 3]];
    let far = *second.iter().find(|v| !first.contains(v))?;
    let size = (q - p).length().max((r - p).length());
    let fits = second.contains(&q) && second.contains(&r) && (q + r - p).distance(far) < 1e-5 * size;
    fits.then_some([p, q - p, r - p])
}
