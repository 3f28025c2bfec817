"""Microfacet models beside Mitsuba 3."""

from __future__ import annotations

import numpy as np

from ..mitsuba import MODELS, Mitsuba, compare, random_cases, rational_error
from . import Skipped, table

COUNT = 1000

TEXT = """# Microfacets: Mitsuba 3

Made by `python -m tests.validation microfacet`; `tests/validation/test_mitsuba_parity.py` repeats it. {count} random sets of parameters
and directions a model: `alpha` .03 to 1 (both widths and `phi_x` apart), `eta` 0.1 to 4 and `k` 0 to 8 of conductors, `eta` 1.1 to 2.6 of
interfaces lit from both sides, half of the pairs refracted; incidence to 87 degrees, facets within three widths. Mitsuba {version}: roughconductor and
roughdielectric, `sample_visible`, variant scalar_rgb. Its packages have no variant of double precision: the differences left are
those of single precision, the largest where a conductor of index near 1 hardly reflects.

{table}
Differences are relative, of `f |cos theta_s|` and of the density of sampling.

## What is taken out
- **Masking of reflection.** Mitsuba multiplies `G_1(wi) G_1(ws)`; gonio has the height-correlated `1 / (1 + Λ_i + Λ_s)`, which lets
  up to {gain:.0f} % more light out in these cases. The ratio of the two, coded a second time in the test, is divided out. Transmission is the same in both.
- **Beckmann's `G_1`.** Mitsuba evaluates a rational approximation [Walter2007, eq. 27], off by up to {rational:.2f} %; gonio the exact one. The same ratio holds it.
- **Direction of transport.** An interface is compared in Mitsuba's importance mode, in which its values are radiance per
  irradiance; radiance mode divides by the squared index.
- **Tails.** Mitsuba returns 0 where a facet's density is below 1e-20; facets beyond three widths are left out.
"""


def make() -> str:
    """The page."""
    try:
        import mitsuba  # noqa: PLC0415
    except ImportError as e:
        raise Skipped("mitsuba has no wheel for this platform") from e
    peer = Mitsuba(mitsuba)
    rows, gain = [], 0.0
    for model in MODELS:
        found = [compare(case, peer(case)) for case in random_cases(model, COUNT, seed=sum(map(ord, model)))]
        values = np.abs([c.value - 1.0 for c in found])
        densities = np.abs([c.pdf - 1.0 for c in found])
        gain = max(gain, *(c.gain for c in found))
        numbers = (np.median(values), values.max(), np.median(densities), densities.max())
        rows.append([f"`{model}`", *(f"{v:.1e}" for v in numbers)])
    head = ["model", "value, median", "value, largest", "density, median", "density, largest"]
    return TEXT.format(
        count=COUNT,
        version=mitsuba.__version__,
        table=table(head, rows),
        gain=100.0 * gain,
        rational=100.0 * rational_error(),
    )
