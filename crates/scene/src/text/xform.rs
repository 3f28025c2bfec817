//! Transforms as RADIANCE writes them [Radiance, common/xf.c].

use glam::{DAffine3, DMat3, DVec3};

/// A similarity: turns, mirrors, shifts and scales.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Xform {
    /// As a matrix.
    pub matrix: DAffine3,
    /// Factor on lengths; negative when it mirrors.
    pub scale: f64,
}

/// Most repetitions of a transform.
const MOST: u32 = 1_000_000;

impl Xform {
    /// No change.
    pub const IDENTITY: Xform = Xform {
        matrix: DAffine3::IDENTITY,
        scale: 1.0,
    };

    /// This transform, then `next`.
    fn then(&self, next: &Xform) -> Xform {
        Xform {
            matrix: next.matrix * self.matrix,
            scale: self.scale * next.scale,
        }
    }

    /// The transform `times` over.
    fn repeated(mut self, mut times: u32) -> Xform {
        let mut all = Xform::IDENTITY;
        while times > 0 {
            if times & 1 == 1 {
                all = all.then(&self);
            }
            self = self.then(&self);
            times >>= 1;
        }
        all
    }

    /// A point.
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.matrix.transform_point3(p)
    }

    /// A direction; its length scales.
    pub fn vector(&self, v: DVec3) -> DVec3 {
        self.matrix.transform_vector3(v)
    }

    /// The transform that `words` begin with (`-t x y z`, `-rx -ry -rz` in degrees, `-s factor`, `-mx -my -mz`,
    /// `-i times` before what is repeated), and how many words it takes. It ends at the first word that is no option.
    ///
    /// # Errors
    /// What is wrong with the option, and the option: a missing or bad number, a zero scale, an unknown option.
    pub fn parse<S: AsRef<str>>(words: &[S]) -> Result<(Xform, usize), (String, &'static str)> {
        let mut all = Xform::IDENTITY;
        let (mut block, mut times) = (Xform::IDENTITY, 1);
        let mut at = 0;
        while let Some(option) = words.get(at).map(AsRef::as_ref).filter(|w| w.starts_with('-')) {
            let number = |k: usize| -> Result<f64, (String, &'static str)> {
                let word = words.get(at + k).map_or("", AsRef::as_ref);
                let value = word.parse::<f64>().ok().filter(|v| v.is_finite());
                value.ok_or_else(|| {
                    (
                        format!("{option} {word}"),
                        "an option of xform and its finite numbers",
                    )
                })
            };
            let turn = |axis: DVec3, degrees: f64| Xform {
                matrix: DAffine3::from_axis_angle(axis, degrees.to_radians()),
                scale: 1.0,
            };
            let scaled = |by: DVec3, scale: f64| Xform {
                matrix: DAffine3::from_mat3(DMat3::from_diagonal(by)),
                scale,
            };
            let (step, used) = match option {
                "-t" => {
                    let by = DVec3::new(number(1)?, number(2)?, number(3)?);
                    let matrix = DAffine3::from_translation(by);
                    (Xform { matrix, scale: 1.0 }, 3)
                }
                "-rx" => (turn(DVec3::X, number(1)?), 1),
                "-ry" => (turn(DVec3::Y, number(1)?), 1),
                "-rz" => (turn(DVec3::Z, number(1)?), 1),
                "-s" => {
                    let by = number(1)?;
                    if by == 0.0 {
                        return Err((format!("{option} {by}"), "a scale that is not zero"));
                    }
                    (scaled(DVec3::splat(by), by), 1)
                }
                "-mx" => (scaled(DVec3::new(-1.0, 1.0, 1.0), -1.0), 0),
                "-my" => (scaled(DVec3::new(1.0, -1.0, 1.0), -1.0), 0),
                "-mz" => (scaled(DVec3::new(1.0, 1.0, -1.0), -1.0), 0),
                "-i" => {
                    all = all.then(&block.repeated(times));
                    block = Xform::IDENTITY;
                    let word = words.get(at + 1).map_or("", AsRef::as_ref);
                    times = word
                        .parse::<i64>()
                        .ok()
                        .and_then(|n| u32::try_from(n.max(0)).ok())
                        .filter(|n| *n <= MOST)
                        .ok_or_else(|| (format!("-i {word}"), "-i and a whole number up to 1000000"))?;
                    at += 2;
                    continue;
                }
                _ => {
                    return Err((
                        option.into(),
                        "-t x y z, -rx -ry -rz degrees, -s factor, -mx -my -mz, -i times",
                    ));
                }
            };
            block = block.then(&step);
            at += 1 + used;
        }
        all = all.then(&block.repeated(times));
        if !all.matrix.is_finite() || !all.scale.is_finite() || all.scale == 0.0 {
            let found = words[..at]
                .iter()
                .map(AsRef::as_ref)
                .collect::<Vec<_>>()
                .join(" ");
            return Err((found, "a transform that keeps within the range of numbers"));
        }
        Ok((all, at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Xform {
        let words: Vec<&str> = text.split_whitespace().collect();
        let (x, used) = Xform::parse(&words).unwrap();
        assert_eq!(used, words.len());
        x
    }

    #[test]
    fn options_apply_from_left_to_right_and_repeat_after_their_count() {
        let p = DVec3::new(1.0, 0.0, 0.0);
        assert!(of("-t 1 0 0 -rz 90").point(p).distance(DVec3::new(0.0, 2.0, 0.0)) < 1e-12);
        assert!(of("-rz 90 -t 1 0 0").point(p).distance(DVec3::new(1.0, 1.0, 0.0)) < 1e-12);
        assert!(
            of("-t 0 0 1 -i 3 -t 1 0 0 -i 1 -s 2")
                .point(p)
                .distance(DVec3::new(8.0, 0.0, 2.0))
                < 1e-12
        );
        assert_eq!(of("-mx -s 3").scale, -3.0);
        assert_eq!(of("-i 0 -t 5 5 5").point(p), p);
        assert!(of("-rx 90").vector(DVec3::Y).distance(DVec3::Z) < 1e-12);
        assert!(of("-ry 90").vector(DVec3::Z).distance(DVec3::X) < 1e-12);
    }

    #[test]
    fn options_without_their_numbers_are_refused() {
        for bad in ["-t 1 2", "-rz", "-s 0", "-s nan", "-q", "-i 2.5", "-i 99999999"] {
            let words: Vec<&str> = bad.split_whitespace().collect();
            assert!(Xform::parse(&words).is_err(), "{bad}");
        }
    }
}
