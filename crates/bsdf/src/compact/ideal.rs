//! The ideal part of a compact model: light that leaves without spreading.

use gonio_geom::{Component, Direction};

use crate::BsdfError;

use super::domain;
use super::frame::Frame;
use super::symmetry::{Axis, Symmetry};

/// Share of the light that is mirrored or passes straight through, over the incidence; linear between nodes of the
/// coordinates `x` and `p_i` of a [`Frame`].
#[derive(Clone, Debug, PartialEq)]
pub struct IdealPart {
    /// What is taken for granted about azimuth.
    pub symmetry: Symmetry,
    /// Azimuth that `p_i` counts from, radians; 0 for isotropic ones.
    pub phi_x: f64,
    /// Nodes along `x` and `p_i`.
    pub shape: [usize; 2],
    /// `[channel][x][p_i]`, each in `[0, 1]`.
    pub shares: Vec<f32>,
}

impl IdealPart {
    /// Bytes of one channel as stored: the shares, two numbers of nodes and the azimuth.
    pub fn bytes_per_channel(&self) -> usize {
        4 * self.shape[0] * self.shape[1] + 16
    }

    /// A frame of the same incidences.
    pub fn frame(&self) -> Frame {
        let round = if self.symmetry == Symmetry::Isotropic {
            2
        } else {
            4
        };
        Frame {
            symmetry: self.symmetry,
            width: [1.0; 2],
            phi_x: self.phi_x,
            shape: [self.shape[0], self.shape[1], 2, round],
        }
    }

    pub(super) fn check(&self, channels: usize) -> Result<(), BsdfError> {
        self.frame().check()?;
        let needed = channels * self.shape[0] * self.shape[1];
        if self.shares.len() != needed {
            let allowed = format!("{needed} for {channels} channels of {:?} incidences", self.shape);
            return Err(domain("shares", format!("{} values", self.shares.len()), allowed));
        }
        match self.shares.iter().find(|s| !(0.0..=1.0).contains(*s)) {
            Some(bad) => Err(domain("shares", bad.to_string(), "0 to 1")),
            None => Ok(()),
        }
    }

    /// Shares of every channel for light from `w`.
    pub(super) fn shares(&self, w: Direction, shares: &mut [f64]) {
        let frame = self.frame();
        let v = w.vec();
        let up = [v.x, v.y, v.z.abs()];
        let [x, p_i, ..] = frame.coordinates(up, up);
        let density = frame.density();
        let bracket = |position: f64, k: usize| {
            let n = self.shape[k];
            let whole = (position.max(0.0) as usize).min(n - 1);
            if frame.axis(k) == Axis::Round {
                (whole % n, (whole + 1) % n, position - whole as f64)
            } else {
                let low = whole.min(n.saturating_sub(2));
                (low, (low + 1).min(n - 1), (position - low as f64).clamp(0.0, 1.0))
            }
        };
        let (i, far_i, s) = bracket(x * density[0], 0);
        let (j, far_j, t) = bracket(p_i * density[1], 1);
        let n = self.shape[1];
        for (share, own) in shares.iter_mut().zip(self.shares.chunks(self.shape[0] * n)) {
            let row = |i: usize| {
                let (a, b) = (f64::from(own[i * n + j]), f64::from(own[i * n + far_j]));
                a + t * (b - a)
            };
            let (near, far) = (row(i), row(far_i));
            *share = near + s * (far - near);
        }
    }
}

/// Where light from `w` goes without spreading.
pub(super) fn straight(w: Direction, component: Component) -> Direction {
    match component {
        Component::Reflection => w.mirror(),
        Component::Transmission => w.through(),
    }
}
