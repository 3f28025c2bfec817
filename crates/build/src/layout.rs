//! Which measured incidences are near a query, and how much each counts.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use gonio_geom::DVec3;

use crate::cubic::Stencil;
use crate::mesh::Mesh;
use crate::plane::{Point, to_plane};

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

/// Directions of incidence with their triangulation (`None` for fewer than three, or in one plane).
#[derive(Clone, Debug)]
pub(crate) struct Triangulated {
    directions: Vec<DVec3>,
    mesh: Option<Arc<Mesh>>,
    hull: Vec<usize>,
}

/// A node that takes part in a query.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Neighbour {
    pub(crate) node: usize,
    pub(crate) weight: f64,
    /// The slice is read with its azimuth turned by pi (an isotropic slice seen from the other side of the normal).
    pub(crate) turned: bool,
}

impl Neighbour {
    /// A node that answers alone.
    pub(crate) fn whole(node: usize, turned: bool) -> Self {
        Neighbour {
            node,
            weight: 1.0,
            turned,
        }
    }

    /// A direction between the query's frame and the slice's.
    #[inline]
    pub(crate) fn turn(&self, v: DVec3) -> DVec3 {
        if self.turned {
            DVec3::new(-v.x, -v.y, v.z)
        } else {
            v
        }
    }
}

/// At most three neighbours, weights summing to 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    list: [Neighbour; 3],
    count: usize,
    /// Whether the query lies between measured incidences.
    pub(crate) inside: bool,
    /// Whether it lies past the last one, or outside their hull.
    pub(crate) beyond: bool,
}

impl Near {
    fn of(entries: &[(usize, f64)], inside: bool) -> Self {
        let mut list = [Neighbour::default(); 3];
        for (slot, &(node, weight)) in list.iter_mut().zip(entries) {
            *slot = Neighbour {
                node,
                weight,
                turned: false,
            };
        }
        Near {
            list,
            count: entries.len().min(3),
            inside,
            beyond: !inside,
        }
    }

    /// One node alone.
    pub(crate) fn alone(node: usize) -> Self {
        Near::of(&[(node, 1.0)], true)
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Neighbour> {
        self.list[..self.count].iter()
    }
}

impl Layout {
    /// The layout of local incidences.
    pub(crate) fn new(directions: &[DVec3], isotropic: bool) -> Self {
        if isotropic {
            return Layout::Isotropic(directions.iter().map(|d| polar(*d)).collect());
        }
        let mesh = Mesh::new(directions.iter().map(|&d| to_plane(d)).collect());
        let hull = mesh
            .as_ref()
            .map_or_else(Vec::new, |m| m.hull().iter().map(|&k| k as usize).collect());
        Layout::Anisotropic(Triangulated {
            directions: directions.to_vec(),
            mesh: mesh.map(Arc::new),
            hull,
        })
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

    /// Incidences that stand at the edge of what was measured: the last one, or those of the hull.
    pub(crate) fn rim(&self) -> Vec<usize> {
        match self {
            Layout::Isotropic(thetas) => vec![thetas.len() - 1],
            Layout::Anisotropic(a) => a.hull.clone(),
        }
    }

    /// Incidences next to one another, each pair once.
    pub(crate) fn pairs(&self) -> Vec<(usize, usize)> {
        match self {
            Layout::Isotropic(thetas) => (1..thetas.len()).map(|k| (k - 1, k)).collect(),
            Layout::Anisotropic(Triangulated { mesh: Some(mesh), .. }) => {
                let mut pairs: Vec<(usize, usize)> = mesh
                    .triangles()
                    .iter()
                    .flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])])
                    .map(|(a, b)| (a.min(b) as usize, a.max(b) as usize))
                    .collect();
                pairs.sort_unstable();
                pairs.dedup();
                pairs
            }
            Layout::Anisotropic(_) => Vec::new(),
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
        let square = |node: usize, turned: bool| match self {
            Layout::Isotropic(thetas) => {
                let at = if turned { -thetas[node] } else { thetas[node] };
                (at - polar(i)).powi(2)
            }
            Layout::Anisotropic(a) => a.directions[node].dot(i).clamp(-1.0, 1.0).acos().powi(2),
        };
        self.near(i)
            .iter()
            .map(|k| k.weight * square(k.node, k.turned))
            .sum()
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
            Layout::Anisotropic(a) => &mut a.directions.iter().map(move |d| d.dot(i).clamp(-1.0, 1.0).acos()),
        };
        angles.fold(f64::INFINITY, f64::min)
    }

    /// Incidences with others on all sides.
    pub(crate) fn interior(&self) -> Vec<usize> {
        match self {
            Layout::Isotropic(thetas) => (1..thetas.len().saturating_sub(1)).collect(),
            Layout::Anisotropic(a) if a.mesh.is_some() => {
                (0..a.directions.len()).filter(|k| !a.hull.contains(k)).collect()
            }
            Layout::Anisotropic(_) => Vec::new(),
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
        near.list[1].turned = true;
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

impl Triangulated {
    /// Barycentric in the triangle around the incidence; outside the hull linear along its nearest edge; without a
    /// triangulation the nearest incidence alone.
    fn near(&self, i: DVec3) -> Near {
        let p = to_plane(i);
        let Some(mesh) = &self.mesh else {
            return Near::of(&[(self.nearest(i), 1.0)], false);
        };
        if let Some(at) = mesh.locate(p) {
            let [a, b, c] = at.vertices.map(|k| k as usize);
            if a == b {
                return Near::of(&[(a, 1.0)], true);
            }
            let [x, y, z] = at.weights;
            return Near::of(&[(a, x), (b, y), (c, z)], true);
        }
        let points = mesh.points();
        let mut best = (f64::INFINITY, 0, 0, 0.0);
        for (k, &a) in self.hull.iter().enumerate() {
            let b = self.hull[(k + 1) % self.hull.len()];
            let (t, d2) = project_on(points[a], points[b], p);
            if d2 < best.0 {
                best = (d2, a, b, t);
            }
        }
        let (_, a, b, t) = best;
        Near::of(&[(a, 1.0 - t), (b, t)], false)
    }

    fn nearest(&self, i: DVec3) -> usize {
        let mut best = 0;
        for k in 1..self.directions.len() {
            if self.directions[k].dot(i) > self.directions[best].dot(i) {
                best = k;
            }
        }
        best
    }
}

/// Position along the segment `a b` (0 to 1) of the point nearest to `p`, and its squared distance.
fn project_on(a: Point, b: Point, p: Point) -> (f64, f64) {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let (x, y) = (p[0] - a[0], p[1] - a[1]);
    let t = ((x * dx + y * dy) / (dx * dx + dy * dy).max(1e-300)).clamp(0.0, 1.0);
    (t, (x - t * dx).powi(2) + (y - t * dy).powi(2))
}

/// Polar angle of a local direction, radians, at most pi/2.
#[inline]
fn polar(v: DVec3) -> f64 {
    v.x.hypot(v.y).atan2(v.z).min(FRAC_PI_2)
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let aniso = Layout::new(&grid, false);
        let polar: Vec<DVec3> = [10.0, 20.0, 60.0]
            .map(|t| Direction::from_degrees(t, 180.0).vec())
            .to_vec();
        let iso = Layout::new(&polar, true);
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
        let layout = Layout::new(&[i], true);
        let (a, b) = layout.frame(i, s);
        assert!(a.y == 0.0 && a.x < 0.0 && (a.dot(b) - i.dot(s)).abs() < 1e-12);
        assert!((a.cross(b).z - i.cross(s).z).abs() < 1e-12, "no reflection");
    }
}
