//! Light displaced between slices: the Knothe–Rosenblatt map, quantile by quantile, over direction cosines.
//!
//! What lies above the diffuse level of a slice is a density of light over the disk of direction cosines, since a BSDF times cosine
//! and solid angle is a BSDF times area of the disk. Its quantiles in x, and those in y at each of them, carry the unit square to
//! the disk; between slices these maps are averaged \[Rosenblatt1952\]. A lobe then travels from where it stands in one slice to
//! where it stands in the next, whichever way that is, and light is conserved. Two lobes that pass one another, or narrow ones whose
//! quantiles in x mix them up, are not followed. The axes are those of the sample, for isotropic ones the plane of incidence.

use gonio_geom::DVec3;

use super::{Across, Counterpart, Frame, MOST_TERMS, Query, View};
use crate::images::Image;

/// Strips over x of the raster, and cells over y of each.
const STRIPS: usize = 192;
const CELLS: usize = 160;

/// Quantiles of x, and of y at each.
const LEVELS: usize = 160;
const STEPS: usize = 96;

/// Light that is everywhere, as a share of the mean, so that quantiles grow without a jump.
const FAINT: f64 = 1e-4;

/// Value below which a slice has no light at a place, 1/sr.
const DARK: f64 = 1e-12;

/// The quantiles of the light of a slice.
#[derive(Clone, Debug)]
pub(crate) struct Quantiles {
    /// Share of the incident light above the diffuse level.
    mass: f64,
    /// Density of the light over x at the middles of the strips; its integral is 1.
    density: Vec<f64>,
    /// x at shares of the light.
    x: Vec<f64>,
    /// y at shares of the light of the strip there: one row an x.
    y: Vec<f64>,
}

/// The point of the disk with share `t` of the cumulative `sums` (ascending, `width` apart from `start` on) below it.
fn inverse(sums: &[f64], start: f64, width: f64, t: f64) -> f64 {
    let wanted = t * sums[sums.len() - 1];
    let k = sums.partition_point(|s| *s < wanted).clamp(1, sums.len() - 1);
    let step = sums[k] - sums[k - 1];
    let part = if step > 0.0 {
        ((wanted - sums[k - 1]) / step).clamp(0.0, 1.0)
    } else {
        0.5
    };
    start + width * ((k - 1) as f64 + part)
}

fn cumulative(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sum = 0.0;
    std::iter::once(0.0)
        .chain(values.map(|v| {
            sum += v;
            sum
        }))
        .collect()
}

/// Share of the light below quantile `k` of `count`: closer together where there is little light, at both ends.
fn share(k: usize, count: usize) -> f64 {
    let (sine, _) = (std::f64::consts::FRAC_PI_2 * k as f64 / count as f64).sin_cos();
    sine * sine
}

/// Middle of strip `k`.
fn middle(k: usize) -> f64 {
    2.0 * (k as f64 + 0.5) / STRIPS as f64 - 1.0
}

impl Quantiles {
    /// Of light of density `value` over the direction cosines; negative values count as 0.
    pub(crate) fn new(value: impl Fn([f64; 2]) -> f64) -> Self {
        let half = |x: f64| (1.0 - x * x).max(0.0).sqrt();
        let columns: Vec<Vec<f64>> = (0..STRIPS)
            .map(|k| {
                let x = middle(k);
                let at = |c: usize| half(x) * (2.0 * (c as f64 + 0.5) / CELLS as f64 - 1.0);
                (0..CELLS).map(|c| value([x, at(c)]).max(0.0)).collect()
            })
            .collect();
        let area = |k: usize| 2.0 / STRIPS as f64 * 2.0 * half(middle(k)) / CELLS as f64;
        let mass: f64 = (0..STRIPS)
            .map(|k| area(k) * columns[k].iter().sum::<f64>())
            .sum();
        let faint = (FAINT * mass / std::f64::consts::PI).max(f64::MIN_POSITIVE);
        let light = |k: usize| area(k) * columns[k].iter().map(|v| v + faint).sum::<f64>();
        let sums = cumulative((0..STRIPS).map(light));
        let all = sums[STRIPS];
        let width = 2.0 / STRIPS as f64;
        let x: Vec<f64> = (0..=LEVELS)
            .map(|j| inverse(&sums, -1.0, width, share(j, LEVELS)))
            .collect();
        let within: Vec<Vec<f64>> = columns
            .iter()
            .map(|c| cumulative(c.iter().map(|v| v + faint)))
            .collect();
        let y = x
            .iter()
            .flat_map(|&x| {
                // Between the middles of two strips their quantiles are mixed.
                let at = ((x + 1.0) / width - 0.5).clamp(0.0, (STRIPS - 1) as f64);
                let k = (at as usize).min(STRIPS - 2);
                let part = at - k as f64;
                let (a, b, within) = (half(middle(k)), half(middle(k + 1)), &within);
                (0..=STEPS).map(move |n| {
                    let t = share(n, STEPS);
                    let of = |k: usize, half: f64| inverse(&within[k], -half, 2.0 * half / CELLS as f64, t);
                    (1.0 - part) * of(k, a) + part * of(k + 1, b)
                })
            })
            .collect();
        Quantiles {
            mass,
            density: (0..STRIPS).map(|k| light(k) / (all * width)).collect(),
            x,
            y,
        }
    }

    /// x of the image's light at level `j`.
    #[inline]
    fn x_at(&self, image: Image, j: usize) -> f64 {
        let [sign, _] = image.of_point([1.0, 1.0]);
        if sign > 0.0 {
            self.x[j]
        } else {
            -self.x[LEVELS - j]
        }
    }

    /// y of the image's light at level `j` and step `n`.
    #[inline]
    fn y_at(&self, image: Image, j: usize, n: usize) -> f64 {
        let [x, y] = image.of_point([1.0, 1.0]);
        let row = if x > 0.0 { j } else { LEVELS - j };
        if y > 0.0 {
            self.y[row * (STEPS + 1) + n]
        } else {
            -self.y[row * (STEPS + 1) + STEPS - n]
        }
    }

    /// Density of the image's light over x.
    #[inline]
    fn density_at(&self, image: Image, x: f64) -> f64 {
        let [x, _] = image.of_point([x, 0.0]);
        let at = (0.5 * (x + 1.0) * STRIPS as f64 - 0.5).clamp(0.0, (STRIPS - 1) as f64);
        let k = (at as usize).min(STRIPS - 2);
        let part = at - k as f64;
        (1.0 - part) * self.density[k] + part * self.density[k + 1]
    }
}

/// Light of a slice that takes part: its weight, quantiles, image, and density over the direction cosines of the query.
pub(crate) struct Source<'a, F> {
    pub(crate) weight: f64,
    pub(crate) quantiles: &'a Quantiles,
    pub(crate) image: Image,
    pub(crate) value: F,
}

/// The first of `count` intervals of an ascending function at whose end it exceeds `wanted`, and where in it that is reached.
#[inline]
fn found(count: usize, of: impl Fn(usize) -> f64, wanted: f64) -> (usize, f64) {
    let (mut low, mut high) = (0, count);
    while high - low > 1 {
        let middle = usize::midpoint(low, high);
        if of(middle) <= wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    let (a, b) = (of(low), of(low + 1));
    let part = if b > a { (wanted - a) / (b - a) } else { 0.5 };
    (low, part)
}

/// The density at direction cosines `p` of light displaced between `sources`, whose weights sum to 1.
pub(crate) fn displaced<F: Fn([f64; 2]) -> f64>(sources: &[Source<'_, F>], p: [f64; 2]) -> f64 {
    let sum = |of: &dyn Fn(&Source<'_, F>) -> f64| sources.iter().map(|s| s.weight * of(s)).sum::<f64>();
    let (j, u) = found(LEVELS, |j| sum(&|s| s.quantiles.x_at(s.image, j)), p[0]);
    let y = |s: &Source<'_, F>, n: usize| {
        let at = |j| s.quantiles.y_at(s.image, j, n);
        (1.0 - u) * at(j) + u * at(j + 1)
    };
    let (n, t) = found(STEPS, |n| sum(&|s| y(s, n)), p[1]);
    if !(0.0..=1.0).contains(&u) || !(0.0..=1.0).contains(&t) {
        return 0.0;
    }
    let (mut mass, mut along, mut across) = (0.0, 0.0, 0.0);
    for s in sources.iter().filter(|s| s.weight > 0.0) {
        let x_at = |j| s.quantiles.x_at(s.image, j);
        let at = if let [_] = sources {
            p
        } else {
            [
                (1.0 - u) * x_at(j) + u * x_at(j + 1),
                (1.0 - t) * y(s, n) + t * y(s, n + 1),
            ]
        };
        let light = (s.value)(at);
        if light <= DARK {
            return 0.0;
        }
        // Each map's area goes with its mass over its density; along x that is one over the density of x alone.
        let density = s.quantiles.density_at(s.image, at[0]);
        mass += s.weight * s.quantiles.mass;
        along += s.weight / density;
        across += s.weight * s.quantiles.mass * density / light;
    }
    if along * across > 0.0 {
        mass / (along * across)
    } else {
        0.0
    }
}

/// The diffuse level as it is, what lies above it displaced, what lies below it where it is.
#[derive(Debug)]
pub(super) struct Displaced;

impl Across for Displaced {
    fn frames(&self) -> &[Frame] {
        &[Frame::Still]
    }

    fn read(&self, _term: usize, _query: &Query<'_>, view: &View<'_>, at: Counterpart) -> f64 {
        view.bsdf(at.direction)
    }

    fn join(&self, _query: &Query<'_>, terms: &[f64; MOST_TERMS]) -> f64 {
        terms[0]
    }

    fn together(&self, query: &Query<'_>, views: &mut dyn Iterator<Item = View<'_>>) -> Option<f64> {
        let views: Vec<View<'_>> = views.collect();
        let sources: Vec<_> = views
            .iter()
            .map(|view| Source {
                weight: view.neighbour.weight,
                quantiles: view.node.quantiles(),
                image: view.neighbour.image,
                value: |p: [f64; 2]| {
                    let z = (1.0 - p[0] * p[0] - p[1] * p[1]).max(0.0).sqrt();
                    view.bsdf(DVec3::new(p[0], p[1], z)) - view.node.level
                },
            })
            .collect();
        let still = |view: &View<'_>| {
            let level = view.node.level;
            view.neighbour.weight * (level + (view.bsdf(query.s) - level).min(0.0))
        };
        Some(views.iter().map(still).sum::<f64>() + displaced(&sources, [query.s.x, query.s.y]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Light = fn([f64; 2]) -> f64;

    /// A lobe whose y axis leans with x.
    fn lobe(p: [f64; 2], [x, y]: [f64; 2]) -> f64 {
        let (dx, dy) = (p[0] - x, p[1] - y - 0.3 * (p[0] - x));
        3.0 * (-(dx / 0.12).powi(2) - (dy / 0.09).powi(2)).exp()
    }

    fn between(a: Light, b: Light, images: [Image; 2], share: f64, p: [f64; 2]) -> f64 {
        let (qa, qb) = (Quantiles::new(a), Quantiles::new(b));
        let seen = |f: Light, image: Image| move |p: [f64; 2]| f(image.of_point(p));
        displaced(
            &[
                Source {
                    weight: 1.0 - share,
                    quantiles: &qa,
                    image: images[0],
                    value: Box::new(seen(a, images[0])) as Box<dyn Fn([f64; 2]) -> f64>,
                },
                Source {
                    weight: share,
                    quantiles: &qb,
                    image: images[1],
                    value: Box::new(seen(b, images[1])),
                },
            ],
            p,
        )
    }

    const SAME: [Image; 2] = [Image::SAME, Image::SAME];

    fn here(p: [f64; 2]) -> f64 {
        lobe(p, [-0.35, 0.1])
    }

    fn there(p: [f64; 2]) -> f64 {
        lobe(p, [0.25, -0.2])
    }

    fn disk(points: usize) -> impl Iterator<Item = [f64; 2]> {
        let golden = std::f64::consts::PI * (1.0 + 5f64.sqrt());
        (0..points).map(move |k| {
            let r = ((k as f64 + 0.5) / points as f64).sqrt();
            let (s, c) = (golden * k as f64).sin_cos();
            [r * c, r * s]
        })
    }

    #[test]
    fn a_shift_is_followed_exactly() {
        for share in [0.25, 0.5, 0.8] {
            let centre = [-0.35 + 0.6 * share, 0.1 - 0.3 * share];
            for (dx, dy) in [(0.0, 0.0), (0.1, 0.0), (-0.08, 0.06), (0.05, -0.1)] {
                let p = [centre[0] + dx, centre[1] + dy];
                let found = between(here, there, SAME, share, p);
                let truth = lobe(p, centre);
                assert!(
                    (found - truth).abs() < 0.02 * 3.0,
                    "{share} {p:?}: {found} {truth}"
                );
            }
        }
    }

    #[test]
    fn both_slices_come_back_at_their_own_incidence() {
        for p in disk(500) {
            let q = Quantiles::new(here);
            let alone = displaced(
                &[Source {
                    weight: 1.0,
                    quantiles: &q,
                    image: Image::SAME,
                    value: here,
                }],
                p,
            );
            assert!((alone - here(p)).abs() < 1e-9, "{p:?}: {alone} {}", here(p));
        }
        for p in [[-0.3, 0.1], [0.2, -0.2], [0.0, 0.0]] {
            assert!((between(here, there, SAME, 0.0, p) - here(p)).abs() < 0.02);
            assert!((between(here, there, SAME, 1.0, p) - there(p)).abs() < 0.02);
        }
    }

    #[test]
    fn light_is_conserved_between_slices_of_different_light() {
        fn wide(p: [f64; 2]) -> f64 {
            0.2 * (1.0 - p[0] * p[0] - p[1] * p[1]).max(0.0) + 0.5 * lobe(p, [0.4, 0.2])
        }
        let points = 20_000;
        let (qa, qb) = (Quantiles::new(here), Quantiles::new(wide));
        for share in [0.3, 0.6] {
            let sources = [
                Source {
                    weight: 1.0 - share,
                    quantiles: &qa,
                    image: Image::SAME,
                    value: here as Light,
                },
                Source {
                    weight: share,
                    quantiles: &qb,
                    image: Image::SAME,
                    value: wide as Light,
                },
            ];
            let all = std::f64::consts::PI / points as f64;
            let light: f64 = disk(points).map(|p| all * displaced(&sources, p)).sum();
            let wanted = (1.0 - share) * qa.mass + share * qb.mass;
            assert!((light / wanted - 1.0).abs() < 0.01, "{share}: {light} {wanted}");
        }
    }

    #[test]
    fn an_image_is_displaced_as_the_slice_itself() {
        fn mirrored(p: [f64; 2]) -> f64 {
            lobe([-p[0], -p[1]], [0.25, -0.2])
        }
        // The slice that is the other one turned by half a turn, seen turned, is the other one.
        for p in [[-0.3, 0.1], [-0.05, -0.05], [0.2, -0.2]] {
            let turned = between(here, mirrored, [Image::SAME, Image::HALF_TURN], 0.5, p);
            let plain = between(here, there, SAME, 0.5, p);
            assert!(
                (turned - plain).abs() < 0.01 * (1.0 + plain),
                "{p:?}: {turned} {plain}"
            );
        }
    }
}
