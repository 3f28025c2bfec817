//! Reading RADIANCE pictures [Ward1991].

use std::path::Path;

use crate::IoError;
use crate::error::{excerpt, read_bytes};

/// A picture that has been read.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadPicture {
    /// Pixels across.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue as they stand in the file, row by row from the top left.
    pub radiance: Vec<[f32; 3]>,
    /// Height over width of a pixel.
    pub pixel_aspect: f64,
}

/// Pixels, at most.
const MOST: usize = 1 << 28;

/// Reads a RADIANCE picture (RGBE, run-length coded in either way or not), whatever corner it begins at. Values are not divided by
/// its exposure.
///
/// # Errors
/// [`IoError::File`] for what the operating system refuses; [`IoError::Format`] for a file that is none, has other
/// colours (XYZE, spectra), or ends too soon.
pub fn read_hdr(path: &Path) -> Result<ReadPicture, IoError> {
    read_hdr_from(path, &read_bytes(path)?)
}

/// [`read_hdr`] of bytes in memory; `path` appears in errors.
///
/// # Errors
/// As [`read_hdr`].
pub fn read_hdr_from(path: &Path, bytes: &[u8]) -> Result<ReadPicture, IoError> {
    let wrong = |line: u64, field: &str, found: &[u8], allowed: &str| {
        IoError::format(path, line, field, excerpt(found), allowed)
    };
    let mut rest = bytes;
    let mut line = || {
        let end = rest.iter().position(|b| *b == b'\n')?;
        let (line, after) = rest.split_at(end);
        rest = &after[1..];
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    };
    let first = line().unwrap_or_default();
    if !first.starts_with(b"#?") {
        let allowed = "a RADIANCE picture, which begins with #?RADIANCE";
        return Err(wrong(1, "picture", bytes.get(..20).unwrap_or(bytes), allowed));
    }
    let (mut number, mut pixel_aspect) = (1, 1.0);
    loop {
        number += 1;
        let Some(text) = line() else {
            return Err(wrong(
                number,
                "header",
                b"end of file",
                "an empty line and the size",
            ));
        };
        if text.is_empty() {
            break;
        }
        if let Some(format) = text.strip_prefix(b"FORMAT=")
            && format.trim_ascii() != b"32-bit_rle_rgbe"
        {
            return Err(wrong(number, "FORMAT", format, "32-bit_rle_rgbe"));
        }
        if let Some(value) = text.strip_prefix(b"PIXASPECT=") {
            let value = std::str::from_utf8(value)
                .ok()
                .and_then(|v| v.trim().parse::<f64>().ok());
            let Some(value) = value.filter(|v| *v > 0.0 && v.is_finite()) else {
                return Err(wrong(number, "PIXASPECT", text, "a number above 0"));
            };
            pixel_aspect *= value;
        }
    }
    let text = line().unwrap_or_default();
    let Some(shape) = Shape::parse(text) else {
        let allowed = "the size, such as -Y 480 +X 640";
        return Err(wrong(number + 1, "size", text, allowed));
    };
    let pixels = decode(rest, shape.length, shape.lines).ok_or_else(|| {
        let found = format!("an end within {} lines of {}", shape.lines, shape.length);
        wrong(number + 2, "pixels", found.as_bytes(), "whole lines of pixels")
    })?;
    Ok(shape.upright(&pixels, pixel_aspect))
}

/// How the pixels of a file lie.
struct Shape {
    lines: usize,
    length: usize,
    /// Whether its lines go down the picture.
    upright: bool,
    /// Whether lines follow each other from the top or the left; whether the pixels of a line do.
    forward: [bool; 2],
}

impl Shape {
    fn parse(text: &[u8]) -> Option<Self> {
        let text = std::str::from_utf8(text).ok()?;
        let words: Vec<&str> = text.split_whitespace().collect();
        let [first, lines, second, length] = words.as_slice() else {
            return None;
        };
        let count = |w: &str| w.parse::<usize>().ok().filter(|n| *n > 0 && *n <= MOST);
        let (lines, length) = (count(lines)?, count(length)?);
        let forward = |w: &str| Some(matches!(w, "-Y" | "+X"));
        let upright = match (&first[1..], &second[1..]) {
            ("Y", "X") => true,
            ("X", "Y") => false,
            _ => return None,
        };
        let signs = [first, second].iter().all(|w| w.starts_with(['+', '-']));
        (signs && lines * length <= MOST).then_some(Shape {
            lines,
            length,
            upright,
            forward: [forward(first)?, forward(second)?],
        })
    }

    fn upright(&self, pixels: &[[f32; 3]], pixel_aspect: f64) -> ReadPicture {
        let (width, height) = if self.upright {
            (self.length, self.lines)
        } else {
            (self.lines, self.length)
        };
        let turned = |k: usize, n: usize, forward: bool| if forward { k } else { n - 1 - k };
        let mut radiance = Vec::with_capacity(pixels.len());
        for row in 0..height {
            for column in 0..width {
                let (line, place) = if self.upright {
                    (row, column)
                } else {
                    (column, row)
                };
                let line = turned(line, self.lines, self.forward[0]);
                let place = turned(place, self.length, self.forward[1]);
                radiance.push(pixels[line * self.length + place]);
            }
        }
        ReadPicture {
            width,
            height,
            radiance,
            pixel_aspect,
        }
    }
}

/// The pixels of all lines; `None` where the bytes end or a run goes past its line.
fn decode(bytes: &[u8], length: usize, lines: usize) -> Option<Vec<[f32; 3]>> {
    // Coded bytes cannot stand for more than 64 pixels each.
    if bytes.len().checked_mul(64)? < length * lines {
        return None;
    }
    let mut bytes = bytes.iter().copied();
    let mut out = Vec::with_capacity(length * lines);
    let mut values = vec![[0_u8; 4]; length];
    for _ in 0..lines {
        let start = [bytes.next()?, bytes.next()?, bytes.next()?, bytes.next()?];
        let long = usize::from(start[2]) << 8 | usize::from(start[3]);
        if start[..2] == [2, 2] && start[2] < 128 && (8..0x8000).contains(&length) {
            if long != length {
                return None;
            }
            for channel in 0..4 {
                let mut x = 0;
                while x < length {
                    let n = usize::from(bytes.next()?);
                    let (n, run) = if n > 128 {
                        (n - 128, bytes.next())
                    } else {
                        (n, None)
                    };
                    for value in values.get_mut(x..x + n)? {
                        value[channel] = match run {
                            Some(v) => v,
                            None => bytes.next()?,
                        };
                    }
                    if n == 0 {
                        return None;
                    }
                    x += n;
                }
            }
        } else {
            plain(&mut bytes, start, &mut values)?;
        }
        out.extend(values.iter().map(colour));
    }
    Some(out)
}

/// A line without runs by channel; `1 1 1 n` repeats the pixel before.
fn plain(bytes: &mut impl Iterator<Item = u8>, start: [u8; 4], values: &mut [[u8; 4]]) -> Option<()> {
    let (mut next, mut x, mut shift) = (start, 0_usize, 0);
    loop {
        if next[..3] == [1, 1, 1] {
            let last = *values.get(x.checked_sub(1)?)?;
            let n = usize::from(next[3]).checked_shl(shift)?;
            values.get_mut(x..x.checked_add(n)?)?.fill(last);
            x += n;
            shift += 8;
            if shift > 24 {
                return None;
            }
        } else {
            *values.get_mut(x)? = next;
            x += 1;
            shift = 0;
        }
        if x == values.len() {
            return Some(());
        }
        next = [bytes.next()?, bytes.next()?, bytes.next()?, bytes.next()?];
    }
}

fn colour(&[r, g, b, e]: &[u8; 4]) -> [f32; 3] {
    if e == 0 {
        return [0.0; 3];
    }
    let scale = 2.0_f64.powi(i32::from(e) - 136);
    [r, g, b].map(|v| ((f64::from(v) + 0.5) * scale) as f32)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{Picture, write_hdr};
    use super::*;

    fn of(bytes: &[u8]) -> Result<ReadPicture, String> {
        read_hdr_from(Path::new("a.hdr"), bytes).map_err(|e| e.to_string())
    }

    #[test]
    fn what_is_written_reads_back_within_the_last_place_of_the_largest() {
        let radiance: Vec<[f32; 3]> = (0..60)
            .map(|k| [k as f32, (k / 7) as f32, 0.01 * k as f32])
            .collect();
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.hdr");
        for width in [5, 20] {
            let picture = Picture {
                width,
                radiance: &radiance,
                luminance: &[1.0; 60],
                standard_error: &[1.0; 60],
                view: "-vtv",
                software: "gonio",
            };
            write_hdr(&path, &picture).unwrap();
            let back = read_hdr(&path).unwrap();
            assert_eq!((back.width, back.height), (width, 60 / width));
            for (a, b) in back.radiance.iter().zip(&radiance) {
                let most = b.iter().fold(0.0_f32, |m, x| m.max(*x));
                assert!((0..3).all(|k| (a[k] - b[k]).abs() <= most / 128.0), "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn pictures_of_every_orientation_stand_upright() {
        // Two columns, three rows; red counts from the top left.
        let one = |r: u8| [r, 0, 0, 136];
        for (size, order) in [
            ("-Y 3 +X 2", [0, 1, 2, 3, 4, 5]),
            ("+Y 3 +X 2", [4, 5, 2, 3, 0, 1]),
            ("-Y 3 -X 2", [1, 0, 3, 2, 5, 4]),
            ("+X 2 -Y 3", [0, 2, 4, 1, 3, 5]),
            ("-X 2 +Y 3", [5, 3, 1, 4, 2, 0]),
        ] {
            let mut bytes = format!("#?RADIANCE\nPIXASPECT=2\n\n{size}\n").into_bytes();
            bytes.extend(order.iter().flat_map(|k| one(*k)));
            let p = of(&bytes).unwrap();
            assert_eq!((p.width, p.height, p.pixel_aspect), (2, 3, 2.0));
            let red: Vec<f32> = p.radiance.iter().map(|c| c[0] - 0.5).collect();
            assert_eq!(red, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0], "{size}");
        }
    }

    #[test]
    fn what_is_no_picture_is_refused_with_its_line() {
        for (bytes, wanted) in [
            (&b"P6 1 1"[..], "a.hdr, line 1: picture: found \"P6 1 1\""),
            (b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n", "a.hdr, line 2: FORMAT"),
            (b"#?RADIANCE\n", "a.hdr, line 2: header"),
            (b"#?RADIANCE\n\n-Y 0 +X 5\n", "a.hdr, line 3: size"),
            (b"#?RADIANCE\n\n-Y 99999999 +X 99999999\n", "a.hdr, line 3: size"),
            (b"#?RADIANCE\n\n-Y 2 +X 5\n12345", "a.hdr, line 4: pixels"),
            (
                b"#?RADIANCE\n\n-Y 1 +X 9\n\x02\x02\0\x09\xff\x01",
                "a.hdr, line 4: pixels",
            ),
        ] {
            let e = of(bytes).unwrap_err();
            assert!(e.starts_with(wanted), "{e}");
        }
    }

    proptest! {
        #[test]
        fn no_bytes_make_the_reader_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300), wide in 1_usize..40) {
            let mut picture = format!("#?RADIANCE\n\n-Y 3 +X {wide}\n").into_bytes();
            let _ = of(&bytes);
            picture.extend(&bytes);
            let _ = of(&picture);
            let start = picture.len() - bytes.len();
            picture.splice(start..start, [2, 2, 0, wide as u8]);
            let _ = of(&picture);
        }
    }
}
