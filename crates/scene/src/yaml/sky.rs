//! Skies and the sun, by place and time or by the place of the sun.

use gonio_io::radiance_material;

use super::item;
use super::node::{Field, Record};
use crate::error::SceneError;
use crate::generate;
use crate::text::{Change, Entry, Xform};

/// The kinds, and what `gensky` calls them with and without the sun; `gendaylit` makes the first.
const KINDS: [(&str, Option<[&str; 2]>); 5] = [
    ("perez", None),
    ("clear", Some(["+s", "-s"])),
    ("intermediate", Some(["+i", "-i"])),
    ("overcast", Some(["-c", "-c"])),
    ("uniform", Some(["-u", "-u"])),
];

pub(super) fn read(field: &Field<'_>) -> Result<Vec<Entry>, SceneError> {
    let record = field.record(&[
        "kind",
        "sun",
        "place",
        "time",
        "direct_normal",
        "diffuse_horizontal",
        "illuminance",
        "ground",
        "show_sun",
        "north",
    ])?;
    let kind = record.need("kind")?.one_of(&KINDS)?;
    let mut words = moment(&record)?;
    let show_sun = record.get("show_sun").map_or(Ok(true), Field::truth)?;
    if let Some(ground) = record.get("ground") {
        words.extend(["-g".into(), ground.number(0.0..=1.0)?.to_string()]);
    }
    let lux = record
        .get("illuminance")
        .map(|f| f.number(0.0..=1e7))
        .transpose()?;
    let weather = ["direct_normal", "diffuse_horizontal"].map(|name| record.get(name));
    let place = field.place();
    let wrong = |e: String| field.fault(e, "a sky of this kind");
    let text = match kind {
        None => {
            let [Some(direct), Some(diffuse)] = weather else {
                let allowed = "direct_normal and diffuse_horizontal in W/m2, for a perez sky";
                return Err(field.fault("a perez sky without its weather", allowed));
            };
            if let Some(field) = record.get("illuminance") {
                return Err(field.fault(
                    "illuminance",
                    "direct_normal and diffuse_horizontal, for a perez sky",
                ));
            }
            words.push("-W".into());
            for field in [direct, diffuse] {
                words.push(field.number(0.0..=1500.0)?.to_string());
            }
            if !show_sun {
                words.push("-s".into());
            }
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            generate::gendaylit(&words).map_err(|e| wrong(e.to_string()))?
        }
        Some(options) => {
            if let Some(field) = weather.into_iter().flatten().next() {
                return Err(field.fault("a CIE sky with weather", "illuminance in lx, or kind: perez"));
            }
            words.push(options[usize::from(!show_sun)].into());
            if let Some(lux) = lux {
                // Horizontal irradiance of the sky without the sun.
                words.extend(["-B".into(), (lux / 179.0).to_string()]);
            }
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            generate::gensky(&words).map_err(|e| wrong(e.to_string()))?
        }
    };
    let items = radiance_material::read_from(&place.file, text.as_bytes())?;
    let mut entries: Vec<Entry> = items
        .into_iter()
        .map(|item| Entry {
            item,
            place: place.clone(),
        })
        .collect();
    for (name, z) in [("sky", 1.0), ("ground", -1.0)] {
        let glow = format!("{name}_glow");
        let white = vec![1.0, 1.0, 1.0, 0.0];
        entries.push(item("skyfunc", "glow", &glow, vec![], white, &place));
        entries.push(item(
            &glow,
            "source",
            name,
            vec![],
            vec![0.0, 0.0, z, 180.0],
            &place,
        ));
    }
    if let Some(north) = record.get("north") {
        let degrees = north.number(-360.0..=360.0)?;
        // Clockwise from y, seen from above.
        let words = ["-rz".to_owned(), (-degrees).to_string()];
        let (xform, _) = Xform::parse(&words).map_err(|(found, allowed)| north.fault(found, allowed))?;
        let change = Change {
            xform,
            words: words.to_vec(),
            modifier: None,
            prefix: None,
            invert: false,
        };
        for entry in &mut entries {
            change.apply(&mut entry.item, &place)?;
        }
    }
    Ok(entries)
}

/// The words for where the sun stands.
fn moment(record: &Record<'_>) -> Result<Vec<String>, SceneError> {
    let way = "sun: {altitude: …, azimuth: …}, or place: {latitude: …, longitude: …, time_zone: …} with time: 2026-06-21 10:30";
    match (record.get("sun"), record.get("place"), record.get("time")) {
        (Some(sun), None, None) => {
            let sun = sun.record(&["altitude", "azimuth"])?;
            let altitude = sun.need("altitude")?.number(-90.0..=90.0)?;
            let compass = sun.need("azimuth")?.number(-360.0..=360.0)?;
            // RADIANCE counts from south to west.
            Ok(vec![
                "-ang".into(),
                altitude.to_string(),
                (compass - 180.0).to_string(),
            ])
        }
        (None, Some(place), Some(time)) => {
            let place = place.record(&["latitude", "longitude", "time_zone"])?;
            let latitude = place.need("latitude")?.number(-90.0..=90.0)?;
            let longitude = place.need("longitude")?.number(-180.0..=180.0)?;
            let zone = place.need("time_zone")?.number(-14.0..=14.0)?;
            let [year, month, day, hour] = date(time)?;
            // RADIANCE counts to the west.
            let words = [
                month,
                day,
                hour,
                "-y".into(),
                year,
                "-a".into(),
                latitude.to_string(),
                "-o".into(),
                (-longitude).to_string(),
                "-m".into(),
                (-15.0 * zone).to_string(),
            ];
            Ok(words.to_vec())
        }
        _ => Err(record.field.fault("no place of the sun, or two", way)),
    }
}

/// Year, month, day and hours of `2026-06-21 10:30`.
fn date(field: &Field<'_>) -> Result<[String; 4], SceneError> {
    let allowed = "a date and time of the clock, such as 2026-06-21 10:30";
    let text = field.text(allowed)?;
    let parse = || {
        let (date, clock) = text.trim().split_once([' ', 'T'])?;
        let date: Vec<u32> = date.split('-').map(|w| w.parse().ok()).collect::<Option<_>>()?;
        let clock: Vec<u32> = clock.split(':').map(|w| w.parse().ok()).collect::<Option<_>>()?;
        let ([year, month, day], [hour, minute]) = (date.as_slice(), clock.as_slice()) else {
            return None;
        };
        let days = match month {
            2 if year % 4 == 0 && (year % 100 != 0 || year % 400 == 0) => 29,
            2 => 28,
            4 | 6 | 9 | 11 => 30,
            _ => 31,
        };
        let fits = (1950..=2050).contains(year)
            && (1..=12).contains(month)
            && (1..=days).contains(day)
            && *hour < 24
            && *minute < 60;
        let hours = f64::from(*hour) + f64::from(*minute) / 60.0;
        fits.then(|| {
            [
                year.to_string(),
                month.to_string(),
                day.to_string(),
                hours.to_string(),
            ]
        })
    };
    parse().ok_or_else(|| field.fault(format!("{text:?}"), allowed))
}
