//! Times of readings on one common scale.

use jiff::Timestamp;
use jiff::civil::DateTime;
use jiff::tz::TimeZone;

use crate::{Scan, ScanError};

/// Seconds since 1970-01-01 UTC at which a record started; `None` when it does not say. A time without an offset
/// counts as UTC (all records of one instrument share their clock).
///
/// # Errors
/// [`ScanError::Domain`] when `meta.started` is not ISO 8601.
pub(crate) fn started(scan: &Scan) -> Result<Option<f64>, ScanError> {
    let Some(text) = scan.meta.started.as_deref() else {
        return Ok(None);
    };
    let text = text.trim();
    let stamp = text
        .parse::<Timestamp>()
        .or_else(|_| {
            text.parse::<DateTime>()
                .and_then(|t| t.to_zoned(TimeZone::UTC))
                .map(|z| z.timestamp())
        })
        .map_err(|_| ScanError::Domain {
            field: "started",
            found: format!("{text:?}"),
            allowed: "ISO 8601, for example 2026-03-01T09:30:00".into(),
        })?;
    Ok(Some(stamp.as_nanosecond() as f64 * 1e-9))
}

/// Time of reading `j` in seconds, given when its record started.
pub(crate) fn reading_time(scan: &Scan, start: f64, j: usize) -> f64 {
    start + scan.time.as_ref().and_then(|t| t.get(j)).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::record;

    #[test]
    fn times_with_and_without_an_offset_share_one_scale() {
        let mut a = record(0.0, 0.0);
        let mut b = record(0.0, 0.0);
        a.meta.started = Some("2026-03-01T09:30:00".into());
        b.meta.started = Some("2026-03-01T10:30:00+01:00".into());
        assert_eq!(started(&a), started(&b));
        a.meta.started = Some("2026-03-01 09:30:10.5".into());
        assert_eq!(
            started(&a).unwrap().unwrap() - started(&b).unwrap().unwrap(),
            10.5
        );
    }

    #[test]
    fn a_time_that_is_none_is_an_error() {
        let mut a = record(0.0, 0.0);
        a.meta.started = Some("yesterday".into());
        assert!(started(&a).is_err());
    }
}
