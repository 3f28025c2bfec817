//! Pictures of RADIANCE as data: the centres of the outermost pixels are the corners of a rectangle from `(0, 0)` on, whose
//! shorter side has the length 1 [Radiance, rt/data.c].

use std::path::Path;

use gonio_io::IoError;
use gonio_io::picture::read_hdr;

/// A picture.
pub(super) struct Image {
    /// Rows from the top.
    pixels: Vec<[f32; 3]>,
    width: usize,
    height: usize,
    /// Width and height in its coordinates.
    size: [f64; 2],
}

impl Image {
    pub(super) fn read(path: &Path) -> Result<Self, IoError> {
        let picture = read_hdr(path)?;
        let (width, height) = (picture.width, picture.height);
        let shape = height as f64 / width as f64 * picture.pixel_aspect;
        let size = if shape >= 1.0 {
            [1.0, shape]
        } else {
            [1.0 / shape, 1.0]
        };
        Ok(Image {
            pixels: picture.radiance,
            width,
            height,
            size,
        })
    }

    /// Red, green and blue between the pixels about a place; beyond the edge those of the edge.
    pub(super) fn value(&self, u: f64, v: f64) -> [f64; 3] {
        let place = |x: f64, size: f64, n: usize| {
            let x = (x / size * (n - 1) as f64).max(0.0).min((n - 1) as f64);
            let low = x.floor();
            (low as usize, (low as usize + 1).min(n - 1), x - low)
        };
        let (x0, x1, tx) = place(u, self.size[0], self.width);
        let (y0, y1, ty) = place(v, self.size[1], self.height);
        let at =
            |x: usize, y: usize, k: usize| f64::from(self.pixels[(self.height - 1 - y) * self.width + x][k]);
        std::array::from_fn(|k| {
            let low = at(x0, y0, k) * (1.0 - tx) + at(x1, y0, k) * tx;
            let high = at(x0, y1, k) * (1.0 - tx) + at(x1, y1, k) * tx;
            low * (1.0 - ty) + high * ty
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_lie_from_corner_to_corner_of_a_rectangle_and_go_on_beyond_it() {
        let image = Image {
            pixels: vec![[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0], [4.0, 0.0, 0.0]],
            width: 4,
            height: 1,
            size: [4.0, 1.0],
        };
        for (u, wanted) in [
            (0.0, 1.0),
            (4.0, 4.0),
            (2.0, 2.5),
            (-7.0, 1.0),
            (9.0, 4.0),
            (f64::NAN, 1.0),
        ] {
            assert_eq!(image.value(u, 0.3)[0], wanted, "{u}");
        }
    }
}
