//! CIE skies.

use std::f64::consts::PI;

use super::words::{GenerateError, HIGHEST, Words, e3, f6, solar};
use crate::sky::cie::Kind;
use crate::sky::sun::{Moment, Site, direction};

const OPTIONS: &str = "-s +s -c -u -i +i, and with a value -y -g -b -B -t -r -R -a -o -m";

/// lm/W of RADIANCE's sky and sun.
const SKY_EFFICACY: f64 = 203.0;
const SUN_EFFICACY: f64 = 208.0;

/// Clocks by their names: meridians, degrees west of Greenwich. Of two of a name the first is meant.
const ZONES: [(&str, f64); 26] = [
    ("YST", 135.0),
    ("YDT", 120.0),
    ("PST", 120.0),
    ("PDT", 105.0),
    ("MST", 105.0),
    ("MDT", 90.0),
    ("CST", 90.0),
    ("CDT", 75.0),
    ("EST", 75.0),
    ("EDT", 60.0),
    ("AST", 60.0),
    ("ADT", 45.0),
    ("NST", 52.5),
    ("NDT", 37.5),
    ("GMT", 0.0),
    ("BST", -15.0),
    ("CET", -15.0),
    ("CEST", -30.0),
    ("EET", -30.0),
    ("EEST", -45.0),
    ("GST", -60.0),
    ("GDT", -75.0),
    ("IST", -82.5),
    ("IDT", -97.5),
    ("JST", -135.0),
    ("NZST", -180.0),
];
/// New Zealand's summer.
const NZDT: f64 = -195.0;

const HOUR: &str = "an hour such as 14.5, 14:30, 14:30CET, or +14.5 for solar time";

/// Hours, whether solar, and the meridian where the word names a clock.
fn hour(words: &mut Words) -> Result<(f64, bool, Option<f64>), GenerateError> {
    let word = words.next().unwrap_or("");
    let (is_solar, time) = word.strip_prefix('+').map_or((false, word), |time| (true, time));
    let end = time.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(time.len());
    let (time, zone) = time.split_at(end);
    let hours = match time.split_once(':') {
        Some((hours, minutes)) => hours
            .parse::<u32>()
            .ok()
            .zip(minutes.parse::<u32>().ok())
            .map(|(h, m)| f64::from(h) + f64::from(m) / 60.0),
        None => time.parse::<f64>().ok(),
    };
    let Some(hours) = hours.filter(|h| h.is_finite() && *h >= 0.0) else {
        return words.wrong("the hour", word, HOUR);
    };
    if zone.is_empty() {
        return Ok((hours, is_solar, None));
    }
    let upper = zone.to_ascii_uppercase();
    let named = ZONES
        .iter()
        .find(|(name, _)| *name == upper)
        .map(|(_, meridian)| *meridian);
    match named.or((upper == "NZDT").then_some(NZDT)) {
        Some(meridian) if !is_solar => Ok((hours, false, Some(meridian.to_radians()))),
        _ => words.wrong("the hour", word, HOUR),
    }
}

/// What a sky's brightness is set by.
#[derive(Clone, Copy)]
enum Set {
    Weather,
    Radiance(f64),
    Irradiance(f64),
}

/// Text of the scene that RADIANCE's `gensky` writes for these words (without the name of the program): the sun, when there
/// is one, and the pattern `skyfunc`.
///
/// # Errors
/// [`GenerateError`], naming the word.
///
/// ```
/// let text = gonio_scene::generate::gensky(&["-ang", "45", "0", "+s"])?;
/// assert!(text.contains("4 -0.000000 -0.707107 0.707107 0.5"));
/// # Ok::<(), gonio_scene::generate::GenerateError>(())
/// ```
pub fn gensky(words: &[&str]) -> Result<String, GenerateError> {
    let line = words.join(" ");
    let mut words = Words::new("gensky", words);
    let (mut site, mut moment, mut clock) = (Site::default(), None, None);
    let (mut altitude, mut azimuth) = (0.0, 0.0);
    if line.starts_with("-ang ") {
        words.next();
        altitude = words.angle("the altitude of -ang")?;
        azimuth = words.angle("the azimuth of -ang")?;
    } else {
        let month = words
            .whole("the month", 1, 12, "1 to 12, or -ang with two angles")?
            .unsigned_abs();
        let day = words.whole("the day", 1, 31, "1 to 31")?.unsigned_abs();
        let (hour, is_solar, meridian) = hour(&mut words)?;
        clock = meridian;
        moment = Some(Moment {
            year: None,
            month,
            day,
            hour,
            solar: is_solar,
        });
    }
    let (mut kind, mut sun, mut year) = (Kind::Clear, true, None);
    let (mut zenith, mut disc) = (Set::Weather, Set::Weather);
    let (mut turbidity, mut reflectance) = (2.45, 0.2);
    while let Some(word) = words.next() {
        match word {
            "-s" | "+s" => (kind, sun) = (Kind::Clear, word == "+s"),
            "-i" | "+i" => (kind, sun) = (Kind::Intermediate, word == "+i"),
            "-c" | "+c" => kind = Kind::Overcast,
            "-u" | "+u" => kind = Kind::Uniform,
            "-y" => {
                year = Some(words.whole("the year of -y", 1, 9999, "1950 to 2050 (1 to 9999 is taken)")?)
            }
            "-b" => zenith = Set::Radiance(words.number("the value of -b")?),
            "-B" => zenith = Set::Irradiance(words.number("the value of -B")?),
            "-r" => disc = Set::Radiance(words.number("the value of -r")?),
            "-R" => disc = Set::Irradiance(words.number("the value of -R")?),
            "-t" => turbidity = words.number("the value of -t")?,
            "-g" => reflectance = words.number("the value of -g")?,
            "-a" => site.latitude = words.angle("the value of -a")?,
            "-o" => site.longitude = words.angle("the value of -o")?,
            "-m" => site.meridian = words.angle("the value of -m")?,
            _ => return words.unknown(word, OPTIONS),
        }
    }
    site.meridian = clock.unwrap_or(site.meridian);
    let mut text = format!("# gensky {line}\n");
    if let Some(moment) = moment {
        let position = Moment { year, ..moment }.sun(&site);
        (altitude, azimuth) = (position.altitude, position.azimuth);
        text += &format!(
            "# Local solar time: {:.2}\n# Solar altitude and azimuth: {:.1} {:.1}\n",
            position.solar_time,
            altitude.to_degrees(),
            azimuth.to_degrees()
        );
    }
    let hidden = kind.hides_the_sun();
    if !hidden && altitude > HIGHEST.to_radians() {
        altitude = HIGHEST.to_radians();
        text += "# the sun is lowered to 87 degrees\n";
    }
    let toward = direction(altitude, azimuth);
    let horizontal = kind.horizontal(altitude);
    let overcast = 8.6 * toward[2] + 0.123;
    let zenith = match zenith {
        Set::Radiance(radiance) => radiance,
        Set::Irradiance(irradiance) => irradiance / (horizontal * PI),
        Set::Weather => {
            let clear = (1.376 * turbidity - 1.81) * altitude.tan() + 0.38;
            let kcd = match kind {
                Kind::Clear => clear,
                Kind::Intermediate => (clear + overcast) / 2.0,
                Kind::Overcast | Kind::Uniform => overcast,
            };
            kcd.max(0.0) * 1000.0 / SKY_EFFICACY
        }
    };
    let mut ground = zenith * horizontal;
    text += &format!("# Ground ambient level: {ground:.1}\n");
    let radiance = match disc {
        Set::Radiance(radiance) => radiance,
        Set::Irradiance(irradiance) if irradiance > 0.0 => irradiance / (5.98e-5 * toward[2]),
        Set::Irradiance(_) => 0.0,
        Set::Weather => {
            let share = if kind == Kind::Intermediate { 0.15 } else { 1.0 };
            share * 1.5e9 / SUN_EFFICACY * (1.147 - 0.147 / toward[2].max(0.16))
        }
    };
    if !hidden && toward[2] > 0.0 && radiance > 0.0 {
        ground += 6e-5 / PI * radiance * toward[2];
        if sun {
            text += &solar(&e3(radiance), toward, "0.5");
        }
    }
    let number = match kind {
        Kind::Clear => 1,
        Kind::Overcast => 2,
        Kind::Uniform => 3,
        Kind::Intermediate => 4,
    };
    let (zenith, ground) = (e3(zenith), e3(ground * reflectance));
    text += "\nvoid brightfunc skyfunc\n2 skybr skybright.cal\n0\n";
    text += &if hidden {
        format!("3 {number} {zenith} {ground}\n")
    } else {
        let relative = e3(kind.zenith_relative(altitude));
        format!("7 {number} {zenith} {ground} {relative} {}\n", f6(toward))
    };
    Ok(text)
}
