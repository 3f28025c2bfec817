//! The tables of an RGL material, and what they have to fulfil.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::{BsdfError, Channel};

/// A table of numbers, the last dimension contiguous.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Length of each dimension.
    pub shape: Vec<usize>,
    /// The values, as many as the product of `shape`.
    pub values: Vec<f32>,
}

/// The content of an RGL material \[DupuyJakob2018\]. `n_p` azimuths and `n_t` polar angles of incidence, `n_c` channels.
///
/// Tables over the unit square have the polar coordinate `sqrt(2 theta / pi)` last and the azimuthal coordinate
/// `(phi + pi) / (2 pi)` before it; nodes lie on the edges too.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RglTables {
    /// Polar angles of incidence, radians, ascending in `[0, pi/2]`.
    pub theta_i: Vec<f64>,
    /// Azimuths of incidence, radians, ascending; one or two entries make the material isotropic. More cover the whole
    /// turn from `-pi`, or its first half or quarter for materials of two-fold or mirror symmetry.
    pub phi_i: Vec<f64>,
    /// Distribution of microfacet normals over the half vector, 1/sr, `>= 0`; `[h, w]`.
    pub ndf: Table,
    /// Projected area of the microsurface over the direction of incidence, `> 0`; `[h, w]`.
    pub sigma: Table,
    /// Density of visible normals over the half vector, `>= 0`, any scale; `[n_p, n_t, h, w]`.
    pub vndf: Table,
    /// Luminance over the square that `vndf` is warped from, `>= 0`, any scale; `[n_p, n_t, h, w]`.
    pub luminance: Table,
    /// Reflected part of each channel over the same square; `[n_p, n_t, n_c, h, w]`, `h` and `w` as in `luminance`.
    /// Negative values occur: colours outside the gamut.
    pub spectra: Table,
    /// The channels of `spectra`.
    pub channels: Vec<Channel>,
    /// Which nodes of `luminance` are directions above the horizon, in its order; `None` when that is not known.
    pub valid: Option<Vec<bool>>,
    /// Whether `spectra` hold the quotient of scattering and the microfacet factor `ndf / (4 sigma)`.
    pub jacobian: bool,
}

fn domain(field: &'static str, found: impl Into<String>, allowed: impl Into<String>) -> BsdfError {
    BsdfError::Domain {
        field,
        found: found.into(),
        allowed: allowed.into(),
    }
}

/// Refuses a table whose shape is not `leading` followed by two dimensions of at least two nodes.
fn shaped(field: &'static str, table: &Table, leading: &[usize]) -> Result<(), BsdfError> {
    let (shape, n) = (&table.shape, leading.len());
    let fits = shape.len() == n + 2 && shape[..n] == *leading && shape[n] >= 2 && shape[n + 1] >= 2;
    if !fits {
        let known: String = leading.iter().map(|d| format!("{d}, ")).collect();
        return Err(domain(
            field,
            format!("shape {shape:?}"),
            format!("shape [{known}h, w] with h and w of at least 2"),
        ));
    }
    let product = shape.iter().try_fold(1usize, |a, &b| a.checked_mul(b));
    if product != Some(table.values.len()) {
        return Err(domain(
            field,
            format!("{} values", table.values.len()),
            format!("as many as the shape {shape:?} says"),
        ));
    }
    Ok(())
}

fn each(
    field: &'static str,
    values: &[f32],
    allowed: &str,
    good: impl Fn(f32) -> bool,
) -> Result<(), BsdfError> {
    match values.iter().position(|&v| !good(v)) {
        None => Ok(()),
        Some(at) => Err(domain(
            field,
            format!("{} at value {}", values[at], at + 1),
            allowed,
        )),
    }
}

fn ascending(field: &'static str, values: &[f64], low: f64, high: f64) -> Result<(), BsdfError> {
    // files hold single precision
    const ROUNDING: f64 = 1e-6;
    let allowed = || {
        let (low, high) = (low.to_degrees(), high.to_degrees());
        format!("1 to 65536 ascending angles of {low} to {high} degrees")
    };
    if values.is_empty() || values.len() > 1 << 16 {
        return Err(domain(field, format!("{} values", values.len()), allowed()));
    }
    let inside = |v: &f64| (low - ROUNDING..=high + ROUNDING).contains(v);
    if let Some(bad) = values.iter().find(|v| !inside(v)) {
        return Err(domain(field, format!("{bad} radians"), allowed()));
    }
    match values.windows(2).find(|w| w[0] >= w[1]) {
        Some(w) => Err(domain(
            field,
            format!("{} before {} radians", w[0], w[1]),
            allowed(),
        )),
        None => Ok(()),
    }
}

impl RglTables {
    /// Number of quarters or halves of the turn that one part of it stands for: 1, 2 or 4; 1 for isotropic materials.
    pub(super) fn reduction(&self) -> u32 {
        let span = match (self.phi_i.first(), self.phi_i.last()) {
            (Some(a), Some(b)) if self.phi_i.len() > 2 => b - a,
            _ => return 1,
        };
        (2.0 * PI / span).round() as u32
    }

    /// Refuses what no material can be made of.
    pub(super) fn check(&self) -> Result<(), BsdfError> {
        ascending("theta_i", &self.theta_i, 0.0, FRAC_PI_2)?;
        ascending("phi_i", &self.phi_i, -PI, PI)?;
        if self.phi_i.len() > 2 && !matches!(self.reduction(), 1 | 2 | 4) {
            let (a, b) = (self.phi_i[0], self.phi_i[self.phi_i.len() - 1]);
            let found = format!("azimuths over {:.3} degrees", (b - a).to_degrees());
            return Err(domain("phi_i", found, "azimuths over 360, 180 or 90 degrees"));
        }
        let incidences = [self.phi_i.len(), self.theta_i.len()];
        shaped("ndf", &self.ndf, &[])?;
        shaped("sigma", &self.sigma, &[])?;
        shaped("vndf", &self.vndf, &incidences)?;
        shaped("luminance", &self.luminance, &incidences)?;
        if self.channels.is_empty() {
            return Err(domain("channels", "none", "at least one"));
        }
        shaped(
            "spectra",
            &self.spectra,
            &[incidences[0], incidences[1], self.channels.len()],
        )?;
        if self.spectra.shape[3..] != self.luminance.shape[2..] {
            return Err(domain(
                "spectra",
                format!("shape {:?}", self.spectra.shape),
                format!(
                    "the last two dimensions of luminance, {:?}",
                    &self.luminance.shape[2..]
                ),
            ));
        }
        if let Some(valid) = self
            .valid
            .as_ref()
            .filter(|v| v.len() != self.luminance.values.len())
        {
            return Err(domain(
                "valid",
                format!("{} values", valid.len()),
                format!("{}, one a node of luminance", self.luminance.values.len()),
            ));
        }
        let natural = |v: f32| v.is_finite() && v >= 0.0;
        each("ndf", &self.ndf.values, "finite numbers >= 0", natural)?;
        each("sigma", &self.sigma.values, "finite numbers > 0", |v| {
            v.is_finite() && v > 0.0
        })?;
        each("vndf", &self.vndf.values, "finite numbers >= 0", natural)?;
        each(
            "luminance",
            &self.luminance.values,
            "finite numbers >= 0",
            natural,
        )?;
        each("spectra", &self.spectra.values, "finite numbers", f32::is_finite)
    }
}
