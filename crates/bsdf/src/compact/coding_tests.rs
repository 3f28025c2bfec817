use super::*;

/// Smooth with a little noise; large where `k` is a multiple of 97.
fn wavy(shape: [usize; 4]) -> Vec<i32> {
    let n: usize = shape.iter().product();
    (0..n)
        .map(|k| {
            let t = k as f64;
            let noise = (1e4 * (0.37 * t).sin()).fract() * 4.0;
            let wild = if k % 97 == 0 {
                20_000.0 * (t * 1.7).sin()
            } else {
                0.0
            };
            (60.0 * (0.01 * t).sin() + noise + wild) as i32
        })
        .collect()
}

fn of(shape: [usize; 4], codes: &[i32]) -> Vec<u8> {
    let values: Vec<f64> = codes.iter().map(|c| f64::from(*c)).collect();
    encode(shape, &weights(shape, &values), codes)
}

#[test]
fn codes_come_back_as_they_were() {
    for shape in [
        [2, 1, 2, 2],
        [6, 1, 7, 8],
        [4, 5, 6, 9],
        [3, 4, 2, 4],
        [24, 1, 40, 17],
    ] {
        for codes in [
            wavy(shape),
            vec![0; shape.iter().product()],
            vec![-MOST; shape.iter().product()],
        ] {
            let bytes = of(shape, &codes);
            assert_eq!(decode(shape, &bytes).unwrap().1, codes, "{shape:?}");
        }
    }
    // alternately the largest and the least: what a prediction misses most
    let shape = [3, 2, 5, 7];
    let codes: Vec<i32> = (0..210).map(|k| if k % 2 == 0 { MOST } else { -MOST }).collect();
    assert_eq!(decode(shape, &of(shape, &codes)).unwrap().1, codes);
}

#[test]
fn even_codes_take_next_to_nothing_and_noise_its_entropy() {
    let shape = [20, 1, 30, 20];
    let even = of(shape, &[5; 12_000]);
    assert!(even.len() < 140, "{}", even.len());
    // eight values, alike often and independent: 3 bits each, unpredictable
    let mut state = 1_u64;
    let noise: Vec<i32> = (0..12_000)
        .map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 61) as i32
        })
        .collect();
    let bytes = of(shape, &noise).len();
    assert!((4_500..5_200).contains(&bytes), "{bytes}");
}

#[test]
fn a_stretch_with_slack_follows_its_neighbours_and_the_rest_stays_within_half_a_step() {
    let shape = [8, 1, 12, 10];
    let values: Vec<f64> = wavy(shape).iter().map(|c| 0.01 * f64::from(c % 50)).collect();
    let own = weights(shape, &values);
    let slack = |k: usize| if k < 480 { 0.5 } else { 8.0 };
    let codes = near(shape, &own, &values, 0.05, slack);
    for (k, (code, value)) in codes.iter().zip(&values).enumerate() {
        let off = (f64::from(*code) - value / 0.05).abs();
        assert!(off <= slack(k) + 1e-9, "{k}: {off}");
    }
    let strict = near(shape, &own, &values, 0.05, |_| 0.5);
    let (loose, strict) = (encode(shape, &own, &codes), encode(shape, &own, &strict));
    assert!(
        4 * loose.len() < 3 * strict.len(),
        "{} {}",
        loose.len(),
        strict.len()
    );
}

#[test]
fn bytes_of_another_table_are_refused() {
    let shape = [6, 1, 7, 8];
    let bytes = of(shape, &wavy(shape));
    assert!(decode([2, 1, 2, 2], &bytes).is_err());
    assert!(decode(shape, &bytes[..10]).is_err());
    let more: Vec<u8> = bytes.iter().copied().chain([7; 40]).collect();
    assert!(decode(shape, &more).is_err());
}
