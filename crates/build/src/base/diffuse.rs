//! The diffuse part under a glossy coat: darker towards grazing incidence and exit.

use std::f64::consts::PI;

use gonio_bsdf::analytic::{Formula, ModelInfo, Pair, ParameterInfo, Real, Role, Scatters};
use gonio_geom::{DVec3, Direction};

/// `f = rho (1 - (1 - c_i)^5) (1 - (1 - c_s)^5) / pi`: what Schlick's reflectance \[Schlick1994, eq. 15\] with `f0 = 0`
/// lets into a coat and out of it again. Reciprocal; its albedo stays below `rho`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coated;

static INFO: ModelInfo = ModelInfo {
    name: "coated-diffuse",
    title: "diffuse under a coat",
    source: "Schlick1994, eq. 15",
    scatters: Scatters::Reflection,
    parameters: &[ParameterInfo {
        name: "kc",
        unit: "1",
        low: 0.0,
        high: 1.0,
        default: 0.2,
        role: Role::Amplitude,
        meaning: "reflectance of the diffuse part before its coat darkens it",
    }],
    breaks: &[],
};

/// `1 - (1 - c)^5`.
#[inline(always)]
fn passed<R: Real>(c: R) -> R {
    let x = -c + 1.0;
    let square = x * x;
    -(square * square * x) + 1.0
}

impl Formula for Coated {
    const INFO: &'static ModelInfo = &INFO;
    const DIFFUSE: bool = true;
    type Shape<R: Real> = R;

    #[inline(always)]
    fn shape<R: Real>(p: &[R]) -> R {
        p[0] * (1.0 / PI)
    }

    #[inline(always)]
    fn bsdf<R: Real>(shape: &R, pair: &Pair<R::Plain>) -> R {
        let (ci, cs) = pair.cosines();
        shape.times(passed(ci) * passed(cs))
    }

    fn pdf(_shape: &f64, _w: Direction, s: Direction) -> f64 {
        s.cos_theta().max(0.0) / PI
    }

    fn sample(_shape: &f64, _w: Direction, u: [f64; 3]) -> Option<Direction> {
        let (r, (sin, cos)) = (u[0].sqrt(), (2.0 * PI * u[1]).sin_cos());
        Direction::new(DVec3::new(r * cos, r * sin, (1.0 - u[0]).max(0.0).sqrt()))
            .filter(|s| s.cos_theta() > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_bsdf::analytic::Analytic;
    use gonio_bsdf::{Bsdf, Channel};

    #[test]
    fn the_coat_darkens_grazing_directions_and_keeps_reciprocity() {
        let model = Analytic::<Coated>::new(&[(Channel::Photopic, vec![0.6])]).unwrap();
        let at = |a: f64, b: f64| {
            model.eval_first(Direction::from_degrees(a, 0.0), Direction::from_degrees(b, 130.0))
        };
        assert!((at(0.0, 0.0) - 0.6 / PI).abs() < 1e-15);
        assert!((at(80.0, 20.0) - at(20.0, 80.0)).abs() < 1e-15);
        let schlick = (1.0 - f64::to_radians(80.0).cos()).powi(5);
        assert!((at(80.0, 0.0) / at(0.0, 0.0) - (1.0 - schlick)).abs() < 1e-12);
    }
}
