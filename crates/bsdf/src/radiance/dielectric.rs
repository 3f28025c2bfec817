//! `dielectric`: the boundary of a solid transparent body.

use gonio_geom::{DVec3, Direction, Side};

use super::argument::no_strings;
use super::{Argument, Parameters, Rgb, check_reals, rgb};
use crate::BsdfError;

/// `void dielectric id 0 0 5 rtn gtn btn n hc`. The body is behind the surface: its normal points out of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Dielectric {
    /// Share of the light that a unit length of the body leaves, `[0, 1]`; the unit is that of the scene.
    pub transmissivity: Rgb,
    /// Refractive index of the body in air, `[0.1, 10]`; below 1 the body is a bubble.
    pub refractive_index: f64,
    /// Hartmann's constant, nm, `[-1000, 1000]`: the index at wavelength `l` is `n + hartmann / l`.
    pub hartmann: f64,
}

impl Dielectric {
    /// Wavelength at which RADIANCE refracts, nm.
    pub const MEAN_WAVELENGTH: f64 = 500.0;

    /// The refractive index at [`Dielectric::MEAN_WAVELENGTH`].
    pub fn index(&self) -> f64 {
        self.refractive_index + self.hartmann / Self::MEAN_WAVELENGTH
    }

    /// Share of the unpolarised light from `w` that the boundary reflects, by Fresnel's law; 1 beyond the angle of
    /// total reflection. The rest is refracted ([`Dielectric::refracted`]).
    pub fn reflectance(&self, w: Direction) -> f64 {
        let Some(s) = self.refracted(w) else {
            return 1.0;
        };
        let (cos, inside, n) = (w.cos_theta().abs(), s.cos_theta().abs(), 1.0 / self.ratio(w));
        let r = |a: f64, b: f64| ((a - b) / (a + b)).powi(2);
        0.5 * (r(cos, n * inside) + r(inside, n * cos))
    }

    /// The direction in which light from `w` goes on behind the boundary, by Snell's law; `None` beyond the angle of
    /// total reflection and on the horizon.
    pub fn refracted(&self, w: Direction) -> Option<Direction> {
        let (ratio, v) = (self.ratio(w), w.vec());
        let z2 = 1.0 - ratio * ratio * (1.0 - v.z * v.z);
        if v.z == 0.0 || z2 < 1e-6 {
            return None;
        }
        Direction::new(DVec3::new(-ratio * v.x, -ratio * v.y, -v.z.signum() * z2.sqrt()))
    }

    /// Radiance on the side of `w` over the radiance behind the boundary that it comes from, losses apart: the squared
    /// ratio of the indices. The shares of [`crate::Bsdf::delta`] are of the flux and leave it out.
    pub fn radiance_ratio(&self, w: Direction) -> f64 {
        self.ratio(w).powi(2)
    }

    /// What `length` of the body (in units of the scene, at least 0) leaves of the light, by Beer's law.
    pub fn internal_transmittance(&self, length: f64) -> Rgb {
        self.transmissivity.map(|t| t.powf(length))
    }

    /// Index on the side of `w` over that behind the boundary.
    fn ratio(&self, w: Direction) -> f64 {
        match w.side() {
            Side::Front => 1.0 / self.index(),
            Side::Back => self.index(),
        }
    }
}

impl Parameters for Dielectric {
    const TYPE: &'static str = "dielectric";
    const ARGUMENTS: &'static [Argument] = &[
        Argument::share("rtn", "red transmissivity of a unit length"),
        Argument::share("gtn", "green transmissivity of a unit length"),
        Argument::share("btn", "blue transmissivity of a unit length"),
        Argument {
            name: "n",
            low: 0.1,
            high: 10.0,
            what: "refractive index of the body in air",
            optional: false,
        },
        Argument {
            name: "hc",
            low: -1000.0,
            high: 1000.0,
            what: "Hartmann's constant in nm, 0 without dispersion",
            optional: false,
        },
    ];

    fn from_arguments(strings: &[String], reals: &[f64]) -> Result<Self, BsdfError> {
        no_strings(strings)?;
        check_reals::<Self>(reals)?;
        Dielectric {
            transmissivity: rgb(reals),
            refractive_index: reals[3],
            hartmann: reals[4],
        }
        .checked()
    }

    fn reals(&self) -> Vec<f64> {
        let mut reals = self.transmissivity.to_vec();
        reals.extend([self.refractive_index, self.hartmann]);
        reals
    }

    fn check(&self) -> Result<(), BsdfError> {
        check_reals::<Self>(&self.reals())?;
        if self.index() < 0.1 {
            return Err(BsdfError::Domain {
                field: "hc",
                found: self.hartmann.to_string(),
                allowed: "n + hc/500 of at least 0.1".into(),
            });
        }
        Ok(())
    }
}
