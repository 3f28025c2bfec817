//! Where lobes are.

use std::f64::consts::{PI, TAU};

use gonio_geom::{Component, DVec3, Direction, Side};

use super::field::Field;
use super::lobe::{Lobe, measured};

/// Pitch of the directions among which peaks are sought, radians.
const GRID: f64 = 0.03;
/// Lobes of a hemisphere at most.
const MOST: usize = 8;

/// What is known of a hemisphere before a path is laid.
#[derive(Default)]
pub(super) struct Survey {
    /// Lobes, the highest first.
    pub(super) lobes: Vec<Lobe>,
    /// Share of the flux within the shadow, of the flux beyond `theta_max`, and of the hemisphere's solid angle in both.
    pub(super) shaded: f64,
    pub(super) beyond: f64,
    pub(super) unread_omega: f64,
    /// Share by which beam and aperture lower the highest DSF of the material.
    pub(super) flattened: f64,
}

/// Evenly spread directions of a hemisphere with the solid angle of each.
fn grid(side: Side) -> (Vec<Direction>, f64) {
    let n = (TAU / (GRID * GRID)).round();
    // Spiral of the golden angle: even in solid angle.
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let at = |k: usize| {
        let z = 1.0 - (k as f64 + 0.5) / n;
        let (s, c) = (golden * k as f64).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Direction::from_unit(DVec3::new(r * c, r * s, z * side.sign()))
    };
    ((0..n as usize).map(at).collect(), TAU / n)
}

/// Looks the hemisphere of `component` over for lobes, with the eyes of every detector: `fields` has one each, one at least. A lobe
/// that several see with about the same widths is one. Shares are those of the detector that has the largest.
pub(super) fn survey(
    fields: &[Field<'_>],
    wi: Direction,
    component: Component,
    theta_max: f64,
    shadow: f64,
) -> Survey {
    let seen = fields.iter().map(|f| one(f, wi, component, theta_max, shadow));
    let joined = seen.reduce(|mut all, next| {
        let new = |lobe: &Lobe| !all.lobes.iter().any(|l| l.is_about(lobe));
        let further: Vec<Lobe> = next.lobes.into_iter().filter(new).collect();
        all.lobes.extend(further);
        all.shaded = all.shaded.max(next.shaded);
        all.beyond = all.beyond.max(next.beyond);
        all.flattened = all.flattened.max(next.flattened);
        all
    });
    joined.unwrap_or_default()
}

fn one(field: &Field<'_>, wi: Direction, component: Component, theta_max: f64, shadow: f64) -> Survey {
    let side = component.scattered_side(wi.side());
    let (at, omega) = grid(side);
    let value = field.seen(&at);
    let background = background(&at, &value);
    let flux: f64 = omega * value.iter().sum::<f64>();
    let beyond = |d: &Direction| d.cos_theta().abs() < theta_max.cos();
    let shaded = |d: &Direction| component == Component::Reflection && d.angle_to(wi) <= shadow;
    let share = |part: &dyn Fn(&Direction) -> bool| {
        let of = at.iter().zip(&value).filter(|(d, _)| part(d)).map(|(_, v)| v);
        (of.sum::<f64>() * omega / flux.max(f64::MIN_POSITIVE)).max(0.0)
    };
    let mut found: Vec<(Direction, f64)> = Vec::new();
    for (start, step) in starts(&at, &value, wi, component) {
        let (peak, height) = climb(field, start, step);
        if height > 0.0 && !found.iter().any(|(p, _)| p.angle_to(peak) < 0.2_f64.to_radians()) {
            found.push((peak, height));
        }
    }
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    let top_seen = found.first().map_or(0.0, |f| f.1);
    let top_true = found.first().map_or(0.0, |f| bare_top(field, f.0));
    let mut lobes: Vec<Lobe> = Vec::new();
    for (peak, height) in found {
        // A second top on the flank of a lobe is part of it.
        let part = lobes
            .iter()
            .any(|l| l.distance(peak) < 1.0 && height < 1.2 * field.seen(&[peak])[0].max(l.height * 0.3));
        if lobes.len() == MOST || part {
            continue;
        }
        lobes.extend(measured(field, wi, component, (peak, height), background));
    }
    let cap = |half: f64| TAU * (1.0 - half.cos());
    let dead = if component == Component::Reflection {
        cap(shadow)
    } else {
        0.0
    };
    Survey {
        shaded: share(&shaded),
        beyond: share(&beyond),
        unread_omega: (dead + TAU * theta_max.cos()) / TAU,
        lobes,
        flattened: if top_true > 0.0 {
            (1.0 - top_seen / top_true).max(0.0)
        } else {
            0.0
        },
    }
}

/// Level of the BSDF away from lobes: its lowest values but for the last few per cent, at no grazing angle.
fn background(at: &[Direction], value: &[f64]) -> f64 {
    let mut f: Vec<f64> = at
        .iter()
        .zip(value)
        .filter(|(d, _)| d.cos_theta().abs() > 0.17)
        .map(|(d, v)| v / d.cos_theta().abs())
        .collect();
    f.sort_by(f64::total_cmp);
    f.get(f.len() / 20).copied().unwrap_or(0.0).max(0.0)
}

/// Where climbs begin, with their first step: local maxima of the grid, and the mirror, unbent and retro directions.
fn starts(at: &[Direction], value: &[f64], wi: Direction, component: Component) -> Vec<(Direction, f64)> {
    let special = match component {
        Component::Reflection => vec![wi.mirror(), wi],
        Component::Transmission => vec![wi.through()],
    };
    let mut out: Vec<(Direction, f64)> = special.into_iter().map(|d| (d, 0.004)).collect();
    let cosine = (2.0 * GRID).cos();
    let mut order: Vec<usize> = (0..at.len()).collect();
    order.sort_by(|&a, &b| value[b].total_cmp(&value[a]));
    let mut local = 0;
    // In falling order a local maximum has no higher neighbour before it.
    for (rank, &j) in order.iter().enumerate() {
        if local == 3 * MOST || value[j] <= 1e-3 * value[order[0]] {
            break;
        }
        if order[..rank].iter().all(|&k| at[j].dot(at[k]) < cosine) {
            out.push((at[j], 0.5 * GRID));
            local += 1;
        }
    }
    out
}

/// Climbs from `start` to a local maximum of what the instrument sees.
fn climb(field: &Field<'_>, start: Direction, first: f64) -> (Direction, f64) {
    let (mut best, mut step) = (start, first);
    let mut height = field.seen(&[best])[0];
    for _ in 0..200 {
        if step < 1e-4 {
            break;
        }
        let around = ring(best, step);
        let values = field.seen(&around);
        let higher = (0..around.len()).max_by(|&a, &b| values[a].total_cmp(&values[b]));
        match higher {
            Some(k) if values[k] > height * (1.0 + 1e-6) => (best, height) = (around[k], values[k]),
            _ => step *= 0.5,
        }
    }
    (best, height)
}

/// Eight directions at angle `step` about `centre`, on its side.
fn ring(centre: Direction, step: f64) -> Vec<Direction> {
    let (a, b) = centre.vec().any_orthonormal_pair();
    (0..8)
        .filter_map(|k| {
            let (s, c) = (0.25 * PI * f64::from(k)).sin_cos();
            let d = Direction::new(centre.vec() + step * (c * a + s * b))?;
            (d.side() == centre.side()).then_some(d)
        })
        .collect()
}

/// The material's own highest DSF about `peak`.
fn bare_top(field: &Field<'_>, peak: Direction) -> f64 {
    let (mut best, mut step) = (peak, 0.01);
    let mut height = field.bare(&[best])[0];
    while step > 2e-5 {
        let around = ring(best, step);
        let values = field.bare(&around);
        match (0..around.len()).max_by(|&a, &b| values[a].total_cmp(&values[b])) {
            Some(k) if values[k] > height => (best, height) = (around[k], values[k]),
            _ => step *= 0.5,
        }
    }
    height
}
