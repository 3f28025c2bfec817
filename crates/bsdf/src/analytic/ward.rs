//! The Ward reflection lobe as first published, and with Dür's normaliser.

use gonio_geom::Direction;

use super::slopes::{GaussianSlopes, mirrored};
use super::{Exemption, Formula, Law, ModelInfo, Pair, ParameterInfo, Real, Scatters, Witness};

/// Gaussian distribution of facet slopes, reflecting, of two widths:
///
/// `f = rho e / (4 pi alpha_x alpha_y sqrt(cos_i cos_s))` [Ward1992, eq. 4 and 5a],
/// `e = exp(-((h_x/alpha_x)^2 + (h_y/alpha_y)^2) / h_z^2)`.
///
/// The albedo falls with `cos theta_i` towards grazing incidence, then grows without bound.
/// [`WardGmd`](super::WardGmd) keeps energy.
#[derive(Clone, Copy, Debug)]
pub struct Ward;

/// [`Ward`] of one width in every azimuth.
#[derive(Clone, Copy, Debug)]
pub struct WardIsotropic;

/// [`Ward`] with `1 / (cos_i cos_s)` in place of the square root [Duer2006]: keeps the albedo nearer to `rho` up to 75
/// degrees and exceeds it the more beyond.
#[derive(Clone, Copy, Debug)]
pub struct WardDuer;

/// [`WardDuer`] of one width in every azimuth.
#[derive(Clone, Copy, Debug)]
pub struct WardDuerIsotropic;

const TWO_WIDTHS: &[ParameterInfo] = &[
    RHO,
    ParameterInfo::width("alpha_x", "rms slope times sqrt 2 along x"),
    ParameterInfo::width("alpha_y", "rms slope times sqrt 2 along y"),
    ParameterInfo::axis(),
];

const ONE_WIDTH: &[ParameterInfo] = &[RHO, ParameterInfo::width("alpha", "rms slope times sqrt 2")];

const RHO: ParameterInfo = ParameterInfo::amplitude(
    "rho",
    0.1,
    "scale of the lobe; its albedo at normal incidence for a narrow lobe",
);

/// A reflection lobe of `source` that exceeds albedo 1 as `breaks` says.
const fn info(
    name: &'static str,
    title: &'static str,
    source: &'static str,
    parameters: &'static [ParameterInfo],
    breaks: &'static [Exemption],
) -> ModelInfo {
    ModelInfo {
        name,
        title,
        source,
        scatters: Scatters::Reflection,
        parameters,
        breaks,
    }
}

/// An albedo `measured` at `theta_i` degrees.
const fn excess(amount: &'static str, parameters: &'static [f64], theta_i: f64, measured: f64) -> Exemption {
    Exemption {
        law: Law::Energy,
        amount,
        witness: Witness {
            parameters,
            theta_i,
            theta_s: 0.0,
            measured,
        },
    }
}

const WARD_EXCESS: &str = "albedo 1.037 rho at 89.9 degrees for alpha = .3, 1.54 rho for alpha = .55";
const DUER_EXCESS: &str = "albedo 1.25 rho at 85 degrees, 4.30 rho at 89 and 39 rho at 89.9 for alpha = .3; above rho from 82 degrees on";

static WARD: ModelInfo = info(
    "ward",
    "Ward 1992",
    "Ward1992, eq. 4",
    ONE_WIDTH,
    &[excess(WARD_EXCESS, &[1.0, 0.3], 89.9, 1.037)],
);
static WARD_ANISOTROPIC: ModelInfo = info(
    "ward-anisotropic",
    "Ward 1992, two widths",
    "Ward1992, eq. 5a",
    TWO_WIDTHS,
    &[excess(WARD_EXCESS, &[1.0, 0.3, 0.3, 0.0], 89.9, 1.037)],
);
static DUER: ModelInfo = info(
    "ward-duer",
    "Ward-Dür",
    "Duer2006",
    ONE_WIDTH,
    &[excess(DUER_EXCESS, &[1.0, 0.3], 85.0, 1.25)],
);
static DUER_ANISOTROPIC: ModelInfo = info(
    "ward-duer-anisotropic",
    "Ward-Dür, two widths",
    "Duer2006",
    TWO_WIDTHS,
    &[excess(DUER_EXCESS, &[1.0, 0.3, 0.3, 0.0], 85.0, 1.25)],
);

/// Prepared parameters.
#[derive(Clone, Copy, Debug)]
pub struct Shape<R> {
    /// `rho / 4`.
    quarter_rho: R,
    slopes: GaussianSlopes<R>,
}

macro_rules! formula {
    ($t:ty, $info:ident, $slopes:expr, $normaliser:expr) => {
        impl Formula for $t {
            const INFO: &'static ModelInfo = &$info;
            type Shape<R: Real> = Shape<R>;

            #[inline(always)]
            fn shape<R: Real>(p: &[R]) -> Shape<R> {
                let slopes: fn(&[R]) -> GaussianSlopes<R> = $slopes;
                Shape {
                    quarter_rho: p[0] * 0.25,
                    slopes: slopes(&p[1..]),
                }
            }

            #[inline(always)]
            fn bsdf<R: Real>(shape: &Shape<R>, pair: &Pair<R::Plain>) -> R {
                let normaliser: fn(R::Plain) -> R::Plain = $normaliser;
                let (ci, cs) = pair.cosines();
                (shape.quarter_rho * shape.slopes.density(pair.sum())).times(normaliser(ci * cs))
            }

            fn pdf(shape: &Shape<f64>, w: Direction, s: Direction) -> f64 {
                shape.slopes.mirrored_density(w, s)
            }

            fn sample(shape: &Shape<f64>, w: Direction, u: [f64; 3]) -> Option<Direction> {
                mirrored(w, shape.slopes.sample(u))
            }

            const SAMPLES_LANES: bool = true;

            #[inline(always)]
            fn sample_lanes<R: Real<Plain = R>>(shape: &Shape<R>, w: [R; 3], u: [R; 3]) -> ([R; 3], R) {
                shape.slopes.mirrored_lanes(w, u)
            }

            fn isotropic(p: &[f64]) -> bool {
                p.len() < 3 || p[1] == p[2]
            }
        }
    };
}
formula!(
    Ward,
    WARD_ANISOTROPIC,
    |p| GaussianSlopes::new(p[0], p[1], p[2]),
    |cc| cc.sqrt().recip()
);
formula!(WardIsotropic, WARD, |p| GaussianSlopes::isotropic(p[0]), |cc| cc
    .sqrt()
    .recip());
formula!(
    WardDuer,
    DUER_ANISOTROPIC,
    |p| GaussianSlopes::new(p[0], p[1], p[2]),
    |cc| cc.recip()
);
formula!(
    WardDuerIsotropic,
    DUER,
    |p| GaussianSlopes::isotropic(p[0]),
    |cc| cc.recip()
);
