//! Values of functions and data in the world: what patterns, textures and mixtures are made of [Radiance, rt/func.c,
//! rt/data.c].

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3, Vec3};
use gonio_io::read_bytes;

use super::grid::Grid;
use super::image::Image;
use crate::cal::{self, CalError, Expression, Point, Program};
use crate::error::{Place, SceneError};
use crate::text::{Files, Xform};

/// Where a function lies in the world.
#[derive(Clone, Copy)]
pub(super) struct Seat {
    inverse: DAffine3,
    forward: DMat3,
    scale: f64,
}

impl Seat {
    pub(super) fn of(transform: &[String], place: &Place) -> Result<Self, SceneError> {
        let (xform, used) = Xform::parse(transform).map_err(|(f, a)| place.fault("transform", f, a))?;
        if let Some(word) = transform.get(used) {
            return Err(place.fault("transform", format!("{word:?}"), "options of xform"));
        }
        let inverse = xform.matrix.inverse();
        if !inverse.is_finite() {
            return Err(place.fault("transform", transform.join(" "), "one that can be undone"));
        }
        Ok(Seat {
            inverse,
            forward: xform.matrix.matrix3,
            scale: xform.scale.abs(),
        })
    }

    /// A vector of the function in the world.
    pub(super) fn world(&self, v: DVec3) -> DVec3 {
        self.forward * v / self.scale
    }

    /// A unit vector of the world where the function is.
    pub(super) fn vector(&self, v: Vec3) -> [f64; 3] {
        self.turned(v.as_dvec3())
    }

    fn turned(&self, v: DVec3) -> [f64; 3] {
        (self.inverse.transform_vector3(v) * self.scale).to_array()
    }

    pub(super) fn point(&self, point: Vec3, normal: Vec3, direction: Vec3) -> Point {
        let turned = |v: DVec3| self.turned(v);
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

/// Values of a list of formulas.
pub(super) struct Function {
    values: Vec<Expression>,
    reals: Vec<f64>,
    pub(super) seat: Seat,
}

/// Functions of interpolated values.
pub(super) struct Data {
    source: Source,
    coordinates: Vec<Expression>,
    /// Of the interpolated values, which follow the real arguments as more of them.
    functions: Vec<Expression>,
    reals: Vec<f64>,
    pub(super) seat: Seat,
}

/// What is interpolated.
enum Source {
    /// A grid a value.
    Grids(Vec<Arc<Grid>>),
    /// Red, green and blue.
    Image(Arc<Image>),
}

/// One or the other.
pub(super) enum Field {
    Function(Function),
    Data(Data),
}

impl Field {
    /// Its values, three at most, at a point and for a ray; how many there are.
    pub(super) fn values(&self, point: Vec3, normal: Vec3, direction: Vec3) -> ([f64; 3], usize) {
        let mut out = [0.0; 3];
        let (functions, arguments, at) = match self {
            Field::Function(f) => {
                let at = f.seat.point(point, normal, direction);
                for (slot, e) in out.iter_mut().zip(&f.values) {
                    *slot = e.evaluate(&at, &f.reals).unwrap_or(0.0);
                }
                return (out, f.values.len());
            }
            Field::Data(d) => {
                let at = d.seat.point(point, normal, direction);
                let mut arguments = d.reals.clone();
                let each = d.coordinates.iter();
                let place: Vec<f64> = each.map(|e| e.evaluate(&at, &arguments).unwrap_or(0.0)).collect();
                // Of three functions each gets the values of all grids.
                match &d.source {
                    Source::Grids(grids) => arguments.extend(grids.iter().map(|g| g.value(&place))),
                    Source::Image(image) => arguments.extend(image.value(place[0], place[1])),
                }
                (&d.functions, arguments, at)
            }
        };
        for (slot, e) in out.iter_mut().zip(functions) {
            *slot = e.evaluate(&at, &arguments).unwrap_or(0.0);
        }
        (out, functions.len())
    }

    pub(super) fn seat(&self) -> &Seat {
        match self {
            Field::Function(f) => &f.seat,
            Field::Data(d) => &d.seat,
        }
    }

    /// Of `count` formulas, a function file and a transform.
    pub(super) fn function(
        strings: &[String],
        reals: &[f64],
        count: usize,
        place: &Place,
        files: &Files,
    ) -> Result<Self, SceneError> {
        let few = || {
            let found = strings.len().to_string();
            place.fault(
                "string arguments",
                found,
                format!("{count} values, a function file, a transform"),
            )
        };
        let (values, rest) = strings.split_at_checked(count).ok_or_else(few)?;
        let (file, transform) = rest.split_first().ok_or_else(few)?;
        let program = program(file, place, files)?;
        let values = expressions(&program, values, place)?;
        check(&values, reals, place)?;
        Ok(Field::Function(Function {
            values,
            reals: reals.to_vec(),
            seat: Seat::of(transform, place)?,
        }))
    }

    /// Of `count` functions, as many data files, a function file, a coordinate a dimension and a transform.
    pub(super) fn data(
        strings: &[String],
        reals: &[f64],
        count: usize,
        place: &Place,
        files: &Files,
    ) -> Result<Self, SceneError> {
        let few = || {
            place.fault(
                "string arguments",
                strings.len().to_string(),
                format!("{count} functions, {count} data files, a function file, a coordinate for each dimension, a transform"),
            )
        };
        let (functions, rest) = strings.split_at_checked(count).ok_or_else(few)?;
        let (names, rest) = rest.split_at_checked(count).ok_or_else(few)?;
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
        if rest.len() <= dimensions {
            return Err(few());
        }
        Field::interpolated(
            Source::Grids(grids),
            functions,
            rest,
            dimensions,
            reals,
            place,
            files,
        )
    }

    /// Of `count` functions, a picture, a function file, two coordinates and a transform.
    pub(super) fn picture(
        strings: &[String],
        reals: &[f64],
        count: usize,
        place: &Place,
        files: &Files,
    ) -> Result<Self, SceneError> {
        if strings.len() < count + 4 {
            let allowed =
                format!("{count} functions, a picture, a function file, two coordinates, a transform");
            return Err(place.fault("string arguments", strings.len().to_string(), allowed));
        }
        let (functions, rest) = strings.split_at(count);
        let image = Arc::new(Image::read(&files.find(&rest[0], place)?)?);
        Field::interpolated(
            Source::Image(image),
            functions,
            &rest[1..],
            2,
            reals,
            place,
            files,
        )
    }

    /// `rest` begins with the function file and the coordinates.
    fn interpolated(
        source: Source,
        functions: &[String],
        rest: &[String],
        dimensions: usize,
        reals: &[f64],
        place: &Place,
        files: &Files,
    ) -> Result<Self, SceneError> {
        let (coordinates, transform) = rest[1..].split_at(dimensions);
        let program = program(&rest[0], place, files)?;
        let coordinates = expressions(&program, coordinates, place)?;
        check(&coordinates, reals, place)?;
        // A function of one value takes that of its grid, one of three takes all [Radiance, rt/p_data.c].
        let count = match &source {
            Source::Grids(grids) => grids.len(),
            Source::Image(_) => 3,
        };
        let first = reals.len() + 1;
        let mut made = Vec::with_capacity(functions.len());
        for (k, name) in functions.iter().enumerate() {
            let one = format!("{name}(arg({}))", first + k);
            let all = format!("{name}(arg({first}),arg({}),arg({}))", first + 1, first + 2);
            let tried = match count {
                1 => program.expression(&one),
                _ => program.expression(&all).or_else(|_| program.expression(&one)),
            };
            made.push(tried.map_err(|e| fault(e, place))?);
        }
        let mut arguments = reals.to_vec();
        arguments.extend(std::iter::repeat_n(0.0, count));
        check(&made, &arguments, place)?;
        Ok(Field::Data(Data {
            source,
            coordinates,
            functions: made,
            reals: reals.to_vec(),
            seat: Seat::of(transform, place)?,
        }))
    }
}

/// The function file of this name: that of the scene, or one that comes with gonio; `.` is none.
pub(super) fn program(name: &str, place: &Place, files: &Files) -> Result<Program, SceneError> {
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
pub(super) fn check(all: &[Expression], reals: &[f64], place: &Place) -> Result<(), SceneError> {
    for e in all {
        e.evaluate(&Point::default(), reals)
            .map_err(|e| fault(e, place))?;
    }
    Ok(())
}

pub(super) fn fault(error: CalError, place: &Place) -> SceneError {
    place.fault("function", error.to_string(), "a function that can be evaluated")
}
