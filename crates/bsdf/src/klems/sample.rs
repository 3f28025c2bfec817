//! Exact sampling of a Klems model by a cumulative table per incident patch.

use gonio_geom::{Component, Direction, Side};

use super::{Klems, KlemsMatrix, Role, Source, source};
use crate::{Bsdf, FourComponents, Lobe, Sample};

/// Cumulative albedo over exit patches for one component.
#[derive(Clone, Debug, Default)]
struct Table {
    reversed: bool,
    patches: usize,
    /// `cumulative[incident * patches + k]` = albedo into the exit patches `0..=k`.
    cumulative: Vec<f64>,
}

impl Table {
    fn new(source: Source<'_>) -> Self {
        let m = source.matrix;
        let (ni, no) = (m.incident().len(), m.exit().len());
        let (from, into, lambda) = if source.reversed {
            (no, ni, m.incident().lambda())
        } else {
            (ni, no, m.exit().lambda())
        };
        let mut cumulative = Vec::with_capacity(from * into);
        for a in 0..from {
            let mut sum = 0.0;
            for (b, l) in lambda.iter().enumerate() {
                sum += l * if source.reversed {
                    m.value(a, b)
                } else {
                    m.value(b, a)
                };
                cumulative.push(sum);
            }
        }
        Table {
            reversed: source.reversed,
            patches: into,
            cumulative,
        }
    }

    fn row(&self, m: &KlemsMatrix, w: Direction) -> &[f64] {
        let k = if self.reversed {
            m.exit().patch(w, Role::Exit)
        } else {
            m.incident().patch(w, Role::Incident)
        };
        &self.cumulative[k * self.patches..(k + 1) * self.patches]
    }
}

/// The tables for light that arrives on one side: reflection, transmission.
#[derive(Clone, Debug)]
pub(crate) struct PatchCdf {
    side: Side,
    tables: [Option<Table>; 2],
}

/// The row of one component for a direction, when the model has the component.
type Row<'a> = Option<(Source<'a>, &'a [f64])>;

const COMPONENTS: [Component; 2] = [Component::Reflection, Component::Transmission];

impl PatchCdf {
    pub(crate) fn new(matrices: &FourComponents<KlemsMatrix>, side: Side) -> Self {
        PatchCdf {
            side,
            tables: COMPONENTS.map(|c| source(matrices, side, c).map(Table::new)),
        }
    }

    pub(crate) fn sample(&self, model: &Klems, w: Direction, u: [f64; 3]) -> Option<Sample> {
        let mut rows: [(f64, Row<'_>); 2] = [(0.0, None), (0.0, None)];
        for (slot, (component, table)) in rows.iter_mut().zip(COMPONENTS.iter().zip(&self.tables)) {
            if let (Some(table), Some(s)) = (table, source(model.matrices(), self.side, *component)) {
                let row = table.row(s.matrix, w);
                *slot = (row.last().copied().unwrap_or(0.0), Some((s, row)));
            }
        }
        let total = rows[0].0 + rows[1].0;
        if total <= 0.0 {
            return None;
        }
        let target = u[2] * total;
        let which = usize::from(target >= rows[0].0);
        let (albedo, Some((s, row))) = rows[which] else {
            return None;
        };
        let rest = (target - which as f64 * rows[0].0).clamp(0.0, albedo);
        let k = row.partition_point(|c| *c <= rest).min(row.len() - 1);
        let side = COMPONENTS[which].scattered_side(self.side);
        let direction = if s.reversed {
            s.matrix.incident().point(k, Role::Incident, side, u[0], u[1])
        } else {
            s.matrix.exit().point(k, Role::Exit, side, u[0], u[1])
        };
        let cos = direction.cos_theta().abs();
        let pdf = model.eval_first(w, direction) * cos / total;
        (pdf > 0.0).then_some(Sample {
            direction,
            weight: total,
            pdf,
            lobe: Lobe::Glossy,
        })
    }
}
