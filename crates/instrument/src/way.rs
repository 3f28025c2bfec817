//! Ways from the source over the points of the spot.

use gonio_geom::{DVec3, Direction};

use crate::nodes::{node, on_disk};
use crate::{Beam, Focus, Holder};

/// Points of the spot of which the share on the sample is counted.
const FILL_POINTS: usize = 16_384;

/// The beam's cross-section and where it goes.
pub(crate) struct Way {
    through: DVec3,
    a: DVec3,
    b: DVec3,
    /// Height of the sample's surface over the origin.
    height: f64,
}

impl Way {
    /// Of a beam from `wi` onto a sample whose surface lies at `height`.
    pub(crate) fn new(wi: Direction, height: f64) -> Self {
        let through = wi.through().vec();
        let (a, b) = through.any_orthonormal_pair();
        Way {
            through,
            a,
            b,
            height,
        }
    }

    /// The point of the sample plane that point (`x`, `y`) of the cross-section lights.
    pub(crate) fn lit(&self, x: f64, y: f64) -> DVec3 {
        let cross = x * self.a + y * self.b;
        cross + self.through * ((self.height - cross.z) / self.through.z)
    }

    /// Where the beam goes, unit.
    pub(crate) fn through(&self) -> DVec3 {
        self.through
    }

    /// A point in the cross-section of the beam, from its axis.
    pub(crate) fn across(&self, x: DVec3) -> DVec3 {
        x - x.dot(self.through) * self.through
    }

    /// Towards the source from `x`, for the part of the beam at `chord` from its centre in direction (`bx`, `by`) of its
    /// cross-section.
    pub(crate) fn source(
        &self,
        beam: &Beam,
        distance: f64,
        x: DVec3,
        chord: f64,
        [bx, by]: [f64; 2],
    ) -> Option<Direction> {
        let sin = chord * (1.0 - 0.25 * chord * chord).sqrt();
        let aim = (1.0 - 0.5 * chord * chord) * self.through + sin * (bx * self.a + by * self.b);
        Direction::new(match beam.focus {
            // All rays through this point of the beam's image on the detector sphere, reached from x.
            Focus::Detector => x - distance * aim,
            Focus::Sample => -aim,
        })
    }
}

/// `wanted` rays over the part of the spot that lies on the sample, and the share of the beam that does.
pub(crate) fn rays(beam: &Beam, distance: f64, holder: &Holder, way: &Way, wanted: usize) -> (Vec<Ray>, f64) {
    let spot = 0.5 * beam.spot_diameter;
    let on_sample = |x: DVec3| holder.holds(x);
    let inside = (0..FILL_POINTS)
        .filter(|&k| {
            let [x, y] = on_disk(node::<2>(k));
            on_sample(way.lit(spot * x, spot * y))
        })
        .count();
    let fill = inside as f64 / FILL_POINTS as f64;
    let mut rays = Vec::with_capacity(wanted);
    if inside == 0 {
        return (rays, 0.0);
    }
    for k in 0.. {
        let u = node::<7>(k);
        let [sx, sy] = on_disk([u[0], u[1]]);
        let chord = beam.profile.chord_of_share(u[2]);
        let (bs, bc) = (std::f64::consts::TAU * u[3]).sin_cos();
        let [dx, dy] = on_disk([u[4], u[5]]);
        // Quarter turns of each node: gradients of the model cancel exactly and curvatures weigh alike in all
        // azimuths, as they do in the average itself.
        for (q, (c, s)) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
            .into_iter()
            .enumerate()
        {
            if rays.len() == wanted {
                return (rays, fill);
            }
            let turn = |x: f64, y: f64| [c * x - s * y, s * x + c * y];
            let [sx, sy] = turn(sx, sy);
            let x = way.lit(spot * sx, spot * sy);
            if !on_sample(x) {
                continue;
            }
            let time = if q % 2 == 0 { u[6] - 0.5 } else { 0.5 - u[6] };
            rays.extend(way.source(beam, distance, x, chord, turn(bc, bs)).map(|wi| Ray {
                x,
                wi: wi.vec().to_array(),
                aperture: turn(dx, dy),
                time,
            }));
        }
    }
    (rays, fill)
}

/// One way from the source over a point of the spot, in the frame of the sample.
pub(crate) struct Ray {
    /// Point of the sample that is lit, metres.
    pub(crate) x: DVec3,
    /// Direction towards the source there.
    pub(crate) wi: [f64; 3],
    /// Point of the aperture in units of its radius.
    pub(crate) aperture: [f64; 2],
    /// When it is read, in units of the time of integration, `[-0.5, 0.5]`.
    pub(crate) time: f64,
}
