//! RADIANCE pictures: 8 bits of red, green, blue and a common exponent, run-length coded [Ward1991].

use std::path::Path;

use super::Picture;
use crate::IoError;
use crate::atomic::write_atomic;

/// Writes the radiance of a picture; its readers take every value within 1/256 of the largest of the three.
///
/// # Errors
/// [`IoError::File`] where the file system refuses, and for a picture whose layers are not equally long.
pub fn write_hdr(path: &Path, picture: &Picture<'_>) -> Result<(), IoError> {
    write_atomic(path, |out| {
        picture.check()?;
        // Lines of a header end where its values do.
        let line = |text: &str| text.replace(['\n', '\r'], " ");
        write!(
            out,
            "#?RADIANCE\nSOFTWARE={}\nVIEW= {}\nEXPOSURE=1\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n",
            line(picture.software),
            line(picture.view),
            picture.height(),
            picture.width
        )?;
        let mut bytes = Vec::new();
        for row in picture.radiance.chunks(picture.width) {
            bytes.clear();
            scanline(row, &mut bytes);
            out.write_all(&bytes)?;
        }
        Ok(())
    })
}

/// Lengths of rows that are run-length coded.
const CODED: std::ops::RangeInclusive<usize> = 8..=0x7fff;

fn scanline(row: &[[f32; 3]], out: &mut Vec<u8>) {
    let pixels: Vec<[u8; 4]> = row.iter().map(|c| rgbe(*c)).collect();
    if !CODED.contains(&row.len()) {
        out.extend(pixels.iter().flatten());
        return;
    }
    out.extend([2, 2, (row.len() >> 8) as u8, row.len() as u8]);
    for channel in 0..4 {
        let values: Vec<u8> = pixels.iter().map(|p| p[channel]).collect();
        runs(&values, out);
    }
}

/// Equal neighbours that are worth a run.
const LEAST_RUN: usize = 4;

fn runs(values: &[u8], out: &mut Vec<u8>) {
    let mut at = 0;
    let mut plain = 0;
    while at < values.len() {
        let same = values[at..]
            .iter()
            .take(127)
            .take_while(|v| **v == values[at])
            .count();
        if same >= LEAST_RUN {
            literals(&values[plain..at], out);
            out.extend([128 + same as u8, values[at]]);
            plain = at + same;
        }
        at += same;
    }
    literals(&values[plain..], out);
}

fn literals(values: &[u8], out: &mut Vec<u8>) {
    for part in values.chunks(128) {
        out.push(part.len() as u8);
        out.extend(part);
    }
}

/// The mantissas are cut off, readers add a half. What is negative or no number is black.
fn rgbe(colour: [f32; 3]) -> [u8; 4] {
    let colour = colour.map(|c| if c > 0.0 { f64::from(c.min(f32::MAX)) } else { 0.0 });
    let largest = colour.iter().fold(0.0_f64, |a, b| a.max(*b));
    if largest < 1e-32 {
        return [0; 4];
    }
    // 2^(e - 1) <= largest < 2^e
    let mut e = largest.log2().floor() as i32 + 1;
    if largest >= 2.0_f64.powi(e) {
        e += 1;
    } else if largest < 2.0_f64.powi(e - 1) {
        e -= 1;
    }
    let scale = 256.0 / 2.0_f64.powi(e);
    let [r, g, b] = colour.map(|c| (c * scale) as u8);
    [r, g, b, (e + 128).clamp(0, 255) as u8]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The coding, read back by its description.
    fn read(mut bytes: &[u8], width: usize, rows: usize) -> Vec<[f32; 3]> {
        let mut take = |n: usize| {
            let (a, b) = bytes.split_at(n);
            bytes = b;
            a.to_vec()
        };
        let mut out = Vec::new();
        for _ in 0..rows {
            let mut pixels = vec![[0_u8; 4]; width];
            if CODED.contains(&width) {
                assert_eq!(take(4), [2, 2, (width >> 8) as u8, width as u8]);
                let mut values = Vec::new();
                while values.len() < 4 * width {
                    let n = take(1)[0];
                    if n > 128 {
                        values.extend(vec![take(1)[0]; usize::from(n) - 128]);
                    } else {
                        values.extend(take(n.into()));
                    }
                }
                assert_eq!(values.len(), 4 * width);
                for (x, p) in pixels.iter_mut().enumerate() {
                    *p = [0, 1, 2, 3].map(|channel| values[channel * width + x]);
                }
            } else {
                for p in &mut pixels {
                    p.copy_from_slice(&take(4));
                }
            }
            out.extend(pixels.iter().map(|p| {
                let f = 2.0_f32.powi(i32::from(p[3]) - 136);
                if p[3] == 0 {
                    [0.0; 3]
                } else {
                    [0, 1, 2].map(|k| (f32::from(p[k]) + 0.5) * f)
                }
            }));
        }
        assert!(bytes.is_empty());
        out
    }

    #[test]
    fn what_is_read_is_what_was_written_within_a_256th_of_the_largest() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.hdr");
        for width in [1, 7, 8, 127, 128, 300] {
            let mut radiance: Vec<[f32; 3]> = (0..3 * width)
                .map(|k| {
                    let x = (k as f32 * 0.7).sin().abs() * 10.0_f32.powi((k % 9) as i32 - 4);
                    if k % 100 > 40 {
                        [1.0, 0.5, 0.0]
                    } else {
                        [x, 2.0 * x, 0.3]
                    }
                })
                .collect();
            radiance[0] = [0.0, -1.0, f32::NAN];
            let layer = vec![0.0; radiance.len()];
            let picture = Picture {
                width,
                radiance: &radiance,
                luminance: &layer,
                standard_error: &layer,
                view: "-vtv -vh 45",
                software: "gonio test",
            };
            write_hdr(&path, &picture).unwrap();
            let bytes = std::fs::read(&path).unwrap();
            let head = format!("VIEW= -vtv -vh 45\nEXPOSURE=1\nFORMAT=32-bit_rle_rgbe\n\n-Y 3 +X {width}\n");
            let at = bytes
                .windows(head.len())
                .position(|w| w == head.as_bytes())
                .unwrap();
            assert!(bytes.starts_with(b"#?RADIANCE\nSOFTWARE=gonio test\n"));
            let found = read(&bytes[at + head.len()..], width, 3);
            assert_eq!(found[0], [0.0; 3]);
            for (a, b) in found.iter().zip(&radiance).skip(1) {
                let largest = b.iter().fold(0.0_f32, |x, y| x.max(*y));
                for k in 0..3 {
                    assert!((a[k] - b[k]).abs() <= largest / 255.0, "{a:?} {b:?}");
                }
            }
        }
    }

    #[test]
    fn powers_of_two_have_the_mantissa_128() {
        for e in -20..20 {
            let x = 2.0_f32.powi(e);
            assert_eq!(rgbe([x, 0.0, 0.0]), [128, 0, 0, (e + 129) as u8]);
            assert_eq!(rgbe([x * (1.0 - 6e-8), 0.0, 0.0])[0], 255);
        }
    }
}
