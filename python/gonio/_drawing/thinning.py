"""Choose what is drawn of a hemisphere or a curve when there is too much, without losing a peak."""

import numpy as np

from gonio._drawing.mesh import Mesh, coarsened
from gonio._drawing.quadtree import representatives
from gonio._drawing.shapes import Floats, Ints


def thin(mesh: Mesh, dsf: Floats, *, most: int, floor: float) -> Mesh:
    """Thin a hemisphere to about `most` readings and triangulate them; `floor` as in `representatives`."""
    if len(mesh.rows) <= most:
        return mesh
    return coarsened(
        mesh, representatives(mesh.vectors, dsf[mesh.rows], side=mesh.side, most=most, floor=floor)
    )


def thin_curve(theta: Floats, values: Floats, *, most: int) -> Ints:
    """Choose rows of a curve to draw: the extremes of each of `most / 2` runs of rows, and every NaN."""
    if len(theta) <= most:
        return np.arange(len(theta))
    bins = (np.arange(len(theta)) * (most // 2)) // len(theta)
    finite = np.where(np.isfinite(values), values, 0.0)
    order = np.lexsort((finite, bins))
    start = np.searchsorted(bins[order], np.arange(most // 2))
    stop = np.r_[start[1:], len(theta)] - 1
    return np.unique(np.r_[order[start], order[stop], np.flatnonzero(~np.isfinite(values))])
