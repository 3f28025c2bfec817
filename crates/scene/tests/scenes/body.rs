//! Bodies that absorb, the boundaries between them, and spotlights.

use glam::Vec3;

use crate::{EYE, FLOOR, close, load, look, parts};

/// A sky that shines from below the horizon only.
const BELOW: &str = "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 -1 180\n";

/// The level faces of a body between two heights, and nothing at its sides.
fn slab(material: &str, low: f64, high: f64) -> String {
    format!(
        "{material} polygon t{high} 0 0 12 -90 -90 {high} 90 -90 {high} 90 90 {high} -90 90 {high}\n\
         {material} polygon b{low} 0 0 12 -90 -90 {low} -90 90 {low} 90 90 {low} 90 -90 {low}\n"
    )
}

/// What a slab lets through upright, with all reflections inside.
fn through(index: f64, left: [f64; 3]) -> Vec3 {
    let r = ((index - 1.0) / (index + 1.0)).powi(2);
    let of = |a: f64| (1.0 - r).powi(2) * a / (1.0 - (r * a).powi(2));
    Vec3::from(left.map(|a| of(a) as f32))
}

#[test]
fn a_dielectric_absorbs_along_the_way_inside() {
    let text = format!(
        "{BELOW}void dielectric d 0 0 5 .2 .5 .9 1.5 0\n{}",
        slab("d", 1.0, 1.7)
    );
    let wanted = through(1.5, [0.2, 0.5, 0.9].map(|t: f64| t.powf(0.7)));
    close(look(&text, EYE, Vec3::ZERO), wanted);
}

#[test]
fn an_interface_of_equal_indices_is_a_change_of_colour() {
    // A slab within a slab of the same index: two ways outside it and one inside.
    let text = format!(
        "{BELOW}void dielectric d 0 0 5 .2 .5 .9 1.5 0\n{}\
         void interface i 0 0 8 .5 .5 .1 1.5 .2 .5 .9 1.5\n{}",
        slab("d", 0.5, 2.0),
        slab("i", 1.0, 1.25)
    );
    let left = [
        0.2_f64.powf(1.25) * 0.5_f64.powf(0.25),
        0.5_f64.powf(1.5),
        0.9_f64.powf(1.25) * 0.1_f64.powf(0.25),
    ];
    close(look(&text, EYE, Vec3::ZERO), through(1.5, left));
    let e = load("void interface i 0 0 4 1 1 1 1.5\ni sphere s 0 0 4 0 0 0 1")
        .err()
        .unwrap();
    assert!(e.contains("line 1: real arguments: found 4, allowed 8"), "{e}");
}

#[test]
fn the_sun_shines_straight_through_a_body_of_index_one_and_is_absorbed() {
    // Three ways to find it: through the body, beside it, and by chance.
    let sun = "void light l 0 0 3 5000 5000 5000\nl source sun 0 0 4 0 0 1 2\n";
    let open = look(&format!("{FLOOR}{sun}"), EYE, Vec3::ZERO).0;
    let text = format!(
        "{FLOOR}{sun}void dielectric d 0 0 5 .2 .5 .9 1 0\n{}",
        slab("d", 4.0, 5.0)
    );
    close(look(&text, EYE, Vec3::ZERO), open * Vec3::new(0.2, 0.5, 0.9));
}

#[test]
fn radiance_under_water_is_greater_by_the_squared_index() {
    // Seen from within a body, an even sky has n2 times its radiance, but for what is reflected.
    let text = "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n\
                void dielectric d 0 0 5 1 1 1 1.33 0\nd sphere s 0 0 4 0 0 0 1\n";
    close(look(text, Vec3::ZERO, Vec3::Z), Vec3::splat(1.33 * 1.33));
    close(look(text, EYE, Vec3::ZERO), Vec3::ONE);
}

#[test]
fn a_spotlight_falls_off_from_its_focus() {
    // The length of its direction lies behind it.
    for focus in [0.5_f32, 2.0] {
        let text = format!(
            "{FLOOR}void spotlight s 0 0 7 8 8 8 120 0 0 -{focus}\ns ring r 0 0 8 0 0 4 0 0 -1 0 .05\n"
        );
        let wanted = 0.5 * 8.0 * 0.05_f32.powi(2) / (4.0 + focus).powi(2);
        close(look(&text, EYE, Vec3::ZERO), Vec3::splat(wanted));
    }
}

#[test]
fn boundaries_are_read_with_their_extinction() {
    let read = parts("void interface i 0 0 8 .5 1 0 1.5 .25 1 1 1.25\ni sphere s 0 0 4 0 0 0 1");
    let body = read.bodies[read.surfaces[0].body.unwrap() as usize];
    let two = std::f32::consts::LN_2;
    assert_eq!(body.inside, Vec3::new(two, 0.0, 100.0));
    assert_eq!(body.outside, Some(Vec3::new(2.0 * two, 0.0, 0.0)));
    assert_eq!(body.index, 1.2);
}
