//! What the sum over a raster depends on where the raster lies.

use gonio_geom::{DVec3, Direction};

use crate::ScanError;
use crate::nearest::DirectionIndex;
use crate::robust::{mean_and_deviation, median};
use crate::weigh::patch_omega;

/// Positions of the raster that are tried.
const PHASES: usize = 32;

/// Factor by which the error of a hard-edged beam falls from twice the pitch to the pitch.
const REFINED: f64 = 8.0;
/// Margin on the scatter over raster phases: one scan shows the beam's fall-off in steps of the pitch only.
const SHIFTED: f64 = 1.5;

/// Standard uncertainty of `power = sum v omega` from where the raster lies, see [`crate::beam_power`]. `variance` is
/// that of `power` from noise.
pub(crate) fn raster_uncertainty(
    points: &[DVec3],
    value: &[f64],
    omega: &[f64],
    centre: Direction,
    power: f64,
    variance: f64,
) -> Result<f64, ScanError> {
    let index = DirectionIndex::new(points.to_vec());
    let pitch = pitch(points, omega, &index);
    let shifted = SHIFTED * phase_scatter(points, value, omega, centre, pitch);
    Ok(
        match thinned_change(points, pitch, &index, value, power, variance)? {
            Some(change) => shifted.max(change / REFINED).min(change),
            None => shifted,
        },
    )
}

/// Standard deviation of `sum v omega` over shifts of the raster `points` by up to half of `pitch` (radians) in both
/// axes, for the round beam that falls off as the readings `value` do about `centre`.
///
/// The fall-off is the non-increasing function of the angle to `centre` that is closest to the readings in the least
/// squares of isotonic regression, linear between its steps, so that noise does not enter.
fn phase_scatter(points: &[DVec3], value: &[f64], omega: &[f64], centre: Direction, pitch: f64) -> f64 {
    let profile = Profile::of(points, value, centre, 0.25 * pitch);
    let (a, b) = centre.vec().any_orthonormal_pair();
    let sums: Vec<f64> = (1..=PHASES)
        .filter_map(|k| {
            // Additive recurrence of the plastic number: even cover of the unit square [Roberts2018].
            let u = (k as f64 * 0.754_877_666_246_692_8).fract() - 0.5;
            let v = (k as f64 * 0.569_840_290_998_053_2).fract() - 0.5;
            let shifted = Direction::new(centre.vec() + pitch * (u * a + v * b))?.vec();
            let terms = points.iter().zip(omega);
            Some(terms.map(|(p, w)| w * profile.at(p.distance(shifted))).sum())
        })
        .collect();
    mean_and_deviation(&sums).map_or(0.0, |m| m.1)
}

/// A non-increasing function of the distance to the centre.
struct Profile(Vec<(f64, f64)>);

impl Profile {
    fn of(points: &[DVec3], value: &[f64], centre: Direction, step: f64) -> Self {
        let mut by_distance: Vec<(f64, f64)> = points
            .iter()
            .zip(value)
            .map(|(p, &v)| (p.distance(centre.vec()), v))
            .collect();
        by_distance.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Pool adjacent violators: sums of distance and value, and count, of each level.
        let mut levels: Vec<(f64, f64, f64)> = Vec::new();
        for (d, v) in by_distance {
            let mut level = (d, v, 1.0);
            while let Some(&(d0, v0, n0)) = levels.last()
                && v0 * level.2 <= level.1 * n0
            {
                level = (level.0 + d0, level.1 + v0, level.2 + n0);
                levels.pop();
            }
            levels.push(level);
        }
        // Levels closer than a step are one: their differences are the raster's, not the beam's.
        let mut merged: Vec<(f64, f64, f64)> = Vec::new();
        for l in levels {
            match merged.last_mut() {
                Some(m) if l.0 / l.2 - m.0 / m.2 < step => *m = (m.0 + l.0, m.1 + l.1, m.2 + l.2),
                _ => merged.push(l),
            }
        }
        Profile(merged.iter().map(|l| (l.0 / l.2, l.1 / l.2)).collect())
    }

    fn at(&self, distance: f64) -> f64 {
        let next = self.0.partition_point(|l| l.0 <= distance);
        match (next.checked_sub(1).and_then(|k| self.0.get(k)), self.0.get(next)) {
            (Some(&(d0, v0)), Some(&(d1, v1))) => v0 + (v1 - v0) * (distance - d0) / (d1 - d0),
            (Some(&(_, v)), None) | (None, Some(&(_, v))) => v,
            (None, None) => 0.0,
        }
    }
}

/// Rms change of the sum when the raster is thinned to twice its pitch, over up to four thinnings that share no
/// reading, less what noise explains; `None` for a raster too small to thin. On a regular raster these are its four phases at twice the pitch.
fn thinned_change(
    points: &[DVec3],
    pitch: f64,
    index: &DirectionIndex,
    value: &[f64],
    power: f64,
    variance: f64,
) -> Result<Option<f64>, ScanError> {
    // Between the diagonal of a cell and twice its side, so that a jittered raster thins like a regular one.
    let radius = 1.7 * pitch;
    let mut left: Vec<usize> = (0..points.len()).collect();
    let (mut square, mut n) = (0.0, 0_usize);
    for _ in 0..4 {
        let chosen = thin(points, &left, radius, index);
        if chosen.len() < 9 {
            break;
        }
        let some: Vec<DVec3> = chosen.iter().map(|&j| points[j]).collect();
        let coarse = patch_omega(&some)?;
        let sum: f64 = chosen.iter().zip(&coarse).map(|(&j, w)| value[j] * w).sum();
        // A share q of the readings has 1 / q times the variance, and shares the full sum's.
        let share = chosen.len() as f64 / points.len() as f64;
        square += (sum - power).powi(2) - (1.0 / share - 1.0) * variance;
        n += 1;
        left.retain(|j| chosen.binary_search(j).is_err());
    }
    if n == 0 {
        return Ok(None);
    }
    Ok(Some((square / n as f64).max(0.0).sqrt()))
}

/// Pitch of the raster, radians; across the lines where these are further apart than the readings along them.
fn pitch(points: &[DVec3], omega: &[f64], index: &DirectionIndex) -> f64 {
    let mut spacing: Vec<f64> = points
        .iter()
        .step_by((points.len() / 500).max(1))
        .filter_map(|&p| {
            let near = index.nearest_k(p, 4, 1.0);
            near.iter().map(|n| n.1).find(|&a| a > 1e-7)
        })
        .collect();
    let along = median(&mut spacing).unwrap_or(0.0);
    let cell = median(&mut omega.to_vec()).unwrap_or(0.0);
    if cell > 2.0 * along * along && along > 0.0 {
        cell / along
    } else {
        cell.sqrt()
    }
}

/// A greatest subset of the readings `from` (ascending) no two of which are closer than `radius`, ascending.
fn thin(points: &[DVec3], from: &[usize], radius: f64, index: &DirectionIndex) -> Vec<usize> {
    let mut taken = vec![false; points.len()];
    let mut chosen = Vec::new();
    for &j in from {
        if taken[j] {
            continue;
        }
        chosen.push(j);
        for (k, _) in index.nearest_k(points[j], points.len(), radius) {
            taken[k] = true;
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_profile_falls_off_as_the_readings_do_and_pools_what_rises() {
        let at = |d: f64| DVec3::new(d, 0.0, (1.0 - d * d).sqrt());
        let points = [0.0, 0.02, 0.04, 0.06].map(at);
        let profile = Profile::of(&points, &[3.0, 1.0, 2.0, 0.0], Direction::NORMAL, 0.001);
        let middle = profile.0[1];
        assert!((middle.0 - 0.03).abs() < 1e-5 && middle.1 == 1.5);
        assert!((profile.at(0.015) - 2.25).abs() < 1e-2);
        assert_eq!(profile.at(1.0), 0.0);
    }
}
