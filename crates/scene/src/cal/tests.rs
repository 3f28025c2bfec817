use proptest::prelude::*;

use super::*;

/// Value of `expression` in a file of these definitions, at the default point.
fn value_in(file: &str, expression: &str, reals: &[f64]) -> Result<f64, CalError> {
    let program = Program::parse(file, "test.cal")?;
    program.expression(expression)?.evaluate(&Point::default(), reals)
}

fn value(expression: &str) -> f64 {
    value_in("", expression, &[]).unwrap()
}

#[test]
fn operators_bind_as_in_radiance() {
    // `rcalc -n -e '$1=-2^2'` and so on.
    for (text, expected) in [
        ("-2^2", 4.0),
        ("2^-1", 0.5),
        ("2^3^2", 512.0),
        ("8-3-2", 3.0),
        ("16/4/2", 2.0),
        ("1+2*3", 7.0),
        ("-(1+2)*3", -9.0),
        ("3*-2", -6.0),
        ("+4-+4", 0.0),
        (".5+1.e1+2E-1", 10.7),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
}

#[test]
fn the_functions_of_the_language_give_what_rcalc_gives() {
    for (text, expected) in [
        ("select(0,5,6)", 2.0),
        ("select(1.6,5,6)", 6.0),
        ("min(3,1,2)", 1.0),
        ("max(3,1,7,2)", 7.0),
        ("if(0,1,2)", 2.0),
        ("if(1e-30,1,2)", 1.0),
        ("rand(3.7)", 0.461515926),
        ("floor(-1.5)+ceil(1.2)", 0.0),
        ("atan2(1,-1)/PI", 0.75),
        ("90*DEGREE", std::f64::consts::FRAC_PI_2),
        ("mod(-1,3)", 2.0),
        ("tri(1.25,1)", 0.75),
        ("frac(-.25)", 0.75),
        ("xor(1,-1)", 1.0),
        ("erf(.5)+erfc(.5)", 1.0),
        ("hermite(1,2,0,0,.5)", 1.5),
        ("bspline(1,1,1,1,.3)", 1.0),
        ("bezier(0,1/3,2/3,1,.3)", 0.3),
    ] {
        assert!((value(text) - expected).abs() < 1e-9, "{text} is {}", value(text));
    }
}

#[test]
fn what_has_no_value_is_zero_and_counted() {
    let program = Program::parse("zero = Px;", "test.cal").unwrap();
    for text in [
        "1/zero",
        "1/0",
        "log(zero)",
        "acos(2)",
        "sqrt(-1)",
        "(-8)^(1/3)",
        "zero^-1",
        "exp(1000)",
        "select(9,1)",
    ] {
        let value = program
            .expression(text)
            .unwrap()
            .evaluate(&Point::default(), &[])
            .unwrap();
        assert_eq!(value, 0.0, "{text}");
    }
    let faults = program.faults();
    assert_eq!((faults.divisions, faults.powers, faults.domains), (2, 2, 5));
    let huge = program.expression("1e308*10-1e308*10").unwrap();
    assert_eq!(huge.evaluate(&Point::default(), &[]).unwrap(), 0.0);
}

#[test]
fn only_the_chosen_branch_is_evaluated() {
    let file = "sum(n) : if(n - .5, n + sum(n - 1), 0);";
    assert_eq!(value_in(file, "sum(40)", &[]).unwrap(), 820.0);
    let program = Program::parse("", "test.cal").unwrap();
    program
        .expression("if(1, 2, 1/Px)")
        .unwrap()
        .evaluate(&Point::default(), &[])
        .unwrap();
    assert_eq!(program.faults(), Faults::default());
}

#[test]
fn functions_may_be_passed_to_functions() {
    assert_eq!(value("dot(D, N)"), -1.0);
    let file = "twice(f, x) = f(f(x)); again(g, x) = twice(g, x) + g(x); inc(x) = x + 1;";
    assert_eq!(value_in(file, "again(inc, 1)", &[]).unwrap(), 5.0);
    assert_eq!(value_in(file, "twice(sqrt, 16)", &[]).unwrap(), 2.0);
    let wrong = value_in(file, "twice(3, 16)", &[]).unwrap_err();
    assert!(
        matches!(wrong, CalError::NotAFunction { parameter: 1, .. }),
        "{wrong}"
    );
}

#[test]
fn names_are_looked_for_in_the_file_and_then_in_the_library() {
    assert_eq!(value_in("PI : 3; sq(x) = -x;", "PI + sq(1)", &[]).unwrap(), 2.0);
    assert_eq!(value_in("PI : 3;", "floor(10*PI`)", &[]).unwrap(), 31.0);
    assert_eq!(value_in("a`b.c = 4; d_1 = a`b.c;", "d_1", &[]).unwrap(), 4.0);
    assert_eq!(value_in("a = 1; a = 2;", "a", &[]).unwrap(), 2.0);
    let wrong = value_in("", "`PI", &[]).unwrap_err();
    assert!(matches!(wrong, CalError::Undefined { .. }), "{wrong}");
}

#[test]
fn real_arguments_and_the_variables_of_the_ray_are_at_hand() {
    assert_eq!(
        value_in("", "AC + A1*A2 + arg(3)", &[2.0, 3.0, 4.0]).unwrap(),
        13.0
    );
    let wrong = value_in("", "A4", &[2.0, 3.0, 4.0]).unwrap_err();
    assert_eq!(
        wrong.to_string(),
        "test.cal: real argument 4 is asked for, and the primitive has 3"
    );
    let at = Point {
        position: [1.0, 2.0, 3.0],
        normal: [0.0, -1.0, 0.0],
        axes: [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]],
        ..Point::default()
    };
    let program = Program::parse("", "test.cal").unwrap();
    for (text, expected) in [
        ("U", 1.0),
        ("V", 3.0),
        ("Jz", 6.0),
        ("Kx", 7.0),
        ("P(2)", 2.0),
        ("S*Rdot+T+Ts", 1.0),
    ] {
        assert_eq!(
            program.expression(text).unwrap().evaluate(&at, &[]).unwrap(),
            expected,
            "{text}"
        );
    }
}

#[test]
fn comments_nest_and_outputs_are_passed_over() {
    let file = "{ a { b } c }\n$1 = $2 + 1;;\nx = 1; { end } y(a,\n b) : a - b";
    assert_eq!(value_in(file, "x + y(3, 1)", &[]).unwrap(), 3.0);
    assert!(value_in("x = $1;", "x", &[]).is_err());
}

#[test]
fn errors_name_file_line_and_what_is_allowed() {
    for (file, expected) in [
        (
            "a = 1;\nb = 2 +;\n",
            "test.cal, line 2: found `;`, where a number, a name or `(` is allowed",
        ),
        (
            "a = 1 b = 2;",
            "test.cal, line 1: found `b`, where an operator, or `;` after a definition is allowed",
        ),
        (
            "f(x = 1;",
            "test.cal, line 1: found `=`, where `,` or `)` is allowed",
        ),
        (
            "\n\n{ a",
            "test.cal, line 3: found the end within a comment, where `}` is allowed",
        ),
        (
            "a = 1e;",
            "test.cal, line 1: found an exponent without digits, where a digit after `e` is allowed",
        ),
        (
            "a = 1 < 2;",
            "test.cal, line 1: found `<`, where an operator, or `;` after a definition is allowed",
        ),
        (
            "1 = a;",
            "test.cal, line 1: found the number 1, where a name to define, or `$` is allowed",
        ),
    ] {
        assert_eq!(
            Program::parse(file, "test.cal").unwrap_err().to_string(),
            expected
        );
    }
    let missing = value_in("a = b;\nc = 1 +\n mising(a);", "c", &[]).unwrap_err();
    assert_eq!(
        missing.to_string(),
        "test.cal, line 3: `mising` is not a function of the file or of the library"
    );
    let few = value_in("f(x, y) = x;", "f(1)", &[]).unwrap_err();
    assert_eq!(
        few.to_string(),
        "test.cal, line 1: `f` is given 1 arguments and needs 2"
    );
}

#[test]
fn a_definition_without_end_is_an_error_and_not_a_hang() {
    let endless = [
        ("a = a + 1;", "a"),
        ("f(x) = f(x + 1);", "f(1)"),
        ("f(g, x) = g(g, x) + 1;", "f(f, 1)"),
    ];
    for (file, text) in endless {
        assert!(
            matches!(value_in(file, text, &[]), Err(CalError::Depth { .. })),
            "{file}"
        );
    }
    let wide = "f(x) = if(x - .5, f(x - 1) + f(x - 1), 1);";
    assert!(matches!(value_in(wide, "f(60)", &[]), Err(CalError::Work { .. })));
    let deep = "(".repeat(5000) + "1" + &")".repeat(5000);
    assert!(matches!(value_in("", &deep, &[]), Err(CalError::Nesting { .. })));
    assert!(matches!(
        value_in("", &("2^".repeat(5000) + "1"), &[]),
        Err(CalError::Nesting { .. })
    ));
    assert!(matches!(
        value_in(&"{".repeat(5000), "1", &[]),
        Err(CalError::Nesting { .. })
    ));
}

#[test]
fn variables_are_evaluated_once_an_evaluation() {
    // Forty doublings would be 10^12 steps otherwise.
    let doublings: String = (0..40).map(|n| format!("a{} = a{n} + a{n};", n + 1)).collect();
    let total = value_in(&format!("a0 = Nz; {doublings}"), "a40", &[]).unwrap();
    assert_eq!(total, 2f64.powi(40));
}

#[test]
fn noise_vanishes_at_lattice_points_and_its_slopes_are_those_of_its_values() {
    let program = Program::parse("", "test.cal").unwrap();
    let at = |text: &str| {
        program
            .expression(text)
            .unwrap()
            .evaluate(&Point::default(), &[])
            .unwrap()
    };
    assert_eq!(at("noise3(3,-2,5)"), 0.0);
    for (name, shift) in [
        ("noise3x", "1e-5,0,0"),
        ("noise3y", "0,1e-5,0"),
        ("noise3z", "0,0,1e-5"),
    ] {
        let [x, y, z] = [0, 1, 2].map(|k| shift.split(',').nth(k).unwrap());
        let moved = at(&format!("noise3(3+{x},-2+{y},5+{z})"));
        let slope = (moved - at("noise3(3,-2,5)")) / 1e-5;
        assert!((slope - at(&format!("{name}(3,-2,5)"))).abs() < 1e-3, "{name}");
    }
}

#[test]
fn the_library_gives_what_rtrace_gives() {
    // A glow under a brightfunc of the formula, seen in a direction (tests/validation/scene_oracle.py).
    let mut wrong = Vec::new();
    for line in include_str!("../../tests/data/functions.txt").lines() {
        let (text, rest) = line.split_once(" | ").unwrap();
        let (direction, expected) = rest.split_once(" | ").unwrap();
        let d: Vec<f64> = direction.split(' ').map(|x| x.parse().unwrap()).collect();
        let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
        let at = Point {
            direction: [d[0] / length, d[1] / length, d[2] / length],
            ..Point::default()
        };
        let found = Program::parse("", "")
            .unwrap()
            .expression(text)
            .unwrap()
            .evaluate(&at, &[])
            .unwrap();
        let expected: f64 = expected.parse().unwrap();
        if (found - expected).abs() > 2e-6 * expected.abs().max(1.0) {
            wrong.push(format!("{text} at {direction} is {found}, not {expected}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A random expression and its value by Rust's own arithmetic.
fn formulas() -> impl Strategy<Value = (String, f64)> {
    let leaf = (0u32..1000).prop_map(|n| (format!("{}.25", n), n as f64 + 0.25));
    leaf.prop_recursive(6, 64, 4, |inner| {
        let pair = (inner.clone(), inner.clone());
        prop_oneof![
            pair.clone()
                .prop_map(|((s, x), (t, y))| (format!("({s} + {t})"), x + y)),
            pair.clone()
                .prop_map(|((s, x), (t, y))| (format!("({s}-{t})"), x - y)),
            pair.clone()
                .prop_map(|((s, x), (t, y))| (format!("({s}\n* {t})"), x * y)),
            pair.clone()
                .prop_map(|((s, x), (t, y))| (format!("min({s}, {t})"), x.min(y))),
            inner.clone().prop_map(|(s, x)| (format!("(-{s})"), -x)),
            inner
                .clone()
                .prop_map(|(s, x)| (format!("sin({s}{{ of }})"), x.sin())),
            (inner.clone(), inner.clone(), inner).prop_map(|((s, x), (t, y), (u, z))| {
                (format!("if({s},{t},{u})"), if x > 0.0 { y } else { z })
            }),
        ]
    })
}

proptest! {
    #[test]
    fn formulas_have_the_value_of_their_arithmetic((text, expected) in formulas()) {
        let found = value(&text);
        prop_assert!((found - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{} is {}, not {}", text, found, expected);
    }

    #[test]
    fn any_text_is_read_or_refused(text in "[-+*/^(){};:=,.`$a-fA-Z0-9 \n_é]{0,80}") {
        if let Ok(program) = Program::parse(&text, "any.cal") {
            for name in ["a", "b(1)", "c(a,b)", "skybright"] {
                if let Ok(expression) = program.expression(name)
                    && let Ok(value) = expression.evaluate(&Point::default(), &[1.0])
                {
                    prop_assert!(value.is_finite());
                }
            }
        }
        let _ = Program::parse("", "any.cal").unwrap().expression(&text);
    }
}
