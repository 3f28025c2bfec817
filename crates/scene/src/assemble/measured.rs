//! Measured materials with what RADIANCE's `BSDF` and `aBSDF` add to their files.

use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

use gonio_bsdf::{Bsdf, Channel, Lobe, Properties, Sample, directional_albedo};
use gonio_geom::{Component, DVec3, Direction, Side};

use super::through::Table;

const CHANNELS: [Channel; 3] = [Channel::Red, Channel::Green, Channel::Blue];

/// Diffuse parts beside those of the file: reflectance of the front and of the back, transmittance.
pub(super) type Diffuse = [[f64; 3]; 3];

/// A model with diffuse parts, of which light may go straight through.
pub(super) struct Measured {
    inner: Arc<dyn Bsdf>,
    diffuse: Diffuse,
    /// How often a diffuse direction is drawn, by the side of the eye, and how many of them are reflected.
    drawn: [[f64; 2]; 2],
    /// A table whose peak goes straight through, and what stays of it, by the side of the eye.
    through: Option<(Table, [f64; 2])>,
}

fn index(side: Side) -> usize {
    usize::from(side == Side::Back)
}

fn mean(rgb: [f64; 3]) -> f64 {
    rgb.iter().sum::<f64>() / 3.0
}

impl Measured {
    pub(super) fn new(inner: Arc<dyn Bsdf>, diffuse: Diffuse, through: Option<Table>) -> Self {
        let drawn = Side::BOTH.map(|side| {
            let theta = if side == Side::Front { 30.0 } else { 150.0 };
            let w = Direction::from_degrees(theta, 0.0);
            let (r, t) = (mean(diffuse[index(side)]), mean(diffuse[2]));
            let both = [Component::Reflection, Component::Transmission];
            let rest: f64 = both
                .map(|c| directional_albedo(inner.as_ref(), w, c, 0))
                .iter()
                .sum();
            match r + t > 0.0 {
                true => [((r + t) / (r + t + rest)).clamp(0.02, 1.0), r / (r + t)],
                false => [0.0, 1.0],
            }
        });
        let through = through.map(|table| {
            let least = Side::BOTH.map(|eye| table.least(eye.opposite(), Component::Transmission));
            (table, least)
        });
        Measured {
            inner,
            diffuse,
            drawn,
            through,
        }
    }

    /// The part of the model that no pattern touches: reflection that is not diffuse.
    pub(super) fn gloss(inner: Arc<dyn Bsdf>, table: Option<&Table>) -> Arc<dyn Bsdf> {
        let least = Side::BOTH.map(|s| table.map_or(0.0, |t| t.least(s, Component::Reflection)));
        Arc::new(Gloss { inner, least })
    }

    /// The diffuse albedo for the eye at `eye` and light at `light`.
    fn lambert(&self, eye: Direction, light: Direction) -> [f64; 3] {
        match eye.side() == light.side() {
            true => self.diffuse[index(eye.side())],
            false => self.diffuse[2],
        }
    }
}

/// Values of a model of one or three channels in all three.
fn spread(model: &dyn Bsdf, wi: Direction, ws: Direction, f: &mut [f64]) {
    match model.channels().len() {
        3 => model.eval(wi, ws, f),
        _ => f.fill(model.eval_first(wi, ws)),
    }
}

impl Bsdf for Measured {
    fn channels(&self) -> &[Channel] {
        &CHANNELS
    }

    fn properties(&self) -> Properties {
        let inner = self.inner.properties();
        Properties {
            reciprocal: inner.reciprocal && self.through.is_none(),
            energy_conserving: false,
            ..inner
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        if ws.cos_theta() == 0.0 {
            return f.fill(0.0);
        }
        match &self.through {
            Some((table, least)) if wi.side() != ws.side() => {
                f.fill(table.scattered(wi, ws, least[index(ws.side())]));
            }
            _ => spread(self.inner.as_ref(), wi, ws, f),
        }
        let lambert = self.lambert(ws, wi);
        f.iter_mut().zip(lambert).for_each(|(f, d)| *f += d * FRAC_1_PI);
    }

    fn eval_first(&self, wi: Direction, ws: Direction) -> f64 {
        let mut f = [0.0; 3];
        self.eval(wi, ws, &mut f);
        f[0]
    }

    fn delta(&self, w: Direction, component: Component, shares: &mut [f64]) -> Option<Direction> {
        shares.fill(0.0);
        let (table, least) = self.through.as_ref()?;
        if component != Component::Transmission || w.cos_theta() == 0.0 {
            return None;
        }
        let share = table.straight(w, least[index(w.side())]);
        shares.fill(share);
        (share > 0.0).then(|| w.through())
    }

    fn has_delta(&self) -> bool {
        let mut shares = [0.0; 3];
        self.through.is_some()
            && (0..18).flat_map(|t| (0..12).map(move |p| (t, p))).any(|(t, p)| {
                let w = Direction::from_degrees(2.0 + 10.0 * f64::from(t), 7.0 + 30.0 * f64::from(p));
                self.delta(w, Component::Transmission, &mut shares).is_some()
            })
    }

    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        let [chance, reflected] = self.drawn[index(w.side())];
        let side = match w.side() == sampled.side() {
            true => reflected,
            false => 1.0 - reflected,
        };
        chance * side * sampled.cos_theta().abs() / PI + (1.0 - chance) * self.inner.pdf(w, sampled)
    }

    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        let [chance, reflected] = self.drawn[index(w.side())];
        let (direction, lobe) = if u[2] < chance {
            let side = match u[2] / chance < reflected {
                true => w.side(),
                false => w.side().opposite(),
            };
            let (r, phi) = (u[0].sqrt(), 2.0 * PI * u[1]);
            let z = side.sign() * (1.0 - u[0]).max(0.0).sqrt();
            (
                Direction::new(DVec3::new(r * phi.cos(), r * phi.sin(), z))?,
                Lobe::Diffuse,
            )
        } else {
            let rest = ((u[2] - chance) / (1.0 - chance)).min(1.0 - f64::EPSILON);
            let drawn = self.inner.sample(w, [u[0], u[1], rest])?;
            (drawn.direction, drawn.lobe)
        };
        let pdf = self.pdf(w, direction);
        let weight = self.eval_first(w, direction) * direction.cos_theta().abs() / pdf;
        (pdf > 0.0).then_some(Sample {
            direction,
            weight,
            pdf,
            lobe,
        })
    }
}

/// Reflection without its diffuse part.
struct Gloss {
    inner: Arc<dyn Bsdf>,
    least: [f64; 2],
}

impl Bsdf for Gloss {
    fn channels(&self) -> &[Channel] {
        &CHANNELS
    }

    fn properties(&self) -> Properties {
        self.inner.properties()
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        if wi.side() != ws.side() {
            return f.fill(0.0);
        }
        spread(self.inner.as_ref(), wi, ws, f);
        let least = self.least[index(wi.side())];
        f.iter_mut().for_each(|f| *f = (*f - least).max(0.0));
    }
}
