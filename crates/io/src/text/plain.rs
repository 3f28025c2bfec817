//! Rows of three plain decimals, all three converted at once in the lanes of AVX2 registers.
//!
//! The marks of a row select its [`Shape`]; one comparison with the shape's template proves that the row has it. A
//! byte shuffle then right-aligns the digits of each number in 16 bytes, and three multiply-adds make an integer of
//! them [Lemire2021 describes the same steps for eight digits]. Integer and power of ten are exact, so the one
//! division is correctly rounded [Clinger1990]. No branch depends on the lengths of the numbers. The first row that
//! is anything else ends the batch and is left to the caller.

use super::shape::{COLUMNS, LENGTH, Shapes};

/// Bytes readable from the first byte of a row on: 16 from its last one.
pub(super) const AFTER: usize = LENGTH + 16;

/// One row: its numbers, and a zero.
pub(super) type Lanes = [f64; COLUMNS + 1];

/// Whether this processor has what [`rows`] needs.
pub(super) fn available() -> bool {
    #[cfg(target_arch = "x86_64")]
    return is_x86_feature_detected!("avx2") && is_x86_feature_detected!("bmi1");
    #[cfg(not(target_arch = "x86_64"))]
    return false;
}

/// Reads plain rows of `buffer[pos..end]` into `out` until it is full or a row is not plain; returns how many and
/// where the next row starts. Looks at `AFTER` bytes of each row: a row nearer to the end of `buffer` is not plain.
/// None on a processor that lacks what it needs.
#[inline]
pub(super) fn rows(
    buffer: &[u8],
    pos: usize,
    end: usize,
    shapes: &mut Shapes,
    out: &mut [Lanes],
) -> (usize, usize) {
    #[cfg(target_arch = "x86_64")]
    if available() {
        // SAFETY: the processor has the instructions, which is all that the function asks for.
        return unsafe { avx2::rows(buffer, pos, end, shapes, out) };
    }
    let _ = (buffer, end, shapes, out);
    (0, pos)
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::*;

    use super::super::shape::{LENGTH, Shape, Shapes};
    use super::{AFTER, Lanes};

    /// Integers below this are exact and leave the exponent bits of 2^52 alone.
    const TWO_52: i64 = 1 << 52;

    #[target_feature(enable = "avx2,bmi1")]
    pub(super) fn rows(
        buffer: &[u8],
        mut pos: usize,
        end: usize,
        shapes: &mut Shapes,
        out: &mut [Lanes],
    ) -> (usize, usize) {
        let mut count = 0;
        while let Some(lanes) = out.get_mut(count) {
            let Some(window) = buffer[pos..].first_chunk::<AFTER>() else {
                break;
            };
            let (low, high) = (bytes32(window, 0), bytes32(window, 32));
            let ends = equal(low, high, b'\n');
            if ends == 0 {
                break;
            }
            let length = ends.trailing_zeros() as usize + 1;
            if pos + length > end {
                break;
            }
            let row = ends ^ (ends - 1); // all bits up to the line end
            let marks = no_digits(low, high) & row;
            let minus = equal(low, high, b'-') & row;
            let shape = shapes.place(marks, minus);
            if shape.marks != marks || differs(shape, low, high) & marks != 0 {
                if let Some(new) = Shape::of(&window[..length]) {
                    *shape = new;
                }
                break;
            }
            let Some(numbers) = numbers(window, shape) else {
                break;
            };
            *lanes = numbers;
            count += 1;
            pos += length;
        }
        (count, pos)
    }

    /// The numbers of a row of this shape; `None` where one is not exact.
    #[target_feature(enable = "avx2")]
    #[inline]
    fn numbers(window: &[u8; AFTER], shape: &Shape) -> Option<Lanes> {
        let digits = |k: usize| {
            let text = bytes16(window, usize::from(shape.starts[k]) % LENGTH);
            _mm_shuffle_epi8(text, bytes16(&shape.gather[k], 0))
        };
        let low_bits = _mm256_set1_epi8(15);
        let first_last = _mm256_and_si256(_mm256_set_m128i(digits(2), digits(0)), low_bits);
        let second = _mm256_and_si256(_mm256_zextsi128_si256(digits(1)), low_bits);
        let fours = |digits| {
            let twos = _mm256_maddubs_epi16(digits, _mm256_set1_epi16(0x010a)); // 10 and 1
            _mm256_madd_epi16(twos, _mm256_set1_epi32(0x0001_0064)) // 100 and 1
        };
        // a lane of 64 bits a number, in their order: its upper eight digits below its lower eight
        let packed = _mm256_packus_epi32(fours(first_last), fours(second));
        let eights = _mm256_madd_epi16(packed, _mm256_set1_epi32(0x0001_2710)); // 10000 and 1
        let upper = _mm256_mul_epu32(eights, _mm256_set1_epi64x(100_000_000));
        let integers = _mm256_add_epi64(upper, _mm256_srli_epi64(eights, 32));
        let large = _mm256_cmpgt_epi64(integers, _mm256_set1_epi64x(TWO_52 - 1));
        if _mm256_testz_si256(large, large) == 0 {
            return None;
        }
        // put into the mantissa of 2^52, which is then subtracted
        let base = _mm256_set1_pd(TWO_52 as f64);
        let integers = _mm256_sub_pd(_mm256_or_pd(_mm256_castsi256_pd(integers), base), base);
        let at = usize::from(shape.exponent) % LENGTH;
        let last = shape.last_divisor([window[at], window[at + 1]])?;
        let divisors = _mm256_blend_pd(lanes(&shape.divisors), _mm256_set1_pd(last), 0b0100);
        let values = _mm256_xor_pd(_mm256_div_pd(integers, divisors), lanes(&shape.signs));
        Some(to_array(values))
    }

    /// Bit `i` is set where byte `i` of 64 is `b`.
    #[target_feature(enable = "avx2")]
    #[inline]
    fn equal(low: __m256i, high: __m256i, b: u8) -> u64 {
        let b = _mm256_set1_epi8(b as i8);
        bits(_mm256_cmpeq_epi8(low, b), _mm256_cmpeq_epi8(high, b))
    }

    /// Bit `i` is set where byte `i` of 64 is no decimal digit.
    #[target_feature(enable = "avx2")]
    #[inline]
    fn no_digits(low: __m256i, high: __m256i) -> u64 {
        // '0'..='9' become the ten smallest signed bytes
        let shift = _mm256_set1_epi8((b'0' as i8).wrapping_add(i8::MIN));
        let limit = _mm256_set1_epi8(i8::MIN + 9);
        let other = |x| _mm256_cmpgt_epi8(_mm256_sub_epi8(x, shift), limit);
        bits(other(low), other(high))
    }

    /// Bit `i` is set where byte `i` is not that of the template.
    #[target_feature(enable = "avx2")]
    #[inline]
    fn differs(shape: &Shape, low: __m256i, high: __m256i) -> u64 {
        !bits(
            _mm256_cmpeq_epi8(low, bytes32(&shape.template, 0)),
            _mm256_cmpeq_epi8(high, bytes32(&shape.template, 32)),
        )
    }

    /// The top bits of 64 bytes.
    #[target_feature(enable = "avx2")]
    #[inline]
    fn bits(low: __m256i, high: __m256i) -> u64 {
        let mask = |x| u64::from(_mm256_movemask_epi8(x) as u32);
        mask(low) | mask(high) << 32
    }

    #[target_feature(enable = "avx2")]
    #[inline]
    fn bytes32(bytes: &[u8], at: usize) -> __m256i {
        let bytes = &bytes[at..at + 32];
        // SAFETY: the slice has the 32 bytes that the unaligned load reads.
        unsafe { _mm256_loadu_si256(bytes.as_ptr().cast()) }
    }

    #[target_feature(enable = "avx2")]
    #[inline]
    fn bytes16(bytes: &[u8], at: usize) -> __m128i {
        let bytes = &bytes[at..at + 16];
        // SAFETY: the slice has the 16 bytes that the unaligned load reads.
        unsafe { _mm_loadu_si128(bytes.as_ptr().cast()) }
    }

    #[target_feature(enable = "avx2")]
    #[inline]
    fn lanes(numbers: &Lanes) -> __m256d {
        // SAFETY: the array has the four numbers that the unaligned load reads.
        unsafe { _mm256_loadu_pd(numbers.as_ptr()) }
    }

    #[target_feature(enable = "avx2")]
    #[inline]
    fn to_array(numbers: __m256d) -> Lanes {
        let mut array = Lanes::default();
        // SAFETY: the array has room for the four numbers that the unaligned store writes.
        unsafe { _mm256_storeu_pd(array.as_mut_ptr(), numbers) };
        array
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// What [`rows`] reads of `text` when it is asked until it gives nothing more twice: the first time it may only
    /// have learnt a shape. Unknown rows are read by the library, as the caller would.
    fn all(text: &str) -> (Vec<[u64; 3]>, usize) {
        let mut buffer = text.as_bytes().to_vec();
        let end = buffer.len();
        buffer.resize(end + AFTER, b'7');
        let (mut shapes, mut out) = (Shapes::new(), [Lanes::default(); 4]);
        let (mut pos, mut found, mut taken) = (0, Vec::new(), 0);
        while pos < end {
            let (count, next) = rows(&buffer, pos, end, &mut shapes, &mut out);
            taken += count;
            found.extend(out[..count].iter().map(|r| [r[0], r[1], r[2]].map(f64::to_bits)));
            pos = next;
            if count < out.len() && pos < end {
                let line = text[pos..].split_inclusive('\n').next().unwrap();
                found.push(by_library(line));
                pos += line.len();
            }
        }
        (found, taken)
    }

    fn by_library(line: &str) -> [u64; 3] {
        let numbers: Vec<u64> = line
            .split_whitespace()
            .map(|w| w.parse::<f64>().unwrap().to_bits())
            .collect();
        numbers.try_into().unwrap()
    }

    #[test]
    fn rows_of_a_known_shape_are_taken() {
        let text = "1.25 20 3e-01\n9.75 10 4e-22\n 1 2 3\r\n 4 5 6\r\n-0.0 5. .5\n-7.5 6. .1\n";
        let (found, taken) = all(text);
        assert_eq!(found, text.lines().map(by_library).collect::<Vec<_>>());
        assert_eq!(taken, if available() { 3 } else { 0 });
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        /// Few places and lengths, so that the shapes of early rows serve later ones.
        #[test]
        fn rows_have_the_values_of_the_library(
            lines in prop::collection::vec(
                "-?[0-9]{1,3}(\\.[0-9]{4})? {1,2}-?[0-9]{1,9}\\.[0-9]{0,7}\t-?[0-9]{1,2}(\\.[0-9]{1,14})?(e[-+][0-9]{2})?\r?\n",
                1..40,
            ),
        ) {
            let (found, _) = all(&lines.concat());
            prop_assert_eq!(found, lines.iter().map(|l| by_library(l)).collect::<Vec<_>>());
        }

        /// The same marks with other digits: the second row is always taken by the shape of the first.
        #[test]
        fn all_digits_of_a_shape_have_the_value_of_the_library(
            shape in "-?9{1,8}(\\.9{0,7})? -?9{0,7}\\.9{1,8}\t-?9{1,3}(\\.9{0,12})?(e[-+]99)?\n",
            digits in prop::collection::vec(0u8..10, 64),
        ) {
            let line: String = shape.bytes().zip(&digits).map(|(b, d)| if b == b'9' { char::from(b'0' + d) } else { char::from(b) }).collect();
            let (found, taken) = all(&[line.clone(), line.clone()].concat());
            prop_assert_eq!(found, vec![by_library(&line); 2]);
            if !line.contains('e') && line.len() <= LENGTH && available() {
                let last = line.split_whitespace().last().unwrap().replace(['-', '.'], "");
                if last.len() < 16 {
                    prop_assert_eq!(taken, 1, "{}", line);
                }
            }
        }

        #[test]
        fn any_bytes_are_safe_and_rows_end_at_line_ends(
            bytes in prop::collection::vec(prop_oneof![Just(b'\n'), Just(b' '), Just(b'1'), Just(b'.'), any::<u8>()], 0..300),
        ) {
            let end = bytes.len().saturating_sub(AFTER);
            let (mut shapes, mut out) = (Shapes::new(), [Lanes::default(); 8]);
            let mut pos = 0;
            while pos < end {
                let (_, next) = rows(&bytes, pos, end, &mut shapes, &mut out);
                prop_assert!(next == pos || bytes[next - 1] == b'\n');
                prop_assert!(next <= end);
                pos = next + 1;
            }
        }
    }
}
