//! Views as RADIANCE writes them: `.vf` files and `-v…` options [Radiance, common/image.c].

use std::path::Path;

use glam::Vec3;
use gonio_io::{IoError, excerpt, read_bytes};
use gonio_trace::camera::{Camera, Projection, View};

use crate::error::SceneError;

/// The view that RADIANCE starts from: perspective, from the origin along y, 45 degrees square.
pub const STANDARD: View = View {
    projection: Projection::Perspective,
    point: Vec3::ZERO,
    direction: Vec3::Y,
    up: Vec3::Z,
    horizontal: 45.0,
    vertical: 45.0,
    shift: [0.0; 2],
    fore: 0.0,
    aft: 0.0,
};

/// Programs whose command lines are views in files.
const PROGRAMS: [&str; 6] = ["VIEW=", "rpict", "rview", "rvu", "rpiece", "pinterp"];

/// The view of a `.vf` file or of the header of a picture: all lines that begin with `VIEW=` or a rendering program, one
/// after the other; what is no view option is passed over.
///
/// # Errors
/// [`SceneError`] naming file and line: no view, an option without its numbers, a view that shows nothing.
pub fn read(path: &Path) -> Result<View, SceneError> {
    let bytes = read_bytes(path)?;
    let mut view = STANDARD;
    let mut last = None;
    for (k, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let Ok(line) = std::str::from_utf8(line) else {
            break;
        };
        let line = line.trim();
        // The end of a picture's header.
        if line.is_empty() && bytes.starts_with(b"#?") {
            break;
        }
        let name = line.split_whitespace().next().unwrap_or("");
        let name = name.rsplit(['/', '\\']).next().unwrap_or("");
        if !PROGRAMS.iter().any(|p| name.starts_with(p)) {
            continue;
        }
        let number = k as u64 + 1;
        let rest = line.strip_prefix("VIEW=").unwrap_or(line);
        let words: Vec<&str> = rest.split_whitespace().collect();
        options(&mut view, &words, false)
            .map_err(|(field, found, allowed)| IoError::format(path, number, field, found, allowed))?;
        last = Some(number);
    }
    let Some(number) = last else {
        let start = excerpt(&bytes);
        let allowed =
            "a line that begins with VIEW= or rvu, such as: rvu -vtv -vp 0 0 1 -vd 0 1 0 -vh 60 -vv 40";
        return Err(IoError::format(path, 1, "view", start, allowed).into());
    };
    Camera::new(view).map_err(|e| IoError::format(path, number, e.field, e.found, e.allowed))?;
    Ok(view)
}

/// The view of options alone, such as `-vtv -vp 0 0 1 -vd 0 1 0 -vh 60 -vv 40`, on top of `base`; `-vf file` takes the view
/// of a file in between.
///
/// # Errors
/// [`SceneError`] for a word that is no view option, an option without its numbers, a view that shows nothing.
pub fn parse(base: View, words: &[&str]) -> Result<View, SceneError> {
    let mut view = base;
    let mut rest = words;
    let wrong =
        |(field, found, allowed): Wrong| IoError::format(Path::new("view"), None, field, found, allowed);
    while let Some(k) = rest.iter().position(|w| *w == "-vf") {
        options(&mut view, &rest[..k], true).map_err(wrong)?;
        let Some(file) = rest.get(k + 1) else {
            return Err(wrong(("-vf".into(), "the end".into(), "a file".into())).into());
        };
        view = read(Path::new(file))?;
        rest = &rest[k + 2..];
    }
    options(&mut view, rest, true).map_err(wrong)?;
    Camera::new(view)?;
    Ok(view)
}

/// Field, what was found, what is allowed.
type Wrong = (String, String, String);

fn options(view: &mut View, words: &[&str], strict: bool) -> Result<(), Wrong> {
    let mut at = 0;
    while let Some(option) = words.get(at) {
        at += 1;
        let number = |k: usize| -> Result<f32, Wrong> {
            let word = words.get(at + k).copied().unwrap_or("");
            let value = word.parse::<f32>().ok().filter(|v| v.is_finite());
            let found = if word.is_empty() {
                "the end".into()
            } else {
                format!("{word:?}")
            };
            value.ok_or_else(|| ((*option).into(), found, "finite numbers".into()))
        };
        let vector = || -> Result<Vec3, Wrong> { Ok(Vec3::new(number(0)?, number(1)?, number(2)?)) };
        at += match *option {
            "-vp" => {
                view.point = vector()?;
                3
            }
            "-vd" => {
                view.direction = vector()?;
                3
            }
            "-vu" => {
                view.up = vector()?;
                3
            }
            "-vh" => {
                view.horizontal = number(0)?;
                1
            }
            "-vv" => {
                view.vertical = number(0)?;
                1
            }
            "-vs" => {
                view.shift[0] = number(0)?;
                1
            }
            "-vl" => {
                view.shift[1] = number(0)?;
                1
            }
            "-vo" => {
                view.fore = number(0)?;
                if view.fore < 0.0 {
                    return Err((
                        option.to_string(),
                        view.fore.to_string(),
                        "a distance of at least 0".into(),
                    ));
                }
                1
            }
            "-va" => {
                view.aft = number(0)?;
                1
            }
            _ => {
                if let Some(letter) = option.strip_prefix("-vt") {
                    view.projection = projection(letter)
                        .ok_or_else(|| ("-vt".into(), format!("{letter:?}"), "one of v l h a s c".into()))?;
                } else if strict {
                    return Err((
                        "view".into(),
                        format!("{option:?}"),
                        "-vt -vp -vd -vu -vh -vv -vs -vl -vo -va -vf".into(),
                    ));
                }
                0
            }
        };
    }
    Ok(())
}

fn projection(letter: &str) -> Option<Projection> {
    Some(match letter {
        "v" => Projection::Perspective,
        "l" => Projection::Parallel,
        "h" => Projection::Hemispherical,
        "a" => Projection::Angular,
        "s" => Projection::Planisphere,
        "c" => Projection::Cylindrical,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<View, SceneError> {
        parse(STANDARD, &text.split_whitespace().collect::<Vec<_>>())
    }

    #[test]
    fn options_set_every_part_of_a_view() {
        let v =
            of("-vta -vp 1 2 3 -vd 0 0 -1 -vu 0 1 0 -vh 180 -vv 170 -vs .5 -vl -.25 -vo 2 -va 7").unwrap();
        assert_eq!(v.projection, Projection::Angular);
        assert_eq!(
            (v.point, v.direction, v.up),
            (Vec3::new(1., 2., 3.), -Vec3::Z, Vec3::Y)
        );
        assert_eq!(
            (v.horizontal, v.vertical, v.shift, v.fore, v.aft),
            (180.0, 170.0, [0.5, -0.25], 2.0, 7.0)
        );
    }

    #[test]
    fn a_file_gives_its_view_past_other_lines_and_other_options() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("a.vf");
        std::fs::write(
            &file,
            "# eye\nrpict -x 512 -vtv -vp 0 -1 .5 -ab 2 -vh 60 -vv 40\nVIEW= -vl .5\n",
        )
        .unwrap();
        let v = read(&file).unwrap();
        assert_eq!(
            (v.point, v.horizontal, v.shift[1]),
            (Vec3::new(0.0, -1.0, 0.5), 60.0, 0.5)
        );
        let words = format!("-vh 20 -vf {} -vv 10", file.display());
        let v = of(&words).unwrap();
        assert_eq!((v.horizontal, v.vertical), (60.0, 10.0));
    }

    #[test]
    fn faults_name_the_option_and_in_files_the_line() {
        for (bad, part) in [
            ("-vp 1 2", "-vp: found the end"),
            ("-vh x", "-vh: found \"x\""),
            ("-vtq", "-vt: found \"q\""),
            ("-va -3", "(-va): found -3"),
            ("-vo 4 -va 3", "(-va): found 3"),
            ("-x 5", "found \"-x\""),
            ("-vh nan", "-vh"),
            ("-vd 0 0 1", "-vu"),
            ("-vf", "-vf"),
        ] {
            let e = of(bad).unwrap_err().to_string();
            assert!(e.contains(part), "{bad}: {e}");
        }
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("a.vf");
        std::fs::write(&file, "\nVIEW= -vh 200\n").unwrap();
        let e = read(&file).unwrap_err().to_string();
        assert!(e.contains("a.vf, line 2: size (-vh): found 200"), "{e}");
        std::fs::write(&file, "nothing\n").unwrap();
        assert!(
            read(&file)
                .unwrap_err()
                .to_string()
                .contains("a.vf, line 1: view")
        );
    }
}
