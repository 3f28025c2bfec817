//! Writing Zemax `.bsdf` files.

use std::io::Write;
use std::path::Path;

use gonio_bsdf::{Bsdf, directional_albedo};
use gonio_geom::{Angles, Component};

use super::frame::Frame;
use super::{SCATTER, SYMMETRIES};
use crate::{IoError, write_atomic};

/// Directions of a written file, degrees, ascending.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Azimuths of incidence; those of an isotropic model are not asked for.
    pub rotations: Vec<f64>,
    /// Polar angles of incidence, 0 to 90, the latter excluded.
    pub incidences: Vec<f64>,
    /// Azimuths about the specular direction between 0 and 180; the other half of the turn mirrors them.
    pub azimuths: Vec<f64>,
    /// Angles from the specular direction, 0 to 180.
    pub radials: Vec<f64>,
}

impl Default for Grid {
    /// Incidences of every 5 degrees to 85, azimuths of every 5, rotations of every 15; radial angles of 0.25 degrees
    /// about the specular direction, widening to 5.
    fn default() -> Self {
        let every = |step: f64, end: f64| {
            (0..)
                .map(move |k| step * f64::from(k))
                .take_while(move |x| *x <= end)
        };
        let radials = every(0.25, 2.0)
            .chain(every(0.5, 5.0).filter(|r| *r > 2.0))
            .chain(every(1.0, 15.0).filter(|r| *r > 5.0))
            .chain(every(2.5, 40.0).filter(|r| *r > 15.0))
            .chain(every(5.0, 175.0).filter(|r| *r > 40.0));
        Grid {
            rotations: every(15.0, 345.0).collect(),
            incidences: every(5.0, 85.0).collect(),
            azimuths: every(5.0, 180.0).collect(),
            radials: radials.collect(),
        }
    }
}

/// What was written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Written {
    /// Keyword of the symmetry.
    pub symmetry: &'static str,
    /// Number of BSDF values.
    pub values: usize,
}

/// Relative difference of two values that counts as none.
const EQUAL: f64 = 1e-6;

impl Grid {
    fn check(&self, path: &Path) -> Result<(), IoError> {
        let lists = [
            ("rotations", &self.rotations, 0.0, 360.0),
            ("incidences", &self.incidences, 0.0, 90.0),
            ("azimuths", &self.azimuths, 0.0, 180.0 + 1e-9),
            ("radials", &self.radials, 0.0, 180.0 + 1e-9),
        ];
        for (name, list, low, high) in lists {
            let good = !list.is_empty()
                && list.windows(2).all(|w| w[0] < w[1])
                && list.iter().all(|x| (low..high).contains(x));
            if !good {
                let allowed = format!("ascending degrees from {low} to {high:.0}");
                return Err(IoError::format(path, None, name, format!("{list:?}"), allowed));
            }
        }
        let (first, last) = (self.azimuths.first(), self.azimuths.last());
        if first != Some(&0.0) || last != Some(&180.0) {
            let found = format!("{first:?} to {last:?}");
            return Err(IoError::format(path, None, "azimuths", found, "0 to 180 degrees"));
        }
        Ok(())
    }
}

/// Writes one channel of `model` for light that arrives on the front, as `Monochrome`: `component` reflection makes a
/// BRDF, transmission a BTDF. The symmetry is that of the values: `PlaneSymmetrical` where both halves of the azimuth
/// agree within 1e-6 at every incidence of an isotropic model, `ASymmetrical` where they do not, `ASymmetrical4D` for an
/// anisotropic model. `comments` stand at the top, one a line. An ideal part of the model is in the total integrated
/// scatter only if it spreads: it has no BSDF.
///
/// # Errors
/// [`IoError::Format`] for a grid that is empty, not ascending or out of range, a channel that the model does not have;
/// refusals of the operating system.
pub fn write(
    path: &Path,
    model: &dyn Bsdf,
    channel: usize,
    component: Component,
    grid: &Grid,
    comments: &str,
) -> Result<Written, IoError> {
    grid.check(path)?;
    if channel >= model.channels().len() {
        let allowed = format!("an index below {}", model.channels().len());
        return Err(IoError::format(
            path,
            None,
            "channel",
            channel.to_string(),
            allowed,
        ));
    }
    let isotropic = model.properties().isotropic;
    let rotations = if isotropic {
        vec![0.0]
    } else {
        grid.rotations.clone()
    };
    let mut azimuths = grid.azimuths.clone();
    azimuths.extend(
        grid.azimuths
            .iter()
            .rev()
            .map(|a| 360.0 - a)
            .filter(|a| *a > 180.0),
    );
    let mut blocks = Vec::new();
    let mut f = vec![0.0; model.channels().len()];
    for &rotation in &rotations {
        for &theta in &grid.incidences {
            let incidence = Angles::from_degrees(theta, rotation);
            let (wi, frame) = (incidence.direction(), Frame::new(incidence, component));
            let mut values = Vec::with_capacity(azimuths.len() * grid.radials.len());
            for &azimuth in &azimuths {
                for &radial in &grid.radials {
                    let ws = frame.on_its_side(azimuth, radial);
                    values.push(ws.map_or(0.0, |ws| {
                        model.eval(wi, ws, &mut f);
                        f[channel]
                    }));
                }
            }
            blocks.push((directional_albedo(model, wi, component, channel), values));
        }
    }
    let half = grid.azimuths.len();
    let plane = isotropic
        && blocks
            .iter()
            .all(|(_, values)| mirrored(values, azimuths.len(), half));
    let symmetry = match (isotropic, plane) {
        (true, true) => SYMMETRIES[0],
        (true, false) => SYMMETRIES[1],
        (false, _) => SYMMETRIES[2],
    };
    if plane {
        azimuths.truncate(half);
    }
    let kept = azimuths.len() * grid.radials.len();
    write_atomic(path, |out| {
        for line in comments.lines() {
            writeln!(out, "# {line}")?;
        }
        let scatter = SCATTER[usize::from(component == Component::Transmission)];
        writeln!(out, "Source\tMeasured\nSymmetry\t{symmetry}")?;
        writeln!(out, "SpectralContent\tMonochrome\nScatterType\t{scatter}")?;
        let lists = [
            ("SampleRotation", &rotations),
            ("AngleOfIncidence", &grid.incidences),
            ("ScatterAzimuth", &azimuths),
            ("ScatterRadial", &grid.radials),
        ];
        for (name, list) in lists {
            writeln!(out, "{name}\t{}", list.len())?;
            row(out, list, |out, x| write!(out, "{x}"))?;
        }
        writeln!(out, "\nMonochrome\nDataBegin")?;
        for (tis, values) in &blocks {
            writeln!(out, "TIS\t{tis:.6}")?;
            for values in values[..kept].chunks(grid.radials.len()) {
                row(out, values, |out, x| write!(out, "{x:.6e}"))?;
            }
        }
        writeln!(out, "DataEnd")
    })?;
    Ok(Written {
        symmetry,
        values: kept * blocks.len(),
    })
}

/// Whether the rows of azimuths past 180 degrees are those of their mirrored ones.
fn mirrored(values: &[f64], rows: usize, half: usize) -> bool {
    let width = values.len() / rows;
    let row = |k: usize| &values[k * width..(k + 1) * width];
    (half..rows).all(|k| {
        let twin = row(2 * half - 2 - k);
        row(k)
            .iter()
            .zip(twin)
            .all(|(a, b)| (a - b).abs() <= EQUAL * a.abs().max(b.abs()))
    })
}

fn row(
    out: &mut dyn Write,
    values: &[f64],
    number: impl Fn(&mut dyn Write, f64) -> std::io::Result<()>,
) -> std::io::Result<()> {
    for (k, &x) in values.iter().enumerate() {
        if k > 0 {
            out.write_all(b"\t")?;
        }
        number(out, x)?;
    }
    out.write_all(b"\n")
}
