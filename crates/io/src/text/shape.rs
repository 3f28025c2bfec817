//! What rows of three numbers have in common when their marks (all bytes that are not digits) are the same and in the
//! same places: only the values of the digits differ. A shape is worked out once, byte by byte, and then tells `plain`
//! where the digits of the next such row are without another look at its grammar.

use super::number::POWERS;

/// Bytes of a row that a shape can describe, line end included.
pub(super) const LENGTH: usize = 64;
/// Numbers of a row that a shape can describe.
pub(super) const COLUMNS: usize = 3;
/// Digits of a number, and bytes from its first digit to its last, that a shape can describe.
const DIGITS: usize = 16;
/// Shapes that are kept. A file has one for each combination of the lengths of its numbers.
const KEPT: usize = 256;

/// The layout of a row.
#[derive(Clone)]
pub(super) struct Shape {
    /// Bit `i` is set where byte `i` is no digit; nothing after the line end.
    pub(super) marks: u64,
    /// What the row holds at its marks; anything elsewhere.
    pub(super) template: [u8; LENGTH],
    /// First digit (or point) of each number.
    pub(super) starts: [u8; COLUMNS],
    /// For each number, which of the bytes from its start on are its digits, right-aligned; `0x80` is none.
    pub(super) gather: [[u8; DIGITS]; COLUMNS],
    /// Power of ten by which the digits of each number are divided, the exponent of the last left out.
    pub(super) divisors: [f64; COLUMNS + 1],
    /// `-0.0` for negative numbers, `0.0` for others and beyond the last.
    pub(super) signs: [f64; COLUMNS + 1],
    /// Digits after the point of the last number.
    pub(super) fraction: i64,
    /// The first of the two digits of the exponent of the last number.
    pub(super) exponent: u8,
    /// What each of these digits adds to the power of ten that divides; zero without an exponent.
    pub(super) weights: [i64; 2],
}

impl Shape {
    /// Describes nothing: no row is without marks.
    const NONE: Shape = Shape {
        marks: 0,
        template: [0; LENGTH],
        starts: [0; COLUMNS],
        gather: [[0x80; DIGITS]; COLUMNS],
        divisors: [1.0; COLUMNS + 1],
        signs: [0.0; COLUMNS + 1],
        fraction: 0,
        exponent: 0,
        weights: [0; 2],
    };

    /// The shape of a row of `COLUMNS` decimals between blanks, the last one possibly with an exponent `e+dd`; `row`
    /// ends with its line end. `None` where there is more to it than that.
    pub(super) fn of(row: &[u8]) -> Option<Shape> {
        if row.len() > LENGTH {
            return None;
        }
        let mut shape = Shape::NONE;
        shape.template[..row.len()].copy_from_slice(row);
        for (i, b) in row.iter().enumerate() {
            shape.marks |= u64::from(!b.is_ascii_digit()) << i;
        }
        let byte = |i: usize| row.get(i).copied().unwrap_or_default();
        let blanks = |mut at: usize| {
            while matches!(byte(at), b' ' | b'\t') {
                at += 1;
            }
            at
        };
        let mut at = 0;
        for column in 0..COLUMNS {
            let gap = blanks(at);
            if column > 0 && gap == at {
                return None;
            }
            at = gap;
            if byte(at) == b'-' {
                shape.signs[column] = -0.0;
                at += 1;
            }
            let start = at;
            let gather = &mut shape.gather[column];
            let mut count = 0;
            let mut point = None;
            loop {
                match byte(at) {
                    b'0'..=b'9' => {
                        *gather.get_mut(count)? = (at - start) as u8;
                        count += 1;
                    }
                    b'.' if point.is_none() => point = Some(count),
                    _ => break,
                }
                at += 1;
            }
            if count == 0 || at - start > DIGITS {
                return None;
            }
            gather.rotate_right(DIGITS - count);
            shape.starts[column] = start as u8;
            let fraction = count - point.unwrap_or(count);
            shape.divisors[column] = POWERS[fraction];
            shape.fraction = fraction as i64;
        }
        if matches!(byte(at), b'e' | b'E') {
            let sign = match byte(at + 1) {
                b'-' => 1,
                b'+' => -1,
                _ => return None,
            };
            if !byte(at + 2).is_ascii_digit() || !byte(at + 3).is_ascii_digit() {
                return None;
            }
            shape.exponent = at as u8 + 2;
            shape.weights = [10 * sign, sign];
            at += 4;
        }
        at = blanks(at);
        at += usize::from(byte(at) == b'\r');
        (byte(at) == b'\n' && at + 1 == row.len()).then_some(shape)
    }

    /// The power of ten that divides the digits of the last number, when it is one of `POWERS`.
    #[inline(always)]
    pub(super) fn last_divisor(&self, exponent: [u8; 2]) -> Option<f64> {
        let [tens, ones] = exponent.map(|b| i64::from(b & 15));
        let power = self.fraction + self.weights[0] * tens + self.weights[1] * ones;
        POWERS.get(power as usize).copied()
    }
}

/// The shapes met last, by their marks.
pub(super) struct Shapes(Vec<Shape>);

impl Shapes {
    pub(super) fn new() -> Self {
        Shapes(vec![Shape::NONE; KEPT])
    }

    /// The only place for the shape of a row with these marks and minus signs.
    #[inline(always)]
    pub(super) fn place(&mut self, marks: u64, minus: u64) -> &mut Shape {
        // Fibonacci hashing: the top bits of the product depend on all bits of the key
        let key = marks ^ (minus << 1);
        let hash = key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (64 - KEPT.trailing_zeros());
        &mut self.0[hash as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_tells_where_the_digits_are() {
        let shape = Shape::of(b" 12.5\t-7 .250e-03\r\n").unwrap();
        assert_eq!(shape.starts, [1, 7, 9]);
        assert_eq!(shape.gather[0][13..], [0, 1, 3]);
        assert_eq!(shape.gather[1][14..], [0x80, 0]);
        assert_eq!(shape.divisors[..2], [10.0, 1.0]);
        assert_eq!(
            shape.signs.map(f64::is_sign_negative),
            [false, true, false, false]
        );
        assert_eq!(shape.last_divisor(*b"03"), Some(1e6));
        assert_eq!(shape.last_divisor(*b"20"), None);
    }

    #[test]
    fn unusual_rows_have_no_shape() {
        for row in [
            "1 2\n",
            "1 2 3 4\n",
            "1 2 3",
            "1 2 3\n ",
            "+1 2 3\n",
            "1 2 3e5\n",
            "1 2 3e005\n",
            "1e+01 2 3\n",
            "1 2 .\n",
            "1 2 1.2.3\n",
            "1 2 nan\n",
            "1 2 12345678901234567\n",
            "# 1 2\n",
            "\n",
            "1-2 3 4\n",
        ] {
            assert!(Shape::of(row.as_bytes()).is_none(), "{row:?}");
        }
    }
}
