"""The cards that choose an incidence: each shows its profile in small."""

import math
from dataclasses import dataclass

import numpy as np

from gonio._drawing.directions import component_of
from gonio._drawing.numbers import angle, number
from gonio._drawing.shapes import Floats
from gonio.reporting.drawn import DrawnSlice
from gonio.reporting.payload import incidence_of

WIDTH, HEIGHT = 132.0, 46.0
"""Size of a small profile in pixels."""

_BINS = 96


@dataclass(frozen=True)
class Card:
    """One incidence: its angles, integrals in words and the path data of its small profile, one a run."""

    theta_i: str
    phi_i: str
    integrals: list[tuple[str, str]]
    paths: list[str]
    mirror: float


def cards(drawn: list[DrawnSlice]) -> list[Card]:
    """One card an incidence, drawn from the first channel, all on one logarithmic scale."""
    first: dict[tuple[float, float], DrawnSlice] = {}
    for d in sorted(drawn, key=lambda d: d.key):
        first.setdefault(incidence_of(d), d)
    chosen = [first[key] for key in dict.fromkeys(incidence_of(d) for d in drawn)]
    peaks = [d.peak for d in chosen if math.isfinite(d.peak) and d.peak > 0.0]
    top = math.log10(max(peaks)) if peaks else 0.0
    two = any(len(d.meshes) > 1 or any(t > 90.0 for t in d.profile.theta) for d in chosen)
    span = (-90.0, 270.0) if two else (-90.0, 90.0)
    return [_card(d, top, span) for d in chosen]


def _card(d: DrawnSlice, top: float, span: tuple[float, float]) -> Card:
    s = d.slice
    integrals = [
        ("DHR" if component_of(s.theta_i, str(i.side)) == "reflection" else "DHT", number(float(i.value), 3))
        for i in s.integrals
    ]
    mirror = (s.theta_i - span[0]) / (span[1] - span[0]) * WIDTH
    return Card(angle(s.theta_i), angle(s.phi_i), integrals, _paths(d, top, span), mirror)


def _paths(d: DrawnSlice, top: float, span: tuple[float, float], decades: float = 3.5) -> list[str]:
    theta, dsf = d.profile.theta, d.profile.dsf
    finite = np.isfinite(theta) & np.isfinite(dsf)
    run = np.cumsum(~finite)
    paths = []
    for index in np.unique(run[finite]):
        member = finite & (run == index)
        if member.sum() >= 2:
            paths.append(_path(theta[member], dsf[member], top, span, decades))
    return paths


def _path(theta: Floats, dsf: Floats, top: float, span: tuple[float, float], decades: float) -> str:
    x = (theta - span[0]) / (span[1] - span[0])
    level = np.log10(np.maximum(dsf, 10.0 ** (top - decades)))
    y = (top - level) / decades
    bins = np.clip((x * _BINS).astype(int), 0, _BINS - 1)
    start = np.flatnonzero(np.r_[True, np.diff(bins) != 0])
    highest = np.minimum.reduceat(y, start)
    along = np.add.reduceat(x, start) / np.diff(np.r_[start, len(x)])
    points = [
        f"{px * WIDTH:.1f} {2.0 + py * (HEIGHT - 4.0):.1f}" for px, py in zip(along, highest, strict=True)
    ]
    return "M" + "L".join(points)
