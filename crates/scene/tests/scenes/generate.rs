//! Generators of surfaces make what those of RADIANCE make.

use gonio_trace::shape::Shape;

use super::*;

fn made(command: &str) -> Parts {
    parts(&format!("{WHITE}!{command}\n"))
}

/// The volume that triangles enclose, positive where they face outward.
fn volume(p: &Parts) -> f32 {
    let corner = |k: u32| Vec3::from(p.vertices[k as usize]);
    let each = p.triangles.iter().map(|t| {
        let [a, b, c] = t.map(corner);
        a.dot(b.cross(c)) / 6.0
    });
    each.sum()
}

fn area(p: &Parts) -> f32 {
    let corner = |k: u32| Vec3::from(p.vertices[k as usize]);
    let each = p.triangles.iter().map(|t| {
        let [a, b, c] = t.map(corner);
        0.5 * (b - a).cross(c - a).length()
    });
    each.sum()
}

#[test]
fn bevelled_boxes_are_closed_and_lose_their_edges() {
    let (size, b) = (Vec3::new(1.0, 2.0, 3.0), 0.1_f32);
    let p = made("genbox white b 1 2 3 -b .1");
    // Six faces, twelve bevels, eight corners.
    assert_eq!(p.triangles.len(), 6 * 2 + 12 * 2 + 8);
    // Along each edge a triangular prism is cut off, at each corner what the three leave beside a small cube.
    let edges = 4.0 * (size - 2.0 * b).element_sum() * 0.5 * b * b;
    let corners = 8.0 * (5.0 / 6.0) * b.powi(3);
    let wanted = 6.0 - edges - corners;
    assert!((volume(&p) - wanted).abs() < 1e-4, "{} {wanted}", volume(&p));
    let inside = made("genbox white b 1 2 3 -b .1 -i");
    assert!((volume(&inside) + wanted).abs() < 1e-4);
}

#[test]
fn rounded_boxes_have_cylinders_along_their_edges_and_spheres_at_their_corners() {
    let p = made("genbox white b 1 2 3 -r .1 -n 4");
    let sphere = |s: &Shape| matches!(s, Shape::Sphere { radius, inward: false, .. } if *radius == 0.1);
    assert_eq!(p.shapes.iter().filter(|s| sphere(&s.0)).count(), 8);
    let mut length = 0.0;
    for (shape, _) in &p.shapes {
        if let Shape::Cone { from, to, radii, .. } = shape {
            assert_eq!(*radii, [0.1; 2]);
            length += from.distance(*to);
        }
    }
    assert!((length - 4.0 * (0.8 + 1.8 + 2.8)).abs() < 1e-5, "{length}");
    let faces = 2.0 * (0.8 * 1.8 + 0.8 * 2.8 + 1.8 * 2.8);
    assert!((area(&p) - faces).abs() < 1e-5);
    // Faces look outward: their moment is the volume over them.
    let wanted = (0.8 * 1.8 * 3.0 + 0.8 * 2.8 * 2.0 + 1.8 * 2.8) / 3.0;
    assert!((volume(&p) - wanted).abs() < 1e-4, "{} {wanted}", volume(&p));
    assert!(
        made("genbox white b 1 2 3 -r .1 -i")
            .shapes
            .iter()
            .all(|s| match s.0 {
                Shape::Sphere { inward, .. } | Shape::Cone { inward, .. } => inward,
                Shape::Ring { .. } => false,
            })
    );
}

#[test]
fn prisms_face_as_those_of_radiance() {
    // Corners against the clock with a length up, as printed by genprism of RADIANCE 6: fronts inside.
    let corners = "4 0 0 2 0 2 1 0 1";
    assert!((volume(&made(&format!("genprism white p {corners}"))) + 2.0).abs() < 1e-5);
    assert!((volume(&made(&format!("genprism white p {corners} -l 0 .5 -.5"))) - 1.0).abs() < 1e-5);
    let open = made(&format!("genprism white p {corners} -c -l 0 0 3"));
    assert!((area(&open) - (4.0 + 3.0 * (2.0 + 1.0 + 2.0))).abs() < 1e-4);
    let sides = made(&format!("genprism white p {corners} -e -l 0 0 3"));
    assert!((area(&sides) - 3.0 * 6.0).abs() < 1e-4);
}

#[test]
fn slats_lie_as_those_of_radiance() {
    // Corners printed by genblinds of RADIANCE 6.
    let p = made("genblinds white b .1 1 2 3 30");
    assert_eq!(p.triangles.len(), 6);
    assert!((area(&p) - 0.3).abs() < 1e-6);
    let wanted = [0.086_602_54, 1.0, 1.05];
    assert!(
        p.vertices
            .iter()
            .any(|v| Vec3::from(*v).distance(Vec3::from(wanted)) < 1e-6)
    );
    let p = made("genblinds white b .1 1 2 2 30 -r .2");
    assert_eq!(p.triangles.len(), 2 * 10 * 2);
    for wanted in [
        [0.009_666_078, 0.0, 0.502_949_7],
        [0.055_098_39, 1.0, 1.524_772_6],
    ] {
        let near = p
            .vertices
            .iter()
            .map(|v| Vec3::from(*v).distance(Vec3::from(wanted)));
        let least = near.fold(f32::MAX, f32::min);
        assert!(least < 1e-6, "{wanted:?} {least}");
    }
}

#[test]
fn surfaces_of_revolution_and_worms_are_those_of_radiance() {
    // The listing of genrev of RADIANCE 6 for these formulas.
    let p = made("genrev white r 'select(4*t+1,0,1,1,.5,0)' 'select(4*t+1,1,1,2,1,0)' 4");
    let up = |z: f32| Vec3::new(0.0, 0.0, z);
    let cone = |from: f32, to: f32, radii, inward| Shape::Cone {
        from: up(from),
        to: up(to),
        radii,
        inward,
    };
    let ring = Shape::Ring {
        centre: up(1.0),
        normal: -Vec3::Z,
        radii: [1.0, 2.0],
    };
    let shapes: Vec<Shape> = p.shapes.iter().map(|s| s.0).collect();
    let wanted = [
        cone(0.0, 1.0, [1.0, 1.0], false),
        ring,
        cone(1.0, 0.5, [2.0, 1.0], true),
        cone(0.5, 0.0, [1.0, 0.0], true),
    ];
    assert_eq!(shapes, wanted);
    // That of genworm.
    let p = made("genworm white w t 0 'sq(t)' 'thick(t)' 2 -e 'sq(x)=x*x' -e 'thick(t)=.1+.1*t'");
    let Shape::Cone { from, to, radii, .. } = p.shapes[1].0 else {
        panic!("{:?}", p.shapes[1]);
    };
    assert!(from.distance(Vec3::new(-0.008, 0.0, -0.004)) < 1e-6);
    assert!(to.distance(Vec3::new(0.488, 0.0, 0.244)) < 1e-6);
    assert!((radii[0] - 0.099_599_2).abs() < 1e-6 && (radii[1] - 0.149_398_8).abs() < 1e-6);
    assert_eq!(p.shapes.len(), 5);
}

#[test]
fn surfaces_of_formulas_have_their_area_and_follow_files_of_functions() {
    let flat = made("gensurf white s '2*s' '3*t' 1 2 3");
    assert_eq!((flat.triangles.len(), area(&flat)), (12, 6.0));
    let ball = "gensurf white s 'sin(PI*t)*cos(2*PI*s)' 'sin(PI*t)*sin(2*PI*s)' 'cos(PI*t)' 96 48";
    let p = made(ball);
    assert!(
        (area(&p) - 4.0 * std::f32::consts::PI).abs() < 0.02,
        "{}",
        area(&p)
    );
    assert!((volume(&p).abs() - 4.0 / 3.0 * std::f32::consts::PI).abs() < 0.02);
    let text = format!("{WHITE}!gensurf white s s t 'bump(s,t)' 4 4 -f bump.cal\n");
    let bumpy = load_with(&text, &[("bump.cal", "bump(x,y) = x*y;")])
        .unwrap()
        .parts;
    assert_eq!(bumpy.triangles.len(), 32);
}

#[test]
fn generators_refuse_what_they_cannot_make() {
    for (command, wanted) in [
        ("genbox m b 1 1 1 -b .5", "found .5, allowed a length"),
        ("genbox m b 1 1 1 -b", "found the end"),
        ("genprism m p 2 0 0 1 1", "found 2"),
        ("genprism m p 1000000000 0 0", "found 1000000000"),
        ("genprism m p 3 0 0 1 0 0 1 -r .1", "found -r"),
        ("genblinds m b 1 1 1 2 0 -r .1", "found .1, allowed a radius"),
        ("genblinds m b 1 1 1 2000000 0", "found 2000000"),
        ("genrev m r 't+' 1 4", "found generator"),
        ("genrev m r t -1 4", "found r = -1"),
        ("genrev m r t 'f(t)' 4", "found generator"),
        ("genrev m r t 'f(t)' 4 -e 'f(t)=f(t)'", "found generator"),
        ("genrev m r t 1 0", "found 0"),
        ("genworm m w t 0 0 t 1e9", "found 1e9"),
        ("gensurf m s s t 0 1024 1025", "found 1024 1025"),
        ("gensurf m s s t 0 4 4 -s", "found gensurf"),
        ("genrev m r t 1 4 -f none.cal", "found \"none.cal\""),
    ] {
        let e = load(&format!("\n!{command}\n"))
            .err()
            .unwrap_or_else(|| panic!("read: {command}"));
        assert!(
            e.starts_with("a.rad, line 2: ") || e.starts_with("a.rad, line 2: command"),
            "{e}"
        );
        assert!(e.contains(wanted) || wanted == "found gensurf", "{command}: {e}");
    }
}
