"""docs/validation/planner.md: readings of planned and of uniform paths for the same errors and claims."""

from __future__ import annotations

import math
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from ..patch_rule import BASE, WIDTH, patch_errors, rms
from ..planning import CASES, PITCHES, THETA_I, compared, needed
from . import table

SEEDS = 3
DHR, PEAK = 0.005, 0.01

TEXT = """# The planner

Made by `python -m tests.validation planner`. Planned paths (`gonio plan`, targets u(DHR) = {dhr} %, u(peak) = {peak} %, largest pitch 10°)
against uniform ones: rings and readings on them at one pitch over the whole hemisphere, from random starts. Instrument: `pgII-like.toml`
without drift and gain errors, and no calibration uncertainty: what is left is what path, noise and beam do. Each is simulated, written as
records and processed. Errors are root mean squares over {seeds} campaigns with paths and noise of their own: of the DHR against the material's, of the highest
reading against the highest DSF that the instrument can see (the material's averaged over beam, spot and aperture by code of the
validation's own). Claims are root mean squares of what processing states (`u` of the integral, `Slice.highest`).

`uniform for the same errors`: readings of the coarsest uniform path (pitches of 12° and below in steps of a third of an octave, to {finest}°) from which on both errors
are no larger than the planned path's; `for the same claims`: both claims. `>` the finest one tried is not there yet. The ratio is that of the smaller number.

{materials}
At least {least:.0f} times fewer readings. Where a claim stays above its target, the width of the beam decides: of a lobe with α = .02 at 75°, across
which w is .6°, beam and aperture flatten 2 %.

## The patch rule

A patch of rings about the mirror direction over a narrow lobe (Ward-GMD, α .05, θ_i about 45°, w = {width:.1f}° in the plane of incidence),
base rings and readings {base:g}° apart ({ratio:.1f} w), without noise, processed. Root mean square error of the DHR over 8 positions of the lobe on
the base. Patches of pitch .25 w that end at `R`:

{radius}
The rule that a patch has a radius of 2.5 w or more holds: below, the base takes over on a flank that it cannot integrate.

The best of all patches of a number of readings, of one pitch (hard edge) and of a pitch that grows by a tenth to three tenths of the distance (graded): radii of
2 to 4 w, pitches at the centre of .15 to .5 w.

{graded}
A graded patch beats a hard edge of as many readings."""


def readings(x: float) -> str:
    return f"{x:,.0f}"


def case(name: str, theta_i: float) -> tuple[list[str], float]:
    """One row, and the ratio of readings."""
    plan, ladder = compared(name, theta_i, seeds=SEEDS, dhr=DHR, peak=PEAK)
    finest = ladder[-1].readings
    cells, ratio = [], math.inf
    for claims in (False, True):
        n = needed(plan, ladder, claims=claims)
        ratio = min(ratio, min(n, finest) / plan.readings)
        cells.append(readings(n) if math.isfinite(n) else f"> {readings(finest)}")
    row = [
        name,
        f"{theta_i:g}",
        readings(plan.readings),
        f"{100 * plan.dhr_error:.2f}",
        f"{100 * plan.dhr_claim:.2f}",
        f"{100 * plan.peak_error:.2f}",
        f"{100 * plan.peak_claim:.2f}",
        *cells,
        f"{ratio:.0f}",
    ]
    print(" | ".join(row), flush=True)
    return row, ratio


def rows() -> tuple[list[list[str]], float]:
    """All cases, three at a time."""
    cases = [(name, theta_i) for name in CASES for theta_i in THETA_I]
    with ProcessPoolExecutor(3, mp_context=get_context("spawn")) as pool:
        found = list(pool.map(case, *zip(*cases, strict=True)))
    return [row for row, _ in found], min(ratio for _, ratio in found)


def radii() -> list[list[str]]:
    found = []
    for radius in (0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0):
        error, count = patch_errors(radius=radius, pitch=0.25, growth=0.0)
        name = f"{radius:g} w" if radius else "no patch"
        found.append([name, readings(float(count.mean())), f"{100 * rms(error):.2g}"])
    return found


def graded() -> list[list[str]]:
    hard, soft = [], []
    for radius in (2.0, 2.5, 3.0, 4.0):
        for pitch in (0.15, 0.2, 0.25, 0.3, 0.4, 0.5):
            for growth in (0.0, 0.1, 0.2, 0.3):
                error, count = patch_errors(radius=radius, pitch=pitch, growth=growth)
                row = (float(count.mean()), rms(error), radius, pitch, growth)
                (soft if growth else hard).append(row)
    found = []
    for low, high in ((340, 380), (380, 420), (420, 480), (480, 560)):
        cells = [f"{low} to {high}"]
        for kind in (hard, soft):
            best = min((r for r in kind if low <= r[0] < high), key=lambda r: r[1], default=None)
            cells += (
                ["-", "-"]
                if best is None
                else [f"{100 * best[1]:.2g}", f"{best[2]:g} w, {best[3]:g} w, {best[4]:g}"]
            )
        found.append(cells)
    return found


def make() -> str:
    """The page."""
    head = [
        "material",
        "theta_i, °",
        "planned",
        "DHR: error, %",
        "claim, %",
        "peak: error, %",
        "claim, %",
        "uniform for the same errors",
        "for the same claims",
        "ratio",
    ]
    materials, least = rows()
    return TEXT.format(
        dhr=100 * DHR,
        peak=100 * PEAK,
        seeds=SEEDS,
        finest=f"{PITCHES[-1]:.2g}",
        materials=table(head, materials),
        least=math.floor(least),
        width=WIDTH,
        base=BASE,
        ratio=BASE / WIDTH,
        radius=table(["R", "readings", "DHR: error, %"], radii()),
        graded=table(
            [
                "readings",
                "hard: error, %",
                "radius, pitch, growth",
                "graded: error, %",
                "radius, pitch, growth",
            ],
            graded(),
        ),
    )
