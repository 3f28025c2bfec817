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
    pub(super) fn new(ray: &Ray, extent: f32) -> Self {
        let inverse = ray.direction.map(|d| {
            let d = if d.abs() < SMALLEST {
                SMALLEST.copysign(d)
            } else {
                d
            };
            1.0 / d
        });
        let d = ray.direction;
        let origin = ray.origin;
        let slack = SLACK * (extent + origin.iter().fold(0.0, |m: f32, x| m.max(x.abs())));
        let size = d.map(f32::abs);
        let along = if size[0] > size[1] && size[0] > size[2] {
            0
        } else if size[1] > size[2] {
            1
        } else {
            2
        };
        let mut across = [(along + 1) % 3, (along + 2) % 3];
        if d[along] < 0.0 {
            across.swap(0, 1);
        }
        Prepared {
            origin: ray.origin,
            along,
            across,
            shear: [d[across[0]] / d[along], d[across[1]] / d[along], 1.0 / d[along]],
            inverse,
            from: [slack, -slack]
                .map(|s| std::array::from_fn(|a| origin[a] + s.copysign(inverse[a]) * s.signum())),
            near: std::array::from_fn(|a| if inverse[a] < 0.0 { a + 3 } else { a }),
            t_min: ray.t_min,
        }
    }
}
