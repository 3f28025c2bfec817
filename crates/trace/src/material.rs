//! What surfaces do with light.

use std::sync::Arc;

use glam::Vec3;
use gonio_bsdf::{Bsdf, Lobe};
use gonio_geom::Direction;

use crate::function::{Scattering, Sight};
use crate::vector::{Frame, cosine_weighted};

/// A material: red, green and blue.
#[derive(Clone)]
pub enum Material {
    /// Light passes as if the surface were not there.
    Nothing,
    /// All light is absorbed, as by the surface of a lamp.
    Black,
    /// A Lambertian reflector on both sides.
    Diffuse {
        /// Its reflectance, each in `[0, 1]`.
        reflectance: Vec3,
    },
    /// Any model of three channels (red, green, blue), or of one, which is grey.
    Model {
        /// The model, in the frame of the surface.
        model: Arc<dyn Bsdf>,
        /// What its `y` axis is closest to; `None` for an isotropic model.
        up: Option<Vec3>,
        /// Whether it has an ideal part.
        ideal: bool,
    },
    /// Functions of the place and both directions.
    Function(Arc<dyn Scattering>),
}

impl Material {
    /// A model of one or three channels; `up` orients one with axes.
    pub fn model(model: Arc<dyn Bsdf>, up: Option<Vec3>) -> Self {
        let ideal = model.has_delta();
        Material::Model { model, up, ideal }
    }
}

/// The largest number below 1.
const BELOW_ONE: f32 = 1.0 - 0.5 * f32::EPSILON;

/// A direction drawn from a material.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drawn {
    /// Where the light comes from, in the world.
    pub(crate) direction: Vec3,
    /// `f cos / pdf`, each channel.
    pub(crate) weight: Vec3,
    /// Per solid angle.
    pub(crate) pdf: f32,
}

/// A material at a point, seen from a direction.
pub(crate) struct Local<'a> {
    pub(crate) material: &'a Material,
    pub(crate) frame: Frame,
    /// Towards the eye, in the frame.
    pub(crate) to_eye: Direction,
    pub(crate) to_eye_local: Vec3,
    /// The factor of a pattern, and the part of the material without it.
    pub(crate) paint: Option<(Vec3, Option<&'a dyn Bsdf>)>,
    /// The normal of the surface where that of the frame is another.
    flat: Option<Vec3>,
    /// Where a material of functions is seen.
    pub(crate) sight: Option<Box<Sight>>,
    /// The share of this material, and the one that has the rest.
    pub(crate) other: Option<(f32, Box<Local<'a>>)>,
}

impl<'a> Local<'a> {
    /// `to_eye` is a unit vector that leaves the surface.
    #[inline(always)]
    pub(crate) fn new(material: &'a Material, normal: Vec3, to_eye: Vec3) -> Self {
        let frame = match material {
            Material::Model { up: Some(up), .. } => Frame::upright(normal, *up),
            _ => Frame::about(normal),
        };
        Local::within(material, frame, to_eye)
    }

    #[inline(always)]
    fn within(material: &'a Material, frame: Frame, to_eye: Vec3) -> Self {
        let to_eye_local = frame.local(to_eye);
        let to_eye = match material {
            Material::Model { .. } => frame.direction(to_eye),
            _ => Direction::NORMAL,
        };
        Local {
            material,
            frame,
            to_eye,
            to_eye_local,
            paint: None,
            flat: None,
            sight: None,
            other: None,
        }
    }

    /// With another normal than that of the surface, turned towards the eye as far as it must be to lie on its side, and
    /// another direction that the y axis is closest to.
    pub(crate) fn bent(
        material: &'a Material,
        flat: Vec3,
        normal: Vec3,
        up: Option<Vec3>,
        to_eye: Vec3,
    ) -> Self {
        /// Least cosine to the eye.
        const LEAST: f32 = 1e-3;
        let side = 1.0_f32.copysign(flat.dot(to_eye));
        let cos = side * normal.dot(to_eye);
        let normal = if cos >= LEAST {
            normal
        } else {
            (normal + side * (LEAST - cos) * to_eye).normalize_or(flat)
        };
        Local {
            flat: Some(flat),
            ..match up {
                Some(up) => Local::within(material, Frame::upright(normal, up), to_eye),
                None => Local::new(material, normal, to_eye),
            }
        }
    }

    /// With a share of this material and the rest of another.
    pub(crate) fn mixed(mut self, share: f32, other: Local<'a>) -> Self {
        if self.other.is_some() {
            // A mixture of mixtures: the rest goes to the end of the list.
            return self.mixed_on(share, other);
        }
        self.other = Some((share, Box::new(other)));
        self
    }

    fn mixed_on(mut self, share: f32, other: Local<'a>) -> Self {
        if let Some((own, rest)) = self.other.take() {
            // share (own A + (1 - own) B) + (1 - share) C = first A + (1 - first) (second B + (1 - second) C)
            let first = share * own;
            let second = share * (1.0 - own) / (1.0 - first);
            self.other = Some((first, Box::new(rest.mixed(second, other))));
        }
        self
    }

    /// Whether a direction lies on the same side of the surface as of the normal that the material shows.
    #[inline(always)]
    pub(crate) fn agrees(&self, from: Vec3) -> bool {
        self.flat
            .is_none_or(|flat| flat.dot(from) * self.frame.z.dot(from) > 0.0)
    }

    /// With a factor on all of the material but `bare`.
    pub(crate) fn painted(mut self, factor: Vec3, bare: Option<&'a dyn Bsdf>) -> Self {
        self.paint = Some((factor, bare));
        self
    }

    /// A value of the material, which `bare` gives of the part without the pattern.
    #[inline(always)]
    pub(crate) fn coloured(&self, value: Vec3, bare: impl FnOnce(&dyn Bsdf) -> Vec3) -> Vec3 {
        match self.paint {
            None => value,
            Some((factor, None)) => factor * value,
            Some((factor, Some(model))) => {
                let bare = bare(model);
                // The pattern may be black where the difference is all rounding.
                bare + factor * (value - bare).max(Vec3::ZERO)
            }
        }
    }

    /// The reflectance of a Lambertian reflector, with its pattern; `None` where a texture turns its normal.
    #[inline(always)]
    pub(crate) fn lambertian(&self) -> Option<Vec3> {
        match self.material {
            _ if self.flat.is_some() || self.other.is_some() => None,
            Material::Diffuse { reflectance } => Some(self.coloured(*reflectance, |_| Vec3::ZERO)),
            _ => None,
        }
    }

    /// Towards the eye, in the world.
    #[inline(always)]
    pub(crate) fn eye(&self) -> Vec3 {
        self.frame.world(self.to_eye_local)
    }

    /// `f |cos|` for light from `from` (unit, leaves the surface), and the density with which it would be drawn.
    #[inline(always)]
    pub(crate) fn eval(&self, from: Vec3) -> (Vec3, f32) {
        match &self.other {
            None => self.eval_one(from),
            Some((share, other)) => self.eval_both(from, *share, other),
        }
    }

    #[inline(never)]
    fn eval_both(&self, from: Vec3, share: f32, other: &Local<'a>) -> (Vec3, f32) {
        let ((f, p), (g, q)) = (self.eval_one(from), other.eval(from));
        (share * f + (1.0 - share) * g, share * p + (1.0 - share) * q)
    }

    /// One of the two draws the direction, by chance.
    #[inline(never)]
    fn sample_both(&self, [u, v, w]: [f32; 3], share: f32, other: &Local<'a>) -> Option<Drawn> {
        let drawn = if w < share {
            self.sample_one([u, v, (w / share).min(BELOW_ONE)])
        } else {
            other.sample([u, v, ((w - share) / (1.0 - share)).min(BELOW_ONE)])
        };
        let direction = drawn?.direction;
        let (f, pdf) = self.eval_both(direction, share, other);
        (pdf > 0.0).then(|| Drawn {
            direction,
            weight: f / pdf,
            pdf,
        })
    }

    #[inline(always)]
    fn eval_one(&self, from: Vec3) -> (Vec3, f32) {
        if !self.agrees(from) {
            return (Vec3::ZERO, 0.0);
        }
        match self.material {
            Material::Nothing | Material::Black => (Vec3::ZERO, 0.0),
            Material::Function(_) => self.eval_function(from),
            Material::Diffuse { reflectance } => {
                let cos = self.frame.z.dot(from);
                if cos * self.to_eye_local.z <= 0.0 {
                    return (Vec3::ZERO, 0.0);
                }
                let pdf = cos.abs() * std::f32::consts::FRAC_1_PI;
                (self.coloured(*reflectance * pdf, |_| Vec3::ZERO), pdf)
            }
            Material::Model { model, .. } => {
                let wi = self.frame.direction(from);
                let f = self.coloured(rgb(model.as_ref(), |f| model.eval(wi, self.to_eye, f)), |bare| {
                    rgb(bare, |f| bare.eval(wi, self.to_eye, f))
                });
                let pdf = model.pdf(self.to_eye, wi) as f32;
                (f * wi.cos_theta().abs() as f32, pdf)
            }
        }
    }

    /// A direction from which scattered light comes; ideal directions are [`Local::ideal`].
    #[inline(always)]
    pub(crate) fn sample(&self, u: [f32; 3]) -> Option<Drawn> {
        match &self.other {
            None => self.sample_one(u),
            Some((share, other)) => self.sample_both(u, *share, other),
        }
    }

    #[inline(always)]
    fn sample_one(&self, u: [f32; 3]) -> Option<Drawn> {
        self.draw(u).filter(|drawn| self.agrees(drawn.direction))
    }

    #[inline(always)]
    fn draw(&self, u: [f32; 3]) -> Option<Drawn> {
        match self.material {
            Material::Nothing | Material::Black => None,
            Material::Function(_) => self.draw_function(u),
            Material::Diffuse { reflectance } => {
                let side = 1.0_f32.copysign(self.to_eye_local.z);
                let local = cosine_weighted([u[0], u[1]]) * Vec3::new(1.0, 1.0, side);
                let pdf = local.z.abs() * std::f32::consts::FRAC_1_PI;
                (pdf > 0.0).then(|| Drawn {
                    direction: self.frame.world(local),
                    weight: self.coloured(*reflectance, |_| Vec3::ZERO),
                    pdf,
                })
            }
            Material::Model { model, .. } => {
                let drawn = model.sample(self.to_eye, u.map(f64::from))?;
                if drawn.lobe == Lobe::Delta {
                    return None;
                }
                let direction = self.frame.vector(drawn.direction);
                let pdf = drawn.pdf as f32;
                let f = self.coloured(
                    rgb(model.as_ref(), |f| model.eval(drawn.direction, self.to_eye, f)),
                    |bare| rgb(bare, |f| bare.eval(drawn.direction, self.to_eye, f)),
                );
                let weight = f * (drawn.direction.cos_theta().abs() / drawn.pdf) as f32;
                Some(Drawn {
                    direction,
                    weight,
                    pdf,
                })
            }
        }
    }
}

/// The three values of a model of one or three channels.
#[inline]
pub(crate) fn rgb(model: &dyn Bsdf, fill: impl FnOnce(&mut [f64])) -> Vec3 {
    if model.channels().len() == 1 {
        let mut f = [0.0];
        fill(&mut f);
        return Vec3::splat(f[0] as f32);
    }
    let mut f = [0.0; 3];
    fill(&mut f);
    Vec3::new(f[0] as f32, f[1] as f32, f[2] as f32)
}
