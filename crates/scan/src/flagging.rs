//! What the readings themselves tell about their use: no data, saturation, sentinels, shadow, repeats, horizon.

use crate::{Flags, NoiseModel, Scan};

/// Angle around the retro direction in which a dip counts as the detector's shadow, radians (8 degrees).
const SHADOW_SEARCH: f64 = 0.139_626_340_159_546_4;
/// A reading below this fraction of every neighbour is a dip.
const SHADOW_DIP: f64 = 0.5;
/// Readings above this many standard deviations of the noise are positive without doubt.
const CLEAR: f64 = 5.0;
/// Part of all readings that exact zeros may make up and still be sentinels rather than a dark sample.
const SENTINEL_SHARE: f64 = 0.25;

/// Geometry that decides on shadow and horizon.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Apertures {
    /// Half angle of the receiver aperture, radians.
    pub(crate) receiver: f64,
    /// Radius about the retro direction in which every reading is in the shadow, radians; `None`: only dips count.
    pub(crate) shadow: Option<f64>,
}

/// Half angle of a receiver aperture of solid angle `omega`, radians.
pub(crate) fn half_angle(omega: f64) -> f64 {
    (1.0 - omega / std::f64::consts::TAU).clamp(-1.0, 1.0).acos()
}

/// Flags of the raw readings of `scan`, before any correction.
pub(crate) fn raw_flags(scan: &Scan, noise: &NoiseModel, apertures: Apertures) -> Vec<Flags> {
    let mut flags = vec![Flags::NONE; scan.len()];
    let saturation = scan.meta.saturation.unwrap_or(f64::INFINITY);
    let retro = scan.incidence.direction();
    let horizon = apertures.receiver.sin().max(1e-9);
    for (j, flag) in flags.iter_mut().enumerate() {
        let v = scan.value[j];
        if !v.is_finite() {
            *flag |= Flags::NO_DATA;
        } else if v >= saturation {
            *flag |= Flags::SATURATED;
        }
        let d = scan.direction(j);
        if d.cos_theta().abs() <= horizon {
            *flag |= Flags::HORIZON;
        }
        if apertures.shadow.is_some_and(|radius| d.angle_to(retro) <= radius) {
            *flag |= Flags::SHADOW;
        }
    }
    sentinels(scan, noise, &mut flags);
    dips(scan, noise, &mut flags);
    repeats(scan, &mut flags);
    flags
}

/// Exact zeros between clearly positive readings of the path.
fn sentinels(scan: &Scan, noise: &NoiseModel, flags: &mut [Flags]) {
    let zeros = scan.value.iter().filter(|v| **v == 0.0).count();
    if zeros == 0 || zeros as f64 > SENTINEL_SHARE * scan.len() as f64 {
        return;
    }
    let clear = CLEAR * noise.readout;
    let positive = |v: Option<&f64>| v.is_none_or(|v| *v > clear && *v > 0.0);
    let mut j = 0;
    while j < scan.len() {
        if scan.value[j] != 0.0 {
            j += 1;
            continue;
        }
        let end = (j..scan.len())
            .find(|&k| scan.value[k] != 0.0)
            .unwrap_or(scan.len());
        let before = j.checked_sub(1).and_then(|b| scan.value.get(b));
        if positive(before) && positive(scan.value.get(end)) {
            for flag in &mut flags[j..end] {
                *flag |= Flags::SENTINEL;
            }
        }
        j = end;
    }
}

/// A reading near the retro direction far below both neighbours on the path: the detector stood in the beam.
fn dips(scan: &Scan, noise: &NoiseModel, flags: &mut [Flags]) {
    let retro = scan.incidence.direction();
    let clear = CLEAR * noise.readout;
    let inner = 1..scan.len().saturating_sub(1);
    for (j, flag) in flags.iter_mut().enumerate().filter(|(j, _)| inner.contains(j)) {
        let v = scan.value[j];
        let lower = scan.value[j - 1].min(scan.value[j + 1]);
        if v.is_finite()
            && lower - v > clear
            && v < SHADOW_DIP * lower
            && scan.direction(j).angle_to(retro) <= SHADOW_SEARCH
            && scan.direction(j - 1).angle_to(scan.direction(j + 1)) <= 2.0 * SHADOW_SEARCH
        {
            *flag |= Flags::SHADOW;
        }
    }
}

/// Exactly equal directions; at a pole the azimuth does not count.
fn repeats(scan: &Scan, flags: &mut [Flags]) {
    let at_pole = |t: f64| t == 0.0 || t == std::f64::consts::PI;
    let key = |j: u32| {
        let (t, p) = (scan.theta_s[j as usize], scan.phi_s[j as usize]);
        (t, if at_pole(t) { 0.0 } else { p })
    };
    let mut order: Vec<u32> = (0..scan.len() as u32).collect();
    order.sort_unstable_by(|&a, &b| {
        let (a, b) = (key(a), key(b));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    for pair in order.windows(2) {
        if key(pair[0]) == key(pair[1]) {
            flags[pair[0] as usize] |= Flags::REPEATED;
            flags[pair[1] as usize] |= Flags::REPEATED;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{path_scan, record};
    use gonio_geom::Direction;

    fn flags(scan: &Scan) -> Vec<Flags> {
        raw_flags(scan, &NoiseModel::UNKNOWN, Apertures::default())
    }

    #[test]
    fn a_zero_between_positive_readings_is_a_sentinel_and_a_dark_sample_is_not() {
        let mut scan = path_scan(10.0, 5.0, |_| 1.0);
        scan.value[7] = 0.0;
        let found = flags(&scan);
        assert!(found[7].intersects(Flags::SENTINEL));
        assert_eq!(found.iter().filter(|f| f.intersects(Flags::SENTINEL)).count(), 1);
        let dark = path_scan(10.0, 5.0, |d| if d.phi() < 3.0 { 0.0 } else { 1.0 });
        assert!(flags(&dark).iter().all(|f| !f.intersects(Flags::SENTINEL)));
    }

    #[test]
    fn the_detectors_shadow_is_the_dip_at_the_retro_direction() {
        let mut scan = record(50.0, 0.0);
        for k in -16..=16 {
            let t = f64::from(k) * 5.0;
            // Signed polar angle towards the source's azimuth; the retro direction is at 50.
            let v = if k == 10 { 8.8 } else { 100.0 + t };
            scan.push(Direction::from_degrees(t, 0.0), v);
        }
        let found = flags(&scan);
        let shadow: Vec<usize> = (0..scan.len())
            .filter(|&j| found[j].intersects(Flags::SHADOW))
            .collect();
        assert_eq!(shadow, vec![26]);
        scan.incidence = record(10.0, 0.0).incidence;
        assert!(flags(&scan).iter().all(|f| !f.intersects(Flags::SHADOW)));
    }

    #[test]
    fn nan_saturation_horizon_and_repeats_are_flagged_where_they_are() {
        let mut scan = path_scan(10.0, 5.0, |_| 1.0);
        scan.value[3] = f64::NAN;
        scan.value[4] = 9.0;
        scan.meta.saturation = Some(9.0);
        scan.push(Direction::from_degrees(90.0, 0.0), 1.0);
        let (t, p) = (scan.theta_s[11], scan.phi_s[11]);
        scan.theta_s.push(t);
        scan.phi_s.push(p);
        scan.value.push(1.0);
        let found = flags(&scan);
        let n = scan.len();
        assert!(found[3].intersects(Flags::NO_DATA) && !found[3].usable());
        assert!(found[4].intersects(Flags::SATURATED) && !found[4].usable());
        assert!(found[n - 2].intersects(Flags::HORIZON) && found[n - 2].usable());
        assert!(found[n - 1].intersects(Flags::REPEATED) && found[11].intersects(Flags::REPEATED));
        assert_eq!(found.iter().filter(|f| f.intersects(Flags::REPEATED)).count(), 2);
    }
}
