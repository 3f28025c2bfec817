//! The data-driven model as a `Bsdf`: evaluated, and drawn from.

use std::sync::Arc;

use gonio_bsdf::{Bsdf, Channel, Lobe, Properties, Sample};
use gonio_geom::{Component, DVec3, Direction, Side};

use super::{DataDriven, side_index, up};
use crate::sampling::Proposal;
use crate::slice_surface::Coverage;

impl DataDriven {
    /// What directions are drawn from for light on `side`; made when first asked for.
    fn proposal(&self, side: Side) -> &Proposal {
        self.proposals[side_index(side)].get_or_init(|| {
            let components: Vec<_> = [Component::Reflection, Component::Transmission]
                .into_iter()
                .filter(|c| self.parts.get(side, *c).is_some())
                .map(|c| (c, self.bases.get(side, c).cloned()))
                .collect();
            Arc::new(Proposal::new(&components, self.isotropic, |c, i, s| {
                self.parts.get(side, c).map_or(0.0, |p| p.eval(i, s))
            }))
        })
    }

    /// Probability of drawing the ideal direction of each component for light from `w`.
    fn direct_chances(&self, w: Direction) -> [(Component, f64); 2] {
        let i = up(w);
        let share = |c| self.direct.get(w.side(), c).map_or(0.0, |d| d.share(i));
        let pair = [Component::Reflection, Component::Transmission].map(|c| (c, share(c)));
        let ideal = pair[0].1 + pair[1].1;
        if ideal <= 0.0 {
            return pair;
        }
        let all = ideal + self.proposal(w.side()).albedo(i);
        pair.map(|(c, share)| (c, share / all))
    }
}

impl Bsdf for DataDriven {
    fn channels(&self) -> &[Channel] {
        &self.channel
    }

    fn properties(&self) -> Properties {
        Properties {
            reciprocal: false,
            energy_conserving: self.energy_conserving,
            isotropic: self.isotropic,
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        if let Some(first) = f.first_mut() {
            *first = self.eval_first(wi, ws);
        }
    }

    #[inline]
    fn eval_first(&self, wi: Direction, ws: Direction) -> f64 {
        let (side, to) = (wi.side(), ws.side());
        if ws.cos_theta() == 0.0 {
            return 0.0;
        }
        let Some(part) = self.parts.get(side, Component::between(side, to)) else {
            return 0.0;
        };
        let i = up(wi);
        let f = part.eval(i, up(ws)) * self.cap_factor(part, side, i);
        if f.is_finite() { f } else { 0.0 }
    }

    fn delta(&self, w: Direction, component: Component, shares: &mut [f64]) -> Option<Direction> {
        shares.fill(0.0);
        let direct = self.direct.get(w.side(), component)?;
        let part = self.parts.get(w.side(), component)?;
        let i = up(w);
        let share = direct.share(i) * self.cap_factor(part, w.side(), i);
        *shares.first_mut()? = share;
        let straight = match component {
            Component::Reflection => w.mirror(),
            Component::Transmission => w.through(),
        };
        (share > 0.0 && w.cos_theta() != 0.0).then_some(straight)
    }

    fn has_data(&self, wi: Direction, ws: Direction) -> bool {
        matches!(self.coverage(wi, ws), Coverage::Measured | Coverage::Interpolated)
    }

    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        if w.cos_theta() == 0.0 || sampled.cos_theta() == 0.0 {
            return 0.0;
        }
        let component = Component::between(w.side(), sampled.side());
        let scattered = 1.0 - self.direct_chances(w).iter().map(|c| c.1).sum::<f64>();
        scattered * self.proposal(w.side()).density(component, up(w), up(sampled))
    }

    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        if w.cos_theta() == 0.0 {
            return None;
        }
        let mut rest = u[2];
        let chances = self.direct_chances(w);
        for (component, chance) in chances {
            if rest < chance {
                let mut share = [0.0];
                let direction = self.delta(w, component, &mut share)?;
                return Some(Sample {
                    direction,
                    weight: share[0] / chance,
                    pdf: chance,
                    lobe: Lobe::Delta,
                });
            }
            rest -= chance;
        }
        let scattered = 1.0 - chances.iter().map(|c| c.1).sum::<f64>();
        let within = (rest / scattered).clamp(0.0, 1.0 - f64::EPSILON);
        let (component, s) = self.proposal(w.side()).draw(up(w), [u[0], u[1], within])?;
        let to = component.scattered_side(w.side());
        let direction = Direction::new(DVec3::new(s.x, s.y, to.sign() * s.z))?;
        let pdf = Bsdf::pdf(self, w, direction);
        let weight = self.eval_first(w, direction) * direction.cos_theta().abs() / pdf;
        (pdf > 0.0 && weight > 0.0 && weight.is_finite()).then_some(Sample {
            direction,
            weight,
            pdf,
            lobe: Lobe::Glossy,
        })
    }
}
