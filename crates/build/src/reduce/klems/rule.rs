//! Quadrature over a ring of patches.

use gonio_bsdf::klems::Ring;

/// The coordinate of a ring at the share `t` of its way in cosine, with the weight of projected solid angle there.
///
/// Models are smooth in the cosine of the polar angle; in the sine squared they have infinite slope at the horizon.
pub(super) fn in_cosine(ring: &Ring, t: f64) -> (f64, f64) {
    let near = ring.theta_lo.to_radians().cos();
    let far = if ring.theta_hi == 90.0 {
        0.0
    } else {
        ring.theta_hi.to_radians().cos()
    };
    let c = near + t * (far - near);
    let u = (near * near - c * c) / (near * near - far * far);
    (u, 2.0 * c / (near + far))
}
