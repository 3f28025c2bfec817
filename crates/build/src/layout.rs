//! Which measured incidences are near a query, and how much each counts.

use std::f64::consts::FRAC_PI_2;

use gonio_geom::DVec3;

use crate::cubic::Stencil;
use crate::images::{Image, Symmetry};
use crate::triangulated::{Placed, Triangulated};
use crate::weights::MOST;

/// An incidence this close to the normal (radians) is the normal: 0.1 degrees.
pub(crate) const NORMAL: f64 = 0.1 * std::f64::consts::PI / 180.0;

/// How the measured incidences lie.
#[derive(Clone, Debug)]
pub(crate) enum Layout {
    /// Only the polar angle matters: polar angles in ascending order.
    Isotropic(Vec<f64>),
    /// Triangulated directions of incidence.
    Anisotropic(Triangulated),
}

/// A node that takes part in a query.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Neighbour {
    pub(crate) node: usize,
    pub(crate) weight: f64,
    /// The image of the slice that is read: an isotropic slice seen from the other side of the normal, or a mirror image.
    pub(crate) image: Image,
}

impl Neighbour {
    /// A node that answers alone.
    pub(crate) fn whole(node: usize, image: Image) -> Self {
        Neighbour {
            node,
            weight: 1.0,
            image,
        }
    }

    /// A direction between the query's frame and the slice's.
    #[inline]
    pub(crate) fn turn(&self, v: DVec3) -> DVec3 {
        self.image.of(v)
    }
}

/// The neighbours of a query, weights summing to 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    list: [Neighbour; MOST],
    count: usize,
    /// Whether the query lies between measured incidences.
    pub(crate) inside: bool,
    /// Whether it lies past the last one, or outside their hull.
    pub(crate) beyond: bool,
}

impl Near {
    fn of(entries: &[(usize, f64)], inside: bool) -> Self {
        Near::placed(entries, inside, |node| (node, Image::SAME))
    }

    pub(crate) fn placed(
        entries: &[(usize, f64)],
        inside: bool,
        of: impl Fn(usize) -> (usize, Image),
    ) -> Self {
        let mut list = [Neighbour::default(); MOST];
        for (slot, &(k, weight)) in list.iter_mut().zip(entries) {
            let (node, image) = of(k);
            *slot = Neighbour { node, weight, image };
        }
        Near {
            list,
            count: entries.len().min(MOST),
            inside,
            beyond: !inside,
        }
    }

    /// One slice alone.
    pub(crate) fn alone(neighbour: Neighbour) -> Self {
        let mut near = Near::of(&[(neighbour.node, 1.0)], true);
        near.list[0] = neighbour;
        near
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Neighbour> {
        self.list[..self.count].iter()
    }

    pub(crate) fn len(&self) -> usize {
        self.count
    }
}

impl Layout {
    /// The layout of local incidences under the images of `symmetry`.
    pub(crate) fn new(directions: &[DVec3], symmetry: Symmetry) -> Self {
        match symmetry {
            Symmetry::Isotropic => Layout::Isotropic(directions.iter().map(|d| polar(*d)).collect()),
            Symmetry::Axes(images) => Layout::Anisotropic(Triangulated::new(directions, images)),
        }
    }

    /// The query in the frame of the slices: an isotropic one is rotated until the incidence has azimuth pi.
    #[inline]
    pub(crate) fn frame(&self, i: DVec3, s: DVec3) -> (DVec3, DVec3) {
        let Layout::Isotropic(_) = self else {
            return (i, s);
        };
        let r = i.x.hypot(i.y);
        let (c, n) = if r > 1e-12 { (i.x / r, i.y / r) } else { (1.0, 0.0) };
        (
            DVec3::new(-r, 0.0, i.z),
            DVec3::new(-(c * s.x + n * s.y), n * s.x - c * s.y, s.z),
        )
    }

    /// The neighbours of an incidence (in the frame of the slices).
    #[inline]
    pub(crate) fn near(&self, i: DVec3) -> Near {
        match self {
            Layout::Isotropic(thetas) => near_polar(thetas, polar(i)),
            Layout::Anisotropic(a) => a.near(i),
        }
    }

    /// The same by a local quadratic of the direction of incidence; `None` where it would amplify errors, outside the
    /// measured incidences, and in isotropic layout.
    pub(crate) fn near_quadratic(&self, i: DVec3) -> Option<Near> {
        let Layout::Anisotropic(a) = self else { return None };
        a.near_quadratic(i)
    }

    /// The measured incidences and their images; none in isotropic layout.
    pub(crate) fn placed(&self) -> &[Placed] {
        match self {
            Layout::Isotropic(_) => &[],
            Layout::Anisotropic(a) => a.placed(),
        }
    }

    /// Incidences that stand at the edge of what was measured: the last one, or those of the hull.
    pub(crate) fn rim(&self) -> Vec<usize> {
        match self {
            Layout::Isotropic(thetas) => vec![thetas.len() - 1],
            Layout::Anisotropic(a) => a.on_hull(),
        }
    }

    /// Incidences next to one another: each, or an image of it, beside another one as it was measured.
    pub(crate) fn pairs(&self) -> Vec<(Neighbour, usize)> {
        match self {
            Layout::Isotropic(thetas) => (1..thetas.len())
                .flat_map(|k| [(k - 1, k), (k, k - 1)])
                .map(|(a, b)| (Neighbour::whole(a, Image::SAME), b))
                .collect(),
            Layout::Anisotropic(a) => a.pairs(),
        }
    }

    /// How far an incidence (in the frame of the slices) lies past the last one, or outside the hull; radians.
    pub(crate) fn past(&self, i: DVec3) -> f64 {
        match self {
            Layout::Isotropic(thetas) => thetas.last().map_or(0.0, |last| (polar(i) - last).max(0.0)),
            Layout::Anisotropic(_) if self.near(i).inside => 0.0,
            Layout::Anisotropic(_) => self.distance(i),
        }
    }

    /// Square distance of an incidence to its neighbours, each by its weight: what the error of linear interpolation
    /// goes with; radians squared.
    pub(crate) fn spread(&self, i: DVec3) -> f64 {
        let square = |k: &Neighbour| match self {
            Layout::Isotropic(thetas) => {
                let theta = thetas[k.node];
                let at = if k.image == Image::SAME { theta } else { -theta };
                (at - polar(i)).powi(2)
            }
            Layout::Anisotropic(a) => {
                let at = k.turn(a.placed()[k.node].direction);
                at.dot(i).clamp(-1.0, 1.0).acos().powi(2)
            }
        };
        self.near(i).iter().map(|k| k.weight * square(k)).sum()
    }

    /// The polar angle of an incidence and those around it; `None` in anisotropic layout, and past the data.
    #[inline]
    pub(crate) fn stencil(&self, i: DVec3) -> Option<(f64, Stencil)> {
        let Layout::Isotropic(thetas) = self else {
            return None;
        };
        let theta = polar(i);
        Some((theta, Stencil::new(thetas, theta)?))
    }

    /// Angle to the nearest measured incidence, radians.
    pub(crate) fn distance(&self, i: DVec3) -> f64 {
        let angles: &mut dyn Iterator<Item = f64> = match self {
            Layout::Isotropic(thetas) => {
                let theta = polar(i);
                &mut thetas.iter().map(move |t| (t - theta).abs())
            }
            Layout::Anisotropic(a) => &mut a
                .placed()
                .iter()
                .map(move |p| p.direction.dot(i).clamp(-1.0, 1.0).acos()),
        };
        angles.fold(f64::INFINITY, f64::min)
    }

    /// Incidences with others on all sides.
    pub(crate) fn interior(&self) -> Vec<usize> {
        match self {
            Layout::Isotropic(thetas) => (1..thetas.len().saturating_sub(1)).collect(),
            Layout::Anisotropic(a) => a.interior(),
        }
    }
}

/// Linear in the polar angle. Below the first incidence its slice is used from both sides of the normal; past the
/// last one the last slice counts alone.
#[inline]
fn near_polar(thetas: &[f64], theta: f64) -> Near {
    let last = thetas.len() - 1;
    if theta >= thetas[last] {
        return Near::of(&[(last, 1.0)], theta <= thetas[last] + 1e-9);
    }
    let first = thetas[0];
    if theta <= first {
        if first < NORMAL {
            return Near::of(&[(0, 1.0)], true);
        }
        let turned = 0.5 * (1.0 - theta / first);
        let mut near = Near::of(&[(0, 1.0 - turned), (0, turned)], theta >= first - 1e-9);
        near.list[1].image = Image::HALF_TURN;
        near.beyond = false;
        return near;
    }
    let mut k = 0;
    while thetas[k + 1] < theta {
        k += 1;
    }
    let w = (theta - thetas[k]) / (thetas[k + 1] - thetas[k]);
    Near::of(&[(k, 1.0 - w), (k + 1, w)], true)
}

/// Polar angle of a local direction, radians, at most pi/2.
#[inline]
fn polar(v: DVec3) -> f64 {
    v.x.hypot(v.y).atan2(v.z).min(FRAC_PI_2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::images::Images;
    use crate::weights::to_incidence_plane;
    use gonio_geom::Direction;

    fn total(near: Near) -> f64 {
        near.iter().map(|k| k.weight).sum()
    }

    #[test]
    fn weights_add_up_to_one_everywhere() {
        let grid: Vec<DVec3> = [
            (0.0, 0.0),
            (30.0, 0.0),
            (30.0, 120.0),
            (30.0, 240.0),
            (60.0, 60.0),
        ]
        .map(|(t, p)| Direction::from_degrees(t, p).vec())
        .to_vec();
        let aniso = Layout::new(&grid, Symmetry::Axes(Images::None));
        let polar: Vec<DVec3> = [10.0, 20.0, 60.0]
            .map(|t| Direction::from_degrees(t, 180.0).vec())
            .to_vec();
        let iso = Layout::new(&polar, Symmetry::Isotropic);
        for theta in [0.0, 5.0, 10.0, 29.0, 45.0, 89.0] {
            for phi in [0.0, 33.0, 180.0, 300.0] {
                let i = Direction::from_degrees(theta, phi).vec();
                assert!((total(aniso.near(i)) - 1.0).abs() < 1e-12);
                assert!((total(iso.near(i)) - 1.0).abs() < 1e-12);
            }
        }
        assert_eq!(aniso.interior(), vec![0]);
        assert_eq!(iso.interior(), vec![1]);
    }

    #[test]
    fn the_isotropic_frame_keeps_the_angle_and_puts_the_incidence_at_pi() {
        let i = Direction::from_degrees(40.0, 77.0).vec();
        let s = Direction::from_degrees(60.0, 200.0).vec();
        let layout = Layout::new(&[i], Symmetry::Isotropic);
        let (a, b) = layout.frame(i, s);
        assert!(a.y == 0.0 && a.x < 0.0 && (a.dot(b) - i.dot(s)).abs() < 1e-12);
        assert!((a.cross(b).z - i.cross(s).z).abs() < 1e-12, "no reflection");
    }

    #[test]
    fn images_fill_the_azimuths_that_were_not_measured() {
        let quarter: Vec<DVec3> = [(0.0, 0.0), (40.0, 0.0), (40.0, 45.0), (40.0, 90.0)]
            .map(|(t, p)| Direction::from_degrees(t, p).vec())
            .to_vec();
        let layout = Layout::new(&quarter, Symmetry::Axes(Images::Quadrilateral));
        assert_eq!(layout.interior(), vec![0]);
        for phi in [20.0, 100.0, 200.0, 300.0] {
            let i = Direction::from_degrees(25.0, phi).vec();
            let near = layout.near(i);
            assert!(near.inside && (total(near) - 1.0).abs() < 1e-12);
            let p = to_incidence_plane(i);
            for (axis, wanted) in p.iter().enumerate() {
                let mean: f64 = near
                    .iter()
                    .map(|k| k.weight * to_incidence_plane(k.turn(quarter[k.node]))[axis])
                    .sum();
                assert!((mean - wanted).abs() < 1e-9);
            }
        }
        let half = Layout::new(&quarter, Symmetry::Axes(Images::None));
        assert!(!half.near(Direction::from_degrees(25.0, 200.0).vec()).inside);
    }
}
