//! Light without spread in tables, and what is said of it.

use gonio_bsdf::analytic::{Analytic, BoundedTransmissionLobe, Lambert, Spectrum};
use gonio_bsdf::radiance::{Glass, Plastic, Trans};
use gonio_bsdf::tensor_tree::{Rank, TensorTree};
use gonio_bsdf::{Properties, RadianceMaterial};

use super::*;

fn photopic(value: f64) -> Spectrum {
    Spectrum::photopic("albedo", value).unwrap()
}

/// The ideal part of a model alone.
struct Unscattered<'a>(&'a dyn Bsdf);

impl Bsdf for Unscattered<'_> {
    fn channels(&self) -> &[Channel] {
        self.0.channels()
    }

    fn properties(&self) -> Properties {
        self.0.properties()
    }

    fn eval(&self, _wi: Direction, _ws: Direction, f: &mut [f64]) {
        f.fill(0.0);
    }

    fn delta(&self, w: Direction, component: Component, shares: &mut [f64]) -> Option<Direction> {
        self.0.delta(w, component, shares)
    }
}

#[test]
fn a_tree_holds_the_ideal_share_at_every_incidence_from_either_side() {
    let trans = Trans {
        color: [0.8; 3],
        specularity: 0.0,
        roughness: 0.0,
        transmissivity: 0.6,
        transmitted_specularity: 0.5,
    };
    let glass = Glass {
        transmissivity: [0.9; 3],
        refractive_index: None,
    };
    let models = [
        RadianceMaterial::from(Plastic::new([0.5; 3], 0.05, 0.0).unwrap()),
        RadianceMaterial::from(glass),
        RadianceMaterial::from(trans),
    ];
    // the borders of large cells of incidence, on both sides of each, and what lies between
    let borders = [0.0f64, 0.25, 0.5, 0.75].map(|sin| sin.asin().to_degrees());
    let near = borders
        .iter()
        .flat_map(|b| [-0.3, -0.05, 0.0, 0.05, 0.3].map(|d| b + d));
    let thetas: Vec<f64> = near.chain((0..88).map(f64::from)).filter(|t| *t >= 0.0).collect();
    let both = [Component::Reflection, Component::Transmission];
    for (k, material) in models.iter().enumerate() {
        let model = material.bsdf().unwrap();
        let whole = to_tensor_tree(model.as_ref(), &TreeOptions::default()).unwrap();
        let model = Unscattered(model.as_ref());
        let share = |sin: f64, side: Side, component| {
            let theta = sin.min(1.0).asin().to_degrees();
            let wi = Direction::from_degrees(if side == Side::Back { 180.0 - theta } else { theta }, 30.0);
            let mut shares = vec![0.0; model.channels().len()];
            model.delta(wi, component, &mut shares);
            shares[0]
        };
        let fine = to_tensor_tree(&model, &TreeOptions::default()).unwrap();
        let wide = TreeOptions {
            rank: Some(Rank::Four),
            ..TreeOptions::default()
        };
        let wide = to_tensor_tree(&model, &wide).unwrap();
        let mut highest = 0.0f64;
        for theta in &thetas {
            for wi in [*theta, 180.0 - theta].map(|t| Direction::from_degrees(t, 30.0)) {
                for component in both {
                    // the share over the cell of incidence, of which there are 128 in the sine; on a border over either
                    let got = fine.model.directional_albedo(wi, component);
                    let wanted = [-1e-6, 1e-6].map(|d| {
                        let cell = (128.0 * (wi.theta().sin() + d).max(0.0)).floor();
                        let sines = (0..64).map(|k| (cell + (f64::from(k) + 0.5) / 64.0) / 128.0);
                        sines.map(|sin| share(sin, wi.side(), component)).sum::<f64>() / 64.0
                    });
                    assert!(
                        wanted.iter().any(|want| (got - want).abs() <= 5e-3 * want),
                        "model {k}, {theta} deg, {component}: {got} for {wanted:?}"
                    );
                    // at rank 4 cells of incidence are wide: looked at for a share that is the same everywhere
                    let want = share(wi.theta().sin(), wi.side(), component);
                    let got = wide.model.directional_albedo(wi, component);
                    assert!(
                        k != 2 || (got - want).abs() <= 1e-3 * want,
                        "rank 4, model {k}, {theta} deg, {component}: {got} for {want}"
                    );
                }
                let sum = |m: &TensorTree| -> f64 { both.iter().map(|c| m.directional_albedo(wi, *c)).sum() };
                highest = highest.max(sum(&whole.model));
            }
        }
        assert!(
            whole.max_albedo >= highest - 1e-6 && whole.max_albedo < 1.01,
            "model {k}: {} for {highest}",
            whole.max_albedo
        );
    }
}

/// 48 % through unscattered and scattered, green of a curtain.
fn curtain() -> RadianceMaterial {
    RadianceMaterial::from(Trans {
        color: [0.8; 3],
        specularity: 0.0,
        roughness: 0.0,
        transmissivity: 0.6,
        transmitted_specularity: 0.5,
    })
}

#[test]
fn ideal_light_in_the_cells_of_a_table_is_compared_with_the_ideal_part_of_its_model() {
    let curtain = curtain();
    let model = curtain.bsdf().unwrap();
    let one = |k: &dyn Bsdf, wi, n| {
        let l = loss(model.as_ref(), 0, k, wi, Component::Transmission, n).unwrap();
        (
            l.rel_l1,
            l.ideal_model,
            l.ideal_reduced,
            l.albedo_reduced,
            l.peak_ratio,
        )
    };
    let klems = to_klems(model.as_ref(), &KlemsOptions::default()).unwrap().model;
    let tree = to_tensor_tree(model.as_ref(), &TreeOptions::default())
        .unwrap()
        .model;
    let wide = TreeOptions {
        rank: Some(Rank::Four),
        ..TreeOptions::default()
    };
    let wide = to_tensor_tree(model.as_ref(), &wide).unwrap().model;
    for theta in [0.0, 14.4, 30.0, 55.0, 120.0, 165.5, 180.0] {
        let wi = Direction::from_degrees(theta, 40.0);
        for (name, table) in [("klems", &klems as &dyn Bsdf), ("tree", &tree), ("rank 4", &wide)] {
            let (rel_l1, wanted, found, albedo, peak) = one(table, wi, 200);
            assert!((wanted - 0.24).abs() < 1e-12);
            assert!((found / wanted - 1.0).abs() < 0.02, "{name}, {theta}: {found}");
            assert!((albedo / 0.48 - 1.0).abs() < 0.01, "{name}, {theta}: {albedo}");
            assert!(
                rel_l1 < 0.02 && (peak - 1.0).abs() < 0.02,
                "{name}, {theta}: {rel_l1} {peak}"
            );
            // and from either of the two, in the other comparison
            for (a, b, table) in [(model.as_ref(), table, 1), (table, model.as_ref(), 0)] {
                let c = compare((a, 0), (b, 0), wi, Component::Transmission).unwrap();
                assert!((c.ideal[1 - table] - 0.24).abs() < 1e-12);
                assert!(
                    (c.ideal[table] / 0.24 - 1.0).abs() < 0.02,
                    "{name}, {theta}: {c:?}"
                );
                assert!(
                    c.rel_l1 < 0.02 && (c.albedo[table] / 0.48 - 1.0).abs() < 0.01,
                    "{c:?}"
                );
                assert!(c.reciprocity[1 - table] < 1e-9, "{c:?}");
                let alone = reciprocity(
                    if table == 1 { (b, 0) } else { (a, 0) },
                    wi,
                    Component::Transmission,
                );
                assert_eq!(c.reciprocity[table], alone.unwrap());
            }
        }
    }
}

#[test]
fn reciprocity_is_unknown_where_nothing_comes_the_other_way() {
    /// Transmits in a lobe.
    struct FromTheFront(Analytic<BoundedTransmissionLobe>);
    impl Bsdf for FromTheFront {
        fn channels(&self) -> &[Channel] {
            self.0.channels()
        }
        fn properties(&self) -> Properties {
            self.0.properties()
        }
        fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
            f.fill(0.0);
            if wi.side() == Side::Front {
                self.0.eval(wi, ws, f);
            }
        }
    }
    let lobe = || Analytic::<BoundedTransmissionLobe>::of(&photopic(0.3), &[0.2]).unwrap();
    let model = FromTheFront(lobe());
    let wi = Direction::from_degrees(20.0, 0.0);
    let of = |component| reciprocity((&model, 0), wi, component).unwrap();
    assert!(of(Component::Transmission).is_nan());
    assert!(of(Component::Reflection).is_nan());
    let both = compare((&model, 0), (&lobe(), 0), wi, Component::Transmission).unwrap();
    assert!(both.reciprocity[0].is_nan() && both.reciprocity[1] < 1e-9);
    let matte = Lambert::reflection(&photopic(0.7)).unwrap();
    assert!(reciprocity((&matte, 0), wi, Component::Reflection).unwrap() < 1e-12);
}

#[test]
fn the_largest_albedo_of_a_constant_and_an_ideal_part_is_their_sum() {
    let curtain = curtain();
    let model = curtain.bsdf().unwrap();
    let found = largest_albedo(model.as_ref());
    // 40 % of .8 is reflected, 60 % transmitted
    assert!((found.value - 0.8).abs() < 1e-3 + 2.0 * found.error, "{found:?}");
    let lambert = Lambert::reflection(&photopic(0.7)).unwrap();
    assert!((largest_albedo(&lambert).value - 0.7).abs() < 1e-9);
}
