//! From rows that repeat their incidence to scans.

use std::collections::HashMap;
use std::path::Path;

use gonio_bsdf::{Channel, Quantity};
use gonio_geom::{Angles, EXTENDED_THETA};
use gonio_scan::{Scan, ScanKind, ScanMeta};

use crate::IoError;
use crate::table::Row;

/// What the rows of one scan share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Key {
    pub(crate) kind: ScanKind,
    pub(crate) quantity: Quantity,
    pub(crate) channel: Channel,
    pub(crate) incidence: Angles,
}

impl Key {
    fn is_of(&self, scan: &Scan) -> bool {
        (self.kind, self.quantity, self.channel, self.incidence)
            == (scan.kind, scan.quantity, scan.channel, scan.incidence)
    }
}

/// Scans in the making, in the order of their first row.
#[derive(Default)]
pub(crate) struct Scans {
    scans: Vec<Scan>,
    /// Scans of each incidence, by its bits.
    places: HashMap<(u64, u64), Vec<usize>>,
}

impl Scans {
    /// Adds a reading and returns the index of its scan.
    pub(crate) fn push(&mut self, key: Key, receiver: Angles, value: f64, time: Option<f64>) -> usize {
        let incidence = (key.incidence.theta.to_bits(), key.incidence.phi.to_bits());
        let candidates = self.places.entry(incidence).or_default();
        let known = candidates.iter().copied().find(|&k| key.is_of(&self.scans[k]));
        let place = known.unwrap_or(self.scans.len());
        if known.is_none() {
            candidates.push(place);
            self.scans.push(Scan {
                kind: key.kind,
                quantity: key.quantity,
                channel: key.channel,
                incidence: key.incidence,
                theta_s: Vec::new(),
                phi_s: Vec::new(),
                value: Vec::new(),
                time: time.map(|_| Vec::new()),
                meta: ScanMeta::default(),
            });
        }
        let scan = &mut self.scans[place];
        scan.theta_s.push(receiver.theta);
        scan.phi_s.push(receiver.phi);
        scan.value.push(value);
        if let (Some(times), Some(t)) = (&mut scan.time, time) {
            times.push(t);
        }
        place
    }

    /// The scans, each with `meta`.
    ///
    /// # Errors
    /// No readings at all.
    pub(crate) fn finish(mut self, path: &Path, meta: &ScanMeta) -> Result<Vec<Scan>, IoError> {
        if self.scans.is_empty() {
            return Err(IoError::format(
                path,
                None,
                "readings",
                "nothing",
                "at least one row below the header row",
            ));
        }
        for scan in &mut self.scans {
            scan.meta = meta.clone();
        }
        Ok(self.scans)
    }
}

/// Canonical angles of a direction that a row states in degrees.
///
/// # Errors
/// Angles outside the ranges of [`Angles::from_stated_degrees`].
pub(crate) fn angles(row: &Row<'_>, names: [&str; 2], theta: f64, phi: f64) -> Result<Angles, IoError> {
    Angles::from_stated_degrees(theta, phi).ok_or_else(|| {
        if EXTENDED_THETA.contains(&theta) {
            row.fault(names[1], phi.to_string(), "-360 to 720 degrees")
        } else {
            row.fault(names[0], theta.to_string(), "-180 to 270 degrees")
        }
    })
}
