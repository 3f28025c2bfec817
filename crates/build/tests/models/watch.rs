//! A build is watched and stopped from another thread.

#![allow(
    clippy::unwrap_used,
    reason = "a test that cannot set up its material has failed"
)]

use std::thread;
use std::time::Duration;

use crate::common::{Noise, measure, thinned};
use gonio_bsdf::analytic::{Spectrum, WardGmd};
use gonio_build::{BuildError, BuildOptions, DataDriven, Stage, Watch};
use gonio_geom::Component::Reflection;
use gonio_scan::Measurement;

fn read() -> Measurement {
    let truth = WardGmd::isotropic(&Spectrum::photopic("rho", 0.4).unwrap(), 0.2).unwrap();
    let five = [10.0, 25.0, 40.0, 55.0, 70.0].map(|t| (t, 180.0));
    let mut data = measure(&truth, &five, &[Reflection], 86.0, Noise(0.01, 2e-4));
    thinned(&mut data, 4);
    data
}

fn watched(watch: &Watch) -> BuildOptions {
    BuildOptions {
        watch: watch.clone(),
        ..BuildOptions::default()
    }
}

#[test]
fn stages_come_one_after_the_other_and_steps_stay_within_their_total() {
    let watch = Watch::default();
    assert_eq!(watch.progress().stage, Stage::Waiting);
    let options = watched(&watch);
    let building = thread::spawn(move || DataDriven::build(&read(), &options));
    let mut seen = vec![watch.progress()];
    while !building.is_finished() {
        let now = watch.progress();
        if seen.last() != Some(&now) {
            seen.push(now);
        }
        thread::sleep(Duration::from_micros(200));
    }
    building.join().unwrap().unwrap();
    assert!(seen.iter().all(|p| p.done <= p.total), "{seen:?}");
    // The other sides and components have no readings: each ends with its first stage.
    let own = seen.iter().take_while(|p| p.stage != Stage::Choice);
    let stages: Vec<Stage> = own.map(|p| p.stage).collect();
    assert!(stages.is_sorted(), "{stages:?}");
    assert!(
        stages.contains(&Stage::LeaveOneOut) && stages.contains(&Stage::Bases),
        "{stages:?}"
    );
}

#[test]
fn a_build_that_is_stopped_ends_with_that_and_no_model() {
    let watch = Watch::default();
    watch.stop();
    let found = DataDriven::build(&read(), &watched(&watch));
    assert_eq!(found.map(|_| ()), Err(BuildError::Stopped));
    // In the midst of it too.
    let watch = Watch::default();
    let options = watched(&watch);
    let building = thread::spawn(move || DataDriven::build(&read(), &options));
    while watch.progress().stage < Stage::Bases && !building.is_finished() {
        thread::sleep(Duration::from_micros(200));
    }
    watch.stop();
    let found = building.join().unwrap();
    assert_eq!(found.map(|_| ()), Err(BuildError::Stopped));
}
