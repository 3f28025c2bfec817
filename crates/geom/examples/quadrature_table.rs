//! Prints the tables of docs/validation/weights.md: errors of hemispherical integrals against known reflectances.
//!
//! `cargo run --release -p gonio-geom --example quadrature_table > docs/validation/weights.md`
#![allow(clippy::print_stdout, clippy::unwrap_used, missing_docs, unreachable_pub)]

#[path = "../tests/support/mod.rs"]
mod support;

use support::{GRADED, HARD, LOBES, MIXED, Outcome, Patch, THETA_I, run};

const SEEDS: std::ops::Range<u64> = 0..5;

fn row(name: &str, o: &Outcome) {
    println!(
        "| {name} | {} | {:.3} ({:.2}) | {:.3} ({:.2}) | **{:.3} ({:.2})** | {:.3} | {:.1} |",
        o.errors.len(),
        o.rms(0),
        o.max(0),
        o.rms(1),
        o.max(1),
        o.rms(2),
        o.max(2),
        o.median_u(),
        100.0 * o.coverage(),
    );
}

/// Name, patches, data to, shadow, lobes, incidences, incidence known.
type Case<'a> = (
    &'a str,
    &'a [Patch],
    f64,
    f64,
    &'a [support::Lobe],
    &'a [f64],
    bool,
);

fn table(cases: &[Case<'_>]) {
    println!("| readings | cases | order 0 | order 1 | order 2 | median u | covered % |");
    println!("|---|---|---|---|---|---|---|");
    for &(name, patches, theta_max, hole, lobes, theta_i, known) in cases {
        row(
            name,
            &run(patches, (theta_max, hole), lobes, theta_i, SEEDS, known),
        );
    }
    println!();
}

fn main() {
    println!(
        "# Hemispherical integrals: error and stated uncertainty

Made by `cargo run --release -p gonio-geom --example quadrature_table > docs/validation/weights.md`.

Directional-hemispherical reflectance of known lobes from noise-free readings. Errors are percent of the truth, rms over the
cases and largest in brackets; `median u` is the median stated standard uncertainty `u_quadrature`, `covered` the share of
cases with |error| ≤ 2 u. Order 0 is Σ Ω⊥ f with exact Voronoi cells, order 1 adds gradients, order 2 (the one
gonio uses) second derivatives.

Paths: rings 3° apart with a reading every 0.2°, random phase, 0.02° jitter, and a refined patch about the mirror direction: *hard
edge* = lines 0.5° apart to 8°; *graded* = 0.5° to 5°, 1° to 9°, 2° to 15°. Incidence 8, 30, 60, 75°, five
seeds.

## Complete data (to 88°)

Lobes: Lambert, GMD α = 0.3, 0.1, 0.05, 0.03, 0.015. Limits: rms 0.3 % (largest 0.7 %) hard edge, 0.15 % (0.5 %) graded.
"
    );
    table(&[
        ("hard edge", HARD, 88.0, 0.0, LOBES, &THETA_I, true),
        ("graded", GRADED, 88.0, 0.0, LOBES, &THETA_I, true),
    ]);
    println!(
        "## Missing data, incidence known

Lobes: Lambert, GMD 0.3, 0.1, 0.05, 0.4 Lambert + 0.5 GMD 0.12, 0.3 Lambert + 0.5 GGX 0.15, GGX 0.3. Limit with data to 82°: 0.5 % rms.
At 75° incidence a cut at 82° goes through the lobe itself; those rows stand alone.
"
    );
    let usual = &THETA_I[..3];
    let grazing = &THETA_I[3..];
    table(&[
        (
            "hard edge, to 82°, incidence ≤ 60°",
            HARD,
            82.0,
            0.0,
            MIXED,
            usual,
            true,
        ),
        (
            "graded, to 82°, incidence ≤ 60°",
            GRADED,
            82.0,
            0.0,
            MIXED,
            usual,
            true,
        ),
        (
            "hard edge, to 82°, incidence 75°",
            HARD,
            82.0,
            0.0,
            MIXED,
            grazing,
            true,
        ),
        (
            "graded, to 82°, incidence 75°",
            GRADED,
            82.0,
            0.0,
            MIXED,
            grazing,
            true,
        ),
        ("graded, to 86°", GRADED, 86.0, 0.0, MIXED, &THETA_I, true),
        (
            "hard edge, shadow of 4° radius",
            HARD,
            88.0,
            4.0,
            MIXED,
            &THETA_I,
            true,
        ),
        (
            "hard edge, shadow of 8° radius",
            HARD,
            88.0,
            8.0,
            MIXED,
            &THETA_I,
            true,
        ),
        (
            "graded, shadow of 8° radius",
            GRADED,
            88.0,
            8.0,
            MIXED,
            &THETA_I,
            true,
        ),
    ]);
    println!("## Missing data, incidence not handed over\n");
    table(&[
        (
            "hard edge, to 82°, incidence ≤ 60°",
            HARD,
            82.0,
            0.0,
            MIXED,
            usual,
            false,
        ),
        (
            "graded, to 82°, incidence 75°",
            GRADED,
            82.0,
            0.0,
            MIXED,
            grazing,
            false,
        ),
        (
            "hard edge, shadow of 8° radius",
            HARD,
            88.0,
            8.0,
            MIXED,
            &THETA_I,
            false,
        ),
    ]);
}
