//! Whether a blank belongs to the sample it is subtracted from.

use gonio_bsdf::Quantity;
use gonio_geom::Angles;

use crate::dark::{DarkMethod, DarkSummary};
use crate::verdict::graded;
use crate::{Flags, Level, NoiseModel, Scan, Verdict};

const ID: &str = "blank_match";
const TITLE: &str = "Blank matches the sample";
/// Share of significantly negative readings that warns, and that fails.
const NEGATIVE: [f64; 2] = [0.02, 0.2];
/// Share of a blank's own readings significantly below zero that warns, for quantities that cannot be negative.
const BELOW_ZERO: f64 = 0.2;
/// How far the blank's structure may be from its own amplitude in the sample before it warns.
const STRUCTURE: f64 = 0.5;

/// Judges a subtraction: `net` is the record after it, `raw` its values before.
///
/// Three signs give a wrong blank away. It takes more than was there: readings below zero by more than three standard
/// deviations. And its own structure (stray light steps along the path) is not in the raw readings: with second
/// differences along the path, which leave the smooth signal of the sample behind, raw = kappa blank, and kappa is 1
/// for the right blank, 0 for one whose stray light the sample's scan does not hold. A blank that is a BSDF or DSF
/// (the instrument has taken a zero of its own off) cannot be negative: then that zero was another one.
pub(crate) fn blank_match(
    net: &Scan,
    raw: &[f64],
    flags: &[Flags],
    noise: &NoiseModel,
    dark: &DarkSummary,
) -> Verdict {
    let sigma = noise.readout.hypot(dark.u_independent).hypot(dark.u_common);
    let usable: Vec<usize> = (0..net.len())
        .filter(|&j| flags[j].usable() && net.value[j].is_finite())
        .collect();
    let at = place(net.incidence);
    if usable.is_empty() {
        return Verdict::not_applicable(ID, TITLE, format!("{at}: no usable reading."));
    }
    let share =
        |limit: f64| usable.iter().filter(|&&j| net.value[j] < limit).count() as f64 / usable.len() as f64;
    let negative = share(-3.0 * sigma);
    let kappa = (dark.method == DarkMethod::Direction)
        .then(|| structure(net, raw, flags, noise))
        .flatten();
    let what = if dark.method == DarkMethod::Direction {
        "blank"
    } else {
        "dark"
    };
    let below = usable
        .iter()
        .filter(|&&j| raw[j] - net.value[j] < -3.0 * sigma)
        .count();
    let below = below as f64 / usable.len() as f64;
    let mut causes: Vec<(Level, f64, &'static str, String)> = Vec::new();
    let of_negative = graded(negative, NEGATIVE[0], NEGATIVE[1]);
    if of_negative > Level::Pass {
        let text = format!(
            "{:.0} % of the readings are negative by more than three standard deviations after the {what} was \
             subtracted: it takes more than was there",
            100.0 * negative
        );
        causes.push((of_negative, 100.0 * negative, "%", text));
    }
    if net.quantity != Quantity::Signal && below > BELOW_ZERO {
        let text = format!(
            "{:.0} % of the {what} itself lies below zero, which no stray light does: the instrument's own zero was \
             another one",
            100.0 * below
        );
        causes.push((Level::Warn, 100.0 * below, "%", text));
    }
    if let Some((kappa, u)) = kappa
        && (kappa - 1.0).abs() > STRUCTURE.max(3.0 * u)
    {
        let text = format!(
            "the {what}'s structure is in the readings by a factor {kappa:.2} (± {u:.2}) in place of 1: its stray light \
             is not that of the sample's scan"
        );
        causes.push((Level::Warn, kappa, "1", text));
    }
    // The gravest first; of equal ones that which was found first.
    causes.sort_by_key(|c| std::cmp::Reverse(c.0));
    let (level, value, unit, sentence) = match causes.first() {
        None => (
            Level::Pass,
            100.0 * negative,
            "%",
            format!(
                "{:.1} % of the readings are negative by more than three standard deviations after the {what} was \
                 subtracted ({at}).",
                100.0 * negative
            ),
        ),
        Some(&(level, value, unit, _)) => {
            let texts: Vec<&str> = causes.iter().map(|c| c.3.as_str()).collect();
            (
                level,
                value,
                unit,
                format!(
                    "{} ({at}). Repeat the {what} with the stray light, gain, zero and source of the sample.",
                    capital(&texts.join("; "))
                ),
            )
        }
    };
    Verdict {
        id: ID,
        title: TITLE,
        level,
        value: Some(value),
        unit,
        sentence,
    }
}

fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars
        .next()
        .map_or(String::new(), |c| c.to_uppercase().chain(chars).collect())
}

/// One finding for all scans: the gravest, with the number of others that are as grave.
pub(crate) fn summed_up(findings: Vec<Verdict>) -> Option<Verdict> {
    let level = findings.iter().map(|f| f.level).max()?;
    let graves: Vec<Verdict> = findings.into_iter().filter(|f| f.level == level).collect();
    let others = graves.len() - 1;
    let mut worst = graves
        .into_iter()
        .reduce(|a, b| if b.value > a.value { b } else { a })?;
    if level > Level::Pass && others > 0 {
        let scans = if others == 1 { "scan" } else { "scans" };
        worst
            .sentence
            .push_str(&format!(" {others} more {scans} show the same."));
    }
    Some(worst)
}

/// `theta_i 30.00, phi_i 0.00 deg`.
pub(crate) fn place(at: Angles) -> String {
    let (theta, phi) = at.to_degrees();
    format!("theta_i {theta:.2}, phi_i {phi:.2} deg")
}

/// Weighted median of raw over blank second differences where the blank's stand out of the noise, with a robust
/// standard error; `None` when fewer than 20 do or they decide nothing.
fn structure(net: &Scan, raw: &[f64], flags: &[Flags], noise: &NoiseModel) -> Option<(f64, f64)> {
    let blank = |j: usize| raw[j] - net.value[j];
    let second = |v: &dyn Fn(usize) -> f64, j: usize| v(j - 1) - 2.0 * v(j) + v(j + 1);
    let floor = 5.0 * 6.0_f64.sqrt() * noise.readout;
    let mut ratios: Vec<f64> = (1..net.len().saturating_sub(1))
        .filter(|&j| flags[j - 1..=j + 1].iter().all(|f| f.usable()))
        .filter(|&j| {
            let turn = net.direction(j - 1).angle_to(net.direction(j + 1));
            let steps = net.direction(j - 1).angle_to(net.direction(j))
                + net.direction(j).angle_to(net.direction(j + 1));
            turn > 0.9 * steps
        })
        .filter_map(|j| {
            let of_blank = second(&blank, j);
            // A sample whose own structure dwarfs the blank's says nothing about it.
            let quiet = raw[j].abs() < 20.0 * of_blank.abs();
            (of_blank.abs() > floor && of_blank != 0.0 && quiet).then(|| second(&|k| raw[k], j) / of_blank)
        })
        .collect();
    if ratios.len() < 20 {
        return None;
    }
    let n = ratios.len() as f64;
    let centre = crate::robust::median(&mut ratios)?;
    let mut around: Vec<f64> = ratios.iter().map(|r| r - centre).collect();
    let u = 1.25 * crate::robust::sigma_about_zero(&mut around)? / n.sqrt();
    (u < 0.3).then_some((centre, u))
}
