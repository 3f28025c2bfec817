//! Patterns: functions of place and direction [Radiance, rt/p_func.c, rt/p_data.c, rt/func.c].

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use gonio_io::radiance_material::Body;
use gonio_io::read_bytes;
use gonio_trace::pattern::Pattern;

use super::grid::Grid;
use super::modifier::{Modifier, type_word};
use crate::cal::{self, CalError, Expression, Point, Program};
use crate::error::{Place, SceneError};
use crate::text::{Files, Xform};

/// Where a function lies in the world.
#[derive(Clone, Copy)]
struct Seat {
    inverse: DAffine3,
    scale: f64,
}

impl Seat {
    fn of(transform: &[String], place: &Place) -> Result<Self, SceneError> {
        let (xform, used) = Xform::parse(transform).map_err(|(f, a)| place.fault("transform", f, a))?;
        if let Some(word) = transform.get(used) {
            return Err(place.fault("transform", format!("{word:?}"), "options of xform"));
        }
        Ok(Seat {
            inverse: xform.matrix.inverse(),
            scale: xform.scale.abs(),
        })
    }

    fn point(&self, point: Vec3, normal: Vec3, direction: Vec3) -> Point {
        let turned = |v: DVec3| (self.inverse.transform_vector3(v) * self.scale).to_array();
        let normal_here = turned(normal.as_dvec3());
        let rdot = -f64::from(normal.dot(direction));
        Point {
            direction: turned(direction.as_dvec3()),
            normal: normal_here,
            position: self.inverse.transform_point3(point.as_dvec3()).to_array(),
            rdot,
            scale: 1.0 / self.scale,
            origin: self.inverse.transform_point3(DVec3::ZERO).to_array(),
            axes: [DVec3::X, DVec3::Y, DVec3::Z].map(turned),
            perturbed_normal: normal_here,
            perturbed_rdot: rdot,
            ..Point::default()
        }
    }
}

/// `brightfunc` and `colorfunc`.
struct Function {
    values: Vec<Expression>,
    reals: Vec<f64>,
    seat: Seat,
}

impl Pattern for Function {
    fn multiplier(&self, point: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
        let at = self.seat.point(point, normal, direction);
        spread(
            self.values
                .iter()
                .map(|e| e.evaluate(&at, &self.reals).unwrap_or(0.0)),
        )
    }
}

/// `brightdata` and `colordata`.
struct Data {
    grids: Vec<Arc<Grid>>,
    coordinates: Vec<Expression>,
    /// Of the interpolated value, which follows the real arguments as one more.
    functions: Vec<Expression>,
    reals: Vec<f64>,
    seat: Seat,
}

impl Pattern for Data {
    fn multiplier(&self, point: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
        let at = self.seat.point(point, normal, direction);
        let mut arguments = self.reals.clone();
        let place: Vec<f64> = self
            .coordinates
            .iter()
            .map(|e| e.evaluate(&at, &arguments).unwrap_or(0.0))
            .collect();
        // Of three functions each gets the values of all grids.
        arguments.extend(self.grids.iter().map(|g| g.value(&place)));
        spread(
            self.functions
                .iter()
                .map(|e| e.evaluate(&at, &arguments).unwrap_or(0.0)),
        )
    }
}

/// One value as grey or three as a colour, without negative ones.
fn spread(values: impl Iterator<Item = f64>) -> Vec3 {
    let mut out = [0.0_f32; 3];
    let mut n = 0;
    for (slot, v) in out.iter_mut().zip(values) {
        *slot = v.max(0.0) as f32;
        n += 1;
    }
    if n == 1 {
        Vec3::splat(out[0])
    } else {
        Vec3::from(out)
    }
}

/// The pattern of a modifier.
pub(super) fn pattern(modifier: &Modifier, files: &Files) -> Result<Arc<dyn Pattern>, SceneError> {
    let place = &modifier.place;
    let word = type_word(&modifier.body);
    let Body::Other { strings, reals, .. } = &*modifier.body else {
        return Err(place.fault("type", word, "a pattern"));
    };
    match word {
        "brightfunc" => function(strings, reals, 1, place, files),
        "colorfunc" => function(strings, reals, 3, place, files),
        "brightdata" => data(strings, reals, 1, place, files),
        "colordata" => data(strings, reals, 3, place, files),
        _ => Err(place.fault(
            "type",
            word,
            "brightfunc, colorfunc, brightdata, colordata: pictures and text as patterns are not rendered, and without \
             them the scene would look otherwise",
        )),
    }
}

fn function(
    strings: &[String],
    reals: &[f64],
    channels: usize,
    place: &Place,
    files: &Files,
) -> Result<Arc<dyn Pattern>, SceneError> {
    let few = || {
        let found = strings.len().to_string();
        place.fault(
            "string arguments",
            found,
            format!("{channels} values, a function file, a transform"),
        )
    };
    let (values, rest) = strings.split_at_checked(channels).ok_or_else(few)?;
    let (file, transform) = rest.split_first().ok_or_else(few)?;
    let program = program(file, place, files)?;
    let values = expressions(&program, values, place)?;
    check(&values, reals, place)?;
    Ok(Arc::new(Function {
        values,
        reals: reals.to_vec(),
        seat: Seat::of(transform, place)?,
    }))
}

fn data(
    strings: &[String],
    reals: &[f64],
    channels: usize,
    place: &Place,
    files: &Files,
) -> Result<Arc<dyn Pattern>, SceneError> {
    let few = || {
        place.fault(
            "string arguments",
            strings.len().to_string(),
            format!("{channels} functions, {channels} data files, a function file, a coordinate for each dimension, a transform"),
        )
    };
    let (functions, rest) = strings.split_at_checked(channels).ok_or_else(few)?;
    let (names, rest) = rest.split_at_checked(channels).ok_or_else(few)?;
    let (file, rest) = rest.split_first().ok_or_else(few)?;
    let grids = names
        .iter()
        .map(|name| Ok(Arc::new(Grid::read(&files.find(name, place)?)?)))
        .collect::<Result<Vec<_>, SceneError>>()?;
    let dimensions = grids[0].dimensions();
    if let Some(k) = grids.iter().position(|g| g.dimensions() != dimensions) {
        return Err(place.fault(
            "data file",
            format!("{:?} of {} dimensions", names[k], grids[k].dimensions()),
            format!("{dimensions}, as the first"),
        ));
    }
    let (coordinates, transform) = rest.split_at_checked(dimensions).ok_or_else(few)?;
    let program = program(file, place, files)?;
    let coordinates = expressions(&program, coordinates, place)?;
    check(&coordinates, reals, place)?;
    // A function of one value takes that of its grid, one of three takes all [Radiance, rt/p_data.c].
    let first = reals.len() + 1;
    let mut made = Vec::with_capacity(channels);
    for (k, name) in functions.iter().enumerate() {
        let one = format!("{name}(arg({}))", first + k);
        let all = format!("{name}(arg({first}),arg({}),arg({}))", first + 1, first + 2);
        let tried = match channels {
            1 => program.expression(&one),
            _ => program.expression(&all).or_else(|_| program.expression(&one)),
        };
        made.push(tried.map_err(|e| fault(e, place))?);
    }
    let mut arguments = reals.to_vec();
    arguments.extend(std::iter::repeat_n(0.0, channels));
    check(&made, &arguments, place)?;
    Ok(Arc::new(Data {
        grids,
        coordinates,
        functions: made,
        reals: reals.to_vec(),
        seat: Seat::of(transform, place)?,
    }))
}

/// The function file of this name: that of the scene, or one that comes with gonio; `.` is none.
fn program(name: &str, place: &Place, files: &Files) -> Result<Program, SceneError> {
    if name == "." {
        return Program::parse("", ".").map_err(|e| fault(e, place));
    }
    let text = match files.find(name, place) {
        Ok(path) => {
            let bytes = read_bytes(&path)?;
            String::from_utf8_lossy(&bytes).into_owned()
        }
        Err(missing) => cal::shipped(name).ok_or(missing)?.to_owned(),
    };
    Program::parse(&text, name).map_err(|e| fault(e, place))
}

fn expressions(program: &Program, texts: &[String], place: &Place) -> Result<Vec<Expression>, SceneError> {
    let each = texts
        .iter()
        .map(|t| program.expression(t).map_err(|e| fault(e, place)));
    each.collect()
}

/// That a value exists somewhere: too few real arguments show at once.
fn check(all: &[Expression], reals: &[f64], place: &Place) -> Result<(), SceneError> {
    for e in all {
        e.evaluate(&Point::default(), reals)
            .map_err(|e| fault(e, place))?;
    }
    Ok(())
}

fn fault(error: CalError, place: &Place) -> SceneError {
    place.fault("function", error.to_string(), "a function that can be evaluated")
}
