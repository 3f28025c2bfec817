//! Synthetic records for the tests of this crate.

use gonio_bsdf::{Channel, Quantity};
use gonio_geom::{Angles, Direction, Side};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use crate::{Scan, ScanKind, ScanMeta};

/// Deviates from a fixed seed, so that a failing case repeats.
pub(crate) struct Noise(Pcg64Mcg);

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Noise(Pcg64Mcg::seed_from_u64(seed))
    }

    pub(crate) fn uniform(&mut self) -> f64 {
        self.0.random()
    }

    pub(crate) fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }
}

/// An empty sample record at `theta_i`, `phi_i` (degrees).
pub(crate) fn record(theta_i: f64, phi_i: f64) -> Scan {
    Scan {
        kind: ScanKind::Sample,
        quantity: Quantity::Signal,
        channel: Channel::Photopic,
        incidence: Angles::from_degrees(theta_i, phi_i),
        theta_s: Vec::new(),
        phi_s: Vec::new(),
        value: Vec::new(),
        time: None,
        meta: ScanMeta::default(),
    }
}

impl Scan {
    pub(crate) fn push(&mut self, d: Direction, value: f64) {
        self.theta_s.push(d.theta());
        self.phi_s.push(d.phi());
        self.value.push(value);
    }
}

/// Meridian path over the front hemisphere at normal incidence: azimuths every `across` degrees, polar angles every
/// `along` degrees up to 89.
pub(crate) fn path_scan(across: f64, along: f64, mut value: impl FnMut(Direction) -> f64) -> Scan {
    let mut scan = record(0.0, 0.0);
    let mut phi = 0.0;
    while phi < 360.0 {
        let mut theta = along;
        while theta < 89.5 {
            let d = Direction::from_degrees(theta, phi);
            scan.push(d, value(d));
            theta += along;
        }
        phi += across;
    }
    scan
}

/// `n` nearly equally spread directions of one hemisphere, none on the horizon.
pub(crate) fn spiral(n: usize, side: Side) -> Vec<Direction> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..n)
        .map(|i| {
            let z = 1.0 - (i as f64 + 0.5) / n as f64;
            Direction::from_spherical((side.sign() * z).acos(), golden * i as f64)
        })
        .collect()
}

/// A record over a [`spiral`] at `theta_i`, `phi_i` degrees.
pub(crate) fn spiral_scan(
    theta_i: f64,
    phi_i: f64,
    n: usize,
    side: Side,
    mut value: impl FnMut(Direction) -> f64,
) -> Scan {
    let mut scan = record(theta_i, phi_i);
    for d in spiral(n, side) {
        scan.push(d, value(d));
    }
    scan
}

/// A beam reference raster about the through direction of `theta_i`, `phi_i` (degrees): pitch and half width in
/// degrees, `profile(gamma)` of the angle in radians to the through direction.
pub(crate) fn beam_scan(
    theta_i: f64,
    phi_i: f64,
    pitch: f64,
    half_width: f64,
    mut profile: impl FnMut(f64) -> f64,
) -> Scan {
    let mut scan = record(theta_i, phi_i);
    scan.kind = ScanKind::Beam;
    let through = scan.incidence.direction().through();
    let helper = if through.vec().x.abs() < 0.9 {
        gonio_geom::DVec3::X
    } else {
        gonio_geom::DVec3::Y
    };
    let e1 = through.vec().cross(helper).normalize();
    let e2 = through.vec().cross(e1);
    let n = (half_width / pitch).round() as i32;
    for a in -n..=n {
        for b in -n..=n {
            let (x, y) = (
                (f64::from(a) * pitch).to_radians(),
                (f64::from(b) * pitch).to_radians(),
            );
            let Some(d) = Direction::new(through.vec() + e1 * x + e2 * y) else {
                continue;
            };
            let gamma = d.angle_to(through);
            scan.push(d, profile(gamma));
        }
    }
    scan
}

/// The values of a record as the DSF of a slice, without uncertainty and weights.
pub(crate) fn slice_of(scan: Scan) -> crate::Slice {
    let n = scan.len();
    crate::Slice {
        incidence: scan.incidence,
        channel: scan.channel,
        theta_s: scan.theta_s,
        phi_s: scan.phi_s,
        dsf: scan.value,
        u_dsf: vec![0.0; n],
        omega: vec![0.0; n],
        flags: vec![crate::Flags::NONE; n],
        u_common: 0.0,
        integrals: Vec::new(),
    }
}
