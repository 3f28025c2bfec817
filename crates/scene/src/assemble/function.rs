//! Materials whose gloss is a function of the direction to the light, or data [Radiance, rt/m_brdf.c].

use std::f32::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::Vec3;
use gonio_trace::function::{Scattering, Sight};
use gonio_trace::material::Material;

use super::body::colour;
use super::field::{self, Seat};
use super::grid::Grid;
use crate::cal::{Expression, Point, Program};
use crate::error::{Place, SceneError};
use crate::text::Files;

pub(super) const TYPES: [&str; 7] = [
    "plasfunc",
    "metfunc",
    "transfunc",
    "BRTDfunc",
    "plasdata",
    "metdata",
    "transdata",
];

/// Values beyond this are none that a scene has.
const LARGEST: f64 = 1e18;

/// Numbers of a material: diffuse parts and what the functions count.
struct Parts {
    /// Diffuse reflectance of the front and of the back, diffuse transmittance; patterns colour them.
    diffuse: [Vec3; 3],
    /// What the function counts in reflection and in transmission.
    gloss: [f32; 2],
    /// Whether it takes the colour there.
    coloured: [bool; 2],
    /// Whether there is anything.
    there: [bool; 2],
    /// The colour of the material.
    colour: Vec3,
    /// Whether the surface turns its front to the eye.
    turns: bool,
}

/// None, one grey or three values.
struct Values(Vec<Expression>);

impl Values {
    fn at(&self, point: &Point, arguments: &[f64]) -> Vec3 {
        let value = |e: &Expression| e.evaluate(point, arguments).unwrap_or(0.0).clamp(0.0, LARGEST) as f32;
        match &self.0[..] {
            [r, g, b] => Vec3::new(value(r), value(g), value(b)),
            [grey] => Vec3::splat(value(grey)),
            _ => Vec3::ZERO,
        }
    }

    /// Of formulas, once where they are the same, not at all where they are 0.
    fn of<'t>(
        texts: [&'t str; 3],
        make: impl Fn(&'t str) -> Result<Expression, SceneError>,
    ) -> Result<Self, SceneError> {
        let [first, others @ ..] = texts;
        let count = match others == [first; 2] {
            true if first.parse::<f64>() == Ok(0.0) => 0,
            true => 1,
            false => 3,
        };
        let each = texts.into_iter().take(count).map(make);
        Ok(Values(each.collect::<Result<_, _>>()?))
    }
}

/// A grid, and where in it a direction lies.
struct Data {
    grid: Grid,
    coordinates: Vec<Expression>,
}

struct Functions {
    parts: Parts,
    gloss: Values,
    data: Option<Data>,
    mirrored: Values,
    straight: Values,
    reals: Vec<f64>,
    seat: Seat,
}

impl Functions {
    fn point(&self, sight: &Sight) -> Point {
        let turned = match self.parts.turns && sight.normal.dot(sight.to_eye) < 0.0 {
            true => -sight.normal,
            false => sight.normal,
        };
        // As in RADIANCE, the normal of textures is always that of the side that is seen.
        let shown = sight.side() * sight.shown;
        Point {
            perturbed_normal: self.seat.vector(shown),
            perturbed_rdot: f64::from(shown.dot(sight.to_eye)).clamp(-1.0, 1.0),
            colour: (self.parts.colour * sight.colour).as_dvec3().to_array(),
            ..self.seat.point(sight.point, turned, -sight.to_eye)
        }
    }
}

impl Scattering for Functions {
    fn eval(&self, sight: &Sight, from: Vec3) -> Vec3 {
        let parts = &self.parts;
        let cos = sight.side() * sight.shown.dot(from);
        let through = usize::from(cos < 0.0);
        if cos == 0.0 || !parts.there[through] {
            return Vec3::ZERO;
        }
        let part = match (through, sight.normal.dot(sight.to_eye) < 0.0) {
            (1, _) => 2,
            (_, back) => usize::from(back),
        };
        let diffuse = FRAC_1_PI * parts.diffuse[part] * sight.colour;
        if self.gloss.0.is_empty() || parts.gloss[through] == 0.0 {
            return diffuse;
        }
        let point = Point {
            target: self.seat.vector(from),
            ..self.point(sight)
        };
        let gloss = match &self.data {
            None => self.gloss.at(&point, &self.reals),
            Some(data) => {
                let mut arguments = self.reals.clone();
                arguments.push(0.0);
                let each = data.coordinates.iter();
                let place: Vec<f64> = each
                    .map(|e| e.evaluate(&point, &arguments).unwrap_or(0.0))
                    .collect();
                arguments[self.reals.len()] = data.grid.value(&place);
                self.gloss.at(&point, &arguments)
            }
        };
        let tint = match parts.coloured[through] {
            true => parts.colour * sight.colour,
            false => Vec3::ONE,
        };
        diffuse + parts.gloss[through] * tint * gloss
    }

    fn mirrored(&self, sight: &Sight) -> Vec3 {
        match self.mirrored.0.is_empty() {
            true => Vec3::ZERO,
            false => self.mirrored.at(&self.point(sight), &self.reals),
        }
    }

    fn straight(&self, sight: &Sight) -> Vec3 {
        match self.is_clear() {
            true => self.straight.at(&self.point(sight), &self.reals),
            false => Vec3::ZERO,
        }
    }

    fn is_clear(&self) -> bool {
        !self.straight.0.is_empty()
    }

    fn reflected(&self, sight: &Sight) -> f32 {
        /// Least chance of a side that has anything.
        const LEAST: f32 = 0.1;
        match self.parts.there {
            [_, false] => return 1.0,
            [false, true] => return 0.0,
            _ => {}
        }
        let [front, back, through] = self.parts.diffuse.map(Vec3::element_sum);
        let seen = if sight.normal.dot(sight.to_eye) < 0.0 {
            back
        } else {
            front
        };
        let [mirror, pass] = match self.gloss.0.is_empty() {
            true => [0.0; 2],
            false => self.parts.gloss,
        };
        let (r, t) = (seen + mirror, through + pass);
        match (r > 0.0, t > 0.0) {
            (_, false) => 1.0,
            (false, true) => 0.0,
            _ => (r / (r + t)).clamp(LEAST, 1.0 - LEAST),
        }
    }
}

/// The material of these arguments.
pub(super) fn material(
    type_word: &str,
    strings: &[String],
    reals: &[f64],
    place: &Place,
    files: &Files,
) -> Result<Material, SceneError> {
    let usage = match type_word {
        "BRTDfunc" => "rrefl grefl brefl rtrns gtrns btrns rbrtd gbrtd bbrtd function-file transform…",
        word if word.ends_with("data") => {
            "function data-file function-file, a coordinate for each dimension, transform…"
        }
        _ => "function function-file transform…",
    };
    let few = || place.fault("string arguments", strings.len().to_string(), usage);
    let parts = parts(type_word, reals, place)?;
    let call =
        |program: &Program, text: String| program.expression(&text).map_err(|e| field::fault(e, place));
    // The size of the source, which functions may ask for, is that of a point.
    const LIGHT: &str = "DxA,DyA,DzA,0";
    let (mut mirrored, mut straight) = (Values(Vec::new()), Values(Vec::new()));
    let (gloss, data, transform) = match type_word {
        "BRTDfunc" => {
            let (words, rest) = strings.split_first_chunk::<9>().ok_or_else(few)?;
            let (file, transform) = rest.split_first().ok_or_else(few)?;
            let program = field::program(file, place, files)?;
            let three = |k: usize| [0, 1, 2].map(|j| words[k + j].as_str());
            mirrored = Values::of(three(0), |t| call(&program, t.into()))?;
            straight = Values::of(three(3), |t| call(&program, t.into()))?;
            // A name cannot begin with a digit: 0 stands for no function.
            let named = three(6).map(|t| if t.starts_with('0') { "0" } else { t });
            let gloss = Values::of(named, |t| match t {
                "0" => call(&program, "0".into()),
                name => call(&program, format!("{name}({LIGHT})")),
            })?;
            (gloss, None, transform)
        }
        word if word.ends_with("data") => {
            let [function, table, file, rest @ ..] = strings else {
                return Err(few());
            };
            let grid = Grid::read(&files.find(table, place)?)?;
            let (places, transform) = rest.split_at_checked(grid.dimensions()).ok_or_else(few)?;
            let program = field::program(file, place, files)?;
            let each = places.iter().map(|t| call(&program, format!("{t}({LIGHT})")));
            let coordinates = each.collect::<Result<Vec<_>, _>>()?;
            field::check(&coordinates, reals, place)?;
            let gloss = call(&program, format!("{function}(arg({}),{LIGHT})", reals.len() + 1))?;
            (Values(vec![gloss]), Some(Data { grid, coordinates }), transform)
        }
        _ => {
            let [function, file, transform @ ..] = strings else {
                return Err(few());
            };
            let program = field::program(file, place, files)?;
            (
                Values(vec![call(&program, format!("{function}({LIGHT})"))?]),
                None,
                transform,
            )
        }
    };
    let mut arguments = reals.to_vec();
    if data.is_some() {
        arguments.push(0.0);
    }
    field::check(&gloss.0, &arguments, place)?;
    field::check(&mirrored.0, reals, place)?;
    field::check(&straight.0, reals, place)?;
    Ok(Material::Function(Arc::new(Functions {
        parts,
        gloss,
        data,
        mirrored,
        straight,
        reals: reals.to_vec(),
        seat: Seat::of(transform, place)?,
    })))
}

fn parts(type_word: &str, reals: &[f64], place: &Place) -> Result<Parts, SceneError> {
    let (count, allowed) = match type_word {
        "BRTDfunc" => (
            9,
            "9 or more: diffuse reflectance of front and back, diffuse transmittance, each red green blue",
        ),
        "transfunc" | "transdata" => (6, "6 or more: red green blue specularity transmissivity tspec"),
        _ => (4, "4 or more: red green blue specularity"),
    };
    if reals.len() < count {
        return Err(place.fault("real arguments", reals.len().to_string(), allowed));
    }
    if let Some(k) = reals[..count].iter().position(|r| !(0.0..=1.0).contains(r)) {
        return Err(place.fault(format!("real argument {}", k + 1), reals[k].to_string(), "0 to 1"));
    }
    let rgb = |k: usize| colour([reals[k], reals[k + 1], reals[k + 2]]);
    if type_word == "BRTDfunc" {
        return Ok(Parts {
            diffuse: [rgb(0), rgb(3), rgb(6)],
            gloss: [1.0; 2],
            coloured: [false; 2],
            there: [true; 2],
            colour: Vec3::ONE,
            turns: false,
        });
    }
    let specular = reals[3] as f32;
    let [trans, straight] = match count {
        6 => {
            let trans = reals[4] as f32 * (1.0 - specular);
            [trans, trans * reals[5] as f32]
        }
        _ => [0.0; 2],
    };
    let body = (1.0 - trans - specular).max(0.0) * rgb(0);
    Ok(Parts {
        diffuse: [body, body, (trans - straight).max(0.0) * rgb(0)],
        gloss: [specular, straight],
        coloured: [type_word.starts_with("met"), true],
        there: [trans < 1.0 - 1e-6, trans > 1e-6],
        colour: rgb(0),
        turns: true,
    })
}
