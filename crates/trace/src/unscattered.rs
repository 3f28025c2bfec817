//! Light that materials mirror or let through without spread.

use glam::Vec3;
use gonio_geom::Component;

use crate::material::{Local, Material, rgb};

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
    /// Light of two materials, which leave it the same direction: a scene does not mix those that do not.
    fn both(a: Option<Self>, share_a: f32, b: Option<Self>, share_b: f32) -> Option<Self> {
        let share = |way: Option<Self>, share: f32| way.map_or(Vec3::ZERO, |w| share * w.share);
        let sum = share(a, share_a) + share(b, share_b);
        Some(Unscattered {
            share: sum,
            ..a.or(b)?
        })
    }

    pub(crate) fn straight(direction: Vec3, share: Vec3) -> Self {
        Unscattered {
            direction,
            share,
            straight: true,
        }
    }
}

impl Local<'_> {
    /// Where light comes from without being scattered, mirrored and transmitted, and its share.
    #[inline]
    pub(crate) fn ideal(&self) -> [Option<Unscattered>; 2] {
        match &self.other {
            None => self.ideal_one(),
            Some((share, other)) => {
                let (own, others) = (self.ideal_one(), other.ideal());
                std::array::from_fn(|k| Unscattered::both(own[k], *share, others[k], 1.0 - share))
            }
        }
    }

    #[inline]
    fn ideal_one(&self) -> [Option<Unscattered>; 2] {
        let mirrored = match self.material {
            Material::Model { ideal: true, .. } => self.unscattered(Component::Reflection),
            Material::Function(_) => self.mirrored_function(),
            _ => None,
        };
        [mirrored, self.transmitted_one()]
    }

    /// The transmitted one of [`Local::ideal`].
    #[inline]
    pub(crate) fn transmitted(&self) -> Option<Unscattered> {
        match &self.other {
            None => self.transmitted_one(),
            Some((share, other)) => {
                Unscattered::both(self.transmitted_one(), *share, other.transmitted(), 1.0 - share)
            }
        }
    }

    #[inline]
    fn transmitted_one(&self) -> Option<Unscattered> {
        match self.material {
            Material::Nothing => Some(Unscattered::straight(
                -self.frame.world(self.to_eye_local),
                Vec3::ONE,
            )),
            Material::Model { ideal: true, .. } => self.unscattered(Component::Transmission),
            Material::Function(_) => self.straight_function(),
            _ => None,
        }
    }

    fn unscattered(&self, component: Component) -> Option<Unscattered> {
        let Material::Model { model, .. } = self.material else {
            return None;
        };
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
        let direction = self.frame.vector(to);
        self.agrees(direction).then_some(Unscattered {
            direction,
            share,
            straight: false,
        })
    }
}
