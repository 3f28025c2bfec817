"""A quadtree over the equal-area map of a hemisphere that is deep where readings differ."""

import numpy as np

from gonio._drawing.directions import equal_area
from gonio._drawing.shapes import Floats, Ints

LEVELS = 11
"""Deepest level of the quadtree: cells of about 0.05 degrees."""

COARSEST = 5
"""Shallowest level of a leaf: cells of about 5 degrees."""


def representatives(vectors: Floats, values: Floats, *, side: str, most: int, floor: float) -> Ints:
    """Positions of about `most` readings that stand for all of them, ascending.

    The tree is refined wherever readings in a cell differ on a scale that is linear below `floor` and
    logarithmic above; every leaf keeps its highest and its lowest reading where they differ by much, else the
    reading in its middle. The highest and the lowest reading of all are always kept.
    """
    if len(values) <= most:
        return np.arange(len(values))
    levels = np.arcsinh(values / max(floor, 1e-300))
    codes = _morton(equal_area(vectors, side))
    order = np.argsort(codes, kind="stable")
    codes, levels = codes[order], levels[order]
    low, high = 0.0, float(np.ptp(levels)) + 1e-9
    kept = _leaves(codes, levels, high)
    for _ in range(14):
        middle = 0.5 * (low + high)
        tried = _leaves(codes, levels, middle)
        if len(tried) > most:
            low = middle
        else:
            high, kept = middle, tried
    return np.unique(order[np.r_[kept, np.argmax(levels), np.argmin(levels)]])


def _morton(points: Floats) -> Ints:
    """Interleaved bits of the cell coordinates at the deepest level."""
    cells = np.clip(((points + 1.0) * 0.5 * 2**LEVELS).astype(np.int64), 0, 2**LEVELS - 1)
    code = np.zeros(len(points), dtype=np.int64)
    for bit in range(LEVELS):
        code |= ((cells[:, 0] >> bit) & 1) << (2 * bit)
        code |= ((cells[:, 1] >> bit) & 1) << (2 * bit + 1)
    return code


def _leaves(codes: Ints, values: Floats, tolerance: float) -> Ints:
    """Choose readings (positions in Morton order) that stand for the leaves of the tree of this tolerance."""
    chosen: list[Ints] = []
    alive = np.arange(len(codes))
    for level in range(COARSEST, LEVELS + 1):
        if len(alive) == 0:
            break
        cell = codes[alive] >> (2 * (LEVELS - level))
        start = np.flatnonzero(np.r_[True, np.diff(cell) != 0])
        count = np.diff(np.r_[start, len(alive)])
        spread = np.maximum.reduceat(values[alive], start) - np.minimum.reduceat(values[alive], start)
        leaf = (spread <= tolerance) | (count <= 2) | (level == LEVELS)
        chosen.append(_stand_ins(alive, start[leaf], count[leaf], values, 0.5 * tolerance))
        alive = alive[~np.repeat(leaf, count)]
    return np.unique(np.concatenate(chosen))


def _stand_ins(alive: Ints, start: Ints, count: Ints, values: Floats, little: float) -> Ints:
    """Choose the extremes of each cell where they differ by more than `little`, else its middle reading."""
    if len(start) == 0:
        return np.empty(0, dtype=np.int64)
    owner = np.repeat(np.arange(len(start)), count)
    member = alive[np.repeat(start - np.r_[0, np.cumsum(count)[:-1]], count) + np.arange(int(count.sum()))]
    order = np.lexsort((values[member], owner))
    first = np.r_[0, np.cumsum(count)[:-1]]
    lowest, highest = member[order][first], member[order][first + count - 1]
    middle = alive[start + count // 2]
    differ = values[highest] - values[lowest] > little
    return np.concatenate([np.where(differ, lowest, middle), np.where(differ, highest, middle)])
