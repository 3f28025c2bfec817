//! The sun and the sky: where the sun stands, and radiance by direction of clear, overcast and measured skies.
//!
//! Directions are unit vectors towards the sky: x east, y north, z up. Radiances are in W/(m² sr), in the unit of RADIANCE
//! (179 lm/W); all skies here are grey.

pub mod cie;
pub mod general;
pub mod perez;
pub mod sun;
#[cfg(test)]
mod tests;

/// The sun as a light at infinity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// Unit direction towards it.
    pub direction: [f64; 3],
    /// Full angle of its disc, radians.
    pub angle: f64,
    /// Radiance of the disc, the same in red, green and blue.
    pub radiance: f64,
}

/// Radiance of a sky and of the ground below, a soft step between them at the horizon, as RADIANCE's function files mix
/// them [Radiance, skybright.cal].
fn above(ground: f64, sky: f64, up: f64) -> f64 {
    let weight = (up + 1.01).powi(10);
    (sky * weight + ground / weight) / (weight + 1.0 / weight)
}

/// Angle between two unit vectors, and its cosine.
fn between(a: [f64; 3], b: [f64; 3]) -> (f64, f64) {
    let cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    (cosine.clamp(-1.0, 1.0).acos(), cosine)
}
