//! The noise of a reading as a function of its level.

use gonio_geom::Direction;

use crate::robust::{median, sigma_about_zero};
use crate::{Scan, ScanMeta};

/// Where a noise model came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoiseOrigin {
    /// The instrument states it (metadata of the record).
    Stated,
    /// Estimated from the scatter of the readings.
    Estimated,
    /// Nothing is known and the readings are too few or too far apart to tell: no noise is counted.
    Unknown,
}

impl NoiseOrigin {
    /// Name used in files and Python.
    pub fn name(self) -> &'static str {
        match self {
            NoiseOrigin::Stated => "stated",
            NoiseOrigin::Estimated => "estimated",
            NoiseOrigin::Unknown => "unknown",
        }
    }
}

/// `sigma(v)^2 = readout^2 + (relative v)^2`: read-out noise and noise proportional to the signal (source, gain).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseModel {
    /// Standard deviation at zero signal, in the unit of the readings, `>= 0`.
    pub readout: f64,
    /// Standard deviation proportional to the signal, as a fraction, `>= 0`.
    pub relative: f64,
    /// Where it came from.
    pub origin: NoiseOrigin,
}

/// Readings that may enter the estimate, from each record; more do not sharpen it.
const MAX_WINDOWS: usize = 40_000;
/// Windows a level bin needs before its scatter counts.
const MIN_WINDOWS: usize = 30;
/// Bins a decade of signal.
const BINS_PER_DECADE: f64 = 2.0;

impl NoiseModel {
    /// A model that counts no noise.
    pub const UNKNOWN: NoiseModel = NoiseModel {
        readout: 0.0,
        relative: 0.0,
        origin: NoiseOrigin::Unknown,
    };

    /// Standard deviation of a reading whose dark-subtracted level is `level`.
    pub fn sigma(&self, level: f64) -> f64 {
        self.readout.hypot(self.relative * level)
    }

    /// The model a record states; a part that it leaves open counts as zero. `None` when it states neither part.
    pub fn stated(meta: &ScanMeta) -> Option<Self> {
        if meta.noise_readout.is_none() && meta.noise_relative.is_none() {
            return None;
        }
        Some(NoiseModel {
            readout: meta.noise_readout.unwrap_or(0.0).max(0.0),
            relative: meta.noise_relative.unwrap_or(0.0).max(0.0),
            origin: NoiseOrigin::Stated,
        })
    }

    /// Estimates the noise from readings that follow one another on the detector's path.
    ///
    /// Second and fourth differences of equally spaced neighbours cancel a smooth signal; for independent noise
    /// their standard deviations are `sqrt(6)` and `sqrt(70)` times that of one reading. In every level bin the two
    /// are averaged, or the smaller is kept where they disagree (what is left of the signal only ever enlarges
    /// them), each by a median, so that edges and outliers do not count. `readout` comes from `dark` where that has
    /// enough readings, else from the lowest bins of `sample`; `relative` is the median over the bins in which it
    /// shows, each with the weight of its windows. Levels count from the median of `dark`. Returns
    /// [`NoiseModel::UNKNOWN`] when no bin holds enough windows. A coarse grid over a narrow lobe gives an upper
    /// bound, since its unresolved structure counts as noise.
    pub fn estimate(sample: &[&Scan], dark: &[&Scan]) -> Self {
        let dark_readout = scatter_of(dark);
        let bins = level_bins(sample, dark_readout.unwrap_or(0.0), dark_level(dark));
        let readout = dark_readout.or_else(|| bins.first().and_then(Bin::sigma));
        let Some(readout) = readout else {
            return NoiseModel::UNKNOWN;
        };
        let fractions: Vec<(f64, usize)> = bins
            .iter()
            .filter(|b| b.level > 0.0)
            .filter_map(|b| Some((b.relative(readout)?, b.level, b.windows.len())))
            .filter(|&(q, level, _)| q * level > readout)
            .map(|(q, _, n)| (q, n))
            .collect();
        NoiseModel {
            readout,
            relative: weighted_median(fractions).unwrap_or(0.0),
            origin: NoiseOrigin::Estimated,
        }
    }
}

/// Median of the finite dark readings; 0 without any.
fn dark_level(dark: &[&Scan]) -> f64 {
    let mut all: Vec<f64> = dark
        .iter()
        .flat_map(|s| s.value.iter().copied())
        .filter(|v| v.is_finite())
        .collect();
    median(&mut all).unwrap_or(0.0)
}

/// The value at which half of the total weight is reached.
fn weighted_median(mut values: Vec<(f64, usize)>) -> Option<f64> {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: usize = values.iter().map(|v| v.1).sum();
    let mut sum = 0;
    values
        .iter()
        .find(|v| {
            sum += v.1;
            2 * sum >= total
        })
        .map(|v| v.0)
}

/// Windows of similar level.
struct Bin {
    level: f64,
    windows: Vec<Window>,
}

/// Square of the median absolute value of a standard normal variable.
const MEDIAN_SQUARE: f64 = 0.454_936_423_119_572_8;

impl Bin {
    /// Standard deviation of a reading of this bin, whatever its level.
    fn sigma(&self) -> Option<f64> {
        let of = |pick: fn(&Window) -> f64| {
            sigma_about_zero(&mut self.windows.iter().map(pick).collect::<Vec<_>>())
        };
        self.agree(of(|w| w.second)?, of(|w| w.fourth)?)
    }

    /// The proportional noise `q` for which half of the differences `d` lie below the median of their distribution,
    /// `d^2 < m (readout^2 + (q level)^2)`: the median of `(d^2 / m - readout^2) / level^2` is `q^2` whatever the
    /// spread of levels.
    fn relative(&self, readout: f64) -> Option<f64> {
        let of = |pick: fn(&Window) -> f64| {
            let mut squares: Vec<f64> = self
                .windows
                .iter()
                .filter(|w| w.level > 0.0)
                .map(|w| (pick(w).powi(2) / MEDIAN_SQUARE - readout * readout) / (w.level * w.level))
                .collect();
            median(&mut squares).map(|q2| q2.max(0.0).sqrt())
        };
        self.agree(of(|w| w.second)?, of(|w| w.fourth)?)
    }

    /// Mean of the two estimates, or the smaller one when they differ by more than three times their scatter: a
    /// median of absolute values scatters by 1.17 / sqrt(n), windows overlap threefold.
    fn agree(&self, second: f64, fourth: f64) -> Option<f64> {
        let scatter = 2.0 / (self.windows.len() as f64).sqrt();
        let (low, high) = (second.min(fourth), second.max(fourth));
        Some(if high - low > 3.0 * scatter * low {
            low
        } else {
            0.5 * (low + high)
        })
    }
}

/// Scatter of all windows of the records together, whatever their level.
fn scatter_of(scans: &[&Scan]) -> Option<f64> {
    let mut second = Vec::new();
    let mut fourth = Vec::new();
    for scan in scans {
        for w in windows(scan) {
            second.push(w.second);
            fourth.push(w.fourth);
        }
    }
    if second.len() < MIN_WINDOWS {
        // A dark record without directions of its own (shutter closed, one position): its plain scatter.
        let mut all: Vec<f64> = Vec::new();
        for scan in scans {
            let mut level: Vec<f64> = scan.value.iter().copied().filter(|v| v.is_finite()).collect();
            let Some(centre) = median(&mut level) else {
                continue;
            };
            all.extend(level.iter().map(|v| v - centre));
        }
        return (all.len() >= MIN_WINDOWS)
            .then(|| sigma_about_zero(&mut all))
            .flatten();
    }
    Some(sigma_about_zero(&mut second)?.min(sigma_about_zero(&mut fourth)?))
}

/// Windows by level above `dark`, lowest level first; levels below `floor` share the first bin.
fn level_bins(scans: &[&Scan], floor: f64, dark: f64) -> Vec<Bin> {
    let mut all: Vec<Window> = scans.iter().flat_map(|s| windows(s)).collect();
    for w in &mut all {
        w.level -= dark;
    }
    let mut scale: Vec<f64> = all.iter().map(|w| w.second.abs()).collect();
    let lowest = floor
        .max(median(&mut scale).unwrap_or(0.0) * 1e-3)
        .max(f64::MIN_POSITIVE);
    let mut bins = std::collections::BTreeMap::<i64, Vec<Window>>::new();
    for w in all {
        let key = if w.level <= lowest {
            -1
        } else {
            ((w.level / lowest).log10() * BINS_PER_DECADE) as i64
        };
        bins.entry(key).or_default().push(w);
    }
    bins.into_values()
        .filter(|members| members.len() >= MIN_WINDOWS)
        .filter_map(|windows| {
            let mut level: Vec<f64> = windows.iter().map(|w| w.level).collect();
            Some(Bin {
                level: median(&mut level)?,
                windows,
            })
        })
        .collect()
}

struct Window {
    level: f64,
    second: f64,
    fourth: f64,
}

/// Every window of five successive, equally spaced, finite readings (thinned to [`MAX_WINDOWS`]), its differences
/// scaled to the standard deviation of one reading.
fn windows(scan: &Scan) -> Vec<Window> {
    let n = scan.len();
    if n < 5 {
        return Vec::new();
    }
    let stride = (n / MAX_WINDOWS).max(1);
    let mut out = Vec::with_capacity((n / stride).min(MAX_WINDOWS + 1));
    for start in (0..n - 4).step_by(stride) {
        let v = &scan.value[start..start + 5];
        if v.iter().any(|x| !x.is_finite() || *x == 0.0) {
            continue;
        }
        let d: [Direction; 5] = std::array::from_fn(|k| scan.direction(start + k));
        let step: [f64; 4] = std::array::from_fn(|k| d[k].angle_to(d[k + 1]));
        let (least, most) = step
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(a, b), &s| (a.min(s), b.max(s)));
        // A turn-round has equal steps too but comes back on itself.
        let straight = d[0].angle_to(d[4]) > 0.8 * step.iter().sum::<f64>();
        if !(least > 0.0 && most <= 1.2 * least && straight) {
            continue;
        }
        out.push(Window {
            level: v.iter().sum::<f64>() / 5.0,
            second: (v[1] - 2.0 * v[2] + v[3]) / 6.0_f64.sqrt(),
            fourth: (v[0] - 4.0 * v[1] + 6.0 * v[2] - 4.0 * v[3] + v[4]) / 70.0_f64.sqrt(),
        });
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Noise, path_scan};

    #[test]
    fn read_out_and_proportional_noise_are_found_without_the_truth() {
        let (readout, relative) = (2e-4_f64, 0.01_f64);
        let mut noise = Noise::new(7);
        // A lobe of 10 degrees on a diffuse floor, rings of 0.25 degrees along the path.
        let signal = |d: Direction| {
            let gamma = d.angle_to(Direction::from_degrees(30.0, 180.0));
            1e-3 + (-gamma * gamma / 0.03).exp()
        };
        let scan = path_scan(3.0, 0.25, |d| {
            let s = signal(d);
            s + noise.normal() * readout.hypot(relative * s)
        });
        let found = NoiseModel::estimate(&[&scan], &[]);
        assert!(
            (found.readout / readout - 1.0).abs() < 0.1,
            "readout {}",
            found.readout
        );
        assert!(
            (found.relative / relative - 1.0).abs() < 0.1,
            "relative {}",
            found.relative
        );
        assert_eq!(found.origin, NoiseOrigin::Estimated);
    }

    #[test]
    fn the_read_out_noise_of_the_dark_record_is_not_raised_by_its_drift() {
        let mut noise = Noise::new(3);
        let mut k = 0.0;
        let dark = path_scan(5.0, 1.0, |_| {
            k += 1e-4;
            0.3 + k + 0.05 * noise.normal()
        });
        let found = NoiseModel::estimate(&[], &[&dark]);
        assert!((found.readout / 0.05 - 1.0).abs() < 0.08, "{}", found.readout);
    }

    #[test]
    fn too_few_readings_give_no_model() {
        let scan = Scan {
            theta_s: vec![0.0; 3],
            phi_s: vec![0.0; 3],
            value: vec![1.0; 3],
            ..path_scan(45.0, 45.0, |_| 1.0)
        };
        assert_eq!(NoiseModel::estimate(&[&scan], &[]), NoiseModel::UNKNOWN);
    }
}
