//! Curved surfaces that are traced as they are.

use glam::Vec3;

/// A curved surface, one-sided in its normal only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A sphere; its normal points outward, inward when `inward`.
    Sphere {
        /// Its centre.
        centre: Vec3,
        /// Its radius, positive.
        radius: f32,
        /// Whether its front is inside.
        inward: bool,
    },
    /// The side of a frustum, open at its ends, or a cylinder when the radii are equal.
    Cone {
        /// Centre of the first end.
        from: Vec3,
        /// Centre of the second end.
        to: Vec3,
        /// Radii of the ends, not both zero.
        radii: [f32; 2],
        /// Whether its front is inside.
        inward: bool,
    },
    /// A flat ring, or a disk when the inner radius is zero.
    Ring {
        /// Its centre.
        centre: Vec3,
        /// Its unit normal.
        normal: Vec3,
        /// Inner and outer radius.
        radii: [f32; 2],
    },
}

impl Shape {
    /// The least box that holds it.
    pub fn bounds(&self) -> [Vec3; 2] {
        let disk = |centre: Vec3, axis: Vec3, r: f32| {
            let half = r * (Vec3::ONE - axis * axis).max(Vec3::ZERO).map(f32::sqrt);
            [centre - half, centre + half]
        };
        match *self {
            Shape::Sphere { centre, radius, .. } => [centre - radius, centre + radius],
            Shape::Cone { from, to, radii, .. } => {
                let axis = (to - from).normalize_or_zero();
                let (a, b) = (disk(from, axis, radii[0]), disk(to, axis, radii[1]));
                [a[0].min(b[0]), a[1].max(b[1])]
            }
            Shape::Ring {
                centre,
                normal,
                radii,
            } => disk(centre, normal, radii[1]),
        }
    }

    /// The nearest distance in `[t_min, t_max]` at which a ray of unit direction meets it. In double precision: the
    /// discriminant of a small sphere far away is a small difference.
    pub fn hit(&self, origin: Vec3, direction: Vec3, t_min: f32, t_max: f32) -> Option<f32> {
        let (o, d) = (origin.as_dvec3(), direction.as_dvec3());
        let range = f64::from(t_min)..=f64::from(t_max);
        match *self {
            Shape::Sphere { centre, radius, .. } => {
                let c = o - centre.as_dvec3();
                let r = f64::from(radius);
                nearest(d.dot(d), c.dot(d), c.dot(c) - r * r, |t| range.contains(&t))
            }
            Shape::Cone { from, to, radii, .. } => {
                let (a, b) = (from.as_dvec3(), to.as_dvec3());
                let length = (b - a).length();
                let axis = (b - a) / length;
                let slope = f64::from(radii[1] - radii[0]) / length;
                let (h0, hd) = ((o - a).dot(axis), d.dot(axis));
                let (p, q) = ((o - a) - h0 * axis, d - hd * axis);
                let (r0, rd) = (f64::from(radii[0]) + slope * h0, slope * hd);
                nearest(q.dot(q) - rd * rd, p.dot(q) - r0 * rd, p.dot(p) - r0 * r0, |t| {
                    let h = h0 + t * hd;
                    range.contains(&t) && (0.0..=length).contains(&h) && r0 + t * rd >= 0.0
                })
            }
            Shape::Ring {
                centre,
                normal,
                radii,
            } => {
                let n = normal.as_dvec3();
                let t = (centre.as_dvec3() - o).dot(n) / d.dot(n);
                let r = (o + t * d - centre.as_dvec3()).length();
                let on = (f64::from(radii[0])..=f64::from(radii[1])).contains(&r);
                (on && range.contains(&t)).then_some(t as f32)
            }
        }
    }

    /// The unit normal of its front at a point on it.
    pub fn normal(&self, point: Vec3) -> Vec3 {
        let facing = |outward: Vec3, inward: bool| if inward { -outward } else { outward };
        match *self {
            Shape::Sphere { centre, inward, .. } => facing((point - centre).normalize(), inward),
            Shape::Cone {
                from,
                to,
                radii,
                inward,
            } => {
                let length = (to - from).length();
                let axis = (to - from) / length;
                let aside = (point - from) - (point - from).dot(axis) * axis;
                let slope = (radii[1] - radii[0]) / length;
                facing(
                    (aside.normalize_or_zero() - slope * axis).normalize_or(axis),
                    inward,
                )
            }
            Shape::Ring { normal, .. } => normal,
        }
    }
}

/// The smaller root of `a t^2 + 2 b t + c` that is allowed.
fn nearest(a: f64, b: f64, c: f64, allowed: impl Fn(f64) -> bool) -> Option<f32> {
    if a == 0.0 {
        let t = -c / (2.0 * b);
        return allowed(t).then_some(t as f32);
    }
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        return None;
    }
    // Without cancellation: one root by the sum of equal signs, the other by Vieta.
    let q = -(b + discriminant.sqrt().copysign(b));
    let (first, second) = (q / a, c / q);
    let (near, far) = if first < second {
        (first, second)
    } else {
        (second, first)
    };
    [near, far].into_iter().find(|t| allowed(*t)).map(|t| t as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPES: [Shape; 5] = [
        Shape::Sphere {
            centre: Vec3::new(0.2, -0.1, 0.3),
            radius: 0.7,
            inward: false,
        },
        Shape::Cone {
            from: Vec3::new(0.0, 0.0, -0.5),
            to: Vec3::new(0.3, 0.2, 0.6),
            radii: [0.6, 0.2],
            inward: false,
        },
        Shape::Cone {
            from: Vec3::new(0.1, 0.0, -0.5),
            to: Vec3::new(0.1, 0.0, 0.5),
            radii: [0.4, 0.4],
            inward: true,
        },
        Shape::Cone {
            from: Vec3::ZERO,
            to: Vec3::Z,
            radii: [0.0, 0.8],
            inward: false,
        },
        Shape::Ring {
            centre: Vec3::new(0.1, 0.2, 0.0),
            normal: Vec3::Y,
            radii: [0.2, 0.9],
        },
    ];

    #[test]
    fn hits_lie_on_the_shape_and_in_its_box_and_normals_stand_on_it() {
        let mut s = crate::sampler::Sampler::new(1, 0, 0);
        for (k, shape) in SHAPES.iter().enumerate() {
            let mut hits = 0;
            for i in 0..20_000 {
                let mut s2 = crate::sampler::Sampler::new(1, k as u32, i);
                let o = Vec3::from_array(std::array::from_fn(|_| 4.0 * s2.one() - 2.0));
                let d = Vec3::from_array(std::array::from_fn(|_| 2.0 * s2.one() - 1.0)).normalize();
                let Some(t) = shape.hit(o, d, 0.0, f32::INFINITY) else {
                    continue;
                };
                hits += 1;
                let p = o + t * d;
                let [low, high] = shape.bounds();
                assert!(
                    p.cmpge(low - 1e-5).all() && p.cmple(high + 1e-5).all(),
                    "{k}: {p}"
                );
                let n = shape.normal(p);
                assert!((n.length() - 1.0).abs() < 1e-5);
                // The surface stays level along its tangents.
                let (a, _) = n.any_orthonormal_pair();
                let back = shape.hit(p + 1e-3 * a + 0.05 * n, -n, 0.0, 1.0);
                assert!(
                    back.is_none_or(|t| (t - 0.05).abs() < 2e-4 || t > 0.06),
                    "{k}: {back:?} {p}"
                );
                assert!(shape.hit(o, d, 0.0, 0.999 * t).is_none());
            }
            assert!(hits > 300, "{k}: {hits}");
            let _ = s.one();
        }
    }

    #[test]
    fn a_small_sphere_far_away_is_hit_within_single_precision() {
        let sphere = Shape::Sphere {
            centre: Vec3::new(0.0, 0.0, 1e4),
            radius: 0.01,
            inward: false,
        };
        assert!(sphere.hit(Vec3::ZERO, Vec3::Z, 0.0, f32::INFINITY).is_some());
        let aside = Vec3::new(0.02, 0.0, 1e4).normalize();
        assert!(sphere.hit(Vec3::ZERO, aside, 0.0, f32::INFINITY).is_none());
    }
}
