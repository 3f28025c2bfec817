//! Reduction to tensor trees: cells are halved where the model varies most.

mod growth;
mod ideal;

use gonio_bsdf::tensor_tree::{Rank, TensorTree};
use gonio_bsdf::{Bsdf, BsdfError, FourComponents};
use gonio_geom::{Component, Side};

use super::OneChannel;
use growth::Growth;

/// How to reduce a model to tensor trees.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeOptions {
    /// Rank; `None` takes 3 for isotropic models and 4 for others.
    pub rank: Option<Rank>,
    /// Components to fill; `None` fills every component that scatters.
    pub components: Option<Vec<(Side, Component)>>,
    /// Number of the model's channel.
    pub channel: usize,
    /// Finest cells have the side `2^-max_depth`; 1 to 10.
    pub max_depth: u8,
    /// Refinement of a component stops when the estimated `integral |f - f_cell| / integral f` (projected solid angles,
    /// all incidences) is below this.
    pub target: f64,
    /// Refinement of a component stops at this number of cells (some 7 bytes each in a file).
    pub max_cells: usize,
    /// Refinement of a component stops where its data would take more bytes than this in a Radiance file.
    pub max_bytes: Option<usize>,
}

impl Default for TreeOptions {
    /// The rank the model needs, all components, depth 8, 3 %, 40 000 cells.
    fn default() -> Self {
        TreeOptions {
            rank: None,
            components: None,
            channel: 0,
            max_depth: 8,
            target: 0.03,
            max_cells: 40_000,
            max_bytes: None,
        }
    }
}

/// A tensor-tree model with what the reduction found.
#[derive(Clone, Debug)]
pub struct TreeReduction {
    /// The model.
    pub model: TensorTree,
    /// Estimated `integral |f - f_cell| / integral f` of each component; 0 where no light is scattered.
    pub error: FourComponents<f64>,
    /// Greatest directional albedo (reflection and transmission of one side) over the incident cells, the ideal part
    /// included.
    pub max_albedo: f64,
    /// Bytes of each component's data in a Radiance file.
    pub bytes: FourComponents<usize>,
    /// Number of evaluations of the model.
    pub evaluations: u64,
}

/// Averages `model` over cells of incidence and exit that are halved, the worst first, until the target, the number of
/// cells or bytes, or the depth is reached. Each average is a Gauss-Legendre product rule of two points a dimension;
/// values are rounded to two to five significant digits, a twentieth of what the cell itself smooths away.
///
/// Cells about the mirror, unbent and retro directions are always looked into; a feature elsewhere that is narrower than
/// about 1/16 in direction cosine can be missed. An ideal part ([`Bsdf::delta`]) goes to the finest cells about its
/// directions, and every incidence keeps its share; RADIANCE's `aBSDF` takes it out of them again. Where an anisotropic
/// model needs more than half of `max_cells` for it, the finest cells of that light are coarser than `max_depth`; in
/// transmission those of the component are then too, because `aBSDF` looks into the smallest cells alone.
///
/// # Errors
/// [`BsdfError::Domain`] for a channel the model does not have, no component that scatters, rank 3 for a model that is
/// not isotropic, or a depth, target or number of cells out of range.
pub fn to_tensor_tree(model: &dyn Bsdf, options: &TreeOptions) -> Result<TreeReduction, BsdfError> {
    let rank = check(model, options)?;
    let one = OneChannel::with_ideal(model, options.channel)?;
    let components = one.components(options.components.as_deref())?;
    let mut trees = FourComponents::default();
    let mut error = FourComponents::default();
    let mut bytes = FourComponents::default();
    let mut evaluations = 0;
    for (side, component) in components {
        let mut growth = Growth::new(one, rank, side, component, options);
        growth.grow();
        evaluations += growth.evaluations;
        error.set(side, component, Some(growth.relative_error()));
        bytes.set(side, component, Some(growth.bytes));
        trees.set(side, component, Some(growth.tree()?));
    }
    let model = TensorTree::new(one.channel(), trees);
    Ok(TreeReduction {
        max_albedo: model.max_albedo(),
        model,
        error,
        bytes,
        evaluations,
    })
}

fn check(model: &dyn Bsdf, options: &TreeOptions) -> Result<Rank, BsdfError> {
    let domain = |field, found: String, allowed: &str| {
        Err(BsdfError::Domain {
            field,
            found,
            allowed: allowed.into(),
        })
    };
    let isotropic = model.properties().isotropic;
    if options.rank == Some(Rank::Three) && !isotropic {
        return domain("rank", "3 for a model that is not isotropic".into(), "4");
    }
    if !(1..=10).contains(&options.max_depth) {
        return domain("max_depth", options.max_depth.to_string(), "1 to 10");
    }
    if !(options.target >= 0.0 && options.target.is_finite()) {
        return domain("target", options.target.to_string(), "0 or more");
    }
    if options.max_cells < 16 || options.max_cells > 1 << 26 {
        return domain("max_cells", options.max_cells.to_string(), "16 to 67108864");
    }
    if let Some(bytes) = options.max_bytes.filter(|n| *n < 1000) {
        return domain("max_bytes", bytes.to_string(), "1000 or more");
    }
    Ok(options
        .rank
        .unwrap_or(if isotropic { Rank::Three } else { Rank::Four }))
}
