//! Energy of each direction, which small differences of many cells add up to.

use super::{PruneOptions, Pyramid};

/// Standard errors of its energy that merging may change for a direction: one in 370 is beyond by chance.
pub(super) const ENERGY: f64 = 3.0;

/// The dimensions of one end of light.
#[derive(Clone, Copy)]
struct End {
    first: usize,
    dimensions: usize,
}

/// Energies of the fine cells of an end, and the squares of their errors.
struct Energies {
    end: End,
    values: Vec<f64>,
    variances: Vec<f64>,
}

impl Pyramid {
    /// Splits leaves until the energy of each direction is that of its averages, as far as the number of cells allows.
    pub(super) fn keep_energy(&mut self, options: &PruneOptions) {
        let incident = End {
            first: 0,
            dimensions: self.dimensions - 2,
        };
        let exit = End {
            first: 2,
            dimensions: 2,
        };
        // At rank 3 exits turn with the incidence.
        let ends = if self.dimensions == 4 {
            vec![incident, exit]
        } else {
            vec![incident]
        };
        let truth: Vec<Energies> = ends.into_iter().map(|end| self.energies(end)).collect();
        let more = (1 << self.dimensions) - 1;
        loop {
            let leaves = self.leaves();
            let wrong: Vec<Vec<bool>> = truth.iter().map(|t| self.wrong(t, &leaves, options)).collect();
            let coarse = leaves.iter().filter(|(depth, _)| *depth < self.log2);
            let split: Vec<(usize, usize)> = coarse
                .filter(|(depth, code)| {
                    let mut ends = truth.iter().zip(&wrong);
                    ends.any(|(t, wrong)| self.places(t.end, *depth, *code).any(|k| wrong[k]))
                })
                .copied()
                .collect();
            if split.is_empty() || leaves.len() + more * split.len() > options.max_cells {
                return;
            }
            for (depth, code) in split {
                self.levels[depth][code].split = true;
            }
        }
    }

    fn energies(&self, end: End) -> Energies {
        let n = 1usize << (end.dimensions * self.log2);
        let (mut values, mut variances) = (vec![0.0; n], vec![0.0; n]);
        for (code, (value, variance)) in self.fine.iter().enumerate() {
            for k in self.places(end, self.log2, code) {
                values[k] += f64::from(*value);
                variances[k] += f64::from(*variance);
            }
        }
        Energies {
            end,
            values,
            variances,
        }
    }

    /// Whether leaves give each direction another energy than its own.
    fn wrong(&self, truth: &Energies, leaves: &[(usize, usize)], options: &PruneOptions) -> Vec<bool> {
        let mut found = vec![0.0; truth.values.len()];
        for (depth, code) in leaves {
            let directions = 1usize << (truth.end.dimensions * (self.log2 - depth));
            let each = self.at(*depth, *code).sum / directions as f64;
            self.places(truth.end, *depth, *code)
                .for_each(|k| found[k] += each);
        }
        let pairs = truth.values.iter().zip(&truth.variances);
        pairs
            .zip(found)
            .map(|((value, variance), found)| {
                let allowed = ENERGY * variance.sqrt() + options.tolerance * value;
                (found - value).abs() > allowed + 1e-6 * value
            })
            .collect()
    }

    /// Depth and code of all leaves.
    fn leaves(&self) -> Vec<(usize, usize)> {
        let mut out = Vec::new();
        let mut walk = vec![(0, 0)];
        while let Some((depth, code)) = walk.pop() {
            match self.at(depth, code).split {
                true => walk.extend(self.children(code).map(|k| (depth + 1, k))),
                false => out.push((depth, code)),
            }
        }
        out
    }

    /// The fine cells of an end that a node holds.
    fn places(&self, end: End, depth: usize, code: usize) -> impl Iterator<Item = usize> + use<> {
        let (d, log2) = (self.dimensions, self.log2);
        let up = log2 - depth;
        let corner = |k: usize| {
            let bits = (0..depth).map(|b| (code >> (b * d + k) & 1) << b);
            bits.sum::<usize>() << up
        };
        let a = corner(end.first);
        let (b, side) = match end.dimensions {
            2 => (corner(end.first + 1), 1usize << up),
            _ => (0, 1),
        };
        let shift = log2 * (end.dimensions - 1);
        (a..a + (1 << up)).flat_map(move |a| (b..b + side).map(move |b| a << shift | b))
    }
}
