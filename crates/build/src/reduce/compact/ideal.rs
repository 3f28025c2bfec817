//! The shares of light that leaves without spreading, over the incidence.

use gonio_bsdf::BsdfError;
use gonio_bsdf::compact::{Frame, IdealPart, Symmetry};
use gonio_bsdf::{Bsdf, FourComponents};
use gonio_geom::{Component, DVec3, Direction, Side};

use super::source::{View, images, spread, turned};

/// Incidences that are looked at.
const PROBES: u32 = 2000;
/// End of the incidence axis: 89.4 degrees.
const END: f64 = 0.985;
/// Difference of shares that counts as none.
const NONE: f64 = 1e-4;
/// Nodes along `x`.
const X: [usize; 4] = [9, 17, 33, 65];

/// The ideal part of a component, and the largest difference of a share from the model's at incidences between the nodes.
///
/// # Errors
/// [`BsdfError::Domain`] for light that is refracted: neither mirrored nor straight through.
pub(super) fn ideal(
    view: &View<'_>,
    side: Side,
    component: Component,
    target: f64,
) -> Result<Option<(IdealPart, f64)>, BsdfError> {
    let n = view.channels().len();
    let placed = |w: Direction| if side == Side::Back { w.flipped() } else { w };
    let at = |w: Direction| {
        let mut shares = vec![0.0; n];
        view.shares(placed(w), component, &mut shares);
        shares
    };
    let probes: Vec<Direction> = (0..PROBES)
        .filter_map(|k| {
            let [a, b, ..] = spread(k);
            let cos = Frame::cos_theta_i(END * a);
            let (sin, phi) = ((1.0 - cos * cos).max(0.0).sqrt(), std::f64::consts::TAU * b);
            Direction::new(DVec3::new(sin * phi.cos(), sin * phi.sin(), cos))
        })
        .collect();
    let mut most = 0.0f64;
    for w in &probes {
        let mut shares = vec![0.0; n];
        let w = placed(*w);
        let Some(to) = view.shares(w, component, &mut shares) else {
            continue;
        };
        let straight = match component {
            Component::Reflection => w.mirror(),
            Component::Transmission => w.through(),
        };
        if to.angle_to(straight) > 1e-6 {
            return Err(BsdfError::Domain {
                field: "model",
                found: format!("an ideal part that bends light from {side} ({component})"),
                allowed: "light that is mirrored or passes straight through".into(),
            });
        }
        most = shares.into_iter().fold(most, f64::max);
    }
    if most == 0.0 {
        return Ok(None);
    }
    let allowed = NONE.max(target * most);
    let known: Vec<Vec<f64>> = probes.iter().map(|w| at(*w)).collect();
    let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
    let holds = |symmetry: Symmetry| {
        images(symmetry, 0.0).iter().all(|image| {
            probes
                .iter()
                .zip(&known)
                .all(|(w, own)| apart(own, &at(turned(image, *w))) <= 0.2 * allowed)
        })
    };
    let (symmetry, azimuths): (_, &[usize]) = if view.properties().isotropic {
        (Symmetry::Isotropic, &[1])
    } else if holds(Symmetry::Quadrilateral) {
        (Symmetry::Quadrilateral, &[3, 5, 9, 17])
    } else if holds(Symmetry::HalfTurn) {
        (Symmetry::HalfTurn, &[5, 9, 17, 33])
    } else {
        (Symmetry::Anisotropic, &[8, 16, 32, 64])
    };
    let mut best: Option<(IdealPart, f64)> = None;
    let mut sizes: Vec<[usize; 2]> = X
        .iter()
        .flat_map(|x| azimuths.iter().map(move |p| [*x, *p]))
        .collect();
    sizes.sort_by_key(|s| s[0] * s[1]);
    for shape in sizes {
        let part = tabulated(symmetry, shape, n, at);
        let mut ideal = FourComponents::default();
        ideal.set(Side::Front, component, Some(part.clone()));
        let made = gonio_bsdf::Compact::with_ideal(
            view.channels().to_vec(),
            FourComponents::default(),
            ideal,
            false,
        )?;
        let mut found = vec![0.0; n];
        let error = probes.iter().zip(&known).fold(0.0f64, |m, (w, own)| {
            made.delta(*w, component, &mut found);
            m.max(apart(own, &found))
        });
        if best.as_ref().is_none_or(|b| error < b.1) {
            best = Some((part, error));
        }
        if error <= allowed {
            break;
        }
    }
    Ok(best)
}

/// The shares at the nodes.
fn tabulated(
    symmetry: Symmetry,
    shape: [usize; 2],
    channels: usize,
    at: impl Fn(Direction) -> Vec<f64>,
) -> IdealPart {
    let part = IdealPart {
        symmetry,
        phi_x: 0.0,
        shape,
        shares: Vec::new(),
    };
    let frame = part.frame();
    let density = frame.density();
    let mut shares = vec![0.0f32; channels * shape[0] * shape[1]];
    for k in 0..shape[0] * shape[1] {
        let x = ((k / shape[1]) as f64 / density[0]).min(END);
        let p_i = if density[1] > 0.0 {
            (k % shape[1]) as f64 / density[1]
        } else {
            0.0
        };
        // the half vector is the normal: a pair at every incidence
        let Some((w, ..)) = frame.pair([x, p_i, 0.0, 0.0]) else {
            continue;
        };
        for (c, share) in at(w).into_iter().enumerate() {
            shares[c * shape[0] * shape[1] + k] = share as f32;
        }
    }
    IdealPart { shares, ..part }
}
