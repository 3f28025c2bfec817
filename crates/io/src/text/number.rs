//! Decimal numbers from bytes, with the result of the standard library bit for bit.
//!
//! A decimal with at most 2^53 as its digits and a power of ten within 10^±22 has both parts exact in an f64, so one
//! multiplication or division rounds correctly [Clinger1990]. Everything else goes to `str::parse`.

/// Longest number that is looked at; longer ones are not numbers but a broken file.
pub(super) const MAX_LENGTH: usize = 1000;

/// Powers of ten that are exact.
pub(super) const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// Largest integer up to which every integer is an f64.
pub(super) const EXACT: u64 = 1 << 53;

/// Whether `b` ends a number.
#[inline(always)]
fn ends(b: Option<&u8>) -> bool {
    matches!(b, None | Some(b' ' | b'\t' | b'\n' | b'\r'))
}

/// Adds the digits from `i` on to `mantissa`; returns where they end.
#[inline(always)]
fn digits(bytes: &[u8], mut i: usize, mantissa: &mut u64) -> usize {
    while let Some(b) = bytes.get(i) {
        let d = b.wrapping_sub(b'0');
        if d > 9 {
            break;
        }
        *mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(d));
        i += 1;
    }
    i
}

/// The number that starts at `start` and ends before a blank, a line end or the end of `bytes`, and where it ends.
/// `Err` holds the end of what is not a number. `nan`, `inf` and their kin are numbers, as for `str::parse`.
#[inline(always)]
pub(super) fn number(bytes: &[u8], start: usize) -> Result<(f64, usize), usize> {
    let mut i = start;
    let negative = bytes.get(i) == Some(&b'-');
    i += usize::from(negative);
    let mut mantissa = 0u64;
    let first = i;
    i = digits(bytes, i, &mut mantissa);
    let mut count = i - first;
    let mut exponent = 0i64;
    if bytes.get(i) == Some(&b'.') {
        let point = i + 1;
        i = digits(bytes, point, &mut mantissa);
        exponent = point as i64 - i as i64;
        count += i - point;
    }
    // 19 digits fit into u64 without wrapping
    if count == 0 || count > 19 || mantissa > EXACT {
        return by_library(bytes, start);
    }
    if !ends(bytes.get(i)) {
        let Some((e, end)) = exponent_at(bytes, i) else {
            return by_library(bytes, start);
        };
        exponent += e;
        i = end;
    }
    let value = mantissa as i64 as f64;
    let value = match exponent {
        0 => value,
        -22..0 => value / POWERS[-exponent as usize],
        1..=22 => value * POWERS[exponent as usize],
        _ => return by_library(bytes, start),
    };
    Ok((if negative { -value } else { value }, i))
}

/// A decimal exponent `e±n` of at most three digits that starts at `i`, and where it ends.
#[inline]
fn exponent_at(bytes: &[u8], i: usize) -> Option<(i64, usize)> {
    if !matches!(bytes.get(i), Some(b'e' | b'E')) {
        return None;
    }
    let sign = bytes.get(i + 1);
    let first = i + 1 + usize::from(matches!(sign, Some(b'-' | b'+')));
    let mut n = 0;
    let end = digits(bytes, first, &mut n);
    if end == first || end - first > 3 || !ends(bytes.get(end)) {
        return None;
    }
    Some((
        if sign == Some(&b'-') {
            -(n as i64)
        } else {
            n as i64
        },
        end,
    ))
}

#[cold]
#[inline(never)]
fn by_library(bytes: &[u8], start: usize) -> Result<(f64, usize), usize> {
    let rest = &bytes[start..bytes.len().min(start + MAX_LENGTH + 1)];
    let length = rest.iter().position(|b| ends(Some(b))).unwrap_or(rest.len());
    let end = start + length;
    if length > MAX_LENGTH {
        return Err(end);
    }
    let text = std::str::from_utf8(&bytes[start..end]).map_err(|_| end)?;
    text.parse().map(|x| (x, end)).map_err(|_| end)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn same_as_the_library(text: &str) {
        let ours = number(text.as_bytes(), 0).map(|(x, _)| x.to_bits()).ok();
        let library = text.parse::<f64>().map(f64::to_bits).ok();
        let nan = |x: Option<u64>| x.is_some_and(|b| f64::from_bits(b).is_nan());
        assert!(
            ours == library || (nan(ours) && nan(library)),
            "{text}: {ours:?} and {library:?}"
        );
    }

    #[test]
    fn corner_cases_agree_with_the_library() {
        for text in [
            "0",
            "-0",
            "-0.0",
            "+1",
            "1.",
            ".5",
            "-.5",
            ".",
            "-",
            "",
            "1e",
            "1e+",
            "1E5",
            "1e-5",
            "2.62E-01",
            "1e22",
            "1e23",
            "9007199254740993",
            "9007199254740992e22",
            "123456789012345678901234567890",
            "0.00000000000000000000000000000000000001",
            "1e400",
            "1e-400",
            "nan",
            "NaN",
            "inf",
            "-Infinity",
            "1.2.3",
            "1,5",
            "0x10",
            "1e0005",
            "1e9999",
            "--1",
            "1-",
            "4.9e-324",
            "2.2250738585072011e-308",
            "1d5",
            "٣",
        ] {
            same_as_the_library(text);
        }
    }

    #[test]
    fn a_number_ends_at_a_blank() {
        assert_eq!(number(b"12.5\t3", 0), Ok((12.5, 4)));
        assert_eq!(number(b"12.5e1\r\n", 0), Ok((125.0, 6)));
    }

    #[test]
    fn an_endless_number_is_refused() {
        let text = vec![b'1'; MAX_LENGTH + 5];
        assert_eq!(number(&text, 0), Err(MAX_LENGTH + 1));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn every_float_reads_back_bit_for_bit(bits in any::<u64>()) {
            let x = f64::from_bits(bits);
            same_as_the_library(&format!("{x}"));
            same_as_the_library(&format!("{x:e}"));
        }

        #[test]
        fn instrument_like_decimals_agree_with_the_library(text in "-?[0-9]{0,12}(\\.[0-9]{0,12})?([eE][-+]?[0-9]{1,4})?") {
            same_as_the_library(&text);
        }

        #[test]
        fn any_text_agrees_with_the_library(text in "[-+.eEnai0-9x]{0,12}") {
            same_as_the_library(&text);
        }
    }
}
