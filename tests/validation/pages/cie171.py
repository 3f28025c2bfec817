"""The analytical cases of CIE 171:2006."""

from __future__ import annotations

import numpy as np

from ..cie171 import CASES, LONG, Row
from . import table

TEXT = """# CIE 171:2006, the analytical cases

Made by `python -m tests.validation cie171`; `tests/validation/test_cie171.py` repeats it with fewer paths. Each case of section 5 of
CIE 171:2006 [CIE171] is a scene of Radiance text, read and measured by gonio at the sensors of the standard.

- **Exact** values are computed apart from gonio (`tests/validation/cie171/exact.py`): configuration factors of polygons by Lambert's edge sum,
  Gauss-Legendre quadrature over the opening for the skies, Fresnel's equations for the pane, conservation of flux.
- **Printed** values: the standard itself was not at hand. Tables 11, 12, 17, 20 and those of appendix B for the skies 1, 5 and 12 are
  compared as the open project CyclesCIEtest transcribed them. They do not decide a row; gonio and the exact values must agree with them within 7 % and
  0.015. Their median is within {median:.1f} % of the exact ones; wall points beside the edge of an opening are off
  by up to 6 %, also under the uniform sky, where the exact value is a configuration factor (5.9, 4 m, A: 45.12 %, printed 46.74 %).
- **Tolerance** of a row: four standard errors and 0.1 % (single precision; a row fails by chance in 1 of 16 000). The last column but one is the
  largest deviation over its tolerance.

{summary}
## What differs from the standard
- 5.2, 5.3: the lamp that is diffuse, and a small ball in 5.2; the photometric files of the other lamps were not at hand.
- 5.5: a pane of index 1.52 and transmissivity 0.96 (0.881 at the normal) against Fresnel's equations.
- 5.7: table 19 is wrong (Ashdown's errata); the exact configuration factor of what the block leaves free takes its place.
- 5.8: the mean over the walls, which conservation of flux makes exact in a room of any shape.
- 5.9 to 5.12: openings without a pane hold one of index 1, which does nothing but tell gonio where light comes in.
- 5.11, 5.12: the ground has the uniform luminance that the standard gives it (reflectance 0.3 under the unobstructed sky).
- 5.13, 5.14: the masks are black, and only the sky counts. Printed are their reflections too, and tables B.22, B.25 and B.26 have known mistakes.

## Points
{points}"""


def _worst(rows: list[Row]) -> float:
    return max(abs(r.found - r.exact) / r.tolerance for r in rows if r.tolerance > 0.0)


def make() -> str:
    """The page."""
    summary, points, off = [], [], []
    for case in CASES:
        rows = case.rows(LONG)
        lit = [r for r in rows if r.exact > 0.0]
        known = [abs(r.exact / r.printed - 1.0) for r in rows if r.printed]
        off += known
        summary.append(
            [
                case.number,
                case.title,
                str(len(rows)),
                f"{100.0 * np.median([abs(r.found / r.exact - 1.0) for r in lit]):.2f} %",
                f"{100.0 * np.median([r.error / r.exact for r in lit]):.2f} %",
                f"{_worst(rows):.2f}",
                f"{100.0 * np.median(known):.1f} % ({100.0 * max(known):.1f} %)" if known else "-",
            ]
        )
        points += [
            [
                case.number,
                r.where,
                "-" if r.printed is None else f"{r.printed:g}",
                f"{r.exact:.5g}",
                f"{r.found:.5g}",
                f"{r.tolerance:.2g}",
            ]
            for r in rows
            if "sky 5" not in r.where
        ]
    head = [
        "case",
        "",
        "values",
        "off, median",
        "stated error, median",
        "largest over tolerance",
        "printed off exact, median (largest)",
    ]
    return TEXT.format(
        median=100.0 * np.median(off),
        summary=table(head, summary),
        points=table(["case", "point", "printed", "exact", "gonio", "tolerance"], points),
    )
