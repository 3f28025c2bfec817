//! The shape of a lobe that the base misses, within one slice.
//!
//! A peak may look like no formula: the disk that an instrument with a wide beam makes of it, off the mirror direction by an
//! error of alignment. A base that stands somewhere else makes the ratio of readings to it change by more between two
//! lines of readings than interpolation can follow. Such a lobe is described by its own readings instead: their mean
//! over the distance from a centre, in ellipses along and across the plane of incidence. The lines that cross the centre
//! tell how it falls off in all directions. What is left, the ratio to that, is interpolated.

use gonio_geom::DVec3;

use crate::plane::{Point, from_plane};

/// Share of the brightest BSDF down to which readings belong to the lobe.
const FOOT: f64 = 0.003;

/// Share of the lobe's light within the radius that is tabulated.
const INSIDE: f64 = 0.99;

/// Steps of the fall-off from the centre to that radius, and fewest readings of one.
const STEPS: usize = 24;
const READINGS: usize = 5;

/// Fewest readings of a lobe, and most that the search for its centre looks at.
const LEAST: usize = 50;
const SEARCHED: usize = 4000;

/// A base that is off by less than this share of the lobe's light describes it, and better than ellipses do.
const MISSED: f64 = 0.55;

/// The fall-off is used where it leaves at most this share of the base's distance from the readings.
const GAIN: f64 = 0.6;

/// Most that the centre rises above the first ring (logarithm).
const MOST_RISE: f64 = 0.3;

/// First steps of the search, in centre (radians) and logarithm of stretch, and how often they are halved.
const FIRST: [f64; 3] = [0.003, 0.003, 0.2];
const HALVED: usize = 4;

/// From the foot of the lobe to this factor of its distance the base takes over.
const BLENDED: f64 = 1.5;

/// One reading of the lobe: position about the mirror direction, BSDF, base, and solid angle.
#[derive(Clone, Copy, Debug)]
struct Reading {
    at: [f64; 2],
    value: f64,
    base: f64,
    weight: f64,
}

/// Centre and stretch of a lobe: in the plane of incidence, across it, and the logarithm of how much wider it is across.
type Shape = [f64; 3];

/// The mean BSDF over the distance from the lobe's centre.
#[derive(Clone, Debug)]
pub(crate) struct Profile {
    mirror: Frame,
    shape: Shape,
    /// Distance from the centre within which most of the lobe's light is.
    foot: f64,
    /// Distances from the centre, ascending.
    radii: Vec<f64>,
    /// Logarithm of the mean BSDF there.
    values: Vec<f64>,
}

/// Angles about the mirror (through) direction.
#[derive(Clone, Copy, Debug)]
struct Frame {
    centre: DVec3,
    along: DVec3,
    across: DVec3,
}

impl Frame {
    fn new(incidence: DVec3) -> Self {
        let centre = DVec3::new(-incidence.x, -incidence.y, incidence.z);
        let side = DVec3::Z.cross(centre);
        let across = if side.length() > 1e-9 {
            side.normalize()
        } else {
            DVec3::Y
        };
        Frame {
            centre,
            along: across.cross(centre),
            across,
        }
    }

    /// Angle from the centre, along the plane of incidence and across it, radians.
    fn at(&self, s: DVec3) -> [f64; 2] {
        let (x, y) = (s.dot(self.along), s.dot(self.across));
        let sine = x.hypot(y);
        let scale = if sine > 1e-12 {
            sine.atan2(s.dot(self.centre)) / sine
        } else {
            1.0
        };
        [x * scale, y * scale]
    }
}

fn radius(shape: &Shape, at: [f64; 2]) -> f64 {
    (at[0] - shape[0]).hypot((at[1] - shape[1]) * (-shape[2]).exp())
}

/// Centre and stretch of the light.
fn moments(lobe: &[Reading]) -> Shape {
    let mean = |of: &dyn Fn(&Reading) -> f64| {
        let (sum, all) = lobe.iter().fold((0.0, 0.0), |(sum, all), r| {
            let light = r.weight * r.value;
            (sum + light * of(r), all + light)
        });
        sum / all.max(f64::MIN_POSITIVE)
    };
    let (x, y) = (mean(&|r| r.at[0]), mean(&|r| r.at[1]));
    let (xx, yy) = (mean(&|r| (r.at[0] - x).powi(2)), mean(&|r| (r.at[1] - y).powi(2)));
    [x, y, 0.5 * (yy.max(1e-12) / xx.max(1e-12)).ln()]
}

impl Profile {
    /// The fall-off of readings of BSDF `value` at `points`, each with its solid angle, in the local frame with light from
    /// `incidence`; `None` where `base` (its value at each reading) describes the lobe, or ellipses do not.
    pub(crate) fn new(
        incidence: DVec3,
        points: &[Point],
        value: &[f64],
        base: &[f64],
        omega: &[f64],
    ) -> Option<Self> {
        let mirror = Frame::new(incidence);
        let top = value.iter().copied().fold(0.0, f64::max);
        let lobe: Vec<Reading> = (0..points.len())
            .filter(|&j| value[j] >= FOOT * top)
            .map(|j| {
                let s = from_plane(points[j]);
                Reading {
                    at: mirror.at(s),
                    value: value[j],
                    base: base[j],
                    weight: omega[j] * s.z,
                }
            })
            .collect();
        let size: f64 = lobe.iter().map(|r| r.weight * r.value).sum();
        let plain: f64 = lobe.iter().map(|r| r.weight * (r.value - r.base).abs()).sum();
        if lobe.len() < LEAST || plain <= MISSED * size {
            return None;
        }
        let few: Vec<Reading> = lobe
            .iter()
            .step_by(lobe.len().div_ceil(SEARCHED))
            .copied()
            .collect();
        let mut best = (moments(&lobe), f64::INFINITY);
        let try_shape =
            |shape: Shape| Profile::of(mirror, shape, &few).map_or(f64::INFINITY, |p| p.apart(&few));
        best.1 = try_shape(best.0);
        let mut step = FIRST;
        for _ in 0..HALVED {
            let mut moved = true;
            while moved {
                moved = false;
                for k in 0..3 {
                    for sign in [-1.0, 1.0] {
                        let mut shape = best.0;
                        shape[k] += sign * step[k];
                        let apart = try_shape(shape);
                        if apart < best.1 {
                            best = (shape, apart);
                            moved = true;
                        }
                    }
                }
            }
            step = step.map(|s| 0.5 * s);
        }
        let profile = Profile::of(mirror, best.0, &lobe)?;
        (profile.apart(&lobe) <= GAIN * plain).then_some(profile)
    }

    /// The mean of `lobe` in rings of `shape`.
    fn of(mirror: Frame, shape: Shape, lobe: &[Reading]) -> Option<Self> {
        let mut order: Vec<(f64, &Reading)> = lobe.iter().map(|r| (radius(&shape, r.at), r)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let light = |r: &Reading| r.weight * r.value;
        let all: f64 = lobe.iter().map(light).sum();
        let mut sum = 0.0;
        let (foot, _) = *order.iter().find(|(_, r)| {
            sum += light(r);
            sum >= INSIDE * all
        })?;
        let width = foot / STEPS as f64;
        let (mut radii, mut values) = (Vec::new(), Vec::new());
        let (mut sums, mut count, mut first) = ([0.0; 2], 0, 0.0);
        for (r, reading) in order.iter().take_while(|(r, _)| *r <= BLENDED * foot) {
            sums = [sums[0] + r * r, sums[1] + reading.value];
            count += 1;
            if count >= READINGS && r - first >= width {
                let n = count as f64;
                radii.push((sums[0] / n).sqrt());
                values.push((sums[1] / n).max(f64::MIN_POSITIVE).ln());
                (sums, count, first) = ([0.0; 2], 0, *r);
            }
        }
        (radii.len() >= 4).then_some(Profile {
            mirror,
            shape,
            foot,
            radii,
            values,
        })
    }

    /// Sum of differences between readings and what base and fall-off say.
    fn apart(&self, lobe: &[Reading]) -> f64 {
        lobe.iter()
            .map(|r| r.weight * (r.value - r.base * self.factor(radius(&self.shape, r.at), || r.base)).abs())
            .sum()
    }

    /// The factor on the base, whose value there `base` gives, at a point of the plane.
    pub(crate) fn at(&self, p: Point, base: impl Fn() -> f64) -> f64 {
        self.factor(radius(&self.shape, self.mirror.at(from_plane(p))), base)
    }

    /// The fall-off over the base within the foot, 1 from [`BLENDED`] times that on.
    fn factor(&self, r: f64, base: impl Fn() -> f64) -> f64 {
        let x = ((r / self.foot - 1.0) / (BLENDED - 1.0)).clamp(0.0, 1.0);
        if x >= 1.0 {
            return 1.0;
        }
        let share = 1.0 - x * x * (3.0 - 2.0 * x);
        (share * (self.ln(r) - base().ln())).exp()
    }

    /// Logarithm of the mean BSDF at distance `r`: within the first ring a parabola through the first two, where they rise
    /// towards the centre; constant beyond the last.
    fn ln(&self, r: f64) -> f64 {
        let k = self.radii.partition_point(|s| *s <= r);
        if k == 0 {
            let [inner, outer] = [self.radii[0], self.radii[1]].map(|r| r * r);
            let rise = (self.values[0] - self.values[1]) / (outer - inner).max(f64::MIN_POSITIVE);
            return self.values[0] + (rise * (inner - r * r)).clamp(0.0, MOST_RISE);
        }
        if k == self.radii.len() {
            return self.values[k - 1];
        }
        let x = (r - self.radii[k - 1]) / (self.radii[k] - self.radii[k - 1]);
        self.values[k - 1] + x * (self.values[k] - self.values[k - 1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::to_plane;
    use gonio_geom::Direction;

    /// Readings in lines half a degree apart about the mirror direction of 70 degrees, every 0.1 degrees along them.
    fn lines() -> (DVec3, Vec<Point>) {
        let i = Direction::from_degrees(70.0, 180.0).vec();
        let frame = Frame::new(i);
        let mut points = Vec::new();
        for line in -10..=10 {
            for step in -50..=50 {
                let (x, y) = (
                    f64::to_radians(0.1 * f64::from(step)),
                    f64::to_radians(0.5 * f64::from(line)),
                );
                let s = frame.centre + frame.along * x + frame.across * y;
                points.push(to_plane(s.normalize()));
            }
        }
        (i, points)
    }

    /// A disk of soft edge, 0.3 degrees off the mirror direction, with a stretch across the plane of incidence.
    fn disk(i: DVec3, stretch: f64, p: Point) -> f64 {
        let at = Frame::new(i).at(from_plane(p));
        let r = radius(&[f64::to_radians(-0.3), 0.0, stretch.ln()], at).to_degrees();
        0.1 + 100.0 / (1.0 + (r / 0.9).powi(12))
    }

    fn profile(stretch: f64, base: impl Fn(Point) -> f64) -> Option<Profile> {
        let (i, points) = lines();
        let value: Vec<f64> = points.iter().map(|&p| disk(i, stretch, p)).collect();
        let base: Vec<f64> = points.iter().map(|&p| base(p)).collect();
        Profile::new(i, &points, &value, &base, &vec![1.0; points.len()])
    }

    #[test]
    fn a_disk_off_the_mirror_direction_is_found_with_its_centre_and_stretch() {
        for stretch in [0.6, 1.0, 1.5] {
            let found = profile(stretch, |_| 1.0).unwrap();
            assert!(
                (found.shape[0].to_degrees() + 0.3).abs() < 0.03,
                "{:?}",
                found.shape
            );
            assert!(found.shape[1].to_degrees().abs() < 0.05, "{:?}", found.shape);
            assert!(
                (found.shape[2].exp() / stretch - 1.0).abs() < 0.1,
                "{:?}",
                found.shape
            );
        }
    }

    #[test]
    fn between_the_lines_the_edge_of_the_disk_is_where_it_should_be() {
        let (i, _) = lines();
        let (frame, found) = (Frame::new(i), profile(0.6, |_| 1.0).unwrap());
        // The lines stand at 0 and 0.5 degrees; the edge lies at 0.54.
        for y in [0.1, 0.2, 0.25, 0.3, 0.4] {
            let s = frame.centre - frame.along * f64::to_radians(0.3) + frame.across * f64::to_radians(y);
            let p = to_plane(s.normalize());
            let ratio = found.at(p, || 1.0) / disk(i, 0.6, p);
            assert!((ratio - 1.0).abs() < 0.05, "{y}: {ratio}");
        }
    }

    #[test]
    fn the_top_of_a_lobe_of_few_readings_is_not_cut_off() {
        let i = Direction::from_degrees(40.0, 180.0).vec();
        let frame = Frame::new(i);
        let width = f64::to_radians(3.0);
        let lobe = |s: DVec3| 0.05 + 20.0 * (-(radius(&[0.0; 3], frame.at(s)) / width).powi(2)).exp();
        // Readings some 1.2 degrees apart: the first ring holds those within a degree of the centre.
        let golden = std::f64::consts::PI * (1.0 + 5f64.sqrt());
        let directions: Vec<DVec3> = (0..300)
            .map(|k| {
                let r = f64::to_radians(0.68) * (f64::from(k) + 0.5).sqrt();
                let (s, c) = (golden * f64::from(k)).sin_cos();
                (frame.centre + frame.along * (r * c) + frame.across * (r * s)).normalize()
            })
            .collect();
        let points: Vec<Point> = directions.iter().map(|&s| to_plane(s)).collect();
        let value: Vec<f64> = directions.iter().map(|&s| lobe(s)).collect();
        let n = points.len();
        let found = Profile::new(i, &points, &value, &vec![0.05; n], &vec![1e-4; n]).unwrap();
        let top = 0.05 * found.at(to_plane(frame.centre), || 0.05);
        assert!((top / 20.05 - 1.0).abs() < 0.01, "{top}");
    }

    #[test]
    fn a_base_that_describes_the_lobe_stays_alone() {
        let (i, _) = lines();
        assert!(profile(0.6, |p| 0.8 * disk(i, 0.6, p)).is_none());
    }

    #[test]
    fn far_from_the_lobe_the_base_is_left_as_it_is() {
        let found = profile(1.0, |_| 1.0).unwrap();
        let p = to_plane(Direction::from_degrees(30.0, 100.0).vec());
        assert_eq!(found.at(p, || 0.3), 1.0);
    }
}
