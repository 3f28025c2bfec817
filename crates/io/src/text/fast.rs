//! Rows of ordinary decimals without a branch a digit.
//!
//! One comparison of 64 bytes gives a bit mask of what is not a digit; its set bits are where numbers end, have their
//! point or their exponent. The digits of a number, its point squeezed out, are then converted eight at a time by
//! three multiplications [Lemire2021 uses the same step]. Whatever is not ordinary (a line of more than 64 bytes, more than 16 digits, words,
//! faults) is left to the careful parser, so this file decides speed and never meaning.

use super::number::{EXACT, POWERS};

/// Bytes readable before the first byte of a row.
pub(super) const BEFORE: usize = 32;
/// Bytes readable from the first byte of a row on.
pub(super) const AFTER: usize = 64;

/// A row with its surroundings.
type Window = [u8; BEFORE + AFTER];

/// Masks of the last `n` of eight bytes (the most significant ones, little-endian).
const LAST: [u64; 9] = {
    let mut masks = [0; 9];
    let mut n = 1;
    while n < 9 {
        masks[n] = u64::MAX << (64 - 8 * n);
        n += 1;
    }
    masks
};

/// Bit `i` is set where byte `i` of the row is not a decimal digit.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn no_digits(window: &Window) -> u64 {
    use std::arch::x86_64::{
        __m128i, _mm_cmplt_epi8, _mm_loadu_si128, _mm_movemask_epi8, _mm_set1_epi8, _mm_sub_epi8,
    };
    let mut mask = 0;
    for (k, chunk) in window[BEFORE..].chunks_exact(16).enumerate() {
        // SAFETY: SSE2 belongs to every x86_64 target, and `chunk` has the 16 bytes that the unaligned load reads.
        let digits = unsafe {
            let bytes = _mm_loadu_si128(chunk.as_ptr().cast::<__m128i>());
            // '0'..='9' become the ten smallest signed bytes
            let shifted = _mm_sub_epi8(bytes, _mm_set1_epi8((b'0' as i8).wrapping_add(i8::MIN)));
            _mm_movemask_epi8(_mm_cmplt_epi8(shifted, _mm_set1_epi8(i8::MIN + 10)))
        };
        mask |= u64::from(digits as u16) << (16 * k);
    }
    !mask
}

/// Bit `i` is set where byte `i` of the row is not a decimal digit.
#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
fn no_digits(window: &Window) -> u64 {
    const HIGH: u64 = 0x8080_8080_8080_8080;
    let mut mask = 0;
    for k in 0..8 {
        let digits = load(window, 8 * k as isize) ^ 0x3030_3030_3030_3030;
        let other = (((digits & !HIGH) + 0x7676_7676_7676_7676) | digits) & HIGH;
        // gathers the high bit of each byte into the top byte
        mask |= (other >> 7).wrapping_mul(0x0102_0408_1020_4080) >> 56 << (8 * k);
    }
    mask
}

/// Eight bytes of the row from byte `at` on, which may lie before the row.
#[inline(always)]
fn load(window: &Window, at: isize) -> u64 {
    let start = (BEFORE as isize + at) as usize;
    let mut bytes = [0; 8];
    bytes.copy_from_slice(&window[start..start + 8]);
    u64::from_le_bytes(bytes)
}

/// The number that eight digits (values 0 to 9, first digit in the lowest byte) spell.
#[inline(always)]
fn eight_digits(digits: u64) -> u64 {
    const PAIRS: u64 = 0x0000_00ff_0000_00ff;
    let twos = digits.wrapping_mul(10).wrapping_add(digits >> 8);
    let high = (twos & PAIRS).wrapping_mul(100 + (1_000_000 << 32));
    let low = ((twos >> 16) & PAIRS).wrapping_mul(1 + (10_000 << 32));
    high.wrapping_add(low) >> 32
}

/// The decimal number of the digits that end before `end`, `fraction` of them after a point where there is one.
#[inline(always)]
fn mantissa(window: &Window, end: usize, count: usize, fraction: usize, point: bool) -> u64 {
    const VALUES: u64 = 0x0f0f_0f0f_0f0f_0f0f;
    let end = end as isize;
    // digits after the point as they stand, digits before it one byte later
    let after = if point { LAST[fraction.min(8)] } else { u64::MAX };
    let joined = (load(window, end - 8) & after) | (load(window, end - 9) & !after);
    let low = eight_digits(joined & LAST[count.min(8)] & VALUES);
    if count <= 8 {
        return low;
    }
    let after = if point {
        LAST[fraction.max(8) - 8]
    } else {
        u64::MAX
    };
    let joined = (load(window, end - 16) & after) | (load(window, end - 17) & !after);
    eight_digits(joined & LAST[count - 8] & VALUES) * 100_000_000 + low
}

/// An integer below 2^52 as f64. The bits are put into the mantissa of 2^52, which is then subtracted: unlike the
/// processor's own conversion this does not wait for the number before it.
#[inline(always)]
fn exact(integer: u64) -> f64 {
    const TWO_52: u64 = 0x4330_0000_0000_0000;
    f64::from_bits(integer | TWO_52) - f64::from_bits(TWO_52)
}

/// Puts the numbers of the row into `numbers` and returns the bytes the row takes, line end included; `None` leaves the
/// row to the careful parser.
#[inline(always)]
pub(super) fn row<const N: usize>(window: &Window, numbers: &mut [f64; N]) -> Option<usize> {
    let byte = |i: usize| window[BEFORE + i];
    // The marks that are not used yet. They are taken off one by one, which is all that a number has to wait for
    // from the one before it.
    let mut marks = no_digits(window);
    let mut pos = 0;
    for (column, x) in numbers.iter_mut().enumerate() {
        while pos < AFTER && matches!(byte(pos), b' ' | b'\t') {
            pos += 1;
            marks &= marks.wrapping_sub(1);
        }
        if pos >= AFTER {
            return None;
        }
        let negative = byte(pos) == b'-';
        if negative {
            pos += 1;
            marks &= marks.wrapping_sub(1);
        }
        let mut end = marks.trailing_zeros() as usize;
        let mut count = end.wrapping_sub(pos);
        let mut fraction = 0;
        let point = end < AFTER && byte(end) == b'.';
        if point {
            marks &= marks.wrapping_sub(1);
            let first = end + 1;
            end = marks.trailing_zeros() as usize;
            fraction = end - first;
            count += fraction;
        }
        if end >= AFTER || count == 0 || count > 16 {
            return None;
        }
        let mantissa = mantissa(window, end, count, fraction, point);
        marks &= marks.wrapping_sub(1);
        let mut exponent = -(fraction as isize);
        if matches!(byte(end), b'e' | b'E') {
            let sign = end + 1;
            if sign >= AFTER {
                return None;
            }
            let minus = byte(sign) == b'-';
            let signed = minus || byte(sign) == b'+';
            if signed {
                marks &= marks.wrapping_sub(1);
            }
            let first = sign + usize::from(signed);
            end = marks.trailing_zeros() as usize;
            let digits = end.wrapping_sub(first);
            if end >= AFTER || digits == 0 || digits > 2 {
                return None;
            }
            let tens = if digits == 2 {
                isize::from(byte(first) - b'0') * 10
            } else {
                0
            };
            let e = tens + isize::from(byte(end - 1) - b'0');
            exponent += if minus { -e } else { e };
            marks &= marks.wrapping_sub(1);
        }
        if mantissa >= EXACT / 2 {
            return None;
        }
        let value = exact(mantissa);
        let value = match exponent {
            -22..=0 => value / POWERS[-exponent as usize],
            1..=22 => value * POWERS[exponent as usize],
            _ => return None,
        };
        *x = if negative { -value } else { value };
        match byte(end) {
            b' ' | b'\t' => pos = end + 1,
            b'\n' | b'\r' if column == N - 1 => pos = end,
            _ => return None,
        }
    }
    if pos >= AFTER {
        return None;
    }
    match byte(pos) {
        b'\n' => Some(pos + 1),
        b'\r' if pos + 1 < AFTER && byte(pos + 1) == b'\n' => Some(pos + 2),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The row as the careful way reads it: split at blanks, parsed by the library.
    fn by_library<const N: usize>(line: &str) -> Option<[u64; N]> {
        let words: Vec<&str> = line.split([' ', '\t']).filter(|w| !w.is_empty()).collect();
        let numbers: Option<Vec<u64>> = words
            .iter()
            .map(|w| w.parse::<f64>().ok().map(f64::to_bits))
            .collect();
        numbers?.try_into().ok()
    }

    fn fast<const N: usize>(line: &str, before: u8) -> Option<([u64; N], usize)> {
        let mut window = [before; BEFORE + AFTER];
        window[BEFORE..BEFORE + line.len()].copy_from_slice(line.as_bytes());
        let mut numbers = [0.0; N];
        row(&window, &mut numbers).map(|n| (numbers.map(f64::to_bits), n))
    }

    #[test]
    fn ordinary_rows_are_taken() {
        for line in [
            "1 2 3\n",
            "80.0258\t203.9620\t0.26200\r\n",
            "  -1.5  2e3 .25\n",
            "1.234567e-01 123456789012345.6 5.\n",
        ] {
            let (numbers, used) = fast::<3>(line, b'7').unwrap();
            assert_eq!(used, line.len());
            assert_eq!(Some(numbers), by_library(line.trim()), "{line}");
        }
    }

    #[test]
    fn rows_that_are_not_ordinary_are_left() {
        for line in [
            "1 2\n",
            "1 2 3 4\n",
            "1 2 nan\n",
            "#1 2 3\n",
            "\n",
            "1 2 1e400\n",
            "1 2 3e\n",
            "1 2 3",
            "1 2 --3\n",
            "1 2 .\n",
        ] {
            assert_eq!(fast::<3>(line, b'7'), None, "{line:?}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(50_000))]

        #[test]
        fn what_is_taken_has_the_value_of_the_library(
            line in "-?[0-9]{0,9}(\\.[0-9]{0,9})?([eE][-+]?[0-9]{1,3})?[ \t]{1,3}-?[0-9]{0,4}(\\.[0-9]{0,13})?[ \t]-?[0-9]{1,17}[ \t]?",
            before: u8,
        ) {
            prop_assume!(line.len() < AFTER);
            if let Some((numbers, used)) = fast::<3>(&format!("{line}\n"), before) {
                prop_assert_eq!(used, line.len() + 1);
                prop_assert_eq!(Some(numbers), by_library(&line));
            }
        }

        #[test]
        fn any_text_has_the_value_of_the_library_or_is_left(line in "[-+.eE0-9 \tx]{0,40}", before: u8) {
            if let Some((numbers, _)) = fast::<2>(&format!("{line}\n"), before) {
                prop_assert_eq!(Some(numbers), by_library(&line));
            }
        }

        #[test]
        fn any_bytes_are_safe(bytes in prop::collection::vec(any::<u8>(), BEFORE + AFTER)) {
            let window: Window = bytes.try_into().unwrap();
            let _ = row(&window, &mut [0.0; 3]);
        }

        #[test]
        fn plain_readings_are_always_taken(theta in 0u32..1_800_000, phi in 0u32..3_600_000, value in 0.0..10.0f64) {
            let line = format!("{:.4}\t{:.4}\t{value:.6e}", f64::from(theta) / 1e4, f64::from(phi) / 1e4);
            let taken = fast::<3>(&format!("{line}\n"), b'\n');
            prop_assert_eq!(taken.map(|t| t.0), by_library(&line));
        }
    }
}
