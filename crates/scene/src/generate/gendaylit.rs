//! Perez skies.

use super::words::{GenerateError, HIGHEST, Words, e3, f6, solar};
use crate::sky::perez::{Given, Output, PerezSky, Weather};
use crate::sky::sun::{Moment, Site, direction};

const OPTIONS: &str = "-P -W -L -G with two values, -E -O -y -i -d -g -a -o -m -b -t -R with one, -s +s -c +c -w without (-C and -l, colour, are not made)";

/// Text of the scene that RADIANCE's `gendaylit` writes for these words (without the name of the program): the sun, when
/// there is one, and the pattern `skyfunc`. Where the light cannot be what is said (no light with the sun up, more than
/// the sun gives, the sun below the horizon at a date and time) the sky is black, as the program writes it.
///
/// # Errors
/// [`GenerateError`], naming the word.
///
/// ```
/// let text = gonio_scene::generate::gendaylit(&["-ang", "40", "20", "-W", "500", "150"])?;
/// assert!(text.contains("2 skybright perezlum.cal"));
/// # Ok::<(), gonio_scene::generate::GenerateError>(())
/// ```
pub fn gendaylit(words: &[&str]) -> Result<String, GenerateError> {
    let line = words.join(" ");
    let mut words = Words::new("gendaylit", words);
    let (mut site, mut moment) = (Site::default(), None);
    let mut weather = Weather {
        altitude: 0.0,
        azimuth: 0.0,
        day: 0.0,
        given: Given::Indices(0.0, 0.0),
        output: Output::Visible,
        water: water(STANDARD_DEW_POINT),
        sun: true,
        ground_reflectance: 0.2,
    };
    if line.starts_with("-ang ") {
        words.next();
        weather.altitude = words.angle("the altitude of -ang")?;
        weather.azimuth = words.angle("the azimuth of -ang")?;
    } else {
        let month = words
            .whole("the month", 1, 12, "1 to 12, or -ang with two angles")?
            .unsigned_abs();
        let day = words.whole("the day", 1, 31, "1 to 31")?.unsigned_abs();
        let word = words.next().unwrap_or("");
        let hour = match word.parse::<f64>() {
            Ok(hour) if (0.0..24.0).contains(&hour) => hour,
            _ => {
                return words.wrong(
                    "the hour",
                    word,
                    "0 or more and below 24, such as 14.5, or +14.5 for solar time",
                );
            }
        };
        moment = Some(Moment {
            year: None,
            month,
            day,
            hour,
            solar: word.starts_with('+'),
        });
    }
    let (mut cloudy, mut year, mut interval) = (false, None, 0.0);
    while let Some(word) = words.next() {
        let two = |words: &mut Words| {
            let first = words.number(&format!("the first value of {word}"))?;
            Ok((first, words.number(&format!("the second value of {word}"))?))
        };
        let what = format!("the value of {word}");
        match word {
            "-P" => weather.given = two(&mut words).map(|(a, b)| Given::Indices(a, b))?,
            "-W" => weather.given = two(&mut words).map(|(a, b)| Given::Irradiance(a, b))?,
            "-L" => weather.given = two(&mut words).map(|(a, b)| Given::Illuminance(a, b))?,
            "-G" => weather.given = two(&mut words).map(|(a, b)| Given::HorizontalIrradiance(a, b))?,
            "-E" => weather.given = Given::Global(words.number(&what)?),
            "-O" => {
                weather.output = match words.whole(&what, 0, 2, "0 (visible), 1 (solar) or 2 (luminance)")? {
                    0 => Output::Visible,
                    1 => Output::Solar,
                    _ => Output::Luminance,
                }
            }
            "-s" | "+s" => (cloudy, weather.sun) = (false, word == "+s"),
            "-c" | "+c" => (cloudy, weather.sun) = (true, false),
            "-y" => year = Some(words.whole(&what, 1, 9999, "1950 to 2050 (1 to 9999 is taken)")?),
            "-i" => {
                interval = words.number(&what)?;
                if interval < 0.0 {
                    return words.wrong(&what, &interval.to_string(), "minutes, 0 or more");
                }
            }
            "-d" => {
                let point = words.number(&what)?;
                weather.water = water(if (-40.0..=40.0).contains(&point) {
                    point
                } else {
                    STANDARD_DEW_POINT
                });
            }
            "-g" => weather.ground_reflectance = words.number(&what)?,
            "-a" => site.latitude = words.angle(&what)?,
            "-o" => site.longitude = words.angle(&what)?,
            "-m" => site.meridian = words.angle(&what)?,
            // Taken by the program and of no effect.
            "-b" | "-t" | "-R" => drop(words.number(&what)?),
            "-w" => {}
            _ => return words.unknown(word, OPTIONS),
        }
    }
    let mut up = true;
    let mut time = 0.0;
    if let Some(moment) = moment {
        let moment = Moment { year, ..moment };
        time = moment.sun(&site).solar_time;
        let (rise, set) = moment.day_span(&site);
        // Half of the time that the readings are means of, hours.
        let half = interval / 120.0;
        if interval > 0.0 && (rise - time).abs() <= half {
            time = (time + half + rise) / 2.0;
        }
        if interval > 0.0 && (set - time).abs() < half {
            time = (time - half + set) / 2.0;
        }
        up = !(time < rise - half || time > set + half);
        let position = moment.sun_at(&site, time);
        (weather.altitude, weather.azimuth) = (position.altitude, position.azimuth);
        weather.day = f64::from(moment.day_of_year());
    }
    if up && !cloudy {
        weather.altitude = weather.altitude.min(HIGHEST.to_radians());
    }
    let sky = if up { PerezSky::new(&weather) } else { None };
    Ok(text(&line, time, &weather, sky.as_ref()))
}

/// Dew point that the model's 2 cm of water stand for, degrees Celsius.
const STANDARD_DEW_POINT: f64 = 10.97353115;

/// Precipitable water, cm, from the dew point in degrees Celsius [Perez1990, eq. 3].
fn water(dew_point: f64) -> f64 {
    (0.07 * dew_point - 0.075).exp()
}

fn text(line: &str, time: f64, weather: &Weather, sky: Option<&PerezSky>) -> String {
    let mut text = format!("# gendaylit {line}\n");
    if let Some([outside, k, direct, diffuse]) = sky.and_then(|sky| sky.split) {
        text += &format!(
            "# erbs_s0, erbs_kt, irr_dir_h, irr_diff: {outside:.3} {k:.3} {direct:.3} {diffuse:.3}\n"
        );
    }
    text += &format!(
        "# Local solar time: {time:.2}\n# Solar altitude and azimuth: {:.1} {:.1}\n",
        weather.altitude.to_degrees(),
        weather.azimuth.to_degrees()
    );
    let pattern = "\nvoid brightfunc skyfunc\n2 skybright perezlum.cal\n0\n";
    let toward = f6(direction(weather.altitude, weather.azimuth));
    let Some(sky) = sky else {
        return text + pattern + &format!("10 0.00 0.00  0.000 0.000 0.000 0.000 0.000  {toward} \n");
    };
    text += &format!(
        "# epsilon, delta, atmospheric precipitable water content : {:.4} {:.4} {:.4} \n",
        sky.clearness, sky.brightness, weather.water
    );
    if weather.sun {
        let radiance = if sky.clearness > 1.0 {
            e3(sky.sun.radiance)
        } else {
            "0.0".into()
        };
        text += &solar(&radiance, sky.sun.direction, "0.533000");
    }
    let [a, b, c, d, e] = sky.coefficients;
    let (factor, ground) = (e3(sky.factor), e3(sky.ground));
    text + pattern + &format!("10 {factor} {ground} {a:.6} {b:.6} {c:.6} {d:.6} {e:.6} {toward} \n")
}
