//! The parts without width: mirrored, straight through, refracted.

use gonio_geom::{Component, Direction, Side};

use super::fresnel::Interface;
use super::{CHANNELS, Dielectric, Glass, Rgb};
use crate::{Bsdf, Channel, Lobe, Properties, Sample};

/// What decides the share of the light and its direction.
#[derive(Clone, Debug)]
pub(super) enum Law {
    /// The same share at every angle on the front; black on the back.
    Mirror(Rgb),
    /// The gloss of smooth plastic, metal and trans, in this colour at normal incidence.
    Gloss(Rgb, Interface),
    /// The share of the entering light that passes a smooth trans.
    Through(Rgb, Interface),
    /// Reflection by a pane.
    PaneReflection(Glass),
    /// Transmission by a pane.
    PaneTransmission(Glass),
    /// Reflection at the boundary of a body.
    BodyReflection(Dielectric),
    /// Refraction at the boundary of a body.
    BodyRefraction(Dielectric),
}

/// One ideal part.
#[derive(Clone, Debug)]
pub(super) struct Ideal(pub(super) Law);

impl Ideal {
    fn component(&self) -> Component {
        match self.0 {
            Law::Mirror(_) | Law::Gloss(..) | Law::PaneReflection(_) | Law::BodyReflection(_) => {
                Component::Reflection
            }
            Law::Through(..) | Law::PaneTransmission(_) | Law::BodyRefraction(_) => Component::Transmission,
        }
    }

    fn shares(&self, w: Direction) -> Rgb {
        let cos = w.cos_theta().abs();
        match &self.0 {
            Law::Mirror(color) if w.side() == Side::Front => *color,
            Law::Mirror(_) => [0.0; 3],
            Law::Gloss(color, interface) => color.map(|c| interface.reflected(c, cos)),
            Law::Through(color, interface) => color.map(|c| c * interface.entering(cos)),
            Law::PaneReflection(glass) => glass.reflectance(cos),
            Law::PaneTransmission(glass) => glass.transmittance(cos),
            Law::BodyReflection(body) => [body.reflectance(w); 3],
            Law::BodyRefraction(body) => [1.0 - body.reflectance(w); 3],
        }
    }

    fn direction(&self, w: Direction) -> Option<Direction> {
        match &self.0 {
            Law::BodyRefraction(body) => body.refracted(w),
            _ if self.component() == Component::Transmission => Some(w.through()),
            _ => Some(w.mirror()),
        }
    }
}

impl Bsdf for Ideal {
    fn channels(&self) -> &[Channel] {
        &CHANNELS
    }

    fn properties(&self) -> Properties {
        Properties {
            reciprocal: true,
            energy_conserving: true,
            isotropic: true,
        }
    }

    fn eval(&self, _wi: Direction, _ws: Direction, f: &mut [f64]) {
        f.fill(0.0);
    }

    fn delta(&self, w: Direction, component: Component, shares: &mut [f64]) -> Option<Direction> {
        shares.fill(0.0);
        if component != self.component() || w.cos_theta() == 0.0 {
            return None;
        }
        let direction = self.direction(w)?;
        let found = self.shares(w);
        shares.iter_mut().zip(found).for_each(|(s, v)| *s = v);
        found.iter().any(|&v| v > 0.0).then_some(direction)
    }

    fn pdf(&self, _w: Direction, _sampled: Direction) -> f64 {
        0.0
    }

    fn sample(&self, w: Direction, _u: [f64; 3]) -> Option<Sample> {
        let mut shares = [0.0; 3];
        let direction = self.delta(w, self.component(), &mut shares)?;
        Some(Sample {
            direction,
            weight: shares[0],
            pdf: 1.0,
            lobe: Lobe::Delta,
        })
    }
}
