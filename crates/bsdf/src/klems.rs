//! Klems matrices: a BSDF constant over pairs of patches.
//!
//! Indices follow the Radiance and WINDOW files: the incident patch of `wi` is found with its azimuth turned by
//! 180 degrees, so mirror reflection and unbent transmission lie on the diagonal [Klems1994; WardEtAl2011].

pub mod basis;
mod sample;

use gonio_geom::{Component, Direction, Side};

use crate::{Bsdf, BsdfError, Channel, FourComponents, Properties, Sample};
pub use basis::{KlemsBasis, Ring, Role};
use sample::PatchCdf;

/// The BSDF of one component: a value in 1/sr for each pair of incident and exit patch.
///
/// Values are single precision, as Radiance keeps them, so that a file round trip is exact.
#[derive(Clone, Debug, PartialEq)]
pub struct KlemsMatrix {
    incident: KlemsBasis,
    exit: KlemsBasis,
    values: Vec<f32>,
}

impl KlemsMatrix {
    /// A matrix of `values[exit * n_incident + incident]` in 1/sr, no cosine inside.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] when the number of values does not match the bases or a value is negative or not finite.
    pub fn new(incident: KlemsBasis, exit: KlemsBasis, values: Vec<f32>) -> Result<Self, BsdfError> {
        let wanted = incident.len() * exit.len();
        if values.len() != wanted {
            return Err(BsdfError::Domain {
                field: "number of matrix values",
                found: values.len().to_string(),
                allowed: format!("{} exit x {} incident = {wanted}", exit.len(), incident.len()),
            });
        }
        check_values(&values)?;
        Ok(KlemsMatrix {
            incident,
            exit,
            values,
        })
    }

    /// Basis of the incident directions (columns).
    pub fn incident(&self) -> &KlemsBasis {
        &self.incident
    }

    /// Basis of the exit directions (rows).
    pub fn exit(&self) -> &KlemsBasis {
        &self.exit
    }

    /// The values, exit patch by exit patch.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The value of a pair of patches, 1/sr (panics past the last patch).
    pub fn value(&self, exit: usize, incident: usize) -> f64 {
        f64::from(self.values[exit * self.incident.len() + incident])
    }

    /// Directional albedo of incident patch `incident`: `sum_exit f Lambda`.
    pub fn albedo(&self, incident: usize) -> f64 {
        let lambda = self.exit.lambda();
        (0..self.exit.len())
            .map(|o| self.value(o, incident) * lambda[o])
            .sum()
    }
}

/// Refuses values that are no BSDF.
pub(crate) fn check_values(values: &[f32]) -> Result<(), BsdfError> {
    match values.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
        Some(bad) => Err(BsdfError::Domain {
            field: "bsdf",
            found: bad.to_string(),
            allowed: "finite and not negative".into(),
        }),
        None => Ok(()),
    }
}

/// A Klems model: up to four matrices.
///
/// Transmission that is absent for one side is answered from the other side's matrix by reciprocity
/// (`f_t(wi, ws) = f_t(ws, wi)`), as Radiance does. Everything else that is absent is 0. A matrix is piecewise
/// constant and what it was filled with: reciprocity and energy conservation are not promised.
#[derive(Clone, Debug)]
pub struct Klems {
    channels: [Channel; 1],
    matrices: FourComponents<KlemsMatrix>,
    cdf: [PatchCdf; 2],
}

impl PartialEq for Klems {
    fn eq(&self, other: &Self) -> bool {
        self.channels == other.channels && self.matrices == other.matrices
    }
}

/// Where the answer for one (side of incidence, component) comes from.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) matrix: &'a KlemsMatrix,
    /// Looked up with incidence and exit exchanged.
    pub(crate) reversed: bool,
}

impl Source<'_> {
    fn value(&self, wi: Direction, ws: Direction) -> f64 {
        let (i, o) = if self.reversed { (ws, wi) } else { (wi, ws) };
        let m = self.matrix;
        m.value(m.exit.patch(o, Role::Exit), m.incident.patch(i, Role::Incident))
    }
}

pub(crate) fn source(
    matrices: &FourComponents<KlemsMatrix>,
    side: Side,
    component: Component,
) -> Option<Source<'_>> {
    if let Some(matrix) = matrices.get(side, component) {
        return Some(Source {
            matrix,
            reversed: false,
        });
    }
    if component == Component::Transmission {
        return matrices.get(side.opposite(), component).map(|matrix| Source {
            matrix,
            reversed: true,
        });
    }
    None
}

impl Klems {
    /// A model of the given matrices for `channel`.
    pub fn new(channel: Channel, matrices: FourComponents<KlemsMatrix>) -> Self {
        let cdf = Side::BOTH.map(|side| PatchCdf::new(&matrices, side));
        Klems {
            channels: [channel],
            matrices,
            cdf,
        }
    }

    /// The matrices.
    pub fn matrices(&self) -> &FourComponents<KlemsMatrix> {
        &self.matrices
    }

    /// The matrix for light that arrives on `side`, when there is one.
    pub fn matrix(&self, side: Side, component: Component) -> Option<&KlemsMatrix> {
        self.matrices.get(side, component)
    }

    /// Greatest directional albedo, reflection and transmission of one side together, over the incident patches.
    pub fn max_albedo(&self) -> f64 {
        let both = [Component::Reflection, Component::Transmission];
        let of = |side: Side| {
            let matrices: Vec<&KlemsMatrix> = both.iter().filter_map(|c| self.matrix(side, *c)).collect();
            let n = matrices.iter().map(|m| m.incident.len()).max().unwrap_or(0);
            (0..n)
                .map(|i| {
                    let there = matrices.iter().filter(|m| i < m.incident.len());
                    there.map(|m| m.albedo(i)).sum::<f64>()
                })
                .fold(0.0, f64::max)
        };
        Side::BOTH.into_iter().map(of).fold(0.0, f64::max)
    }

    /// Directional-hemispherical reflectance or transmittance at `wi`; 0 where the model has no such component.
    pub fn directional_albedo(&self, wi: Direction, component: Component) -> f64 {
        let Some(s) = source(&self.matrices, wi.side(), component) else {
            return 0.0;
        };
        let m = s.matrix;
        if s.reversed {
            let o = m.exit.patch(wi, Role::Exit);
            let lambda = m.incident.lambda();
            (0..m.incident.len()).map(|i| m.value(o, i) * lambda[i]).sum()
        } else {
            m.albedo(m.incident.patch(wi, Role::Incident))
        }
    }
}

impl Bsdf for Klems {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn properties(&self) -> Properties {
        Properties {
            reciprocal: false,
            energy_conserving: false,
            isotropic: false,
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        f[0] = self.eval_first(wi, ws);
    }

    fn eval_first(&self, wi: Direction, ws: Direction) -> f64 {
        if ws.cos_theta() == 0.0 {
            return 0.0;
        }
        let component = Component::between(wi.side(), ws.side());
        source(&self.matrices, wi.side(), component).map_or(0.0, |s| s.value(wi, ws))
    }

    fn holds(&self, wi: Direction, ideal: Direction, ws: Direction) -> bool {
        let component = Component::between(wi.side(), ws.side());
        ideal.side() == ws.side()
            && source(&self.matrices, wi.side(), component).is_some_and(|s| {
                let (basis, role) = if s.reversed {
                    (&s.matrix.incident, Role::Incident)
                } else {
                    (&s.matrix.exit, Role::Exit)
                };
                basis.patch(ideal, role) == basis.patch(ws, role)
            })
    }

    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        let total = self.directional_albedo(w, Component::Reflection)
            + self.directional_albedo(w, Component::Transmission);
        if total <= 0.0 {
            return 0.0;
        }
        self.eval_first(w, sampled) * sampled.cos_theta().abs() / total
    }

    /// Exact: a patch by its share of the albedo, then a point uniform in projected solid angle. The weight is the
    /// albedo of the incident patch (reflection and transmission together).
    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        self.cdf[usize::from(w.side() == Side::Back)].sample(self, w, u)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn matrix(f: impl Fn(usize, usize) -> f32) -> KlemsMatrix {
        let b = KlemsBasis::quarter();
        let n = b.len();
        let values = (0..n * n).map(|k| f(k / n, k % n)).collect();
        KlemsMatrix::new(b.clone(), b, values).unwrap()
    }

    fn model(keys: &[(Side, Component, KlemsMatrix)]) -> Klems {
        let mut four = FourComponents::default();
        for (s, c, m) in keys {
            four.set(*s, *c, Some(m.clone()));
        }
        Klems::new(Channel::Photopic, four)
    }

    #[test]
    fn a_constant_matrix_has_albedo_pi_times_its_value() {
        let k = model(&[(
            Side::Front,
            Component::Reflection,
            matrix(|_, _| (0.5 / PI) as f32),
        )]);
        for theta in [0.0, 40.0, 89.0] {
            let wi = Direction::from_degrees(theta, 30.0);
            assert!((k.directional_albedo(wi, Component::Reflection) - 0.5).abs() < 1e-7);
            assert_eq!(k.directional_albedo(wi, Component::Transmission), 0.0);
            assert_eq!(k.eval_first(wi, Direction::from_degrees(120.0, 0.0)), 0.0);
        }
    }

    #[test]
    fn the_four_components_answer_for_their_own_sides_only() {
        let k = model(&[
            (Side::Front, Component::Reflection, matrix(|_, _| 0.1)),
            (Side::Front, Component::Transmission, matrix(|_, _| 0.2)),
            (Side::Back, Component::Reflection, matrix(|_, _| 0.3)),
            (Side::Back, Component::Transmission, matrix(|_, _| 0.4)),
        ]);
        let up = Direction::from_degrees(30.0, 0.0);
        let down = Direction::from_degrees(150.0, 0.0);
        let f = |a, b| (k.eval_first(a, b) * 10.0).round() as i32;
        assert_eq!([f(up, up), f(up, down), f(down, down), f(down, up)], [1, 2, 3, 4]);
    }

    #[test]
    fn absent_transmission_is_answered_from_the_other_side_by_reciprocity() {
        let k = model(&[(
            Side::Front,
            Component::Transmission,
            matrix(|o, i| (100 * o + i) as f32 * 1e-5),
        )]);
        for (a, b) in [(10.0, 20.0), (50.0, 100.0), (80.0, 300.0)] {
            let up = Direction::from_degrees(a, b);
            let down = Direction::from_degrees(180.0 - b / 4.0, a);
            assert_eq!(k.eval_first(down, up), k.eval_first(up, down));
        }
    }

    #[test]
    fn samples_stay_where_the_model_scatters_and_carry_the_albedo() {
        let k = model(&[
            (
                Side::Front,
                Component::Reflection,
                matrix(|o, i| if o == i { 0.3 } else { 0.01 }),
            ),
            (
                Side::Front,
                Component::Transmission,
                matrix(|o, _| (o % 3) as f32 * 0.05),
            ),
        ]);
        for wi in [
            Direction::from_degrees(33.0, 70.0),
            Direction::from_degrees(140.0, 200.0),
        ] {
            let albedo = k.directional_albedo(wi, Component::Reflection)
                + k.directional_albedo(wi, Component::Transmission);
            let n = 2000;
            let mut inverse = 0.0;
            for j in 0..n {
                let t = f64::from(j);
                let u = [
                    (t * 0.8191725134).fract(),
                    (t * 0.6710436067).fract(),
                    (t * 0.5497004779).fract(),
                ];
                let s = k.sample(wi, u).unwrap();
                let f = k.eval_first(wi, s.direction);
                assert!((s.pdf - k.pdf(wi, s.direction)).abs() < 1e-9 * s.pdf);
                assert!((s.weight - f * s.direction.cos_theta().abs() / s.pdf).abs() < 1e-9);
                assert!((s.weight - albedo).abs() < 1e-9);
                inverse += s.direction.cos_theta().abs() / s.pdf / f64::from(n);
            }
            // E[cos / pdf] is the projected solid angle of the support
            let support: f64 = if wi.side() == Side::Front {
                let l = KlemsBasis::quarter();
                PI + (0..l.len())
                    .filter(|o| !o.is_multiple_of(3))
                    .map(|o| l.lambda()[o])
                    .sum::<f64>()
            } else {
                let o = KlemsBasis::quarter().patch(wi, Role::Exit);
                if o.is_multiple_of(3) { 0.0 } else { PI }
            };
            assert!(
                (inverse - support).abs() < 0.05 * support + 1e-12,
                "{inverse} {support}"
            );
        }
    }

    #[test]
    fn values_that_are_no_bsdf_are_refused() {
        let b = KlemsBasis::quarter();
        assert!(KlemsMatrix::new(b.clone(), b.clone(), vec![0.0; 3]).is_err());
        let mut v = vec![0.0; b.len() * b.len()];
        v[5] = f32::NAN;
        assert!(KlemsMatrix::new(b.clone(), b.clone(), v.clone()).is_err());
        v[5] = -1.0;
        assert!(KlemsMatrix::new(b.clone(), b, v).is_err());
    }
}
