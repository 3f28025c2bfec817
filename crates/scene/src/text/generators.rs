//! `genprism`, `genblinds`, `genrev`, `genworm`, `gensurf` [Radiance, gen/].

use glam::DVec3;
use gonio_io::radiance_material::Item;

use super::generated::{Formulas, MOST, Wrong, number, polygon, segments, shape};

/// The prism of `genprism material name N x1 y1 … xN yN [-l x y z] [-c] [-e]`.
pub(super) fn genprism(words: &[String]) -> Result<Vec<Item>, Wrong> {
    const USAGE: &str =
        "genprism material name N x1 y1 … xN yN [-l x y z] [-c] [-e]; not -r, nor corners in a file";
    let [material, name, count, rest @ ..] = words else {
        return Err((words.join(" "), USAGE));
    };
    let whole = |v: f64| v.fract() == 0.0 && (3.0..=MOST as f64).contains(&v);
    let n = number(Some(count), USAGE, whole)? as usize;
    let mut rest = rest.iter();
    let mut base = Vec::new();
    for _ in 0..n {
        let mut next = || number(rest.next(), "x y of every corner", |_| true);
        base.push(DVec3::new(next()?, next()?, 0.0));
    }
    let (mut along, mut open, mut ends) = (DVec3::Z, false, true);
    while let Some(option) = rest.next() {
        match option.as_str() {
            "-l" => {
                let mut next = || number(rest.next(), "-l and the vector of its length", |_| true);
                along = DVec3::new(next()?, next()?, next()?);
            }
            "-c" => open = true,
            "-e" => ends = false,
            _ => return Err((option.clone(), USAGE)),
        }
    }
    let mut items = Vec::new();
    if ends {
        let top: Vec<DVec3> = base.iter().rev().map(|p| *p + along).collect();
        items.push(polygon(material, &format!("{name}.b"), &base));
        items.push(polygon(material, &format!("{name}.t"), &top));
    }
    for k in 0..n - usize::from(open) {
        let (p, q) = (base[k], base[(k + 1) % n]);
        items.push(polygon(
            material,
            &format!("{name}.{}", k + 1),
            &[p, p + along, q + along, q],
        ));
    }
    Ok(items)
}

/// The slats of `genblinds material name depth width height slats angle [-r|+r radius]`.
pub(super) fn genblinds(words: &[String]) -> Result<Vec<Item>, Wrong> {
    const USAGE: &str = "genblinds material name depth width height slats angle [-r|+r radius]";
    /// Facets of a curved slat.
    const FACETS: usize = 10;
    let [material, name, depth, width, height, slats, angle, curve @ ..] = words else {
        return Err((words.join(" "), USAGE));
    };
    let size = |word: &String| number(Some(word), "sizes above 0", |v| v > 0.0);
    let (depth, width, height) = (size(depth)?, size(width)?, size(height)?);
    let slats = segments(Some(slats))?;
    let (sin, cos) = number(Some(angle), "an angle in degrees", |_| true)?
        .to_radians()
        .sin_cos();
    // Points of the section along the chord and off it.
    let section: Vec<(f64, f64)> = match curve {
        [] => vec![(0.0, 0.0), (depth, 0.0)],
        [side, radius] if side == "-r" || side == "+r" => {
            let allowed = "a radius of at least half the depth";
            let radius = number(Some(radius), allowed, |r| r >= 0.5 * depth)?;
            let half = (0.5 * depth / radius).asin();
            let up = if side == "+r" { 1.0 } else { -1.0 };
            let point = |k: usize| {
                let a = half * (2.0 * k as f64 / FACETS as f64 - 1.0);
                (
                    0.5 * depth + radius * a.sin(),
                    up * radius * (a.cos() - half.cos()),
                )
            };
            (0..=FACETS).map(point).collect()
        }
        _ => return Err((curve.join(" "), USAGE)),
    };
    if slats * (section.len() - 1) > MOST {
        return Err((slats.to_string(), "at most 1048576 polygons"));
    }
    let mut items = Vec::new();
    for slat in 0..slats {
        let z = height * (slat as f64 + 0.5) / slats as f64;
        let at = |(u, v): (f64, f64), y: f64| DVec3::new(u * cos - v * sin, y, z + u * sin + v * cos);
        for (k, ends) in section.windows(2).enumerate() {
            let points = [
                at(ends[0], 0.0),
                at(ends[0], width),
                at(ends[1], width),
                at(ends[1], 0.0),
            ];
            items.push(polygon(material, &format!("{name}.{}.{k}", slat + 1), &points));
        }
    }
    Ok(items)
}

/// The surface of revolution of `genrev material name z(t) r(t) segments`; `definitions` are those of `-e` and `-f`.
pub(super) fn genrev(words: &[String], definitions: &str) -> Result<Vec<Item>, Wrong> {
    const USAGE: &str = "genrev material name z(t) r(t) segments [-e formula] [-f file]; not -s";
    let [material, name, z, r, count] = words else {
        return Err((words.join(" "), USAGE));
    };
    let n = segments(Some(count))?;
    let curve = Formulas::new(definitions, "t", &[z, r])?;
    let mut items = Vec::new();
    let [mut z0, mut r0] = curve.at::<2>(&[0.0])?;
    for k in 1..=n {
        let [z1, r1] = curve.at::<2>(&[k as f64 / n as f64])?;
        if r0 < 0.0 || r1 < 0.0 {
            return Err((format!("r = {}", r0.min(r1)), "radii of at least 0"));
        }
        let id = format!("{name}.{k}");
        let axis = [0.0, 0.0, z0, 0.0, 0.0, z1];
        if z0 == z1 && r0 != r1 {
            let normal = if r1 > r0 { -1.0 } else { 1.0 };
            let reals = vec![0.0, 0.0, z0, 0.0, 0.0, normal, r0, r1];
            items.push(shape(material, "ring", &id, reals));
        } else if z0 != z1 && r0 == r1 && r0 > 0.0 {
            let word = if z1 > z0 { "cylinder" } else { "tube" };
            items.push(shape(material, word, &id, [axis.as_slice(), &[r0]].concat()));
        } else if z0 != z1 && r0 != r1 {
            let word = if z1 > z0 { "cone" } else { "cup" };
            items.push(shape(material, word, &id, [axis.as_slice(), &[r0, r1]].concat()));
        }
        (z0, r0) = (z1, r1);
    }
    Ok(items)
}

/// The worm of `genworm material name x(t) y(t) z(t) r(t) segments`: spheres, and cones that touch them.
pub(super) fn genworm(words: &[String], definitions: &str) -> Result<Vec<Item>, Wrong> {
    const USAGE: &str = "genworm material name x(t) y(t) z(t) r(t) segments [-e formula] [-f file]";
    let [material, name, x, y, z, r, count] = words else {
        return Err((words.join(" "), USAGE));
    };
    let n = segments(Some(count))?;
    let curve = Formulas::new(definitions, "t", &[x, y, z, r])?;
    let mut items = Vec::new();
    let mut last: Option<(DVec3, f64)> = None;
    for k in 0..=n {
        let [x, y, z, r] = curve.at::<4>(&[k as f64 / n as f64])?;
        if r < 0.0 {
            return Err((format!("r = {r}"), "radii of at least 0"));
        }
        let p = DVec3::new(x, y, z);
        if let Some((p0, r0)) = last {
            let (way, wider) = (p - p0, r - r0);
            let length = way.length();
            // Within the other sphere there is nothing between.
            if length > wider.abs() {
                let slope = wider / length;
                let (back, thin) = (slope / length * way, (1.0 - slope * slope).sqrt());
                let ends = [(p0 - r0 * back).to_array(), (p - r * back).to_array()].concat();
                let id = format!("{name}.c{k}");
                if wider == 0.0 && r > 0.0 {
                    items.push(shape(material, "cylinder", &id, [ends, vec![r]].concat()));
                } else if wider != 0.0 {
                    let radii = vec![r0 * thin, r * thin];
                    items.push(shape(material, "cone", &id, [ends, radii].concat()));
                }
            }
        }
        if r > 0.0 {
            let reals = [p.to_array().as_slice(), &[r]].concat();
            items.push(shape(material, "sphere", &format!("{name}.s{k}"), reals));
        }
        last = Some((p, r));
    }
    Ok(items)
}

/// The surface of `gensurf material name x(s,t) y(s,t) z(s,t) m n`: quadrangles where they are flat, else triangles.
pub(super) fn gensurf(words: &[String], definitions: &str) -> Result<Vec<Item>, Wrong> {
    const USAGE: &str = "gensurf material name x(s,t) y(s,t) z(s,t) m n [-e formula] [-f file]; not -s, -o, nor a file of points";
    let [material, name, x, y, z, m, n] = words else {
        return Err((words.join(" "), USAGE));
    };
    let (m, n) = (segments(Some(m))?, segments(Some(n))?);
    if m.saturating_mul(n) > MOST {
        return Err((format!("{m} {n}"), "at most 1048576 cells"));
    }
    let surface = Formulas::new(definitions, "s,t", &[x, y, z])?;
    let mut points = Vec::with_capacity((m + 1) * (n + 1));
    for j in 0..=n {
        for i in 0..=m {
            let place = [i as f64 / m as f64, j as f64 / n as f64];
            points.push(DVec3::from(surface.at::<3>(&place)?));
        }
    }
    let mut items: Vec<Item> = Vec::new();
    for j in 0..n {
        for i in 0..m {
            let at = |i: usize, j: usize| points[j * (m + 1) + i];
            let quad = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            for part in pieces(quad, (i + j) % 2 == 0) {
                items.push(polygon(material, &format!("{name}.{}", items.len() + 1), &part));
            }
        }
    }
    Ok(items)
}

/// The flat polygons of a quadrangle; without area it is none.
fn pieces([a, b, c, d]: [DVec3; 4], first: bool) -> Vec<Vec<DVec3>> {
    let triangles = if first {
        [[a, b, c], [a, c, d]]
    } else {
        [[a, b, d], [b, c, d]]
    };
    let turn = |t: &[DVec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]);
    let normals = triangles.each_ref().map(turn);
    let size = (c - a).length_squared().max((d - b).length_squared());
    let empty = normals.map(|n| n.length() <= 1e-12 * size);
    let flat = normals[0].cross(normals[1]).length() <= 1e-9 * normals[0].length() * normals[1].length();
    // All corners turn the same way.
    let convex = [[d, a, b], [a, b, c], [b, c, d], [c, d, a]]
        .iter()
        .all(|t| turn(t).dot(normals[0]) > 0.0);
    if empty == [false; 2] && flat && convex {
        return vec![vec![a, b, c, d]];
    }
    let kept = triangles.iter().zip(empty).filter(|(_, empty)| !empty);
    kept.map(|(t, _)| t.to_vec()).collect()
}
