//! Views as RADIANCE writes them: `-vtv -vp 0 0 1 -vd 0 1 0 …`.

use std::fmt;
use std::str::FromStr;

use glam::Vec3;

use crate::camera::{Projection, View, ViewError};

const TYPES: [(char, Projection); 6] = [
    ('v', Projection::Perspective),
    ('l', Projection::Parallel),
    ('h', Projection::Hemispherical),
    ('a', Projection::Angular),
    ('s', Projection::Planisphere),
    ('c', Projection::Cylindrical),
];

const OPTIONS: &str = "-vtv, -vtl, -vth, -vta, -vts, -vtc, -vp, -vd, -vu, -vh, -vv, -vo, -vs, -vl";

impl Default for View {
    /// That of RADIANCE: perspective from the origin to the north, 45 degrees.
    fn default() -> Self {
        View {
            projection: Projection::Perspective,
            point: Vec3::ZERO,
            direction: Vec3::Y,
            up: Vec3::Z,
            horizontal: 45.0,
            vertical: 45.0,
            shift: [0.0; 2],
            fore: 0.0,
        }
    }
}

impl FromStr for View {
    type Err = ViewError;

    /// Options of a command line, or the text of a view file: of its last line with a view counts what follows the name of
    /// the program or `VIEW=`. What is not given is as in [`View::default`].
    fn from_str(text: &str) -> Result<Self, ViewError> {
        let line = text.lines().rev().find(|l| l.contains("-v")).ok_or(ViewError {
            field: "file or options",
            found: "no option that begins with -v".into(),
            allowed: OPTIONS,
        })?;
        let mut words = line.split_whitespace();
        let mut view = View::default();
        let mut begun = false;
        while let Some(word) = words.next() {
            let word = word.strip_prefix("VIEW=").unwrap_or(word);
            if word.is_empty() || !begun && !word.starts_with('-') {
                continue; // the name of a program
            }
            begun = true;
            match word {
                "-vp" => view.point = vector("-vp", &mut words)?,
                "-vd" => view.direction = vector("-vd", &mut words)?,
                "-vu" => view.up = vector("-vu", &mut words)?,
                "-vh" => view.horizontal = number("-vh", words.next())?,
                "-vv" => view.vertical = number("-vv", words.next())?,
                "-vo" => view.fore = number("-vo", words.next())?,
                "-vs" => view.shift[0] = number("-vs", words.next())?,
                "-vl" => view.shift[1] = number("-vl", words.next())?,
                "-va" => {
                    let aft = number("-va", words.next())?;
                    if aft != 0.0 {
                        return Err(ViewError {
                            field: "-va",
                            found: aft.to_string(),
                            allowed: "0: no aft clipping plane",
                        });
                    }
                }
                _ => view.projection = projection(word)?,
            }
        }
        Ok(view)
    }
}

fn projection(word: &str) -> Result<Projection, ViewError> {
    let mut letters = word.strip_prefix("-vt").unwrap_or_default().chars();
    match (letters.next(), letters.next()) {
        (Some(letter), None) => TYPES.iter().find(|t| t.0 == letter).map(|t| t.1),
        _ => None,
    }
    .ok_or_else(|| ViewError {
        field: "option",
        found: word.to_owned(),
        allowed: OPTIONS,
    })
}

fn number(option: &'static str, word: Option<&str>) -> Result<f32, ViewError> {
    word.and_then(|w| w.parse().ok())
        .filter(|x: &f32| x.is_finite())
        .ok_or_else(|| ViewError {
            field: option,
            found: word.unwrap_or("the end").to_owned(),
            allowed: "a number",
        })
}

fn vector<'a>(option: &'static str, words: &mut impl Iterator<Item = &'a str>) -> Result<Vec3, ViewError> {
    Ok(Vec3::new(
        number(option, words.next())?,
        number(option, words.next())?,
        number(option, words.next())?,
    ))
}

impl fmt::Display for View {
    /// The options, all of them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let letter = TYPES.iter().find(|t| t.1 == self.projection).map_or('v', |t| t.0);
        let (p, d, u) = (self.point, self.direction, self.up);
        write!(
            f,
            "-vt{letter} -vp {} {} {} -vd {} {} {} -vu {} {} {} -vh {} -vv {} -vo {} -va 0 -vs {} -vl {}",
            p.x,
            p.y,
            p.z,
            d.x,
            d.y,
            d.z,
            u.x,
            u.y,
            u.z,
            self.horizontal,
            self.vertical,
            self.fore,
            self.shift[0],
            self.shift[1]
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_file_and_what_is_written_of_it_are_the_same_view() {
        let text = "rvu -vtv -vp 1 2 3\nVIEW= -vth -vp 1 -2.5 1e1 -vd 0 0 -1 -vu 0 1 0 -vh 180 -vv 180 -vo 0.5 -va 0 -vs .25 -vl 0\n";
        let view: View = text.parse().unwrap();
        assert_eq!(view.projection, Projection::Hemispherical);
        assert_eq!(view.point, Vec3::new(1.0, -2.5, 10.0));
        assert_eq!((view.fore, view.shift), (0.5, [0.25, 0.0]));
        assert_eq!(view.to_string().parse::<View>().unwrap(), view);
        let rvu: View = "rvu -vta -vp 1 2 3".parse().unwrap();
        assert_eq!(
            rvu,
            View {
                projection: Projection::Angular,
                point: Vec3::new(1.0, 2.0, 3.0),
                ..View::default()
            }
        );
    }

    #[test]
    fn unknown_and_unfinished_options_are_named() {
        for (text, name) in [
            ("-vtx", "-vtx"),
            ("-vt", "-vt"),
            ("-vtv -ab 2", "-ab"),
            ("-vp 1 2", "the end"),
            ("-vh wide", "wide"),
            ("-vd 0 nan 0", "nan"),
            ("-vtv -va 3", "-va"),
            ("", "no option"),
        ] {
            let message = text.parse::<View>().unwrap_err().to_string();
            assert!(message.contains(name), "{text}: {message}");
        }
    }
}
