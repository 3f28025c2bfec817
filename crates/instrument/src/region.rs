//! Regions of the path that are read more densely, and paths given reading by reading.

use std::f64::consts::PI;

use gonio_geom::{Angles, Component, Direction};

use crate::InstrumentError;
use crate::error::in_range;

/// A patch of rings around the mirror or the unbent direction whose pitch grows with the distance from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Radius, radians, `(0, pi/2]`.
    pub radius: f64,
    /// Pitch between rings at the centre, radians, `>= 0.0002`.
    pub pitch: f64,
    /// Growth of the pitch per unit distance from the centre, `[0, 1]`.
    pub growth: f64,
    /// Pitch along a ring as a share of the pitch between rings, `[0.1, 2]`.
    pub along: f64,
}

impl Default for Patch {
    /// 25 degrees wide, .2 degrees at the centre growing by .04, six tenths of that along the rings.
    fn default() -> Self {
        Patch {
            radius: 25.0_f64.to_radians(),
            pitch: 0.2_f64.to_radians(),
            growth: 0.04,
            along: 0.6,
        }
    }
}

impl Patch {
    pub(crate) fn check(&self) -> Result<(), InstrumentError> {
        in_range("patch radius", self.radius, 1e-3, 0.5 * PI, " rad")?;
        in_range("patch pitch", self.pitch, 2e-4, 0.5, " rad")?;
        in_range("patch growth", self.growth, 0.0, 1.0, "")?;
        in_range("patch along", self.along, 0.1, 2.0, "")
    }
}

/// What a region lies around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Around {
    /// The mirror direction; reflection.
    Mirror,
    /// The unbent direction; transmission.
    Through,
    /// The direction of incidence; reflection, but for the detector's shadow.
    Retro,
    /// A given direction, whatever the incidence; the hemisphere it lies in.
    At(Angles),
}

impl Around {
    /// The centre for incidence `wi` over the hemisphere of `component`, if it has one there.
    pub fn centre(self, wi: Direction, component: Component) -> Option<Direction> {
        let (of, centre) = match self {
            Around::Mirror => (Component::Reflection, wi.mirror()),
            Around::Through => (Component::Transmission, wi.through()),
            Around::Retro => (Component::Reflection, wi),
            Around::At(angles) => {
                let centre = angles.direction();
                let of = if centre.side() == wi.side() {
                    Component::Reflection
                } else {
                    Component::Transmission
                };
                (of, centre)
            }
        };
        (of == component).then_some(centre)
    }
}

/// A refined region of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// What it lies around.
    pub around: Around,
    /// Its rings.
    pub patch: Patch,
}

/// A fast scan before the scan proper whose peaks are given refined regions; its readings are not kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prescan {
    /// Pitch of the fast scan in both directions, radians, `[0.005, 0.5]`.
    pub pitch: f64,
    /// A reading is a peak when it exceeds this many times the median of those within three pitches, `[1.1, 1e6]`.
    pub threshold: f64,
    /// Peaks that are given a region at most, the highest first, `1..=100`.
    pub count: usize,
    /// The region around each.
    pub patch: Patch,
}

impl Prescan {
    pub(crate) fn check(&self) -> Result<(), InstrumentError> {
        in_range("prescan pitch", self.pitch, 0.005, 0.5, " rad")?;
        in_range("prescan threshold", self.threshold, 1.1, 1e6, "")?;
        in_range("prescan count", self.count as f64, 1.0, 100.0, "")?;
        self.patch.check()
    }

    /// Peaks among readings `value` at `at`, free of the dark level and with read-out noise of `sigma`: highest within two
    /// pitches, above the threshold and five deviations of the noise, outside all of `known` (centre and radius). Highest first.
    pub(crate) fn peaks(
        &self,
        at: &[Direction],
        value: &[f64],
        sigma: f64,
        known: &[(Direction, f64)],
    ) -> Vec<Direction> {
        let mut found: Vec<usize> = (0..at.len())
            .filter(|&j| value[j] > 5.0 * sigma && !known.iter().any(|(c, r)| at[j].angle_to(*c) < 0.5 * r))
            .filter(|&j| {
                let close = |pitches: f64| {
                    let cosine = (pitches * self.pitch).cos();
                    (0..at.len()).filter(move |&k| k != j && at[j].dot(at[k]) > cosine)
                };
                if close(2.0).any(|k| value[k] > value[j]) {
                    return false;
                }
                let mut around: Vec<f64> = close(3.0).map(|k| value[k]).collect();
                around.sort_by(f64::total_cmp);
                let median = around.get(around.len() / 2).copied().unwrap_or(0.0);
                value[j] > self.threshold * median.max(sigma)
            })
            .collect();
        found.sort_by(|&j, &k| value[k].total_cmp(&value[j]));
        found.truncate(self.count);
        found.into_iter().map(|j| at[j]).collect()
    }
}

/// A path given reading by reading: for each incidence the directions in the order they are read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PathTable {
    /// Incidence and directions.
    pub lines: Vec<(Angles, Vec<Direction>)>,
}

impl PathTable {
    /// The directions for `incidence`, which lies within .01 degrees of one of the table's.
    pub fn of(&self, incidence: Direction) -> Option<&[Direction]> {
        let near = |a: &Angles| a.direction().angle_to(incidence) < 0.01_f64.to_radians();
        self.lines
            .iter()
            .find(|(a, _)| near(a))
            .map(|(_, d)| d.as_slice())
    }
}
