use gonio_geom::Component;

use super::super::microsurface::{EVEN, mean_cosine};
use super::*;
use crate::Rgl;
use crate::analytic::{Sum, family};
use crate::directional_albedo;

fn sum_of(parts: &[(&str, &[f64])]) -> Sum {
    let model = |(name, values): &(&str, &[f64])| {
        let parameters = [(Channel::Green, values.to_vec())];
        family(name).unwrap().model(&parameters).unwrap()
    };
    Sum::new(parts.iter().map(model).collect()).unwrap()
}

fn paint(alpha: f64) -> Sum {
    sum_of(&[("lambert", &[0.3]), ("ward-gmd", &[0.1, alpha])])
}

fn tables(model: &dyn Bsdf) -> RglTables {
    RglTables::of(model, &[(Channel::Green, 0)], &RglOptions::of(model)).unwrap()
}

/// Relative L1 error of the tables at one incidence over directions of equal projected solid angle.
fn rel_l1(model: &dyn Bsdf, rgl: &Rgl, wi: Direction) -> f64 {
    let n = 120;
    let (mut difference, mut sum) = (0.0, 0.0);
    for a in 0..n {
        for b in 0..n {
            let (x, y) = (
                (f64::from(a) + 0.5) / f64::from(n),
                (f64::from(b) + 0.5) / f64::from(n),
            );
            let ws = Direction::from_spherical(x.sqrt().asin(), TAU * y);
            let f = model.eval_first(wi, ws);
            difference += (rgl.eval_first(wi, ws) - f).abs();
            sum += f;
        }
    }
    difference / sum
}

#[test]
fn the_distribution_of_a_surface_that_reflects_like_its_retro_reflection_is_found() {
    // kernel f(w, w) cos(w) <w, m> of f = D(w) / (4 sigma(w) cos(w)): its eigenvector is D
    let alpha: f64 = 0.3;
    let ndf = |cos: f64| {
        let c2 = cos * cos;
        alpha * alpha / (PI * (c2 * (alpha * alpha - 1.0) + 1.0).powi(2))
    };
    struct Retro<F: Fn(f64) -> f64>(F, Vec<Channel>);
    impl<F: Fn(f64) -> f64 + Send + Sync> Bsdf for Retro<F> {
        fn channels(&self) -> &[Channel] {
            &self.1
        }
        fn properties(&self) -> crate::Properties {
            crate::Properties {
                reciprocal: true,
                energy_conserving: false,
                isotropic: true,
            }
        }
        fn eval(&self, wi: Direction, _: Direction, f: &mut [f64]) {
            let n = 400;
            let (w, mut sigma) = (wi.theta(), 0.0);
            for k in 0..n {
                let m = FRAC_PI_2 * (f64::from(k) + 0.5) / f64::from(n);
                let ring = TAU * m.sin() * FRAC_PI_2 / f64::from(n);
                sigma += ring * (self.0)(m.cos()) * mean_cosine(w, m);
            }
            f[0] = (self.0)(wi.cos_theta()) / (4.0 * sigma * wi.cos_theta().max(1e-9));
        }
    }
    let model = Retro(ndf, vec![Channel::Green]);
    let nodes = Nodes {
        rows: 3,
        columns: 128,
    };
    let found = Microsurface::of(&model, &[(Channel::Green, 0)], nodes);
    for column in [0, 20, 60, 100] {
        let wanted = (1.0 - EVEN) * ndf(found.nodes.theta(column).cos()) + EVEN / PI;
        let ratio = found.density(0, column) / wanted;
        assert!((ratio - 1.0).abs() < 2e-3, "{column}: {ratio}");
    }
    assert!((found.area(0, 0) - 1.0).abs() < 1e-3);
}

#[test]
fn mean_cosine_is_the_mean_over_the_azimuth() {
    for (a, b) in [(0.0, 0.5), (0.7, 0.3), (1.2, 1.1), (1.5, 1.55)] {
        let n = 20_000;
        let i = Direction::from_spherical(a, 0.0);
        let sum: f64 = (0..n)
            .map(|k| {
                i.dot(Direction::from_spherical(
                    b,
                    TAU * (f64::from(k) + 0.5) / f64::from(n),
                ))
                .max(0.0)
            })
            .sum();
        assert!((sum / f64::from(n) - mean_cosine(a, b)).abs() < 1e-6);
    }
}

#[test]
fn tables_give_the_model_at_their_nodes_and_near_it_between() {
    for (alpha, at_nodes, between) in [(0.15, 0.02, 0.03), (0.4, 0.01, 0.015)] {
        let model = paint(alpha);
        let rgl = Rgl::new(tables(&model)).unwrap();
        for theta in [0.0, 30.0, 60.0, 80.0] {
            let found = rel_l1(&model, &rgl, Direction::from_degrees(theta, 70.0));
            assert!(found < at_nodes, "{alpha} {theta}: {found}");
        }
        for theta in [12.5, 52.5, 72.5] {
            let found = rel_l1(&model, &rgl, Direction::from_degrees(theta, 70.0));
            assert!(found < between, "{alpha} {theta}: {found}");
        }
    }
}

#[test]
fn anisotropic_models_keep_their_axes() {
    let model = sum_of(&[
        ("lambert", &[0.2]),
        ("ward-gmd-anisotropic", &[0.2, 0.15, 0.4, 0.5]),
    ]);
    let rgl = Rgl::new(tables(&model)).unwrap();
    assert!(!rgl.is_isotropic());
    // two-fold symmetric: half a turn is enough
    let last = rgl.phi_i().last().copied().unwrap();
    assert!(rgl.phi_i().len() == 13 && last.abs() < 1e-12, "{last}");
    for (theta, phi) in [(30.0, 0.0), (30.0, 60.0), (60.0, 150.0), (45.0, 300.0)] {
        let found = rel_l1(&model, &rgl, Direction::from_degrees(theta, phi));
        assert!(found < 0.02, "{theta} {phi}: {found}");
    }
}

#[test]
fn sampling_the_tables_carries_the_albedo_with_weights_of_little_spread() {
    let model = paint(0.2);
    let rgl = Rgl::new(tables(&model)).unwrap();
    for theta in [0.0, 40.0, 70.0] {
        let w = Direction::from_degrees(theta, 20.0);
        let albedo = directional_albedo(&model, w, Component::Reflection, 0);
        let n = 40_000;
        let (mut sum, mut largest) = (0.0, 0.0f64);
        for k in 0..n {
            // points of a lattice
            let u = [
                (f64::from(k) + 0.5) / f64::from(n),
                (0.618_033_988_749_9 * f64::from(k)).fract(),
                0.5,
            ];
            if let Some(s) = rgl.sample(w, u) {
                sum += s.weight;
                largest = largest.max(s.weight);
            }
        }
        let mean = sum / f64::from(n);
        assert!((mean / albedo - 1.0).abs() < 0.02, "{theta}: {mean} {albedo}");
        assert!(largest < 2.0 * albedo, "{theta}: {largest}");
    }
}

#[test]
fn what_makes_no_tables_is_refused_by_name() {
    let model = paint(0.2);
    let good = RglOptions::of(&model);
    let refused = |options: &RglOptions, channel| {
        RglTables::of(&model, &[(Channel::Green, channel)], options)
            .unwrap_err()
            .to_string()
    };
    assert!(refused(&good, 3).starts_with("channels: found [3]"));
    let mut options = good.clone();
    options.theta_i = vec![0.0, FRAC_PI_2];
    assert!(refused(&options, 0).starts_with("theta_i: found"));
    let mut options = good.clone();
    options.resolution = 2;
    assert!(refused(&options, 0).starts_with("resolution: found 2"));
    let black = sum_of(&[("lambert", &[0.0])]);
    let rgl = Rgl::new(tables(&black)).unwrap();
    let wi = Direction::from_degrees(30.0, 0.0);
    assert_eq!(rgl.eval_first(wi, wi.mirror()), 0.0);
}
