//! Nodes on the unit interval, computed once.

use std::sync::LazyLock;

use gonio_geom::quadrature::gauss_legendre;

static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_legendre(64));

/// The nodes in `(0, 1)` with their weights, which sum to 1; exact for polynomials of degree up to 127.
pub(super) fn unit_interval() -> impl Iterator<Item = (f64, f64)> {
    RULE.iter().copied()
}
