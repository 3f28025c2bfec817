//! The benchmark of docs/validation/weights.md, reduced, on other seeds than the ones its shares were chosen on
//! (0 to 5, 100, 101, 200 and 201).

mod support;

use support::{GRADED, HARD, LOBES, MIXED, THETA_I, run};

const SEEDS: std::ops::Range<u64> = 300..304;

#[test]
fn complete_readings_with_a_hard_edged_patch_give_the_reflectance_within_the_limits() {
    let o = run(HARD, (88.0, 0.0), LOBES, &THETA_I, SEEDS, true);
    assert!(
        o.rms(2) <= 0.3 && o.max(2) <= 0.7,
        "rms {} max {}",
        o.rms(2),
        o.max(2)
    );
    assert!(o.coverage() >= 0.95, "coverage {}", o.coverage());
    assert!(o.median_u() <= 3.0 * o.rms(2));
    assert!(
        o.rms(2) < o.rms(1) && o.rms(1) < o.rms(0),
        "every order is worth its cost"
    );
}

#[test]
fn complete_readings_with_a_graded_patch_give_the_reflectance_within_the_limits() {
    let o = run(GRADED, (88.0, 0.0), LOBES, &THETA_I, SEEDS, true);
    assert!(
        o.rms(2) <= 0.15 && o.max(2) <= 0.5,
        "rms {} max {}",
        o.rms(2),
        o.max(2)
    );
    assert!(o.coverage() >= 0.95, "coverage {}", o.coverage());
    assert!(o.median_u() <= 3.0 * o.rms(2));
}

#[test]
fn readings_cut_at_82_degrees_give_the_reflectance_within_half_a_percent() {
    for patches in [HARD, GRADED] {
        let o = run(patches, (82.0, 0.0), MIXED, &THETA_I[..3], SEEDS, true);
        assert!(o.max(2) <= 0.5, "max {}", o.max(2));
        assert!(o.coverage() >= 0.95, "coverage {}", o.coverage());
        assert!(o.extrapolated.iter().all(|&x| x >= 0.0));
    }
}

#[test]
fn a_cut_through_the_lobe_is_covered_by_its_uncertainty() {
    let o = run(HARD, (82.0, 0.0), MIXED, &THETA_I[3..], SEEDS, true);
    assert!(o.rms(2) <= 0.5, "rms {}", o.rms(2));
    assert!(o.coverage() >= 0.95, "coverage {}", o.coverage());
}

#[test]
fn the_shadow_of_the_detector_is_filled_within_a_third_of_a_percent_rms_and_covered() {
    for hole in [4.0, 8.0] {
        let o = run(HARD, (88.0, hole), MIXED, &[8.0, 30.0], SEEDS, true);
        // The largest error is not bounded here: 0.73 % was found (8 degrees, next to the lobe), past the 0.7 % of
        // complete readings.
        assert!(o.rms(2) <= 0.3, "rms {}", o.rms(2));
        assert!(o.coverage() >= 0.95, "coverage {}", o.coverage());
    }
}

#[test]
fn without_the_incidence_the_uncertainty_still_covers() {
    let o = run(HARD, (82.0, 0.0), MIXED, &THETA_I[..3], SEEDS, false);
    assert!(o.coverage() >= 0.95, "coverage {}", o.coverage());
}
