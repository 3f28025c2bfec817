use std::f64::consts::PI;

use gonio_bsdf::analytic::{Analytic, BoundedTransmissionLobe, Lambert, Spectrum, Sum, WardGmd};
use gonio_bsdf::klems::{KlemsBasis, Role};
use gonio_bsdf::tensor_tree::Rank;
use gonio_bsdf::{Properties, directional_albedo};

use super::*;

const FRONT: (Side, Component) = (Side::Front, Component::Reflection);

fn photopic(value: f64) -> Spectrum {
    Spectrum::photopic("albedo", value).unwrap()
}

/// Lambert 0.4 and a lobe of 0.2, isotropic.
fn glossy(alpha: f64) -> Sum {
    Sum::new(vec![
        Box::new(Lambert::reflection(&photopic(0.4)).unwrap()),
        Box::new(WardGmd::isotropic(&photopic(0.2), alpha).unwrap()),
    ])
    .unwrap()
}

fn brushed() -> Sum {
    let lobe = WardGmd::anisotropic(&photopic(0.25), 0.1, 0.3, 0.4);
    Sum::new(vec![
        Box::new(Lambert::reflection(&photopic(0.3)).unwrap()),
        Box::new(lobe.unwrap()),
    ])
    .unwrap()
}

/// Reflects 0.5 from the front and 0.1 from the back, transmits in a lobe.
struct TwoFaced(Analytic<BoundedTransmissionLobe>);

impl TwoFaced {
    fn new() -> Self {
        TwoFaced(Analytic::<BoundedTransmissionLobe>::of(&photopic(0.3), &[0.2]).unwrap())
    }
}

impl Bsdf for TwoFaced {
    fn channels(&self) -> &[Channel] {
        &[Channel::Photopic]
    }

    fn properties(&self) -> Properties {
        Properties {
            reciprocal: true,
            energy_conserving: true,
            isotropic: true,
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        f[0] = match (wi.side(), ws.side()) {
            (Side::Front, Side::Front) => 0.5 / PI,
            (Side::Back, Side::Back) => 0.1 / PI,
            _ => self.0.eval_first(wi, ws),
        };
    }
}

/// Average of the albedo over an incident patch: midpoints in the cosine of the polar angle and in azimuth.
fn patch_albedo(model: &dyn Bsdf, basis: &KlemsBasis, patch: usize, side: Side, c: Component) -> f64 {
    let ring = basis.ring(patch);
    let [near, far] = [ring.theta_lo, ring.theta_hi].map(|t| t.to_radians().cos());
    let (mut sum, mut weights) = (0.0, 0.0);
    let azimuths = if model.properties().isotropic { 1 } else { 2 };
    for a in 0..8 {
        let cos = near + (far - near) * (f64::from(a) + 0.5) / 8.0;
        let u = (near * near - cos * cos) / (near * near - far * far);
        for b in 0..azimuths {
            let v = (f64::from(b) + 0.5) / f64::from(azimuths);
            let wi = basis.point(patch, Role::Incident, side, u, v);
            sum += cos * directional_albedo(model, wi, c, 0);
            weights += cos;
        }
    }
    sum / weights
}

#[test]
fn lambert_gives_rho_over_pi_in_every_entry() {
    let model = Lambert::reflection(&photopic(0.7)).unwrap();
    let r = to_klems(&model, &KlemsOptions::default()).unwrap();
    let k = &r.model;
    for side in Side::BOTH {
        let m = k.matrix(side, Component::Reflection).unwrap();
        assert!(
            m.values()
                .iter()
                .all(|v| (f64::from(*v) * PI / 0.7 - 1.0).abs() < 1e-6)
        );
        assert!(k.matrix(side, Component::Transmission).is_none());
    }
    assert!((r.max_albedo - 0.7).abs() < 1e-6 && r.capped.is_empty() && r.unsettled == 0);
}

#[test]
fn klems_entries_keep_the_patch_averaged_energy() {
    for (model, basis, patches) in [
        (
            &glossy(0.1) as &dyn Bsdf,
            KlemsBasis::full(),
            [0usize, 3, 30, 60, 100, 140],
        ),
        (&glossy(0.03), KlemsBasis::full(), [0, 3, 30, 60, 100, 140]),
        // every patch of an anisotropic model has its own incidences
        (&brushed(), KlemsBasis::quarter(), [0, 3, 11, 20, 30, 40]),
    ] {
        let options = KlemsOptions {
            basis,
            components: Some(vec![FRONT]),
            ..KlemsOptions::default()
        };
        let r = to_klems(model, &options).unwrap();
        let m = r.model.matrix(Side::Front, Component::Reflection).unwrap();
        for patch in patches {
            let want = patch_albedo(model, &options.basis, patch, Side::Front, Component::Reflection);
            let got = m.albedo(patch);
            assert!((got / want - 1.0).abs() < 1e-2, "patch {patch}: {got} for {want}");
        }
    }
}

#[test]
fn an_isotropic_model_is_reduced_alike_with_and_without_its_symmetry() {
    struct Hidden(Sum);
    impl Bsdf for Hidden {
        fn channels(&self) -> &[Channel] {
            self.0.channels()
        }
        fn properties(&self) -> Properties {
            Properties {
                isotropic: false,
                ..self.0.properties()
            }
        }
        fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
            self.0.eval(wi, ws, f);
        }
    }
    let options = KlemsOptions {
        basis: KlemsBasis::quarter(),
        components: Some(vec![FRONT]),
        incident_points: 5,
        ..KlemsOptions::default()
    };
    let fast = to_klems(&glossy(0.15), &options).unwrap();
    let slow = to_klems(&Hidden(glossy(0.15)), &options).unwrap();
    assert!(fast.evaluations * 4 < slow.evaluations);
    let (a, b) = (
        fast.model.matrix(Side::Front, Component::Reflection).unwrap(),
        slow.model.matrix(Side::Front, Component::Reflection).unwrap(),
    );
    for (x, y) in a.values().iter().zip(b.values()) {
        assert!((x / y - 1.0).abs() < 5e-3, "{x} {y}");
    }
}

#[test]
fn a_klems_matrix_of_a_reciprocal_model_is_reciprocal() {
    let options = KlemsOptions {
        basis: KlemsBasis::quarter(),
        components: Some(vec![FRONT]),
        incident_points: 5,
        ..KlemsOptions::default()
    };
    let r = to_klems(&brushed(), &options).unwrap();
    let m = r.model.matrix(Side::Front, Component::Reflection).unwrap();
    let b = &options.basis;
    // f(wi in P, ws in Q) = f(wi in Q, ws in P), where the incident index turns the azimuth
    for i in 0..b.len() {
        for o in 0..b.len() {
            let centre = |p| b.point(p, Role::Exit, Side::Front, 0.5, 0.5);
            let back = m.value(
                b.patch(b.point(i, Role::Incident, Side::Front, 0.5, 0.5), Role::Exit),
                b.patch(centre(o), Role::Incident),
            );
            assert!(
                (m.value(o, i) / back - 1.0).abs() < 0.03,
                "{i} {o}: {} {back}",
                m.value(o, i)
            );
        }
    }
}

#[test]
fn front_and_back_stay_apart_in_both_reductions() {
    let model = TwoFaced::new();
    let k = to_klems(
        &model,
        &KlemsOptions {
            basis: KlemsBasis::quarter(),
            ..KlemsOptions::default()
        },
    )
    .unwrap()
    .model;
    let t = to_tensor_tree(&model, &TreeOptions::default()).unwrap().model;
    let (up, down) = (
        Direction::from_degrees(30.0, 10.0),
        Direction::from_degrees(150.0, 10.0),
    );
    for m in [&k as &dyn Bsdf, &t] {
        assert!((m.eval_first(up, up) * PI - 0.5).abs() < 1e-4);
        assert!((m.eval_first(down, down) * PI - 0.1).abs() < 1e-4);
    }
    for wi in [up, down] {
        let want = directional_albedo(&model, wi, Component::Transmission, 0);
        assert!((k.directional_albedo(wi, Component::Transmission) / want - 1.0).abs() < 0.02);
        assert!((t.directional_albedo(wi, Component::Transmission) / want - 1.0).abs() < 0.02);
    }
    assert_eq!(k.matrices().len(), 4);
    assert_eq!(t.trees().len(), 4);
}

#[test]
fn capping_is_reported_patch_by_patch() {
    struct Bright;
    impl Bsdf for Bright {
        fn channels(&self) -> &[Channel] {
            &[Channel::Photopic]
        }
        fn properties(&self) -> Properties {
            Properties {
                reciprocal: false,
                energy_conserving: false,
                isotropic: true,
            }
        }
        fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
            f[0] = if wi.side() == ws.side() {
                (1.2 - 0.5 * wi.cos_theta().abs()) / PI
            } else {
                0.0
            };
        }
    }
    let mut options = KlemsOptions {
        basis: KlemsBasis::half(),
        components: Some(vec![FRONT]),
        ..KlemsOptions::default()
    };
    let honest = to_klems(&Bright, &options).unwrap();
    assert!(honest.max_albedo > 1.05 && honest.capped.is_empty());
    options.cap_albedo = true;
    let capped = to_klems(&Bright, &options).unwrap();
    assert_eq!(capped.max_albedo, honest.max_albedo);
    let (a, b) = (
        honest.model.matrix(Side::Front, Component::Reflection).unwrap(),
        capped.model.matrix(Side::Front, Component::Reflection).unwrap(),
    );
    for i in 0..options.basis.len() {
        let listed = capped.capped.iter().find(|(_, p, _)| *p == i);
        assert_eq!(listed.is_some(), a.albedo(i) > 1.0);
        assert!(b.albedo(i) <= 1.0 && (a.albedo(i) > 1.0 || a.albedo(i) == b.albedo(i)));
    }
}

#[test]
fn a_tree_of_a_constant_is_coarse_and_exact() {
    let r = to_tensor_tree(
        &Lambert::reflection(&photopic(0.7)).unwrap(),
        &TreeOptions::default(),
    )
    .unwrap();
    let t = r.model.tree(Side::Front, Component::Reflection).unwrap();
    assert!((t.albedo([0.2, 0.0]) - 0.7).abs() < 1e-5 && (r.max_albedo - 0.7).abs() < 1e-5);
    assert!(t.len() < 6000, "{}", t.len());
}

#[test]
fn the_error_of_a_tree_falls_with_its_budget() {
    for (model, rank) in [(&glossy(0.1) as &dyn Bsdf, Rank::Three), (&brushed(), Rank::Four)] {
        let mut last = f64::INFINITY;
        for max_cells in [1_000, 10_000, 100_000] {
            let options = TreeOptions {
                components: Some(vec![FRONT]),
                target: 0.0,
                max_cells,
                ..TreeOptions::default()
            };
            let r = to_tensor_tree(model, &options).unwrap();
            let t = r.model.tree(Side::Front, Component::Reflection).unwrap();
            assert!(t.rank() == rank && t.len() <= max_cells);
            let estimate = *r.error.get(Side::Front, Component::Reflection).unwrap();
            let measured: f64 = [20.0, 45.0, 65.0]
                .iter()
                .map(|th| {
                    let wi = Direction::from_degrees(*th, 33.0);
                    loss(model, 0, &r.model, wi, Component::Reflection, 128)
                        .unwrap()
                        .rel_l1
                })
                .sum::<f64>()
                / 3.0;
            assert!(
                estimate < last && measured < 2.0 * estimate + 0.01,
                "{estimate} {measured}"
            );
            last = estimate;
        }
    }
}

#[test]
fn trees_keep_the_albedo_of_narrow_lobes() {
    for alpha in [0.02, 0.05, 0.1, 0.2] {
        let model = glossy(alpha);
        let options = TreeOptions {
            components: Some(vec![FRONT]),
            ..TreeOptions::default()
        };
        let r = to_tensor_tree(&model, &options).unwrap();
        for theta in [3.0, 15.0, 40.0, 60.0, 75.0] {
            let wi = Direction::from_degrees(theta, 77.0);
            let want = directional_albedo(&model, wi, Component::Reflection, 0);
            let got = r.model.directional_albedo(wi, Component::Reflection);
            assert!(
                (got / want - 1.0).abs() < 0.03,
                "alpha {alpha}, {theta}: {got} for {want}"
            );
        }
    }
}

#[test]
fn requests_that_make_no_sense_are_refused() {
    let iso = glossy(0.2);
    let bad_channel = KlemsOptions {
        channel: 3,
        ..KlemsOptions::default()
    };
    assert!(to_klems(&iso, &bad_channel).is_err());
    let bad_tolerance = KlemsOptions {
        tolerance: f64::NAN,
        ..KlemsOptions::default()
    };
    assert!(to_klems(&iso, &bad_tolerance).is_err());
    let rank = TreeOptions {
        rank: Some(Rank::Three),
        ..TreeOptions::default()
    };
    assert!(to_tensor_tree(&brushed(), &rank).is_err());
    let depth = TreeOptions {
        max_depth: 0,
        ..TreeOptions::default()
    };
    assert!(to_tensor_tree(&iso, &depth).is_err());
    let nothing = TreeOptions {
        components: Some(Vec::new()),
        ..TreeOptions::default()
    };
    assert!(to_tensor_tree(&iso, &nothing).is_err());
}

#[test]
fn an_ideal_part_goes_to_its_patches() {
    use gonio_bsdf::RadianceMaterial;
    use gonio_bsdf::albedo::directional_albedo;
    use gonio_bsdf::radiance::{Glass, Plastic};
    let smooth = RadianceMaterial::from(Plastic::new([0.5; 3], 0.05, 0.0).unwrap());
    let model = smooth.bsdf().unwrap();
    let pane = RadianceMaterial::from(Glass {
        transmissivity: [0.9; 3],
        refractive_index: None,
    });
    for (model, component) in [
        (model, Component::Reflection),
        (pane.bsdf().unwrap(), Component::Transmission),
    ] {
        let klems = to_klems(model.as_ref(), &KlemsOptions::default()).unwrap().model;
        let matrix = klems.matrix(Side::Front, component).unwrap();
        let basis = matrix.incident();
        for incident in [0, 5, 40, 100] {
            let n = 16;
            let mean: f64 = (0..n * n)
                .map(|k| {
                    let at = |k: usize| (k as f64 + 0.5) / n as f64;
                    let wi = basis.point(incident, Role::Incident, Side::Front, at(k / n), at(k % n));
                    directional_albedo(model.as_ref(), wi, component, 0)
                })
                .sum::<f64>()
                / (n * n) as f64;
            let found = matrix.albedo(incident);
            assert!(
                (found / mean - 1.0).abs() < 5e-3,
                "patch {incident}: {found} for {mean}"
            );
            // The whole of it lies on the diagonal.
            if component == Component::Transmission {
                let own = matrix.value(incident, incident) * basis.lambda()[incident];
                assert!((own / found - 1.0).abs() < 1e-6);
            }
        }
    }
}
