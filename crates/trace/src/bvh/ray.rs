//! A ray and what it hits.

/// A half line in scene coordinates, in single precision. `direction` need not be of unit length: distances are in its
/// lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: [f32; 3],
    /// Where it goes.
    pub direction: [f32; 3],
    /// Nothing nearer is hit.
    pub t_min: f32,
    /// Nothing beyond is hit.
    pub t_max: f32,
}

impl Ray {
    /// The whole half line.
    pub fn new(origin: [f32; 3], direction: [f32; 3]) -> Self {
        Ray {
            origin,
            direction,
            t_min: 0.0,
            t_max: f32::INFINITY,
        }
    }
}

/// A point of a triangle that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in lengths of the ray's direction.
    pub t: f32,
    /// Barycentric weight of the second vertex.
    pub u: f32,
    /// Barycentric weight of the third vertex.
    pub v: f32,
    /// Index of the triangle.
    pub triangle: u32,
}

/// What the tests against boxes and triangles need of a ray.
#[derive(Clone, Copy)]
pub(super) struct Prepared {
    pub(super) origin: [f32; 3],
    /// The axis along which the direction is largest, and the two others in an order that keeps orientation.
    pub(super) along: usize,
    pub(super) across: [usize; 2],
    /// What takes the direction to that axis: `x - shear[0] z`, `y - shear[1] z`, `shear[2] z`.
    pub(super) shear: [f32; 3],
    pub(super) inverse: [f32; 3],
    /// The origin as the near and the far planes see it: moved so that boxes are larger by what the corners of triangles
    /// are rounded by.
    pub(super) from: [[f32; 3]; 2],
    /// Row of the near plane of each axis in a node's bounds.
    pub(super) near: [usize; 3],
    pub(super) t_min: f32,
}

/// Direction components below this are taken for it: their inverse stays finite.
const SMALLEST: f32 = 1e-30;

/// Rounding of a corner in the frame of the ray, over the largest coordinates: half a unit in the last place each for the
/// difference, the slope, and the shear, on two axes.
const SLACK: f32 = 4.0 * f32::EPSILON;

impl Prepared {
    /// For boxes with coordinates up to `extent`.
    #[inline(always)]
    pub(super) fn new(ray: &Ray, extent: f32) -> Self {
        let [x, y, z] = ray.direction;
        let size = [x.abs(), y.abs(), z.abs()];
        let along = if size[0] > size[1] && size[0] > size[2] {
            0
        } else if size[1] > size[2] {
            1
        } else {
            2
        };
        const NEXT: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];
        let [mut first, mut second] = NEXT[along];
        if ray.direction[along] < 0.0 {
            (first, second) = (second, first);
        }
        let largest = ray.origin[0]
            .abs()
            .max(ray.origin[1].abs())
            .max(ray.origin[2].abs());
        let slack = SLACK * (extent + largest);
        let (mut inverse, mut near, mut from) = ([0.0; 3], [0; 3], [ray.origin; 2]);
        for axis in 0..3 {
            let d = ray.direction[axis];
            let back = d < 0.0;
            inverse[axis] = 1.0
                / if size[axis] < SMALLEST {
                    SMALLEST.copysign(d)
                } else {
                    d
                };
            near[axis] = if back { axis + 3 } else { axis };
            let aside = if back { -slack } else { slack };
            from[0][axis] += aside;
            from[1][axis] -= aside;
        }
        // A zero of either sign is in front: its near plane is the lower one.
        let steep = inverse[along];
        Prepared {
            origin: ray.origin,
            along,
            across: [first, second],
            shear: [ray.direction[first] * steep, ray.direction[second] * steep, steep],
            inverse: std::array::from_fn(|a| if near[a] < 3 { inverse[a].abs() } else { inverse[a] }),
            from,
            near,
            t_min: ray.t_min,
        }
    }
}
