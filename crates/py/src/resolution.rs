//! `Resolution`: what a measurement keeps of the instrument signature.

use gonio_bsdf::Channel;
use gonio_scan as core;
use pyo3::prelude::*;

use crate::errors::{OrRaise, domain};

/// What the readings of one channel resolve.
#[pyclass(frozen, module = "gonio", name = "Resolution")]
pub(crate) struct Resolution(pub(crate) core::Resolution);

#[pymethods]
impl Resolution {
    #[new]
    #[pyo3(signature = (*, channel, fwhm, radius_50, radius_90, second_moment, receiver_radius=None,
                        spot_radius=None))]
    fn new(
        channel: &str,
        fwhm: f64,
        radius_50: f64,
        radius_90: f64,
        second_moment: f64,
        receiver_radius: Option<f64>,
        spot_radius: Option<f64>,
    ) -> PyResult<Self> {
        let positive = |name, value: f64, unit: &str| {
            if value.is_finite() && value > 0.0 {
                Ok(value.to_radians())
            } else {
                Err(domain(name, value, &format!("{unit} > 0")))
            }
        };
        Ok(Self(core::Resolution {
            channel: channel.parse::<Channel>().or_raise()?,
            fwhm: positive("fwhm", fwhm, "degrees")?,
            radius_50: positive("radius_50", radius_50, "degrees")?,
            radius_90: positive("radius_90", radius_90, "degrees")?,
            second_moment: positive("second_moment", second_moment, "square degrees")?.to_radians(),
            receiver_radius: receiver_radius
                .map(|r| positive("receiver_radius", r, "degrees"))
                .transpose()?,
            spot_radius: spot_radius
                .map(|r| positive("spot_radius", r, "degrees"))
                .transpose()?,
        }))
    }

    /// Spectral channel.
    #[getter]
    fn channel(&self) -> String {
        self.0.channel.to_string()
    }

    /// Full width at half maximum of the instrument signature, degrees.
    #[getter]
    fn fwhm(&self) -> f64 {
        self.0.fwhm.to_degrees()
    }

    /// Angle from the centroid that holds 50 % of the power, degrees.
    #[getter]
    fn radius_50(&self) -> f64 {
        self.0.radius_50.to_degrees()
    }

    /// Angle from the centroid that holds 90 % of the power, degrees.
    #[getter]
    fn radius_90(&self) -> f64 {
        self.0.radius_90.to_degrees()
    }

    /// Second moment about the centroid, square degrees: of beam and receiver aperture together.
    #[getter]
    fn second_moment(&self) -> f64 {
        self.0.second_moment.to_degrees().to_degrees()
    }

    /// Half angle of the receiver aperture seen from the sample, degrees, or None where it is not known.
    #[getter]
    fn receiver_radius(&self) -> Option<f64> {
        self.0.receiver_radius.map(f64::to_degrees)
    }

    /// Radius of the lit spot seen from the detector, degrees, or None where it is not known.
    #[getter]
    fn spot_radius(&self) -> Option<f64> {
        self.0.spot_radius.map(f64::to_degrees)
    }

    fn __repr__(&self) -> String {
        format!(
            "Resolution(channel=\"{}\", fwhm={:.4}, second_moment={:.3e})",
            self.0.channel,
            self.fwhm(),
            self.second_moment()
        )
    }
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Resolution>()
}
