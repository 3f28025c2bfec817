//! Samplers of tables: trees, matrices, half-angle and RGL tables; from both sides, transmission told of one side only.

use gonio_bsdf::analytic::{Sum, family};
use gonio_bsdf::klems::{Klems, KlemsBasis, KlemsMatrix};
use gonio_bsdf::rgl::{RglOptions, RglTables};
use gonio_bsdf::tensor_tree::{Rank, TensorTree, Tree, TreeBuilder};
use gonio_bsdf::{Bsdf, Channel, FourComponents, HalfDifference, Rgl};
use gonio_geom::disk::square_to_disk;
use gonio_geom::{Component, DVec3, Direction, Side};
use rayon::prelude::*;

use crate::chi_square::sidak;
use crate::common::incidence;
use crate::trial::run;

/// Rate at which all comparisons of one kind together raise a false alarm, were the seeds drawn anew.
const FALSE_ALARM: f64 = 1e-3;
const SAMPLES: u64 = 150_000;
/// Polar angles of incidence, degrees.
const THETAS: [f64; 4] = [0.0, 33.0, 84.0, 112.0];

/// Numbers in `[0, 1)` without a pattern.
fn scattered(k: u32) -> f64 {
    (f64::from(k) * 0.618_033_988_75 + 0.3 * f64::from(k / 7).sin()).rem_euclid(1.0)
}

/// A tree that is finer in some cells than in others.
fn tree(rank: Rank) -> Tree {
    fn grow(b: &mut TreeBuilder, rank: Rank, depth: u32, k: &mut u32) {
        b.branch().unwrap();
        for child in 0..rank.children() {
            *k += 1;
            let mut next = |n: usize| -> Vec<f32> {
                (0..n)
                    .map(|_| {
                        *k += 1;
                        (0.02 + scattered(*k).powi(4)) as f32
                    })
                    .collect()
            };
            match (child as u32 + depth) % 3 {
                0 if depth > 1 => grow(b, rank, depth - 1, k),
                1 => b.block(&next(rank.children())).unwrap(),
                _ => b.block(&next(1)).unwrap(),
            }
        }
        b.end().unwrap();
    }
    let mut b = TreeBuilder::new(rank);
    grow(&mut b, rank, if rank == Rank::Three { 4 } else { 3 }, &mut 0);
    b.finish().unwrap()
}

const FRONT: [Component; 2] = [Component::Reflection, Component::Transmission];

fn of_tree(rank: Rank) -> Box<dyn Bsdf> {
    let mut trees = FourComponents::default();
    for component in FRONT {
        trees.set(Side::Front, component, Some(tree(rank)));
    }
    Box::new(TensorTree::new(Channel::Photopic, trees))
}

fn klems(basis: KlemsBasis) -> Box<dyn Bsdf> {
    let mut matrices = FourComponents::default();
    for (c, component) in FRONT.into_iter().enumerate() {
        let n = (basis.len() * basis.len()) as u32;
        let values = (0..n).map(|k| (0.01 + scattered(k + c as u32).powi(6)) as f32);
        let matrix = KlemsMatrix::new(basis.clone(), basis.clone(), values.collect()).unwrap();
        matrices.set(Side::Front, component, Some(matrix));
    }
    Box::new(Klems::new(Channel::Photopic, matrices))
}

fn glossy(lobe: &str, values: &[f64]) -> Sum {
    let part = |name: &str, values: &[f64]| {
        let parameters = [(Channel::Photopic, values.to_vec())];
        family(name).unwrap().model(&parameters).unwrap()
    };
    Sum::new(vec![part("lambert", &[0.2]), part(lobe, values)]).unwrap()
}

fn models() -> Vec<(&'static str, Box<dyn Bsdf>)> {
    let channels = [(Channel::Photopic, 0)];
    let isotropic = glossy("ggx", &[0.8, 0.2]);
    let brushed = glossy("ward-gmd-anisotropic", &[0.4, 0.1, 0.3, 0.6]);
    let rgl = |model: &dyn Bsdf| -> Box<dyn Bsdf> {
        Box::new(Rgl::new(RglTables::of(model, &channels, &RglOptions::of(model)).unwrap()).unwrap())
    };
    vec![
        ("tree of rank 3", of_tree(Rank::Three)),
        ("tree of rank 4", of_tree(Rank::Four)),
        ("klems", klems(KlemsBasis::half())),
        (
            "half-angle table",
            Box::new(HalfDifference::of(&isotropic, [30, 30, 60], &channels).unwrap()),
        ),
        ("rgl isotropic", rgl(&isotropic)),
        ("rgl anisotropic", rgl(&brushed)),
    ]
}

/// `integral f |cos|` over both hemispheres on 400 x 400 directions of equal projected solid angle each.
fn albedo(model: &dyn Bsdf, w: Direction) -> f64 {
    let n = 400;
    let step = 1.0 / f64::from(n);
    let mut sum = 0.0;
    for a in 0..n {
        for b in 0..n {
            let (x, y) = square_to_disk(step * (f64::from(a) + 0.5), step * (f64::from(b) + 0.5));
            let up = Direction::from_unit(DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt()));
            sum += model.eval_first(w, up) + model.eval_first(w, up.flipped());
        }
    }
    std::f64::consts::PI * step * step * sum
}

#[test]
fn samples_of_tables_follow_their_density_from_either_side() {
    let models = models();
    let cases: Vec<(&str, &dyn Bsdf, f64)> = models
        .iter()
        .flat_map(|(name, model)| THETAS.map(|theta| (*name, &**model, theta)))
        .filter(|(_, model, theta)| *theta < 90.0 || albedo(*model, incidence(*theta)) > 0.0)
        .collect();
    // Trees and matrices are lit from the back through the transmission of the front.
    assert_eq!(cases.len(), 3 * 4 + 3 * 3);
    let least = sidak(FALSE_ALARM, 2 * cases.len());
    let failed: Vec<String> = cases
        .par_iter()
        .filter_map(|(name, model, theta)| {
            let label = format!("{name} at {theta} degrees");
            let w = incidence(*theta);
            let t = run(*model, |w, u| model.sample(w, u), w, &label, SAMPLES);
            let albedo = albedo(*model, w);
            let spread = 4.0 * t.standard_error + 0.01 * albedo;
            // Quadrature over the edges of cells is good to some 1e-4; where the density is whole, a failed sample shows in chi-square.
            let whole = (t.mass - 1.0).abs() < 3e-4;
            let good = t.chi_square.p > least
                && (whole || (t.mass < 1.0 && t.p_accepted > least))
                && (t.mean - albedo).abs() < spread;
            (!good).then(|| {
                format!(
                    "{label}: {:?}, mass {} +- {:.0e}, accepted p {:.1e}, mean {} +- {:.1e}, albedo {albedo}",
                    t.chi_square, t.mass, t.mass_error, t.p_accepted, t.mean, t.standard_error
                )
            })
        })
        .collect();
    assert!(failed.is_empty(), "below p = {least:.1e}:\n{}", failed.join("\n"));
}
