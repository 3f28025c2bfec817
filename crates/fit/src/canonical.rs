//! One description of an anisotropic lobe where several mean the same.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use crate::FitOptions;
use crate::data::FitData;
use crate::fitting::Setting;
use crate::refine::settle;
use crate::solver::Solution;

/// An azimuth and the pair of widths along and across it.
const AXES: [(&str, &str, &str); 2] = [("phi_x", "alpha_x", "alpha_y"), ("phi_x", "n_u", "n_v")];

/// Turns every lobe so that `phi_x` lies in `(-45, 45]` degrees: a half turn changes nothing, a quarter turn swaps the
/// widths. The minimum is the same and is found again from there.
pub(crate) fn canonical(
    setting: &Setting<'_>,
    data: &mut FitData,
    solution: Solution,
    options: &FitOptions<'_>,
) -> Solution {
    let mut x = solution.x.clone();
    let find = |name: &str| -> Vec<usize> {
        let parameter = setting.chart.model.position(name);
        (0..setting.chart.len())
            .filter(|&k| Some(setting.chart.variables[k].parameter) == parameter)
            .collect()
    };
    for (phi, along, across) in AXES {
        let (phi, along, across) = (find(phi), find(along), find(across));
        let ([phi], [along], [across]) = (&phi[..], &along[..], &across[..]) else {
            continue;
        };
        if [phi, along, across].iter().any(|k| setting.held[**k]) {
            continue;
        }
        let half = x[*phi] - PI * (x[*phi] / PI).round();
        x[*phi] = half;
        if half > FRAC_PI_4 || half <= -FRAC_PI_4 {
            x[*phi] -= FRAC_PI_2.copysign(half);
            x.swap(*along, *across);
        }
    }
    if x == solution.x {
        return solution;
    }
    let mut found = settle(
        &setting.chart,
        data,
        setting.goal,
        &x,
        setting.bounds(),
        &setting.solver(options),
    );
    found.evaluations += solution.evaluations;
    found
}
