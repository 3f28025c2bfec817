//! The virtual integrating sphere against the balance of its flux and against integrals of the model.
//!
//! Comparisons allow four standard errors of 32 replicates: beyond them lie 4 of 10 000.
#![allow(clippy::unwrap_used, missing_docs)]

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use gonio_bsdf::analytic::{Sum, family};
use gonio_bsdf::{Bsdf, Channel, RadianceMaterial};
use gonio_instrument::InstrumentError;
use gonio_instrument::sphere::{
    Arrangement, Baffle, Detector, Effort, Filling, Method, Place, Plan, PortName, Source, Sphere,
    SphereResult, State, Trap, measure, read,
};

fn place(theta: f64, phi: f64, diameter: f64) -> Place {
    Place {
        theta: theta.to_radians(),
        phi: phi.to_radians(),
        radius: 0.5e-3 * diameter,
    }
}

/// A sphere of 300 mm.
fn plan(arrangement: Arrangement) -> Plan {
    Plan {
        arrangement,
        radius: 0.15,
        wall: 0.97,
        standard: 0.98,
        plug: 0.97,
        theta_i: f64::to_radians(8.0),
        phi_i: 0.0,
        beam_radius: 0.005,
        divergence: 0.0,
        sample_radius: 0.0125,
        entrance_radius: 0.0125,
        trap: Some(Trap {
            radius: 0.0175,
            residual: 0.0,
        }),
        detector: Detector {
            place: place(90.0, 90.0, 25.0),
            reflectance: 0.05,
            view: FRAC_PI_2,
        },
        comparison: Some(place(110.0, 270.0, 25.0)),
        auxiliary: Some(place(60.0, 200.0, 12.0)),
        baffles: vec![Baffle {
            between: [PortName::Sample, PortName::Detector],
            at: 0.6,
            radius: 0.03,
            reflectance: 0.97,
        }],
    }
}

fn model(parts: &[(&str, &[f64])]) -> Arc<dyn Bsdf> {
    let parts = parts.iter().map(|(name, values)| {
        let values = [(Channel::Photopic, values.to_vec())];
        family(name).unwrap().model(&values).unwrap()
    });
    Arc::new(Sum::new(parts.collect()).unwrap())
}

fn plastic(diffuse: f64, specular: f64, alpha: f64) -> Arc<dyn Bsdf> {
    model(&[("lambert", &[diffuse]), ("ward-gmd", &[specular, alpha])])
}

fn measured(plan: Plan, model: &Arc<dyn Bsdf>, method: Method, rays: u32) -> (Sphere, SphereResult) {
    let sphere = Sphere::new(plan).unwrap();
    let effort = Effort { rays, seed: 3 };
    let found = measure(&sphere, model, 0, method, &effort, &Default::default(), &|_| {});
    let found = found.unwrap().unwrap();
    (sphere, found)
}

fn reading(sphere: &Sphere, state: State, source: Source, rays: u32) -> (f64, f64) {
    let effort = Effort { rays, seed: 5 };
    let found = read(sphere, &[(state, source)], &effort, &Default::default(), &|_| {});
    let found = found.unwrap().unwrap();
    (found[0].value(), found[0].error())
}

#[test]
fn the_multiplier_agrees_with_its_formula_within_half_a_percent() {
    // Wall reflectance, diameters of sample, comparison and detector port, mm.
    for (wall, ports) in [
        (0.80, [25.0, 25.0, 25.0]),
        (0.95, [25.0, 25.0, 25.0]),
        (0.98, [25.0, 25.0, 25.0]),
        (0.98, [60.0, 50.0, 30.0]),
        (0.90, [100.0, 70.0, 60.0]),
    ] {
        let mut plan = plan(Arrangement::Reflection);
        (plan.wall, plan.plug) = (wall, wall);
        plan.baffles.clear();
        plan.sample_radius = 0.5e-3 * ports[0];
        plan.comparison = Some(place(110.0, 270.0, ports[1]));
        plan.detector.place = place(90.0, 90.0, ports[2]);
        let sphere = Sphere::new(plan).unwrap();
        for (trap_open, sample) in [(true, 0.0), (false, 0.98)] {
            let state = State {
                sample: Filling::Lambert(sample),
                comparison: Filling::Open,
                trap_open,
            };
            let (flux, error) = reading(&sphere, state, Source::Auxiliary, 1 << 18);
            let fraction = sphere.port(PortName::Detector).unwrap().fraction();
            let (found, u) = (flux / fraction, error / fraction);
            let trap = if trap_open { 0.0 } else { wall };
            let filled = [
                (PortName::Sample, sample),
                (PortName::Trap, trap),
                (PortName::Detector, 0.05),
            ];
            let wanted = sphere.multiplier(wall, &filled);
            assert!(u < 1.5e-3 * wanted, "{u} {wanted}");
            assert!(
                (found / wanted - 1.0).abs() < 5e-3,
                "{wall} {ports:?} {trap_open}: {found} ± {u}, {wanted}"
            );
        }
    }
}

/// The light through the trap is that of the model within 2 %, and the total within half a percent, both within four
/// standard errors and what flat ports and baffles leave (half a percent).
fn close(sphere: &Sphere, found: &SphereResult, material: &Arc<dyn Bsdf>) {
    let near = |found: gonio_instrument::sphere::Estimate, wanted: f64, most: f64| {
        let off = (found.value - wanted).abs();
        let allowed = (most * wanted).min(4.0 * found.u + 0.01 * wanted);
        assert!(off < allowed, "{found:?}, {wanted}");
    };
    let port = sphere.cone().unwrap().integral(material.as_ref(), 0);
    let whole = sphere.whole(material.as_ref(), 0);
    let share = found.diffuse_share.unwrap();
    near(found.port.unwrap(), port, 0.02);
    near(
        found.regular.unwrap(),
        (port - share * whole) / (1.0 - share),
        0.02,
    );
    near(found.total, whole, 0.01);
}

#[test]
fn a_procedure_with_correction_finds_what_a_plastic_sends_through_the_trap_within_two_percent() {
    for (wall, trap, method, material) in [
        (0.97, 35.0, Method::Comparison, plastic(0.4, 0.05, 0.01)),
        (0.90, 35.0, Method::Comparison, plastic(0.05, 0.04, 0.03)),
        (0.98, 60.0, Method::Comparison, plastic(0.6, 0.2, 0.1)),
        (0.97, 50.0, Method::Auxiliary, plastic(0.4, 0.15, 0.06)),
    ] {
        let mut plan = plan(Arrangement::Reflection);
        (plan.wall, plan.plug) = (wall, wall);
        plan.trap = Some(Trap {
            radius: 0.5e-3 * trap,
            residual: 0.0,
        });
        let (sphere, found) = measured(plan, &material, method, 1 << 17);
        close(&sphere, &found, &material);
    }
}

#[test]
fn a_procedure_finds_regular_and_diffuse_transmittance() {
    let pane = model(&[
        ("lambert", &[0.2]),
        ("lambert-transmission", &[0.3]),
        ("bounded-transmission-lobe", &[0.3, 0.03]),
    ]);
    let mut plan = plan(Arrangement::Transmission);
    plan.comparison = None;
    let (sphere, found) = measured(plan, &pane, Method::Auxiliary, 1 << 17);
    close(&sphere, &found, &pane);
}

#[test]
fn glass_sends_all_it_transmits_into_the_trap() {
    let glass = RadianceMaterial::from_arguments("glass", &[], &[0.9; 3])
        .unwrap()
        .unwrap();
    let glass: Arc<dyn Bsdf> = Arc::from(glass.bsdf().unwrap());
    let mut plan = plan(Arrangement::Transmission);
    plan.comparison = None;
    let (sphere, found) = measured(plan, &glass, Method::Auxiliary, 1 << 14);
    let whole = sphere.whole(glass.as_ref(), 0);
    assert!(found.diffuse.unwrap().value == 0.0, "{found:?}");
    assert!(
        (found.port.unwrap().value - whole).abs() < 4.0 * found.total.u + 1e-3 * whole,
        "{found:?} {whole}"
    );
}

#[test]
fn substitution_reads_as_much_too_little_as_the_multipliers_say() {
    let grey = model(&[("lambert", &[0.3])]);
    for sample in [25.0, 50.0] {
        let mut plan = plan(Arrangement::Reflection);
        plan.sample_radius = 0.5e-3 * sample;
        let (sphere, found) = measured(plan, &grey, Method::Substitution, 1 << 16);
        let with = |rho: f64| {
            let filled = [
                (PortName::Sample, rho),
                (PortName::Trap, 0.97),
                (PortName::Comparison, 0.97),
                (PortName::Detector, 0.05),
            ];
            sphere.multiplier(1.0, &filled)
        };
        let wanted = 0.3 * with(0.3) / with(0.98);
        let total = found.plain_total;
        assert!(wanted < 0.29, "{wanted}");
        assert!(
            (total.value - wanted).abs() < 4.0 * total.u + 2e-3 * wanted,
            "{total:?} {wanted}"
        );
    }
}

#[test]
fn a_lambertian_sample_has_no_regular_part() {
    let white = model(&[("lambert", &[0.8])]);
    let (_, found) = measured(plan(Arrangement::Reflection), &white, Method::Comparison, 1 << 15);
    let regular = found.regular.unwrap();
    assert!(regular.value.abs() < 4.0 * regular.u, "{regular:?}");
    assert!(found.port.unwrap().value > 0.0);
}

#[test]
fn without_a_baffle_the_detector_sees_the_sample_and_the_total_is_wrong() {
    // A wide lobe that reaches the detector beside the trap at once.
    let lobe = model(&[("ward-gmd", &[0.5, 0.15])]);
    let mut open = plan(Arrangement::Reflection);
    open.detector.place = place(34.0, 180.0, 25.0);
    open.baffles.clear();
    let shaded = Plan {
        baffles: vec![Baffle {
            between: [PortName::Sample, PortName::Detector],
            at: 0.85,
            radius: 0.014,
            reflectance: 0.97,
        }],
        ..open.clone()
    };
    let total = |plan| measured(plan, &lobe, Method::Comparison, 1 << 14).1.total.value;
    let (without, with) = (total(open), total(shaded));
    assert!(without > 1.2 * with, "{without} {with}");
}

#[test]
fn a_turned_sample_sends_its_lobe_elsewhere() {
    let brushed = model(&[("ward-gmd-anisotropic", &[0.5, 0.02, 0.2, 0.0])]);
    let mut shares = Vec::new();
    for phi_i in [0.0, FRAC_PI_2] {
        let mut plan = plan(Arrangement::Reflection);
        plan.phi_i = phi_i;
        let (sphere, found) = measured(plan, &brushed, Method::Comparison, 1 << 15);
        let wanted = sphere.cone().unwrap().integral(brushed.as_ref(), 0);
        let port = found.port.unwrap();
        assert!(
            (port.value - wanted).abs() < 4.0 * port.u + 0.01 * wanted,
            "{port:?} {wanted}"
        );
        shares.push(wanted);
    }
    assert!((shares[0] - shares[1]).abs() > 1e-4, "{shares:?}");
}

#[test]
fn the_share_of_diffuse_light_in_the_trap_is_that_of_its_disk() {
    // A small spot: the view factor of the trap's disk by its solid angle's boundary, against the projected area of a round
    // cone of the half angle.
    let sphere = Sphere::new(plan(Arrangement::Reflection)).unwrap();
    let cone = sphere.cone().unwrap();
    let (share, half) = (cone.diffuse_share(), cone.half_angle());
    assert!((share - half.sin().powi(2) * f64::to_radians(8.0).cos()).abs() < 1e-12);
    // From a point of the wall, Lambertian light is even over the sphere: the share is nearly that of the cap.
    let fraction = sphere.port(PortName::Trap).unwrap().fraction();
    assert!((share / fraction - 1.0).abs() < 0.02, "{share} {fraction}");
}

#[test]
fn the_same_seed_gives_the_same_readings_and_another_gives_others() {
    let material = plastic(0.4, 0.05, 0.05);
    let with = |seed| {
        let sphere = Sphere::new(plan(Arrangement::Reflection)).unwrap();
        let effort = Effort { rays: 1 << 10, seed };
        measure(
            &sphere,
            &material,
            0,
            Method::Comparison,
            &effort,
            &Default::default(),
            &|_| {},
        )
        .unwrap()
        .unwrap()
    };
    assert_eq!(with(1), with(1));
    assert_ne!(with(1).total, with(2).total);
}

#[test]
fn impossible_spheres_are_refused_in_a_sentence() {
    type Change = fn(&mut Plan);
    let cases: [(Change, &str); 11] = [
        (|p| p.wall = 1.2, "sphere.wall: found 1.2, allowed 0.05 to 0.999"),
        (
            |p| p.sample_radius = 0.2,
            "sample.diameter: found 0.4 m, allowed 0.0001 to 0.15 m",
        ),
        (|p| p.theta_i = 0.02, "entrance and trap"),
        (
            |p| p.comparison = Some(place(95.0, 90.0, 25.0)),
            "detector and comparison",
        ),
        (|p| p.beam_radius = 0.0124, "beam.diameter"),
        (|p| p.divergence = 0.1, "beam.diameter"),
        (|p| p.baffles[0].radius = 0.07, "baffle"),
        (|p| p.baffles[0].between[1] = PortName::Trap, "in the beam"),
        (|_| (), ""),
        (
            |p| p.auxiliary = Some(place(90.0, 270.0, 12.0)),
            "opposite to the detector port",
        ),
        (|p| p.detector.view = 3.0, "detector.view"),
    ];
    for (change, wanted) in cases {
        let mut plan = plan(Arrangement::Reflection);
        change(&mut plan);
        match Sphere::new(plan) {
            Ok(_) => assert!(wanted.is_empty(), "{wanted}"),
            Err(error) => assert!(
                !wanted.is_empty() && error.to_string().contains(wanted),
                "{error}, wanted {wanted}"
            ),
        }
    }
    let mut plan = plan(Arrangement::Reflection);
    plan.auxiliary = None;
    plan.comparison = None;
    let sphere = Sphere::new(plan).unwrap();
    for method in [Method::Auxiliary, Method::Comparison] {
        let effort = Effort { rays: 32, seed: 1 };
        let found = measure(
            &sphere,
            &plastic(0.4, 0.1, 0.1),
            0,
            method,
            &effort,
            &Default::default(),
            &|_| {},
        );
        assert!(matches!(
            found,
            Err(InstrumentError::Domain { field: "method", .. })
        ));
    }
}
