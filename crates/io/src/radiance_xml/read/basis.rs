//! Angle bases a file defines or names.

use gonio_bsdf::klems::KlemsBasis;

use super::super::values::Structure;
use super::state::State;
use crate::{IoError, excerpt};

/// A ring as the file is telling it.
#[derive(Default)]
pub(super) struct Block {
    pub(super) lower: Option<f64>,
    pub(super) upper: Option<f64>,
    pub(super) n_phi: Option<usize>,
}

impl State<'_> {
    pub(super) fn close_basis(&mut self, line: u64) -> Result<(), IoError> {
        if self.blocks.is_empty() {
            return Ok(()); // a name alone
        }
        let whole: Option<Vec<(f64, f64, usize)>> = self
            .blocks
            .iter()
            .map(|b| Some((b.lower?, b.upper?, b.n_phi?)))
            .collect();
        let Some(rings) = whole else {
            return Err(self.error(
                line,
                "AngleBasisBlock",
                "an incomplete ring",
                "LowerTheta, UpperTheta and nPhis",
            ));
        };
        let gapless = rings.windows(2).all(|w| w[0].1 == w[1].0);
        if !gapless {
            return Err(self.error(
                line,
                "ThetaBounds",
                "rings with a gap",
                "each ring begins where the last one ends",
            ));
        }
        let bounds: Vec<f64> = std::iter::once(rings[0].0)
            .chain(rings.iter().map(|r| r.1))
            .collect();
        let n_phi: Vec<usize> = rings.iter().map(|r| r.2).collect();
        let basis =
            KlemsBasis::new(self.basis_name.clone(), &bounds, &n_phi).map_err(|e| self.domain(e, line))?;
        if let Ok(standard) = KlemsBasis::by_name(&self.basis_name)
            && standard.rings() != basis.rings()
        {
            return Err(self.error(
                line,
                "AngleBasis",
                format!("rings that are not those of {}", standard.name()),
                "the standard rings under a standard name",
            ));
        }
        self.bases.push(basis);
        Ok(())
    }

    pub(super) fn basis(&self, field: &str, name: &str, line: u64) -> Result<KlemsBasis, IoError> {
        if matches!(self.structure, Some(Structure::Tree(_))) {
            return Ok(KlemsBasis::full()); // not used by trees
        }
        if let Some(b) = self.bases.iter().find(|b| b.name().eq_ignore_ascii_case(name)) {
            return Ok(b.clone());
        }
        KlemsBasis::by_name(name).map_err(|_| {
            let own: Vec<&str> = self.bases.iter().map(KlemsBasis::name).collect();
            self.error(
                line,
                field,
                excerpt(name.as_bytes()),
                format!(
                    "LBNL/Klems Full, Half, Quarter or a basis the file defines ({})",
                    own.join(", ")
                ),
            )
        })
    }
}
