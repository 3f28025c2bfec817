//! Mixtures of materials [Radiance, rt/m_mixture.c].

use gonio_bsdf::RadianceMaterial;
use gonio_io::radiance_material::Body;
use gonio_trace::pattern::{Layer, Mixture};

use super::Assembly;
use super::material::{Above, Look};
use super::modifier::type_word;
use crate::error::SceneError;

/// Mixtures within one another, at most.
const DEEPEST: usize = 8;

impl Assembly<'_> {
    /// The look of mixture `k`, `above` what stands before it on the way from the surface.
    pub(super) fn mixture(&mut self, k: usize, mut above: Above) -> Result<Look, SceneError> {
        let modifier = self.modifiers.get(k).clone();
        let place = &modifier.place;
        let Body::Other { strings, .. } = &*modifier.body else {
            return Err(place.fault("type", "no mixture", "mixfunc, mixdata, mixpict"));
        };
        let [first, second, rest @ ..] = strings.as_slice() else {
            let allowed = "two materials, and the function of their shares";
            return Err(place.fault("string arguments", strings.len().to_string(), allowed));
        };
        above.mixtures += 1;
        if above.mixtures > DEEPEST {
            let allowed = format!("mixtures {DEEPEST} within one another");
            return Err(place.fault("mixture", format!("{:?}", modifier.id), allowed));
        }
        let share = super::pattern::share(&modifier, rest, self.files)?;
        let mut pane = None;
        let mut layers = [Layer::default(); 2];
        for (layer, name) in layers.iter_mut().zip([first, second]) {
            let Some(of) = self.modifiers.find_above(k, name, "mixture", place)? else {
                layer.material = self.nothing();
                continue;
            };
            let look = self.make_look(of, above.clone())?;
            if look.proxy != 0.0 {
                return Err(place.fault("mixture", "a BSDF with a thickness", "a surface without one"));
            }
            pane = pane.or(look.pane);
            *layer = Layer {
                material: match look.material {
                    Some(material) => material,
                    None => self.nothing(),
                },
                paint: look.paint,
                texture: look.texture,
                mixture: look.mixture,
                up: look.up,
            };
        }
        self.parts.mixtures.push(Mixture { share, layers });
        Ok(Look {
            // Only its place is taken: the mixture is shown.
            material: Some(layers[0].material),
            mixture: Some((self.parts.mixtures.len() - 1) as u32),
            pane,
            ..Look::default()
        })
    }
}

/// Whether a material bends light that passes: mixed with another, one ray would have two ways.
pub(super) fn bends(body: &Body) -> bool {
    match body {
        Body::Material(m) => matches!(m, RadianceMaterial::Dielectric(_)),
        other => type_word(other) == "interface",
    }
}
