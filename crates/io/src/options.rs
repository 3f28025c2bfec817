//! What the user states about a file because the file does not.

use gonio_bsdf::{Channel, Quantity};
use gonio_scan::ScanKind;

use crate::Format;
use crate::table::TableMapping;

/// What a reader is told beside the file. Everything is optional; what a file states itself may be repeated here but
/// not contradicted.
#[derive(Debug, Clone, Default)]
pub struct ReadOptions {
    /// Format of the file; recognised by content when `None`.
    pub format: Option<Format>,
    /// What the records were taken for, for formats that do not say (their default is a sample).
    pub kind: Option<ScanKind>,
    /// Quantity of the values, for formats that do not say.
    pub quantity: Option<Quantity>,
    /// Spectral channel, for formats that do not say.
    pub channel: Option<Channel>,
    /// Azimuth of the sample's up mark in a Mountain file, degrees, in place of the file's `#upphi`; 90 keeps the
    /// azimuths as written.
    pub upphi: Option<f64>,
    /// Columns of a table.
    pub table: TableMapping,
}
