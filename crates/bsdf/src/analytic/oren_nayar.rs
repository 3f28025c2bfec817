//! Oren and Nayar's rough diffuse reflection, the qualitative model.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2};

use gonio_geom::Direction;

use super::lambert::{cosine_density, cosine_direction};
use super::{Exemption, Formula, Law, ModelInfo, Pair, ParameterInfo, Real, Role, Scatters, Witness};

/// Lambertian facets of Gaussian slope angles, shadowed and masked, without interreflection:
///
/// `f = rho/pi (A + B max(0, cos(phi_s - phi_i)) sin a tan b)`, `a` the larger and `b` the smaller polar angle,
/// `A = 1 - sigma^2 / (2 (sigma^2 + 0.33))`, `B = 0.45 sigma^2 / (sigma^2 + 0.09)` [OrenNayar1994].
///
/// This is the paper's qualitative model with 0.33 (not 0.57, its stand-in for interreflection), not its full one. It is evaluated from vectors:
/// `cos(phi_s - phi_i) sin a tan b = (wi.ws - cos_i cos_s) / max(cos_i, cos_s)`. With `sigma = 0` it is Lambertian.
#[derive(Clone, Copy, Debug)]
pub struct OrenNayar;

static INFO: ModelInfo = ModelInfo {
    name: "oren-nayar",
    title: "Oren-Nayar, qualitative model",
    source: "OrenNayar1994",
    scatters: Scatters::Reflection,
    parameters: &[
        ParameterInfo::amplitude("rho", 0.5, "reflectance of a facet"),
        ParameterInfo {
            name: "sigma",
            unit: "rad",
            low: 0.0,
            high: FRAC_PI_2,
            default: 0.3,
            role: Role::Exponent,
            meaning: "standard deviation of the facets' slope angle; 0 is Lambertian",
        },
    ],
    breaks: &[Exemption {
        law: Law::Energy,
        amount: "albedo 1.013 rho at 89 degrees for sigma = .15; 1.015 rho at most, at grazing incidence for sigma = .2; below rho everywhere for sigma above .33",
        witness: Witness {
            parameters: &[1.0, 0.15],
            theta_i: 89.0,
            theta_s: 0.0,
            measured: 1.013,
        },
    }],
};

/// Prepared parameters: `rho A / pi` and `rho B / pi`.
#[derive(Clone, Copy, Debug)]
pub struct Shape<R> {
    even: R,
    retro: R,
}

impl Formula for OrenNayar {
    const INFO: &'static ModelInfo = &INFO;
    const DIFFUSE: bool = true;
    type Shape<R: Real> = Shape<R>;

    #[inline(always)]
    fn shape<R: Real>(p: &[R]) -> Shape<R> {
        let square = p[1].squared();
        let scale = p[0] * FRAC_1_PI;
        Shape {
            even: scale * (-(square * 0.5) / (square + 0.33) + 1.0),
            retro: scale * (square * 0.45) / (square + 0.09),
        }
    }

    #[inline(always)]
    fn bsdf<R: Real>(shape: &Shape<R>, pair: &Pair<R::Plain>) -> R {
        let (ci, cs) = pair.cosines();
        let zero = R::Plain::constant(0.0);
        let towards = (pair.wi[0] * pair.ws[0] + pair.wi[1] * pair.ws[1]).max(zero);
        shape.even + shape.retro.times(towards / ci.max(cs))
    }

    fn pdf(_shape: &Shape<f64>, _w: Direction, s: Direction) -> f64 {
        cosine_density(s)
    }

    fn sample(_shape: &Shape<f64>, _w: Direction, u: [f64; 3]) -> Option<Direction> {
        cosine_direction(u)
    }
}
