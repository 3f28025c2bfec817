//! Directions in which paths go on: drawn by the material, and towards screens that scatter the light of the sky.

use glam::Vec3;

use crate::material::Local;
use crate::path::{Next, Origin};
use crate::scene::{Meeting, Scene};

/// Share of the directions after a scattering that go to the screens, where there are any.
const TO_SCREENS: f32 = 0.5;

impl Scene {
    /// A direction in which the path goes on.
    #[inline(always)]
    pub(crate) fn scattered(&self, met: &Meeting, local: &Local<'_>, mut u: [f32; 3]) -> Option<Next> {
        let screens = self.parts.screens.iter().filter(|s| apart(s, met.point)).count();
        if screens > 0 {
            if u[2] < TO_SCREENS {
                u[2] /= TO_SCREENS;
                let direction = self.towards_screen(met.point, screens, u)?;
                let (f, pdf) = local.eval(direction);
                let pdf = self.with_screens(met.point, direction, pdf);
                return (pdf > 0.0 && f != Vec3::ZERO).then_some(Next {
                    direction,
                    weight: f / pdf,
                    came: Origin::Drawn {
                        from: met.point,
                        pdf,
                        draws: 1.0,
                    },
                });
            }
            u[2] = ((u[2] - TO_SCREENS) / (1.0 - TO_SCREENS)).min(0.999_999_94);
        }
        let drawn = local.sample(u)?;
        let pdf = self.with_screens(met.point, drawn.direction, drawn.pdf);
        Some(Next {
            direction: drawn.direction,
            weight: drawn.weight * (drawn.pdf / pdf),
            came: Origin::Drawn {
                from: met.point,
                pdf,
                draws: 1.0,
            },
        })
    }

    /// The density of a direction when some of them go to the screens.
    #[inline(always)]
    pub(crate) fn with_screens(&self, from: Vec3, direction: Vec3, pdf: f32) -> f32 {
        let screens = &self.parts.screens;
        if screens.is_empty() {
            return pdf;
        }
        let (mut sum, mut n) = (0.0, 0);
        for screen in screens.iter().filter(|s| apart(s, from)) {
            sum += screen_pdf(screen, from, direction);
            n += 1;
        }
        match n {
            0 => pdf,
            _ => (1.0 - TO_SCREENS) * pdf + TO_SCREENS * sum / n as f32,
        }
    }

    fn towards_screen(&self, from: Vec3, count: usize, u: [f32; 3]) -> Option<Vec3> {
        let k = ((u[2] * count as f32) as usize).min(count - 1);
        let [corner, a, b] = *self.parts.screens.iter().filter(|s| apart(s, from)).nth(k)?;
        (corner + u[0] * a + u[1] * b - from).try_normalize()
    }
}

/// Whether a point lies off the plane of a screen, from which no direction leads to it.
#[inline(always)]
fn apart([corner, a, b]: &[Vec3; 3], from: Vec3) -> bool {
    let normal = a.cross(*b);
    // Of the size of the screen, whose normal is as long as its area.
    let off = normal.dot(from - *corner);
    off * off > 1e-8 * normal.length_squared() * normal.length()
}

/// Density per solid angle of a direction to a point drawn evenly from a parallelogram; zero where it misses it.
fn screen_pdf([corner, a, b]: &[Vec3; 3], from: Vec3, direction: Vec3) -> f32 {
    let normal = a.cross(*b);
    let along = normal.dot(direction);
    if along == 0.0 {
        return 0.0;
    }
    let t = normal.dot(*corner - from) / along;
    let p = from + t * direction - *corner;
    let area2 = normal.length_squared();
    let (u, v) = (p.cross(*b).dot(normal) / area2, a.cross(p).dot(normal) / area2);
    if t <= 0.0 || !(0.0..=1.0).contains(&u) || !(0.0..=1.0).contains(&v) {
        return 0.0;
    }
    t * t / along.abs()
}
