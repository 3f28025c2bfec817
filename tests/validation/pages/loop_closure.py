"""Simulate, process, compare with the truth as the instrument sees it."""

from __future__ import annotations

import numpy as np

from ..claims import claims
from ..line_pitch import line_sums
from ..loop_closure import PARTS, closure, instrument
from . import table

RATIOS = (0.5, 1.0, 1.25, 1.5, 2.0)
SEEDS = (11, 12, 13, 14, 15, 16)

VARIANTS: dict[str, tuple[dict[str, float], float]] = {
    "as described": ({}, 1.0),
    "beam and aperture half as wide": ({"beam_half_width": 0.05, "aperture": 0.05}, 1.0),
    "beam and aperture twice as wide": ({"beam_half_width": 0.2, "aperture": 0.2}, 1.0),
    "path half as dense": ({}, 2.0),
    "path a quarter as dense": ({}, 4.0),
    "path an eighth as dense": ({}, 8.0),
}
"""Settings, and the factor of all pitches of the path."""

NARROW = "Ward-GMD, alpha .02"
"""The material of the variants: the beam smears it most."""

TEXT = """# Loop closure

Made by `python -m tests.validation loop-closure`. Each material is measured by the virtual goniophotometer described in
`pgII-like.toml` (xenon lamp that drifts and flickers, four gain ranges, shot noise, a detector that moves while it reads, incidences
8°, 40° and 65°), written to raw files, read back and processed with the calibration uncertainty the instrument states. The truth is
the material's DSF averaged over beam, spot and aperture by code of its own (256 nodes, 2000 random readings an incidence). `held`: share of readings whose interval DSF ± 1.96 u holds that; `held, bare`:
that holds the material's DSF itself. Integrals: how many of the DHR and DHT lie within their expanded uncertainty (k = 2), the largest
error and the largest claim.

{materials}
## A claim follows the error

`{narrow}`, {seeds} campaigns each. Readings within 5° of the mirror direction, where beam and path tell: root mean square of the error
against the material's own DSF and of the claim u, both relative to the highest DSF there. DHR: the same over all campaigns and
incidences, relative to the truth. Gains and lamp are free of error here, and no calibration uncertainty is stated: what is left is what
processing finds out by itself.

{variants}
Coarser paths leave the DHR's claim cautious. What the beam does to a peak is claimed from the Laplacian over the readings around, what
motion does from the curvature along the path: the detector reads over half of its way to the next reading here, and the records say so
(`integration`). Where steps are as wide as the lobe neither curvature is seen whole, and the claim of a reading falls behind.

## Lines across a lobe

Rings {ratios} lobe widths apart (w, 1/e half width) over a narrow lobe, without noise, 12 positions of the lobe between rings: largest
error of the summed DHR and largest loss of the highest reading, beside `2 exp(-(pi w / d)²)` and `1 - exp(-(d / 2w)²)`. Rings that
wobble by a tenth of their pitch: root mean square error of the DHR.

{lines}"""


def percent(x: float, digits: int = 2) -> str:
    return f"{100 * x:.{digits}f}"


def materials() -> list[list[str]]:
    rows = []
    for name in PARTS:
        c = closure(name, instrument(), seed=21)
        rows.append(
            [
                name,
                f"{c.readings:,}",
                percent(c.held_seen, 1),
                percent(c.held_true, 1),
                percent(c.median_error),
                f"{c.integrals_held} of {len(c.integrals)}",
                percent(max(abs(e) for e, _ in c.integrals), 3),
                percent(max(u for _, u in c.integrals), 3),
            ]
        )
    return rows


def variant(settings: dict[str, float], pitches: float) -> list[str]:
    """Errors and claims near the mirror direction and of the DHR."""
    found = claims(NARROW, settings, pitches, seeds=SEEDS)
    return [
        percent(found.error),
        percent(found.claim),
        f"{found.error / found.claim:.2f}",
        percent(found.dhr_error, 3),
        percent(found.dhr_claim, 3),
        f"{found.dhr_error / found.dhr_claim:.2f}",
    ]


def lines() -> list[list[str]]:
    """Errors of sums over rings beside their closed forms."""
    rows = []
    for ratio in RATIOS:
        error, loss = line_sums(ratio, jitter=0.0, phases=12)
        wobbling = np.concatenate([line_sums(ratio, jitter=0.1, phases=12, seed=s)[0] for s in SEEDS[:4]])
        rows.append(
            [
                f"{ratio:g}",
                f"{np.abs(error - error.mean()).max():.1e}",
                f"{2 * np.exp(-((np.pi / ratio) ** 2)):.1e}",
                percent(loss.max(), 1),
                percent(1 - np.exp(-((ratio / 2) ** 2)), 1),
                percent(float(np.std(wobbling))),
            ]
        )
    return rows


def make() -> str:
    """The page."""
    head = [
        "material",
        "readings",
        "held, %",
        "held, bare, %",
        "median error, %",
        "integrals",
        "error, %",
        "claim, %",
    ]
    second = ["instrument", "DSF: error, %", "claim, %", "ratio", "DHR: error, %", "claim, %", "ratio"]
    third = ["d / w", "DHR: error", "closed form", "peak: loss, %", "closed form, %", "wobbling: DHR, %"]
    return TEXT.format(
        ratios=", ".join(f"{r:g}" for r in RATIOS),
        lines=table(third, lines()),
        materials=table(head, materials()),
        narrow=NARROW,
        seeds=len(SEEDS),
        variants=table(second, [[name, *variant(*v)] for name, v in VARIANTS.items()]),
    )
