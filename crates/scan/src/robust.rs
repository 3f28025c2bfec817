//! Order statistics that one bad reading cannot move.

/// Factor from the median absolute value of a centred normal variable to its standard deviation.
const MAD_TO_SIGMA: f64 = 1.482_602_218_505_602;

/// Median of the values, which are reordered; `None` when there is none. NaN sorts last.
pub(crate) fn median(values: &mut [f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// The `q` quantile (`q` in `[0, 1]`, linear between order statistics) of the values, which are reordered.
pub(crate) fn quantile(values: &mut [f64], q: f64) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let position = q.clamp(0.0, 1.0) * (values.len() - 1) as f64;
    let lower = position.floor() as usize;
    let (_, &mut a, rest) = values.select_nth_unstable_by(lower, f64::total_cmp);
    let fraction = position - lower as f64;
    if fraction == 0.0 || rest.is_empty() {
        return Some(a);
    }
    let b = rest.iter().copied().fold(f64::INFINITY, f64::min);
    Some(a + fraction * (b - a))
}

/// Standard deviation of a zero-mean normal sample from the median of its absolute values, which are reordered.
pub(crate) fn sigma_about_zero(values: &mut [f64]) -> Option<f64> {
    for v in values.iter_mut() {
        *v = v.abs();
    }
    median(values).map(|m| m * MAD_TO_SIGMA)
}

/// Mean and standard deviation (n - 1) of the values; the deviation is 0 for one value.
pub(crate) fn mean_and_deviation(values: &[f64]) -> Option<(f64, f64)> {
    let n = values.len();
    if n == 0 {
        return None;
    }
    let mean = values.iter().sum::<f64>() / n as f64;
    if n == 1 {
        return Some((mean, 0.0));
    }
    let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
    Some((mean, (square / (n - 1) as f64).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_count_lies_between_the_middle_two() {
        assert_eq!(median(&mut [4.0, 1.0, 3.0, 2.0]), Some(2.5));
        assert_eq!(median(&mut []), None);
    }

    #[test]
    fn quantiles_interpolate() {
        assert_eq!(quantile(&mut [0.0, 10.0, 20.0, 30.0], 1.0), Some(30.0));
        assert_eq!(quantile(&mut [0.0, 10.0, 20.0, 30.0], 0.5), Some(15.0));
    }
}
