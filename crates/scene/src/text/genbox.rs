//! The boxes of `genbox`, sharp, bevelled or rounded [Radiance, gen/genbox.c].

use glam::DVec3;
use gonio_io::radiance_material::Item;

use super::generated::{Wrong, number, polygon, shape};

const USAGE: &str = "genbox material name xsize ysize zsize [-i] [-b bevel | -r round [-n segments] [-s]]";

/// What is done to the edges.
#[derive(Clone, Copy, PartialEq)]
enum Edges {
    Sharp,
    Bevelled(f64),
    Rounded(f64),
}

/// The surfaces of a box; `words` are what follows `genbox`. Rounded edges and corners are cylinders and spheres, into however many
/// segments (`-n`) RADIANCE would cut them.
///
/// # Errors
/// What is wrong, and what is allowed.
pub(super) fn genbox(words: &[String]) -> Result<Vec<Item>, Wrong> {
    let [material, name, sizes @ ..] = words else {
        return Err((words.join(" "), USAGE));
    };
    let (sizes, options) = sizes
        .split_at_checked(3)
        .ok_or_else(|| (words.join(" "), USAGE))?;
    let mut size = DVec3::ZERO;
    for (k, word) in sizes.iter().enumerate() {
        size[k] = number(Some(word), "sizes above 0", |v| v > 0.0)?;
    }
    let (mut inward, mut edges) = (false, Edges::Sharp);
    let mut options = options.iter();
    while let Some(option) = options.next() {
        let mut length = || {
            let most = 0.5 * size.min_element();
            number(
                options.next(),
                "a length of at least 0, less than half of each size",
                |v| (0.0..most).contains(&v),
            )
        };
        match option.as_str() {
            "-i" => inward = true,
            "-b" => edges = Edges::Bevelled(length()?),
            "-r" => edges = Edges::Rounded(length()?),
            "-s" => {}
            "-n" => {
                number(options.next(), "a number of segments", |v| v >= 1.0)?;
            }
            _ => return Err((option.clone(), USAGE)),
        }
    }
    if matches!(edges, Edges::Bevelled(0.0) | Edges::Rounded(0.0)) {
        edges = Edges::Sharp;
    }
    let inset = match edges {
        Edges::Sharp => 0.0,
        Edges::Bevelled(b) | Edges::Rounded(b) => b,
    };
    let cuboid = Cuboid {
        size,
        inset,
        inward,
        material,
        name,
    };
    let mut items = cuboid.faces();
    match edges {
        Edges::Sharp => {}
        Edges::Bevelled(_) => items.extend(cuboid.bevels()),
        Edges::Rounded(radius) => items.extend(cuboid.rounds(radius)),
    }
    Ok(items)
}

struct Cuboid<'a> {
    size: DVec3,
    inset: f64,
    inward: bool,
    material: &'a str,
    name: &'a str,
}

/// The corner of three bits: bit 0 is x, bit 1 y, bit 2 z.
fn upper(corner: usize, axis: usize) -> bool {
    corner >> axis & 1 == 1
}

impl Cuboid<'_> {
    /// The point of a corner that lies on the face across `axis`.
    fn on_face(&self, corner: usize, axis: usize) -> DVec3 {
        let mut p = self.inner(corner);
        p[axis] = if upper(corner, axis) { self.size[axis] } else { 0.0 };
        p
    }

    /// The corner drawn in by the inset along all three axes.
    fn inner(&self, corner: usize) -> DVec3 {
        let along = |k: usize| {
            if upper(corner, k) {
                self.size[k] - self.inset
            } else {
                self.inset
            }
        };
        DVec3::new(along(0), along(1), along(2))
    }

    /// A polygon that faces away from the middle, or to it.
    fn facing(&self, id: &str, mut points: Vec<DVec3>) -> Item {
        let turn = (points[1] - points[0]).cross(points[2] - points[0]);
        let away = turn.dot(points[0] - 0.5 * self.size) > 0.0;
        if away == self.inward {
            points.reverse();
        }
        polygon(self.material, &format!("{}.{id}", self.name), &points)
    }

    fn faces(&self) -> Vec<Item> {
        let mut items = Vec::with_capacity(6);
        for axis in 0..3 {
            let (a, b) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
            for first in [0, 1 << axis] {
                let corners = [first, first | a, first | a | b, first | b];
                let id: String = corners.iter().map(usize::to_string).collect();
                let points = corners.iter().map(|c| self.on_face(*c, axis)).collect();
                items.push(self.facing(&id, points));
            }
        }
        items
    }

    /// The twelve edges by their two corners, and the axes of the faces that meet there.
    fn edges() -> impl Iterator<Item = ([usize; 2], [usize; 2])> {
        (0..3).flat_map(|axis| {
            let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
            (0..4).map(move |k| {
                let corner = (k & 1) << a | (k >> 1) << b;
                ([corner, corner | 1 << axis], [a, b])
            })
        })
    }

    fn bevels(&self) -> Vec<Item> {
        let mut items: Vec<Item> = Self::edges()
            .map(|([p, q], [a, b])| {
                let points = vec![
                    self.on_face(p, a),
                    self.on_face(q, a),
                    self.on_face(q, b),
                    self.on_face(p, b),
                ];
                self.facing(&format!("{p}{q}"), points)
            })
            .collect();
        items.extend((0..8).map(|corner| {
            let points = (0..3).map(|axis| self.on_face(corner, axis)).collect();
            self.facing(&corner.to_string(), points)
        }));
        items
    }

    fn rounds(&self, radius: f64) -> Vec<Item> {
        let [cylinder, sphere] = if self.inward {
            ["tube", "bubble"]
        } else {
            ["cylinder", "sphere"]
        };
        let mut items: Vec<Item> = Self::edges()
            .map(|([p, q], _)| {
                let (from, to) = (self.inner(p), self.inner(q));
                let reals = [from.to_array().as_slice(), &to.to_array(), &[radius]].concat();
                shape(self.material, cylinder, &format!("{}.{p}{q}", self.name), reals)
            })
            .collect();
        items.extend((0..8).map(|corner| {
            let reals = [self.inner(corner).to_array().as_slice(), &[radius]].concat();
            shape(self.material, sphere, &format!("{}.{corner}", self.name), reals)
        }));
        items
    }
}
