use super::*;

/// What RADIANCE 6's programs print (tests/validation/scene_oracle.py): 1e-5 of a number, or one in its last printed digit.
#[test]
fn every_number_is_the_one_that_radiance_prints() {
    let mut wrong = Vec::new();
    for line in include_str!("../../tests/data/skies.txt").lines() {
        let (command, expected) = line.split_once(" | ").unwrap();
        let words: Vec<_> = command.split(' ').collect();
        let text = match words[0] {
            "gensky" => gensky(&words[1..]),
            _ => gendaylit(&words[1..]),
        };
        let text = text.unwrap();
        let printed = text
            .lines()
            .filter(|l| !l.starts_with('#'))
            .flat_map(str::split_whitespace)
            .collect::<Vec<_>>();
        let expected = expected.split(' ').collect::<Vec<_>>();
        let same = printed.len() == expected.len() && printed.iter().zip(&expected).all(|(a, b)| near(a, b));
        if !same {
            wrong.push(format!(
                "{command}\n  {}\n  {}",
                printed.join(" "),
                expected.join(" ")
            ));
        }
    }
    assert!(wrong.is_empty(), "{} differ:\n{}", wrong.len(), wrong.join("\n"));
}

fn near(a: &str, b: &str) -> bool {
    let (Ok(x), Ok(y)) = (a.parse::<f64>(), b.parse::<f64>()) else {
        return a == b;
    };
    let mantissa = b.split('e').next().unwrap_or(b);
    let decimals = mantissa
        .split_once('.')
        .map_or(0, |(_, digits)| digits.len() as i32);
    let exponent = b
        .split_once('e')
        .map_or(0, |(_, digits)| digits.parse::<i32>().unwrap());
    (x - y).abs() <= (1e-5 * y.abs()).max(1.001 * 10f64.powi(exponent - decimals))
}

#[test]
fn a_bad_word_is_named() {
    for (words, expected) in [
        (
            vec!["13", "1", "12"],
            "gensky: the month is `13`; it must be 1 to 12, or -ang with two angles",
        ),
        (
            vec!["6", "21"],
            "gensky: the hour is missing; it must be an hour such as 14.5, 14:30, 14:30CET, or +14.5 for solar time",
        ),
        (
            vec!["6", "21", "12XYZ"],
            "gensky: the hour is `12XYZ`; it must be an hour such as 14.5, 14:30, 14:30CET, or +14.5 for solar time",
        ),
        (
            vec!["6", "21", "12", "-g", "x"],
            "gensky: the value of -g is `x`; it must be a number",
        ),
        (
            vec!["6", "21", "12", "-q"],
            "gensky: unknown option `-q`; the options are -s +s -c -u -i +i, and with a value -y -g -b -B -t -r -R -a -o -m",
        ),
        (
            vec!["-ang", "nan", "0"],
            "gensky: the altitude of -ang is `nan`; it must be a number",
        ),
    ] {
        assert_eq!(gensky(&words).unwrap_err().to_string(), expected);
    }
    let missing = gendaylit(&["6", "21", "12", "-W", "600"]).unwrap_err();
    assert_eq!(
        missing.to_string(),
        "gendaylit: the second value of -W is missing; it must be a number"
    );
    let output = gendaylit(&["6", "21", "12", "-O", "3"]).unwrap_err();
    assert_eq!(
        output.to_string(),
        "gendaylit: the value of -O is `3`; it must be 0 (visible), 1 (solar) or 2 (luminance)"
    );
    let colour = gendaylit(&["6", "21", "12", "-C"]).unwrap_err();
    assert!(colour.to_string().contains("unknown option `-C`"), "{colour}");
}
