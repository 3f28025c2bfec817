//! Where the sun stands.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A place on the earth and the clock it keeps, radians. Longitudes are positive west of Greenwich, as RADIANCE has them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// North of the equator.
    pub latitude: f64,
    /// West of Greenwich.
    pub longitude: f64,
    /// Meridian of the clock, west of Greenwich.
    pub meridian: f64,
}

impl Default for Site {
    /// Where RADIANCE's programs are when nothing is said.
    fn default() -> Self {
        Site {
            latitude: 0.66,
            longitude: 2.13,
            meridian: 120f64.to_radians(),
        }
    }
}

/// A moment by the calendar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// With a year the position is that of the almanac [Michalsky1988], without it a yearly mean.
    pub year: Option<i32>,
    /// 1 to 12.
    pub month: u32,
    /// 1 to 31.
    pub day: u32,
    /// Hours since midnight, of the clock or of the sun.
    pub hour: f64,
    /// Whether `hour` is solar time.
    pub solar: bool,
}

/// A position of the sun, radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Position {
    /// Above the horizon.
    pub altitude: f64,
    /// West of south.
    pub azimuth: f64,
    /// Solar time, hours.
    pub solar_time: f64,
}

/// Unit vector towards the sun: x east, y north, z up.
pub fn direction(altitude: f64, azimuth: f64) -> [f64; 3] {
    let (sa, ca) = azimuth.sin_cos();
    let (up, level) = altitude.sin_cos();
    [-sa * level, -ca * level, up]
}

impl Moment {
    /// Day of a year of 365 days, from 1.
    pub fn day_of_year(&self) -> u32 {
        const BEFORE: [u32; 12] = [0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334];
        BEFORE
            .get(self.month.wrapping_sub(1) as usize)
            .copied()
            .unwrap_or(0)
            + self.day
    }

    /// Declination of the yearly mean, radians.
    pub fn mean_declination(&self) -> f64 {
        0.4093 * (TAU / 365.0 * (f64::from(self.day_of_year()) - 81.0)).sin()
    }

    /// Where the sun stands, with the formulas of RADIANCE's programs: the yearly means of the IES Lighting Handbook, or
    /// with a year the almanac's [Michalsky1988], to 0.01 degrees from 1950 to 2050.
    pub fn sun(&self, site: &Site) -> Position {
        let time = if self.solar {
            self.hour
        } else if let Some(year) = self.year {
            self.almanac(year, site).1
        } else {
            let day = f64::from(self.day_of_year());
            self.hour + 0.170 * (4.0 * PI / 373.0 * (day - 80.0)).sin()
                - 0.129 * (TAU / 355.0 * (day - 8.0)).sin()
                + 12.0 / PI * (site.meridian - site.longitude)
        };
        self.sun_at(site, time)
    }

    /// Where the sun stands on this day at a solar time, hours, with the declination of the moment.
    pub fn sun_at(&self, site: &Site, solar_time: f64) -> Position {
        let declination = self
            .year
            .map_or_else(|| self.mean_declination(), |year| self.almanac(year, site).0);
        let hour_angle = solar_time * (PI / 12.0);
        let (sl, cl) = site.latitude.sin_cos();
        let (sd, cd) = declination.sin_cos();
        Position {
            altitude: (sl * sd - cl * cd * hour_angle.cos()).clamp(-1.0, 1.0).asin(),
            azimuth: -(cd * hour_angle.sin()).atan2(-cl * sd - sl * cd * hour_angle.cos()),
            solar_time,
        }
    }

    /// Declination and solar time from the almanac's ecliptic coordinates.
    fn almanac(&self, year: i32, site: &Site) -> (f64, f64) {
        let since = i64::from(year) - 1949;
        let leap = i64::from(self.month > 2 && year & 3 == 0);
        let day = i64::from(self.day_of_year()) + leap + since * 365 + since / 4;
        let universal = self.hour + site.meridian * (12.0 / PI);
        // Days since noon of 1 January 2000.
        let days = day as f64 + universal / 24.0 + (2_432_916.5 - 2_451_545.0);
        let mean_longitude = (280.460 + 0.985_647_4 * days).to_radians().rem_euclid(TAU);
        let anomaly = (357.528 + 0.985_600_3 * days).to_radians().rem_euclid(TAU);
        let longitude = mean_longitude
            + 1.915f64.to_radians() * anomaly.sin()
            + 0.020f64.to_radians() * (2.0 * anomaly).sin();
        let obliquity = (23.439 - 4e-7 * days).to_radians();
        let ascension = (longitude.sin() * obliquity.cos()).atan2(longitude.cos());
        let greenwich = 6.697_375 + 0.065_709_824_2 * days + 24.0 * (days - days.floor()) + 12.0;
        let time = greenwich - site.longitude * (12.0 / PI) - ascension * (12.0 / PI) + 12.0;
        ((obliquity.sin() * longitude.sin()).asin(), time.rem_euclid(24.0))
    }

    /// Solar times of sunrise and sunset of the yearly mean; not numbers where the sun does not cross the horizon.
    pub fn day_span(&self, site: &Site) -> (f64, f64) {
        let w = f64::from((-site.latitude.tan() * self.mean_declination().tan()) as f32);
        let half = (FRAC_PI_2 - w.atan2((1.0 - w * w).sqrt())) * 12.0 / PI;
        (12.0 - half, 12.0 + half)
    }
}
