//! Bins that follow a density: how many samples to expect in each, and which one a direction falls into.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use gonio_geom::{Direction, Side};

/// Largest share of the samples that one bin may expect.
const LARGEST: f64 = 1.0 / 256.0;
/// Size, radians, of the boxes about the mirror and the unbent direction, whatever the density; farther off they grow
/// with the distance.
const CENTRE: f64 = 0.01;
/// Boxes at which the subdivision stops; [`Partition::error`] tells how exact it is then.
const MOST_BOXES: usize = 60_000;

/// Both hemispheres in boxes of `theta` and `phi`, halved one coordinate at a time where the density needs it: to
/// integrate it, to follow narrow lobes wherever the samples crowd, and to give no bin too large a share.
pub(crate) struct Partition {
    nodes: Vec<Node>,
    roots: [usize; 2],
    phi_0: f64,
    samples: f64,
    /// Share of the samples in each bin: the integral of the density.
    pub(crate) mass: Vec<f64>,
    /// Sum of the differences between the nested quadrature rules; the true error is far smaller.
    pub(crate) error: f64,
}

struct Node {
    mass: f64,
    error: f64,
    /// Coordinate (0 theta, 1 phi), where it is split, and the two halves.
    split: Option<(usize, f64, usize, usize)>,
    bin: usize,
}

/// Low and high of theta and phi.
type Area = [(f64, f64); 2];

/// A sample and the density there, in the coordinates of the boxes.
struct Pilot {
    at: [f64; 2],
    density: f64,
}

impl Partition {
    /// Bins for samples of `density` given `w`, fine enough for a test of `samples` samples. `pilot` are some samples;
    /// they show where the density is large between the nodes of the quadrature.
    pub(crate) fn new(
        density: impl Fn(Direction) -> f64,
        w: Direction,
        pilot: impl IntoIterator<Item = Direction>,
        samples: u64,
    ) -> Self {
        let mut partition = Partition {
            nodes: Vec::new(),
            roots: [0; 2],
            phi_0: w.phi() + PI,
            samples: samples as f64,
            mass: Vec::new(),
            error: 0.0,
        };
        let centre = [w.theta().min(PI - w.theta()), 0.0];
        let mut sides: [Vec<Pilot>; 2] = [Vec::new(), Vec::new()];
        for d in pilot {
            let (side, at) = partition.place(d);
            let density = density(d) * at[0].sin();
            sides[side].push(Pilot { at, density });
        }
        for (side, pilot) in sides.into_iter().enumerate() {
            let local = |theta: f64, dphi: f64| {
                let d = Direction::from_spherical(theta, partition.phi_0 + dphi);
                density(if side == 0 { d } else { d.flipped() }) * theta.sin()
            };
            let mut nodes = std::mem::take(&mut partition.nodes);
            let mut growth = Growth {
                nodes: &mut nodes,
                density: &local,
                centre,
                samples: partition.samples,
            };
            partition.roots[side] = growth.grow([(0.0, FRAC_PI_2), (-PI, PI)], pilot);
            partition.nodes = nodes;
            partition.number(partition.roots[side]);
        }
        partition
    }

    /// The bin of `d`.
    pub(crate) fn bin(&self, d: Direction) -> usize {
        let (side, at) = self.place(d);
        let mut k = self.roots[side];
        while let Some((axis, middle, low, high)) = self.nodes[k].split {
            k = if at[axis] < middle { low } else { high };
        }
        self.nodes[k].bin
    }

    /// Side (0 front) and coordinates of `d`: polar angle from that side's normal, azimuth from the mirror direction.
    fn place(&self, d: Direction) -> (usize, [f64; 2]) {
        let side = usize::from(d.side() == Side::Back);
        let v = d.vec();
        let theta = v.x.hypot(v.y).atan2(v.z.abs());
        let dphi = v.y.atan2(v.x) - self.phi_0;
        (side, [theta, dphi - TAU * (dphi / TAU).round()])
    }

    /// Joins boxes below node `k` into the largest bins of at most [`LARGEST`].
    fn number(&mut self, k: usize) {
        if self.nodes[k].mass > LARGEST
            && let Some((_, _, low, high)) = self.nodes[k].split
        {
            self.number(low);
            self.number(high);
            return;
        }
        let bin = self.mass.len();
        self.mass.push(self.nodes[k].mass);
        self.error += self.nodes[k].error;
        let mut below = vec![k];
        while let Some(k) = below.pop() {
            self.nodes[k].bin = bin;
            if let Some((_, _, low, high)) = self.nodes[k].split {
                below.extend([low, high]);
            }
        }
    }
}

struct Growth<'a, F> {
    nodes: &'a mut Vec<Node>,
    density: &'a F,
    centre: [f64; 2],
    samples: f64,
}

impl<F: Fn(f64, f64) -> f64> Growth<'_, F> {
    fn grow(&mut self, area: Area, pilot: Vec<Pilot>) -> usize {
        let k = self.nodes.len();
        let q = integrate(self.density, area);
        self.nodes.push(Node {
            mass: q.mass,
            error: q.error,
            split: None,
            bin: usize::MAX,
        });
        let mut size = area.map(|(low, high)| high - low);
        size[1] *= (0.5 * (area[0].0 + area[0].1)).sin();
        // A hundredth of the standard deviation of the count, or of a bin that is pooled.
        let tolerance = 0.01 * (q.mass.max(5.0 / self.samples) / self.samples).sqrt();
        let longer = usize::from(size[1] > size[0]);
        let distance = (0..2)
            .map(|a| (area[a].0 - self.centre[a]).max(self.centre[a] - area[a].1))
            .fold(0.0, f64::max);
        let missed = pilot.iter().any(|p| p.density > 1.5 * q.largest);
        let axis = if q.mass > LARGEST || q.error > tolerance {
            q.axis.unwrap_or(longer)
        } else if missed || size[longer] > CENTRE + distance {
            longer
        } else {
            return k;
        };
        if size[axis] < 1e-9 || self.nodes.len() > MOST_BOXES {
            return k;
        }
        let middle = 0.5 * (area[axis].0 + area[axis].1);
        let (mut low, mut high) = (area, area);
        low[axis].1 = middle;
        high[axis].0 = middle;
        let (below, above): (Vec<_>, Vec<_>) = pilot.into_iter().partition(|p| p.at[axis] < middle);
        let low = self.grow(low, below);
        let high = self.grow(high, above);
        self.nodes[k].split = Some((axis, middle, low, high));
        self.nodes[k].mass = self.nodes[low].mass + self.nodes[high].mass;
        self.nodes[k].error = self.nodes[low].error + self.nodes[high].error;
        k
    }
}

struct Quadrature {
    mass: f64,
    error: f64,
    /// Largest value at the nodes.
    largest: f64,
    /// The coordinate along which the density varies more; none when it does not.
    axis: Option<usize>,
}

/// Gauss-Kronrod products of 11 x 11 nodes, and of 5 x 11 and 11 x 5 among them for the error [Piessens1983].
fn integrate(density: &impl Fn(f64, f64) -> f64, area: Area) -> Quadrature {
    let half = area.map(|(low, high)| 0.5 * (high - low));
    let middle = area.map(|(low, high)| 0.5 * (high + low));
    let (mut fine, mut largest) = (0.0, 0.0f64);
    let mut marginal = [[0.0; KRONROD.len()]; 2];
    for (i, &(x, wx)) in KRONROD.iter().enumerate() {
        for (j, &(y, wy)) in KRONROD.iter().enumerate() {
            let v = density(middle[0] + half[0] * x, middle[1] + half[1] * y);
            marginal[0][i] += wy * v;
            marginal[1][j] += wx * v;
            fine += wx * wy * v;
            largest = largest.max(v);
        }
    }
    let spread = marginal.map(|m| {
        let mean = fine / 2.0;
        m.iter()
            .zip(KRONROD)
            .map(|(v, (_, w))| w * (v - mean).powi(2))
            .sum::<f64>()
    });
    let coarse = marginal.map(|m| {
        GAUSS
            .iter()
            .enumerate()
            .map(|(k, w)| w * m[2 * k + 1])
            .sum::<f64>()
    });
    let area = half[0] * half[1];
    Quadrature {
        mass: fine * area,
        largest,
        error: coarse.map(|c| (fine - c).abs()).iter().sum::<f64>() * area,
        axis: (spread[0] + spread[1] > 1e-12 * fine * fine).then_some(usize::from(spread[1] > spread[0])),
    }
}

/// Nodes and weights of the 11-point Kronrod rule on `[-1, 1]`; the odd ones are Gauss nodes.
#[rustfmt::skip]
const KRONROD: [(f64, f64); 11] = [
    (-0.984_085_360_094_842_5, 0.042_582_036_751_081_83),
    (-0.906_179_845_938_664, 0.115_233_316_622_473_4),
    (-0.754_166_726_570_849_2, 0.186_800_796_556_492_66),
    (-0.538_469_310_105_683_1, 0.241_040_339_228_647_6),
    (-0.279_630_413_161_783_2, 0.272_849_801_912_558_9),
    (0.0, 0.282_987_417_857_491_2),
    (0.279_630_413_161_783_2, 0.272_849_801_912_558_9),
    (0.538_469_310_105_683_1, 0.241_040_339_228_647_6),
    (0.754_166_726_570_849_2, 0.186_800_796_556_492_66),
    (0.906_179_845_938_664, 0.115_233_316_622_473_4),
    (0.984_085_360_094_842_5, 0.042_582_036_751_081_83),
];

/// Weights of the 5-point Gauss rule at the odd nodes of [`KRONROD`].
const GAUSS: [f64; 5] = [
    0.236_926_885_056_189_1,
    0.478_628_670_499_366_5,
    0.568_888_888_888_888_9,
    0.478_628_670_499_366_5,
    0.236_926_885_056_189_1,
];
