//! Patterns.

use std::sync::Arc;

use gonio_trace::pattern::Pattern;

use super::modifier::{Modifier, type_word};
use crate::error::SceneError;
use crate::text::Files;

/// The pattern of a modifier.
pub(super) fn pattern(modifier: &Modifier, _files: &Files) -> Result<Arc<dyn Pattern>, SceneError> {
    Err(modifier.place.fault(
        "type",
        type_word(&modifier.body),
        "no pattern: gonio does not render it yet, and without it the picture would be another",
    ))
}
