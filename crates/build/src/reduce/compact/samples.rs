//! Pairs over the coordinates of a table, with what the model and the base answer there.

use gonio_bsdf::compact::{Frame, LARGEST};

use super::base::Base;
use super::source::{Pair, Source, spread};

/// Least ratio to the base that is told apart from none.
const LEAST_LOG: f64 = -7.0;
/// Largest.
const LARGEST_LOG: f64 = 12.0;
/// Stretches of the incidence axis over each of which the light is made equal.
const STRETCHES: usize = 16;
/// Cosine of 75 degrees: light of incidences beyond counts by the share of it that an even sky sends there.
const STEEP: f64 = 0.258_819_045_102_520_76;
/// End of the incidence axis for what is drawn: 89.4 degrees.
const END: f64 = 0.985;

const _: () = assert!(LARGEST_LOG <= LARGEST);

/// Logarithms and weights of one channel.
#[derive(Clone, Debug, Default)]
pub(super) struct Column {
    /// `ln(f / base)`.
    pub(super) log: Vec<f32>,
    /// Light of the pair, `f cos` times solid angle, in units of the mean of its incidence; beyond 75 degrees less, as
    /// `cos(theta_i) / cos(75 deg)`.
    pub(super) weight: Vec<f32>,
}

/// Pairs spread over a table.
pub(super) struct Samples {
    pub(super) pairs: Vec<Pair>,
    /// Places in nodes along the axes.
    pub(super) places: Vec<[f32; 4]>,
    pub(super) columns: Vec<Column>,
    /// `f cos` times solid angle, all channels together.
    pub(super) light: Vec<f64>,
    /// Mean albedo over the incidences, all channels together.
    pub(super) albedo: f64,
}

/// `ln(f / base)` within the range that is kept.
pub(super) fn log_ratio(f: f64, base: f64) -> f64 {
    (f / base).ln().clamp(LEAST_LOG, LARGEST_LOG)
}

/// Length of each axis of coordinates.
pub(super) fn spans(frame: &Frame) -> [f64; 4] {
    let density = frame.density();
    [0, 1, 2, 3].map(|k| {
        let nodes = frame.shape[k] as f64;
        let round = frame.is_round(k);
        if density[k] > 0.0 {
            (if round { nodes } else { nodes - 1.0 }) / density[k]
        } else {
            0.0
        }
    })
}

/// `count` points of the sequence from `first` on, those that are pairs.
pub(super) fn draw(source: &Source<'_>, base: &Base, frame: &Frame, first: u32, count: usize) -> Samples {
    let (spans, density) = (spans(frame), frame.density());
    let (mut pairs, mut places, mut angles) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..count as u32 {
        let unit = spread(first.wrapping_add(k));
        let at = [0, 1, 2, 3].map(|a| unit[a] * spans[a] * if a == 0 { END } else { 1.0 });
        if let Some((wi, ws, solid_angle)) = frame.pair(at) {
            pairs.push((wi, ws));
            places.push([0, 1, 2, 3].map(|a| (at[a] * density[a]) as f32));
            angles.push(solid_angle * ws.cos_theta());
        }
    }
    let (f, b) = (source.many(&pairs), base.many(source, &pairs));
    let n = source.channels();
    let mut columns = vec![Column::default(); n];
    for (c, column) in columns.iter_mut().enumerate() {
        let mut sums = [(0.0, 0usize); STRETCHES];
        let stretch = |place: &[f32; 4]| {
            let x = f64::from(place[0]) / density[0];
            ((x * STRETCHES as f64) as usize).min(STRETCHES - 1)
        };
        for (j, place) in places.iter().enumerate() {
            let sum = &mut sums[stretch(place)];
            sum.0 += f[j * n + c] * angles[j];
            sum.1 += 1;
        }
        for (j, place) in places.iter().enumerate() {
            let (f, b) = (f[j * n + c], b[j * n + c]);
            let (sum, number) = sums[stretch(place)];
            let weight = if sum > 0.0 {
                let slant = (pairs[j].0.cos_theta() / STEEP).min(1.0);
                slant * f * angles[j] * number as f64 / sum
            } else {
                0.0
            };
            column.log.push(log_ratio(f, b) as f32);
            column.weight.push(weight as f32);
        }
    }
    let light: Vec<f64> = f
        .chunks(n)
        .zip(&angles)
        .map(|(f, angle)| f.iter().sum::<f64>() * angle)
        .collect();
    let area = spans[2]
        * spans[3]
        * if frame.symmetry.is_isotropic() && spans[3] < 3.0 {
            2.0
        } else {
            1.0
        };
    Samples {
        albedo: light.iter().sum::<f64>() * area / count as f64,
        pairs,
        places,
        columns,
        light,
    }
}
