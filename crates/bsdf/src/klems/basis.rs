//! Klems angle bases: rings of polar angle cut into azimuthal patches.

use std::f64::consts::{PI, TAU};

use gonio_geom::{DVec3, Direction, Side};

use crate::BsdfError;

/// One ring of patches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Lower polar bound in degrees.
    pub theta_lo: f64,
    /// Upper polar bound in degrees.
    pub theta_hi: f64,
    /// Number of azimuthal patches; patch `k` is centred at `360 k / n_phi` degrees.
    pub n_phi: usize,
    /// Index of the ring's first patch.
    pub first: usize,
}

impl Ring {
    /// Projected solid angle of each patch of the ring, sr: `pi (cos^2 lo - cos^2 hi) / n_phi` [Klems1994].
    pub fn projected_solid_angle(&self) -> f64 {
        let lo = self.theta_lo.to_radians().cos();
        let hi = cos_degrees(self.theta_hi);
        PI * (lo * lo - hi * hi) / self.n_phi as f64
    }
}

/// Cosine with the horizon exact, so that the projected solid angles sum to pi to the last digit.
fn cos_degrees(theta: f64) -> f64 {
    if theta == 90.0 {
        0.0
    } else {
        theta.to_radians().cos()
    }
}

/// Which way a direction is looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The incident direction: its azimuth is turned by 180 degrees, so that mirror reflection and unbent
    /// transmission lie on the diagonal of a matrix.
    Incident,
    /// The exit direction: its own azimuth.
    Exit,
}

impl Role {
    fn turn(self) -> f64 {
        match self {
            Role::Incident => -1.0,
            Role::Exit => 1.0,
        }
    }
}

/// A hemisphere cut into rings of patches.
#[derive(Clone, Debug, PartialEq)]
pub struct KlemsBasis {
    name: String,
    rings: Vec<Ring>,
    lambda: Vec<f64>,
    ring_of: Vec<usize>,
}

impl KlemsBasis {
    /// A basis of the polar bounds `bounds` in degrees (rising from 0 to 90, one more than rings) and the number of
    /// patches of each ring.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] when the bounds do not rise from 0 to 90 or a ring has no patch.
    pub fn new(name: impl Into<String>, bounds: &[f64], n_phi: &[usize]) -> Result<Self, BsdfError> {
        let rising = bounds.windows(2).all(|w| w[0] < w[1]);
        let ends = bounds.first() == Some(&0.0) && bounds.last() == Some(&90.0);
        if !(rising && ends && bounds.len() == n_phi.len() + 1) {
            return Err(BsdfError::Domain {
                field: "theta bounds",
                found: format!("{bounds:?} for {} rings", n_phi.len()),
                allowed: "one bound more than rings, rising from 0 to 90 degrees".into(),
            });
        }
        if let Some(bad) = n_phi.iter().find(|&&n| n == 0 || n > 10_000) {
            return Err(BsdfError::Domain {
                field: "patches in a ring",
                found: bad.to_string(),
                allowed: "1 to 10000".into(),
            });
        }
        let mut rings = Vec::with_capacity(n_phi.len());
        let mut first = 0;
        for (k, &n) in n_phi.iter().enumerate() {
            rings.push(Ring {
                theta_lo: bounds[k],
                theta_hi: bounds[k + 1],
                n_phi: n,
                first,
            });
            first += n;
        }
        let lambda = rings
            .iter()
            .flat_map(|r| std::iter::repeat_n(r.projected_solid_angle(), r.n_phi))
            .collect();
        let ring_of = rings
            .iter()
            .enumerate()
            .flat_map(|(i, r)| std::iter::repeat_n(i, r.n_phi))
            .collect();
        Ok(KlemsBasis {
            name: name.into(),
            rings,
            lambda,
            ring_of,
        })
    }

    fn known(name: &str, bounds: &[f64], n_phi: &[usize]) -> Self {
        match KlemsBasis::new(name, bounds, n_phi) {
            Ok(basis) => basis,
            Err(e) => unreachable!("the tables of this file are valid: {e}"),
        }
    }

    /// `LBNL/Klems Full`: 9 rings.
    pub fn full() -> Self {
        KlemsBasis::known(
            "LBNL/Klems Full",
            &[0.0, 5.0, 15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0, 90.0],
            &[1, 8, 16, 20, 24, 24, 24, 16, 12],
        )
    }

    /// `LBNL/Klems Half`: 7 rings.
    pub fn half() -> Self {
        KlemsBasis::known(
            "LBNL/Klems Half",
            &[0.0, 6.5, 19.5, 32.5, 45.5, 58.5, 71.5, 90.0],
            &[1, 8, 12, 16, 20, 12, 8],
        )
    }

    /// `LBNL/Klems Quarter`: 5 rings.
    pub fn quarter() -> Self {
        KlemsBasis::known(
            "LBNL/Klems Quarter",
            &[0.0, 9.0, 27.0, 45.0, 63.0, 90.0],
            &[1, 8, 12, 12, 8],
        )
    }

    /// One of the three standard bases by its name, with or without `LBNL/Klems`, in any case.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] for any other name.
    pub fn by_name(name: &str) -> Result<Self, BsdfError> {
        let key = name.trim().to_ascii_lowercase();
        let key = key.strip_prefix("lbnl/klems").map_or(key.as_str(), str::trim);
        match key {
            "full" => Ok(KlemsBasis::full()),
            "half" => Ok(KlemsBasis::half()),
            "quarter" => Ok(KlemsBasis::quarter()),
            _ => Err(BsdfError::Domain {
                field: "basis",
                found: format!("{name:?}"),
                allowed: "full, half, quarter".into(),
            }),
        }
    }

    /// Name of the basis as files write it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.lambda.len()
    }

    /// Whether there is no patch (never, by construction).
    pub fn is_empty(&self) -> bool {
        self.lambda.is_empty()
    }

    /// The rings from the normal to the horizon.
    pub fn rings(&self) -> &[Ring] {
        &self.rings
    }

    /// The ring of patch `patch` (panics past the last patch).
    pub fn ring(&self, patch: usize) -> &Ring {
        &self.rings[self.ring_of[patch]]
    }

    /// Index of the ring of patch `patch` (panics past the last patch).
    pub fn ring_index(&self, patch: usize) -> usize {
        self.ring_of[patch]
    }

    /// Projected solid angle of each patch, sr; they sum to pi.
    pub fn lambda(&self) -> &[f64] {
        &self.lambda
    }

    /// Patch of a direction, whichever side it leaves to. Patches hold their lower polar bound and are centred on
    /// multiples of `360 / n_phi` degrees.
    pub fn patch(&self, direction: Direction, role: Role) -> usize {
        let v = direction.vec();
        let theta = v.x.hypot(v.y).atan2(v.z.abs()).to_degrees();
        let ring = self
            .rings
            .iter()
            .rfind(|r| r.theta_lo <= theta)
            .unwrap_or(&self.rings[0]);
        let turn = role.turn();
        let phi = (turn * v.y).atan2(turn * v.x).rem_euclid(TAU);
        let k = (phi / TAU * ring.n_phi as f64 + 0.5) as usize;
        ring.first + if k >= ring.n_phi { 0 } else { k }
    }

    /// A direction in patch `patch`: `(u, v)` in `[0, 1]^2` is uniform in projected solid angle.
    pub fn point(&self, patch: usize, role: Role, side: Side, u: f64, v: f64) -> Direction {
        let ring = self.ring(patch);
        let lo = ring.theta_lo.to_radians().sin();
        let hi = ring.theta_hi.to_radians().sin();
        let sin2 = lo * lo + u * (hi * hi - lo * lo);
        let phi = (patch - ring.first) as f64 - 0.5 + v;
        let phi = phi * TAU / ring.n_phi as f64;
        let r = sin2.max(0.0).sqrt();
        let turn = role.turn();
        let z = side.sign() * (1.0 - sin2).max(0.0).sqrt();
        let vec = DVec3::new(turn * r * phi.cos(), turn * r * phi.sin(), z);
        Direction::new(vec).unwrap_or(Direction::NORMAL)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> [KlemsBasis; 3] {
        [KlemsBasis::full(), KlemsBasis::half(), KlemsBasis::quarter()]
    }

    #[test]
    fn the_standard_bases_have_145_77_and_41_patches() {
        assert_eq!(all().map(|b| b.len()), [145, 77, 41]);
    }

    #[test]
    fn projected_solid_angles_sum_to_pi() {
        for basis in all() {
            let sum: f64 = basis.lambda().iter().sum();
            assert!((sum - PI).abs() < 1e-13, "{}: {sum}", basis.name());
        }
    }

    #[test]
    fn a_point_of_a_patch_lies_in_that_patch() {
        for basis in all() {
            for patch in 0..basis.len() {
                for (u, v) in [(0.5, 0.5), (0.01, 0.01), (0.99, 0.01), (0.01, 0.99), (0.99, 0.99)] {
                    for role in [Role::Incident, Role::Exit] {
                        for side in Side::BOTH {
                            let d = basis.point(patch, role, side, u, v);
                            assert_eq!(d.side(), side);
                            assert_eq!(basis.patch(d, role), patch);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn mirror_and_through_directions_share_the_index_of_their_incidence() {
        let basis = KlemsBasis::full();
        for theta in [2.0, 12.0, 37.0, 61.0, 88.0] {
            for phi in [3.0, 97.0, 181.0, 290.0] {
                let wi = Direction::from_degrees(theta, phi);
                let i = basis.patch(wi, Role::Incident);
                assert_eq!(basis.patch(wi.mirror(), Role::Exit), i);
                assert_eq!(basis.patch(wi.through(), Role::Exit), i);
            }
        }
    }

    #[test]
    fn bounds_that_do_not_reach_the_horizon_are_refused() {
        assert!(KlemsBasis::new("x", &[0.0, 30.0, 80.0], &[1, 8]).is_err());
        assert!(KlemsBasis::new("x", &[0.0, 30.0, 30.0, 90.0], &[1, 8, 8]).is_err());
        assert!(KlemsBasis::new("x", &[0.0, 90.0], &[0]).is_err());
        assert!(KlemsBasis::by_name("third").is_err());
        assert_eq!(KlemsBasis::by_name("LBNL/Klems Half"), Ok(KlemsBasis::half()));
    }
}
