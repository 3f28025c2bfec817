//! The BSDF of geometry against closed forms.
#![allow(clippy::unwrap_used, missing_docs)]

use std::sync::Arc;

use glam::Vec3;
use gonio_bsdf::klems::{KlemsBasis, Role};
use gonio_bsdf::{FourComponents, RadianceMaterial};
use gonio_geom::{Component, Direction, Side};
use gonio_instrument::device::{Device, Effort, Extent, PatchTable, patch_tables};
use gonio_trace::material::Material;
use gonio_trace::scene::{Parts, Surface};
use gonio_trace::travel::Body;

const PERIOD: f32 = 0.1;

fn quad(parts: &mut Parts, corners: [[f32; 3]; 4]) {
    let k = parts.vertices.len() as u32;
    parts.vertices.extend(corners);
    parts.triangles.extend([[k, k + 1, k + 2], [k, k + 2, k + 3]]);
    parts.triangle_surface.extend([0; 2]);
}

fn made_of(material: Material) -> Parts {
    Parts {
        materials: vec![material],
        surfaces: vec![Surface::default()],
        ..Parts::default()
    }
}

fn grey(rho: f32) -> Material {
    Material::Diffuse {
        reflectance: Vec3::splat(rho),
    }
}

/// Glass of index 1.5 that lies behind its surfaces.
fn glass() -> Parts {
    let glass = RadianceMaterial::from_arguments("dielectric", &[], &[1.0, 1.0, 1.0, 1.5, 0.0])
        .unwrap()
        .unwrap();
    let body = Body {
        inside: Vec3::ZERO,
        outside: None,
        index: 1.5,
    };
    Parts {
        bodies: vec![body],
        surfaces: vec![Surface {
            body: Some(0),
            ..Surface::default()
        }],
        ..made_of(Material::model(Arc::from(glass.bsdf().unwrap()), None))
    }
}

/// Faces of a block from 0 to the corner `[x, y, -h]`.
fn block(parts: &mut Parts, [x, y, h]: [f32; 3]) {
    let (a, b, c, d) = ([0.0, 0.0], [x, 0.0], [x, y], [0.0, y]);
    let at = |[x, y]: [f32; 2], z| [x, y, z];
    quad(parts, [at(a, 0.0), at(b, 0.0), at(c, 0.0), at(d, 0.0)]);
    quad(parts, [at(a, -h), at(d, -h), at(c, -h), at(b, -h)]);
    for [p, q] in [[a, b], [b, c], [c, d], [d, a]] {
        quad(parts, [at(p, 0.0), at(p, -h), at(q, -h), at(q, 0.0)]);
    }
}

fn mirror(rho: f64) -> Material {
    let mirror = RadianceMaterial::from_arguments("mirror", &[], &[rho; 3])
        .unwrap()
        .unwrap();
    Material::model(Arc::from(mirror.bsdf().unwrap()), None)
}

/// One period of a part that goes on for ever.
fn measured(parts: Parts, rays: u32) -> FourComponents<PatchTable> {
    let extent = Extent {
        window: Some([0.0, 0.0, PERIOD, PERIOD]),
        periodic: true,
    };
    let device = Device::new(parts, extent).unwrap();
    let effort = Effort {
        rays,
        ..Effort::default()
    };
    patch_tables(
        &device,
        &KlemsBasis::quarter(),
        &effort,
        &Default::default(),
        &|_| {},
    )
    .unwrap()
}

/// Albedo of an incident patch, and its standard error as if those of the pairs were independent.
fn albedo(
    tables: &FourComponents<PatchTable>,
    side: Side,
    component: Component,
    incident: usize,
) -> (f64, f64) {
    let basis = KlemsBasis::quarter();
    let Some(table) = tables.get(side, component) else {
        return (0.0, 0.0);
    };
    let n = basis.len();
    let (mut sum, mut square) = (0.0, 0.0);
    for (exit, lambda) in basis.lambda().iter().enumerate() {
        sum += lambda * table.luminance(exit * n + incident);
        square += (lambda * table.errors[exit * n + incident]).powi(2);
    }
    (sum, square.sqrt())
}

/// Mean of a function of the direction over a patch.
fn over_patch(patch: usize, f: impl Fn(Direction) -> f64) -> f64 {
    let basis = KlemsBasis::quarter();
    let n = 400;
    let step = |k: usize| (k as f64 + 0.5) / n as f64;
    let all =
        (0..n * n).map(|k| f(basis.point(patch, Role::Incident, Side::Front, step(k / n), step(k % n))));
    all.sum::<f64>() / (n * n) as f64
}

/// Slope of a direction across the grooves or slats, which lie along x.
fn slope(d: Direction) -> f64 {
    (d.vec().y / d.vec().z).abs()
}

#[test]
fn a_lambertian_plate_has_the_same_bsdf_everywhere() {
    let mut parts = made_of(grey(0.6));
    let (low, high) = (-PERIOD, 2.0 * PERIOD);
    quad(
        &mut parts,
        [
            [low, low, 0.0],
            [high, low, 0.0],
            [high, high, 0.0],
            [low, high, 0.0],
        ],
    );
    let tables = measured(parts, 4096);
    for side in Side::BOTH {
        let table = tables.get(side, Component::Reflection).unwrap();
        // Of 1681 pairs with errors from 16 replicates each, one beyond 6.5 is met about once in 60 seeds.
        for (k, error) in table.errors.iter().enumerate() {
            let off = table.luminance(k) - 0.6 / std::f64::consts::PI;
            assert!(off.abs() < 6.5 * error, "{side:?} {k}: {off} {error}");
        }
        let through = tables.get(side, Component::Transmission);
        assert!(through.is_none_or(|t| t.values.iter().flatten().all(|v| *v == 0.0)));
    }
}

#[test]
fn a_groove_of_two_mirrors_returns_what_meets_both() {
    // Mirrors at 45 degrees: of light of slope t <= 1 across the groove, 1 - t meets both and goes back where it came from in
    // the plane across the groove, t meets one (geometry of the two reflections).
    let rho = 0.8;
    let mut parts = made_of(mirror(rho));
    let h = 0.5 * PERIOD;
    let (low, high) = (-PERIOD, 2.0 * PERIOD);
    quad(
        &mut parts,
        [[low, 0.0, 0.0], [high, 0.0, 0.0], [high, h, -h], [low, h, -h]],
    );
    quad(
        &mut parts,
        [
            [low, h, -h],
            [high, h, -h],
            [high, PERIOD, 0.0],
            [low, PERIOD, 0.0],
        ],
    );
    let tables = measured(parts, 16_384);
    let basis = KlemsBasis::quarter();
    let mut seen = 0;
    for patch in 0..basis.len() {
        let steepest = [0.0, 0.5, 1.0]
            .iter()
            .flat_map(|u| {
                [0.0, 0.25, 0.5, 0.75, 1.0].map(|v| basis.point(patch, Role::Incident, Side::Front, *u, v))
            })
            .map(slope)
            .fold(0.0, f64::max);
        if steepest > 1.0 {
            continue;
        }
        seen += 1;
        let wanted = over_patch(patch, |d| rho * rho * (1.0 - slope(d)) + rho * slope(d));
        let (found, error) = albedo(&tables, Side::Front, Component::Reflection, patch);
        assert!(
            (found - wanted).abs() < 5.0 * error,
            "{patch}: {found} {wanted} {error}"
        );
        assert!(error < 5e-3, "{error}");
    }
    assert!(seen >= 9, "{seen}");
}

#[test]
fn black_slats_let_pass_what_goes_between_them() {
    // Slats of depth w at right angles to the plane, p apart: 1 - (w / p) t passes.
    let mut parts = made_of(Material::Black);
    let depth = 0.4 * PERIOD;
    let (low, high) = (-PERIOD, 2.0 * PERIOD);
    let y = 0.5 * PERIOD;
    quad(
        &mut parts,
        [[low, y, 0.0], [high, y, 0.0], [high, y, depth], [low, y, depth]],
    );
    // An extent along y that says where the period is.
    quad(
        &mut parts,
        [
            [low, 0.0, 0.0],
            [low, 0.0, 1e-6],
            [low, PERIOD, 1e-6],
            [low, PERIOD, 0.0],
        ],
    );
    let tables = measured(parts, 16_384);
    for patch in 0..KlemsBasis::quarter().len() {
        let wanted = over_patch(patch, |d| (1.0 - 0.4 * slope(d)).max(0.0));
        for side in Side::BOTH {
            let (found, error) = albedo(&tables, side, Component::Transmission, patch);
            let off = (found - wanted).abs();
            assert!(
                off < 5.0 * error + 1e-4,
                "{side:?} {patch}: {found} {wanted} {error}"
            );
            assert!(error < 0.01, "{error}");
        }
    }
}

#[test]
fn white_slats_lose_no_light() {
    let mut parts = made_of(grey(1.0));
    let (low, high) = (-PERIOD, 2.0 * PERIOD);
    quad(
        &mut parts,
        [
            [low, 0.01, 0.0],
            [high, 0.01, 0.0],
            [high, 0.09, 0.07],
            [low, 0.09, 0.07],
        ],
    );
    let tables = measured(parts, 4096);
    for side in Side::BOTH {
        for patch in 0..KlemsBasis::quarter().len() {
            let (reflected, u) = albedo(&tables, side, Component::Reflection, patch);
            let (through, v) = albedo(&tables, side, Component::Transmission, patch);
            // What two estimates of a pair share makes the sum scatter a little: 6 standard errors and .2 %.
            let off = (reflected + through - 1.0).abs();
            assert!(
                off < 6.0 * u.hypot(v) + 2e-3,
                "{side:?} {patch}: {reflected} {through} {u} {v}"
            );
        }
    }
}

#[test]
fn one_side_knows_the_other_by_reciprocity() {
    let mut parts = made_of(grey(0.5));
    let (low, high) = (-PERIOD, 2.0 * PERIOD);
    quad(
        &mut parts,
        [
            [low, 0.01, 0.0],
            [high, 0.01, 0.0],
            [high, 0.09, 0.07],
            [low, 0.09, 0.07],
        ],
    );
    let extent = Extent {
        window: Some([0.0, 0.0, PERIOD, PERIOD]),
        periodic: true,
    };
    let device = Device::new(parts, extent).unwrap();
    let of = |sides, seed| {
        let effort = Effort {
            rays: 4096,
            sides,
            seed,
            ..Effort::default()
        };
        patch_tables(
            &device,
            &KlemsBasis::quarter(),
            &effort,
            &Default::default(),
            &|_| {},
        )
        .unwrap()
    };
    let (front, back) = (of([true, false], 1), of([false, true], 2));
    assert!(front.get(Side::Back, Component::Reflection).is_none());
    let [a, b] = [&front, &back].map(|t| t.get(Side::Front, Component::Transmission).unwrap());
    let mut beyond = 0;
    for k in 0..a.values.len() {
        let error = a.errors[k].hypot(b.errors[k]);
        beyond += usize::from((a.luminance(k) - b.luminance(k)).abs() > 3.0 * error.max(1e-9));
    }
    // Of 1681 pairs some 0.5 % lie beyond three errors by chance, those few rays reach more.
    assert!(beyond < 50, "{beyond}");
    assert_eq!(of([true, false], 1), front);
}

#[test]
fn a_part_without_extent_and_a_window_beside_it_are_refused() {
    let flat = Extent::default();
    let error = Device::new(made_of(grey(0.5)), flat).err().unwrap().to_string();
    assert!(
        error.contains("geometry") && error.contains("extent in x and y"),
        "{error}"
    );
    let mut parts = made_of(grey(0.5));
    quad(
        &mut parts,
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
    );
    let beside = Extent {
        window: Some([0.5, 0.5, 1.5, 0.6]),
        periodic: false,
    };
    let error = Device::new(parts, beside).err().unwrap().to_string();
    assert!(
        error.contains("window") && error.contains("0.5 0.5 1.5 0.6"),
        "{error}"
    );
}

#[test]
fn a_glass_plate_divides_light_as_fresnel_says() {
    let mut parts = glass();
    block(&mut parts, [PERIOD, PERIOD, 0.02]);
    // The plate goes on beyond the period: no sides.
    parts.triangles.truncate(4);
    parts.triangle_surface.truncate(4);
    let tables = measured(parts, 2048);
    let reflected = |d: Direction| {
        let cos = d.vec().z.abs();
        let inside = (1.0 - (1.0 - cos * cos) / 2.25).sqrt();
        let r = |a: f64, b: f64| ((a - b) / (a + b)).powi(2);
        // Each polarisation goes to and fro on its own in the plate; here light is unpolarised at each face, as in RADIANCE.
        let r = 0.5 * (r(cos, 1.5 * inside) + r(inside, 1.5 * cos));
        2.0 * r / (1.0 + r)
    };
    for patch in 0..KlemsBasis::quarter().len() {
        let wanted = over_patch(patch, reflected);
        for side in Side::BOTH {
            for (component, wanted) in [
                (Component::Reflection, wanted),
                (Component::Transmission, 1.0 - wanted),
            ] {
                let (found, error) = albedo(&tables, side, component, patch);
                let off = (found - wanted).abs();
                assert!(
                    off < 5.0 * error + 1e-5,
                    "{side:?} {component:?} {patch}: {found} {wanted} {error}"
                );
                assert!(error < 0.01, "{error}");
            }
        }
    }
}

/// A block of glass as a part that stands alone, lit from the front.
fn lone_block(rays: u32, seed: u64) -> FourComponents<PatchTable> {
    let mut parts = glass();
    block(&mut parts, [0.1, 0.1, 0.05]);
    let device = Device::new(parts, Extent::default()).unwrap();
    let effort = Effort {
        rays,
        sides: [true, false],
        limits: gonio_trace::path::Limits {
            bounces: 1024,
            ..Default::default()
        },
        seed,
    };
    patch_tables(
        &device,
        &KlemsBasis::quarter(),
        &effort,
        &Default::default(),
        &|_| {},
    )
    .unwrap()
}

#[test]
fn a_part_that_stands_alone_sends_out_all_light_that_falls_on_its_window() {
    let tables = lone_block(2048, 1);
    for patch in 0..KlemsBasis::quarter().len() {
        let (reflected, u) = albedo(&tables, Side::Front, Component::Reflection, patch);
        let (through, v) = albedo(&tables, Side::Front, Component::Transmission, patch);
        // Of light that leaves beside the window some goes on behind the part, some before it.
        let off = (reflected + through - 1.0).abs();
        assert!(
            off < 5.0 * u.hypot(v) + 1e-4,
            "{patch}: {reflected} {through} {u} {v}"
        );
    }
}

#[test]
fn standard_errors_are_the_scatter_of_other_seeds() {
    let runs: Vec<_> = (1..=24).map(|seed| lone_block(512, seed)).collect();
    for component in [Component::Reflection, Component::Transmission] {
        let tables: Vec<&PatchTable> = runs
            .iter()
            .map(|t| t.get(Side::Front, component).unwrap())
            .collect();
        let n = tables.len() as f64;
        let (mut scatter, mut claimed) = (0.0, 0.0);
        for k in 0..tables[0].errors.len() {
            let mean = tables.iter().map(|t| t.luminance(k)).sum::<f64>() / n;
            let square = tables.iter().map(|t| (t.luminance(k) - mean).powi(2));
            scatter += square.sum::<f64>() / (n - 1.0);
            claimed += tables.iter().map(|t| t.errors[k].powi(2)).sum::<f64>() / n;
        }
        // The brightest of the pairs decide, some twenty with 23 degrees of freedom each: the ratio scatters by 7 %.
        let ratio = scatter / claimed;
        assert!((ratio - 1.0).abs() < 0.3, "{component:?}: {ratio}");
    }
}

#[test]
fn numbers_of_rays_are_rounded_up_in_steps_of_a_quarter_at_most() {
    for rays in 1..5000 {
        let rounded = Effort::rounded(rays);
        assert!(
            rounded >= rays && rounded <= rays.div_ceil(16) * 20,
            "{rays}: {rounded}"
        );
        assert_eq!(Effort::rounded(rounded), rounded);
    }
    assert_eq!(Effort::rounded(2600), 3072);
}
