//! Tables of readings whose columns the user names (docs/formats/table.md).

/// Which column of a table is what.
#[derive(Debug, Clone, Default)]
pub struct TableMapping {}
