//! Blinds and films in windows as lights: what they bring in of the sky is known beforehand.
//!
//! A screen that scatters the sky has the same radiance everywhere, but for what stands before the sky. A veil holds that
//! radiance by direction, of a simplified BSDF (constant over pairs of Klems patches) under the free sky, and is a light with
//! it. Where a path is scattered by the screen, only the difference is left to chance: the true BSDF and what stands before
//! the sky, less the simplified one, in one and the same direction (a control variate). Means stay what they are, whatever the
//! simplified BSDF.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use gonio_bsdf::Bsdf;
use gonio_bsdf::klems::{KlemsBasis, Role};
use gonio_geom::{Direction, Side};

use crate::light::{Light, Lights, Pane, Sky, Towards};
use crate::material::{Local, Material, rgb};
use crate::path::{Next, Origin, balance};
use crate::pattern::Pattern;
use crate::scene::{Meeting, Scene};
use crate::vector::Frame;

/// Directions of the sky in a patch whose radiances are averaged, on each axis.
const WITHIN: usize = 64;
/// Least share of the sky that is free before a screen, of light that is evenly scattered.
const FREE: f32 = 0.2;

/// A screen that brings in the sky.
pub(crate) struct Veil {
    /// Of its surface.
    frame: Frame,
    /// Side to the sky, and to the room.
    outer: Side,
    basis: KlemsBasis,
    /// The simplified BSDF, `[exit][incident]`.
    simple: Vec<Vec3>,
    /// The same for suns: index of the light, and by exit patch.
    suns: Vec<(u32, Vec<Vec3>)>,
    /// Its radiance by exit patch.
    radiance: Vec<Vec3>,
    mean: Vec3,
}

impl Veil {
    fn new(model: &dyn Bsdf, frame: Frame, outer: Side, sky: &Sky, lights: &Lights) -> Option<Self> {
        let basis = KlemsBasis::full();
        let n = basis.len();
        let inner = outer.opposite();
        let centre = |patch: usize, role: Role, side: Side| basis.point(patch, role, side, 0.5, 0.5);
        let light: Vec<Vec3> = (0..n)
            .map(|patch| {
                let step = |k: usize| (k as f64 + 0.5) / WITHIN as f64;
                let sum: Vec3 = (0..WITHIN * WITHIN)
                    .map(|k| basis.point(patch, Role::Incident, outer, step(k / WITHIN), step(k % WITHIN)))
                    .map(|d| sky.radiance(frame.vector(d)))
                    .sum();
                sum * (basis.lambda()[patch] / (WITHIN * WITHIN) as f64) as f32
            })
            .collect();
        // What all of a disk brings: the mean of the cosine over it is a closed form while none of it sets.
        let up = frame.z * outer.sign() as f32;
        let mut suns: Vec<(u32, Vec<Vec3>, Vec3, Vec3)> = lights
            .distant()
            .filter(|(_, sun)| up.dot(sun.towards()) > sun.sin())
            .map(|(k, sun)| {
                let flux = sun.radiance * (std::f32::consts::PI * sun.sin().powi(2) * up.dot(sun.towards()));
                (k, Vec::with_capacity(n), sun.towards(), flux)
            })
            .collect();
        let mut simple = Vec::with_capacity(n * n);
        let mut radiance = Vec::with_capacity(n);
        let mut mean = Vec3::ZERO;
        for exit in 0..n {
            let ws = centre(exit, Role::Exit, inner);
            let row = (0..n).map(|k| {
                let wi = centre(k, Role::Incident, outer);
                rgb(model, |f| model.eval(wi, ws, f))
            });
            let row: Vec<Vec3> = row.map(|f| if f.is_finite() { f } else { Vec3::ZERO }).collect();
            let mut sum: Vec3 = row.iter().zip(&light).map(|(f, l)| *f * *l).sum();
            for (_, values, towards, flux) in &mut suns {
                let wi = frame.direction(*towards);
                let f = rgb(model, |f| model.eval(wi, ws, f));
                let f = if f.is_finite() { f } else { Vec3::ZERO };
                values.push(f);
                sum += f * *flux;
            }
            mean += sum * (basis.lambda()[exit] / std::f64::consts::PI) as f32;
            radiance.push(sum);
            simple.extend(row);
        }
        (mean.max_element() > 0.0 && mean.is_finite()).then_some(Veil {
            frame,
            outer,
            basis,
            simple,
            suns: suns.into_iter().map(|(k, values, ..)| (k, values)).collect(),
            radiance,
            mean,
        })
    }

    fn local(&self, v: Vec3) -> Direction {
        let l = self.frame.local(v);
        Direction::from_unit(DVec3::new(l.x.into(), l.y.into(), l.z.into()))
    }

    /// Whether a unit vector leaves the surface towards the room.
    #[inline]
    fn inside(&self, v: Vec3) -> bool {
        self.frame.z.dot(v) * (self.outer.sign() as f32) < 0.0
    }

    /// `f |cos|` of the simplified BSDF.
    fn simplified(&self, from: Vec3, to_eye: Vec3) -> Vec3 {
        if self.inside(from) {
            return Vec3::ZERO;
        }
        let exit = self.basis.patch(self.local(to_eye), Role::Exit);
        let incident = self.basis.patch(self.local(from), Role::Incident);
        self.simple[exit * self.basis.len() + incident] * self.frame.z.dot(from).abs()
    }
}

impl Veil {
    /// `f |cos|` of the simplified BSDF for a direction towards a sun.
    fn simplified_sun(&self, k: u32, from: Vec3, to_eye: Vec3) -> Vec3 {
        let Some((_, values)) = self.suns.iter().find(|s| s.0 == k) else {
            return Vec3::ZERO;
        };
        values[self.basis.patch(self.local(to_eye), Role::Exit)] * self.frame.z.dot(from).abs()
    }
}

impl Pattern for Veil {
    fn multiplier(&self, _: Vec3, _: Vec3, direction: Vec3) -> Vec3 {
        if !self.inside(-direction) {
            return Vec3::ZERO;
        }
        let radiance = self.radiance[self.basis.patch(self.local(-direction), Role::Exit)];
        Vec3::select(self.mean.cmpgt(Vec3::ZERO), radiance / self.mean, Vec3::ZERO)
    }
}

impl Scene {
    /// Makes lights of the screens that most of the sky is free before; they are screens no longer.
    pub(crate) fn hang_veils(&mut self) {
        let Some(sky) = self.parts.sky.clone() else {
            return;
        };
        if self.travels {
            return;
        }
        let screens = std::mem::take(&mut self.parts.screens);
        let left = screens
            .into_iter()
            .filter(|s| self.hang(&sky, s).is_none())
            .collect();
        self.parts.screens = left;
    }

    fn hang(&mut self, sky: &Sky, screen: &[Vec3; 3]) -> Option<()> {
        let [corner, a, b] = *screen;
        let corners = [corner, corner + a, corner + a + b, corner + b];
        let near = 1e-5 * self.extent;
        let of = |k: u32| self.triangle(k).0;
        let at_corners = |k: &u32| {
            of(*k)
                .iter()
                .all(|v| corners.iter().any(|c| c.distance(*v) <= near))
        };
        let mut triangles: Vec<u32> = (0..self.parts.triangles.len() as u32)
            .filter(at_corners)
            .collect();
        let first = *triangles.first()?;
        let surface = self.triangle(first).1;
        triangles.retain(|k| self.triangle(*k).1 == surface);
        if triangles.len() != 2 {
            return None;
        }
        let look = self.parts.surfaces[surface as usize];
        let simple = look.is_plain() && look.light.is_none() && !look.concealed && look.glow == Vec3::ZERO;
        let Material::Model { model, up, .. } = &self.parts.materials[look.material as usize] else {
            return None;
        };
        let [p, q, r] = of(first);
        let normal = (q - p).cross(r - p).try_normalize()?;
        let frame = match up {
            Some(up) => Frame::upright(normal, *up),
            None => Frame::about(normal),
        };
        let (front, back) = (self.free(screen, normal), self.free(screen, -normal));
        let outer = if front >= back { Side::Front } else { Side::Back };
        if !simple || look.up.is_some() || front.max(back) < FREE {
            return None;
        }
        let veil = Veil::new(model.as_ref(), frame, outer, sky, &self.lights)?;
        let inner = normal * -(outer.sign() as f32);
        let bright = |d: Vec3| (veil.mean * veil.multiplier(Vec3::ZERO, inner, d)).max_element();
        let pane = Pane::new(*screen, inner, veil.mean, &bright)?;
        let light = self.lights.push(Light::Pane(pane));
        let veil = Arc::new(veil);
        self.parts.light_patterns.resize(light as usize, None);
        self.parts.light_patterns.push(Some(veil.clone()));
        let own = self.parts.surfaces.len() as u32;
        self.parts.surfaces.push(crate::scene::Surface {
            light: Some(light),
            ..look
        });
        for k in triangles {
            self.parts.triangle_surface[k as usize] = own;
        }
        self.veils.resize(own as usize, None);
        self.veils.push(Some(veil));
        Some(())
    }

    /// The veil that a surface is.
    #[inline(always)]
    pub(crate) fn veil(&self, surface: u32) -> Option<&Veil> {
        self.veils.get(surface as usize)?.as_deref()
    }

    /// Whether the sky that a point scatters is known beforehand.
    #[inline(always)]
    pub(crate) fn veiled(&self, met: &Meeting, local: &Local<'_>) -> bool {
        self.veil(met.surface)
            .is_some_and(|veil| veil.inside(local.eye()))
    }

    /// What the sky brings to a point of a veil beyond what is known of it beforehand: one of `draws` samples of the sky.
    #[inline(never)]
    pub(crate) fn beyond_veil(&self, met: &Meeting, local: &Local<'_>, place: [f32; 2], draws: f32) -> Vec3 {
        let (Some(veil), Some(sky)) = (self.veil(met.surface), &self.parts.sky) else {
            return Vec3::ZERO;
        };
        let towards = self.draw_sky(sky, met.point, place);
        let known = veil.simplified(towards.direction, local.eye());
        self.beyond(met, local, &towards, draws, known, true) * sky.radiance(towards.direction)
    }

    /// The same of a sun, which was chosen this often.
    #[inline(never)]
    pub(crate) fn sun_beyond_veil(
        &self,
        met: &Meeting,
        local: &Local<'_>,
        k: u32,
        often: f32,
        place: [f32; 2],
    ) -> Vec3 {
        let (Some(veil), Some(towards)) = (
            self.veil(met.surface),
            self.lights.get(k).sample(met.point, place),
        ) else {
            return Vec3::ZERO;
        };
        let known = veil.simplified_sun(k, towards.direction, local.eye());
        self.beyond(met, local, &towards, often, known, false) * towards.radiance
    }

    /// What a direction that was drawn this often brings of unit radiance beyond what is known of it beforehand.
    fn beyond(
        &self,
        met: &Meeting,
        local: &Local<'_>,
        towards: &Towards,
        often: f32,
        known: Vec3,
        from_sky: bool,
    ) -> Vec3 {
        let direction = towards.direction;
        let (f, pdf) = local.eval(direction);
        let pdf = self.with_screens(met.point, direction, pdf);
        let through = match f == Vec3::ZERO {
            true => None,
            false => self.passes(self.off(met, direction), direction, f32::INFINITY, from_sky),
        };
        // Of unscattered light behind the veil the drawn directions of materials say nothing.
        let alone = through.as_ref().is_some_and(|p| p.alone);
        let seen = through.map_or(Vec3::ZERO, |p| f * p.left);
        let chance = often * towards.pdf;
        let weight = balance(chance, pdf);
        (seen * if alone { 1.0 } else { weight } - weight * known) / chance
    }

    /// What is known beforehand of the sky in a direction that a veil drew, as far as that way to draw it counts: what the sky
    /// brings along the path counts in full.
    #[inline(never)]
    pub(crate) fn known_of(&self, met: &Meeting, local: &Local<'_>, next: &Next) -> Vec3 {
        let (Some(veil), Some(sky)) = (self.veil(met.surface), &self.parts.sky) else {
            return Vec3::ZERO;
        };
        let Origin::Drawn { from, pdf, draws } = next.came else {
            return Vec3::ZERO;
        };
        let weight = balance(pdf, draws * self.sky_pdf(sky, from, next.direction));
        let known = veil.simplified(next.direction, local.eye());
        let mut sum = known * sky.radiance(next.direction) * (weight / pdf);
        for (k, sun) in self.lights.distant().filter(|(_, sun)| sun.holds(next.direction)) {
            let weight = balance(pdf, draws * self.lights.probability(from, k) * sun.pdf());
            let known = veil.simplified_sun(k, next.direction, local.eye());
            sum += known * sun.radiance * (weight / pdf);
        }
        sum
    }
}
