//! Data files of RADIANCE: values on a grid of any number of dimensions [Radiance, rt/data.c].

use std::path::Path;

use gonio_io::{IoError, excerpt, read_bytes};

/// Dimensions of a grid, and its values, at most.
const MOST_DIMENSIONS: usize = 4;
const MOST_VALUES: usize = 1 << 26;

/// Values on a grid.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    /// Places along each dimension, rising or falling.
    axes: Vec<Vec<f64>>,
    /// The last dimension fastest.
    values: Vec<f64>,
}

impl Grid {
    /// Reads a data file: the number of dimensions, for each `first last count` or `0 0 count` and the places, then values.
    pub(super) fn read(path: &Path) -> Result<Self, IoError> {
        Grid::parse(path, &read_bytes(path)?)
    }

    fn parse(path: &Path, bytes: &[u8]) -> Result<Self, IoError> {
        let mut numbers = bytes.split(|b| *b == b'\n').enumerate().flat_map(|(k, line)| {
            let text = line.split(|b| *b == b'#').next().unwrap_or(line);
            let words = text.split(|b| b.is_ascii_whitespace()).filter(|w| !w.is_empty());
            words.map(move |w| (k as u64 + 1, w))
        });
        let mut last = 1;
        let mut number = |field: &str| -> Result<(f64, u64), IoError> {
            let Some((line, word)) = numbers.next() else {
                return Err(IoError::format(path, last, field, "end of file", "a number"));
            };
            last = line;
            let value = std::str::from_utf8(word).ok().and_then(|w| w.parse::<f64>().ok());
            match value.filter(|v| v.is_finite()) {
                Some(v) => Ok((v, line)),
                None => Err(IoError::format(
                    path,
                    line,
                    field,
                    excerpt(word),
                    "a finite number",
                )),
            }
        };
        let whole = |(v, line): (f64, u64), field: &str, most: usize| {
            if v.fract() == 0.0 && v >= 1.0 && v <= most as f64 {
                return Ok(v as usize);
            }
            Err(IoError::format(
                path,
                line,
                field,
                v.to_string(),
                format!("a whole number from 1 to {most}"),
            ))
        };
        let dimensions = whole(number("dimensions")?, "dimensions", MOST_DIMENSIONS)?;
        let (mut axes, mut total) = (Vec::with_capacity(dimensions), 1_usize);
        for _ in 0..dimensions {
            let (first, line) = number("first place")?;
            let (end, _) = number("last place")?;
            let n = whole(number("places")?, "places", MOST_VALUES / total)?;
            total *= n;
            let axis: Vec<f64> = if first == end && n > 1 {
                let each = (0..n).map(|_| Ok(number("place")?.0));
                each.collect::<Result<_, IoError>>()?
            } else {
                let step = (end - first) / (n.max(2) - 1) as f64;
                (0..n).map(|k| first + step * k as f64).collect()
            };
            let rising = axis.windows(2).all(|w| w[0] < w[1]);
            if !rising && !axis.windows(2).all(|w| w[0] > w[1]) {
                return Err(IoError::format(
                    path,
                    line,
                    "places",
                    "an order that turns",
                    "rising or falling places",
                ));
            }
            axes.push(axis);
        }
        let mut values = Vec::new();
        for _ in 0..total {
            values.push(number("values")?.0);
        }
        Ok(Grid { axes, values })
    }

    pub(super) fn dimensions(&self) -> usize {
        self.axes.len()
    }

    /// The value at a place, linear between its neighbours on each axis. Beyond an end it goes on along the last slope
    /// for one step and falls off as one over the distance after that, as in RADIANCE.
    pub(super) fn value(&self, place: &[f64]) -> f64 {
        self.within(0, 0, place)
    }

    fn within(&self, axis: usize, first: usize, place: &[f64]) -> f64 {
        let Some(places) = self.axes.get(axis) else {
            return self.values.get(first).copied().unwrap_or(0.0);
        };
        let x = place.get(axis).copied().unwrap_or(0.0);
        let at = |k: usize| self.within(axis + 1, (first + k) * self.stride(axis), place);
        let n = places.len();
        if n == 1 {
            return at(0);
        }
        let falling = places[0] > places[1];
        let k = places
            .partition_point(|p| if falling { *p >= x } else { *p <= x })
            .clamp(1, n - 1);
        let t = (x - places[k - 1]) / (places[k] - places[k - 1]);
        let (low, high) = (at(k - 1), at(k));
        if t > 2.0 {
            (2.0 * high - low) / (t - 1.0)
        } else if t < -1.0 {
            (2.0 * low - high) / -t
        } else {
            low * (1.0 - t) + high * t
        }
    }

    /// What an index is multiplied with for the next axis.
    fn stride(&self, axis: usize) -> usize {
        self.axes.get(axis + 1).map_or(1, Vec::len)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<Grid, String> {
        Grid::parse(Path::new("a.dat"), text.as_bytes()).map_err(|e| e.to_string())
    }

    #[test]
    fn a_plane_on_uneven_places_is_interpolated_exactly() {
        let grid = of("# a plane: x + 10 y\n2\n0 2 3\n0 0 2 1 5 # y\n10 50 11 51 12 52\n").unwrap();
        for (x, y) in [(0.0, 1.0), (0.5, 2.0), (1.75, 4.5), (2.0, 5.0)] {
            assert!((grid.value(&[x, y]) - (x + 10.0 * y)).abs() < 1e-12, "{x} {y}");
        }
        assert_eq!(grid.value(&[0.0, 0.5]), 5.0);
        // Two steps past the end: the value one step past it over the distance from the end.
        assert_eq!(grid.value(&[4.0, 1.0]), 13.0 / 2.0);
        assert_eq!(of("1\n10 0 2\n1 3\n").unwrap().value(&[5.0]), 2.0);
    }

    #[test]
    fn faults_name_file_and_line() {
        for (text, wanted) in [
            ("", "a.dat, line 1: dimensions: found end of file"),
            ("9\n", "a.dat, line 1: dimensions: found 9"),
            ("1\n0 1 0\n", "a.dat, line 2: places: found 0"),
            ("1\n0 1 2\n1 x\n", "a.dat, line 3: values: found \"x\""),
            ("1\n0 0 3 1 3 2\n1 1 1\n", "a.dat, line 2: places"),
            ("1\n0 1 1e9\n", "a.dat, line 2: places"),
        ] {
            let e = of(text).unwrap_err();
            assert!(e.starts_with(wanted), "{e}");
        }
    }
}
