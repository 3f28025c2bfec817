//! What surfaces do with light.

use std::sync::Arc;

use glam::Vec3;
use gonio_bsdf::{Bsdf, Lobe};
use gonio_geom::{Component, Direction};

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
}

impl Material {
    /// A model of one or three channels; `up` orients one with axes.
    pub fn model(model: Arc<dyn Bsdf>, up: Option<Vec3>) -> Self {
        let ideal = model.has_delta();
        Material::Model { model, up, ideal }
    }
}

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
    material: &'a Material,
    frame: Frame,
    /// Towards the eye, in the frame.
    to_eye: Direction,
    to_eye_local: Vec3,
    /// The factor of a pattern, and the part of the material without it.
    paint: Option<(Vec3, Option<&'a dyn Bsdf>)>,
}

impl<'a> Local<'a> {
    /// `to_eye` is a unit vector that leaves the surface.
    #[inline(always)]
    pub(crate) fn new(material: &'a Material, normal: Vec3, to_eye: Vec3) -> Self {
        let frame = match material {
            Material::Model { up: Some(up), .. } => Frame::upright(normal, *up),
            _ => Frame::about(normal),
        };
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
        }
    }

    /// With a factor on all of the material but `bare`.
    pub(crate) fn painted(mut self, factor: Vec3, bare: Option<&'a dyn Bsdf>) -> Self {
        self.paint = Some((factor, bare));
        self
    }

    /// A value of the material, which `bare` gives of the part without the pattern.
    #[inline(always)]
    fn coloured(&self, value: Vec3, bare: impl FnOnce(&dyn Bsdf) -> Vec3) -> Vec3 {
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

    /// `f |cos|` for light from `from` (unit, leaves the surface), and the density with which it would be drawn.
    #[inline(always)]
    pub(crate) fn eval(&self, from: Vec3) -> (Vec3, f32) {
        match self.material {
            Material::Nothing | Material::Black => (Vec3::ZERO, 0.0),
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
        match self.material {
            Material::Nothing | Material::Black => None,
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

    /// Where light comes from without being scattered, mirrored and transmitted, and its share.
    #[inline]
    pub(crate) fn ideal(&self) -> [Option<Unscattered>; 2] {
        match self.material {
            Material::Nothing => [
                None,
                Some(Unscattered::straight(
                    -self.frame.world(self.to_eye_local),
                    Vec3::ONE,
                )),
            ],
            Material::Model {
                model, ideal: true, ..
            } => [Component::Reflection, Component::Transmission].map(|component| {
                let mut to = None;
                let share = rgb(model.as_ref(), |s| to = model.delta(self.to_eye, component, s));
                let share = self.coloured(share, |bare| {
                    rgb(bare, |s| {
                        bare.delta(self.to_eye, component, s);
                    })
                });
                let to = to.filter(|_| share.max_element() > 0.0)?;
                if to.vec().dot(self.to_eye.vec()) < -1.0 + 1e-9 {
                    return Some(Unscattered::straight(-self.frame.world(self.to_eye_local), share));
                }
                Some(Unscattered {
                    direction: self.frame.vector(to),
                    share,
                    straight: false,
                })
            }),
            _ => [None, None],
        }
    }
}

/// Light that arrives unscattered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unscattered {
    /// Where it comes from, in the world.
    pub(crate) direction: Vec3,
    pub(crate) share: Vec3,
    /// Whether it goes on as it came.
    pub(crate) straight: bool,
}

impl Unscattered {
    fn straight(direction: Vec3, share: Vec3) -> Self {
        Unscattered {
            direction,
            share,
            straight: true,
        }
    }
}

/// The three values of a model of one or three channels.
#[inline]
fn rgb(model: &dyn Bsdf, fill: impl FnOnce(&mut [f64])) -> Vec3 {
    if model.channels().len() == 1 {
        let mut f = [0.0];
        fill(&mut f);
        return Vec3::splat(f[0] as f32);
    }
    let mut f = [0.0; 3];
    fill(&mut f);
    Vec3::new(f[0] as f32, f[1] as f32, f[2] as f32)
}
