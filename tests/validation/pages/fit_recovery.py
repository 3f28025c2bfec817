"""Random known materials through the virtual goniophotometer and back: coverage of the stated intervals."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from gonio import _native

from ..recovery import Recovery, recover
from . import table

SETS = 200

TEXT = """# Recovery of known parameters

Made by `python -m tests.validation fit-recovery`. For every fit model random materials (number in the second column) are measured by
the virtual goniophotometer (noise .8 %, beam and aperture of .1°, three reference scans, drifting dark, pointing of .001°, spot of
4 mm at 1.02 m; incidences 10°, 35° and 60°, four incidences of several azimuths for models with an axis, some 2500 readings each),
processed as a recording is, and fitted with the model itself. Widths are .05 to .35, even in their logarithm. The table gives how many
of the stated 95 % intervals hold the true parameter, over all parameters and for each; of {sets} trials of a right claim, 92 to 98 %
hold in 19 cases of 20. The last column is the root mean square of error over stated uncertainty; bold is what lies outside 92 to 98 %.

{table}
Amplitudes share the error of the beam's power, which is drawn anew in every campaign. Widths come out right within .2 `u` in the
median, but for the narrow ones of Beckmann interfaces, `beckmann-dielectric` (.4) and `beckmann-dielectric-anisotropic` (.75): the spot's
image in refracted light is taken as the same over the whole lobe (.2 with a spot of .1 mm, 40 materials).
"""


def percent(share: float) -> str:
    """A share in percent, bold outside 92 to 98 %."""
    text = f"{100 * share:.1f}"
    return text if 0.92 <= share <= 0.98 else f"**{text}**"


def row(found: Recovery) -> list[str]:
    """The row of one model."""
    return [
        f"`{found.model}`",
        str(found.sets),
        percent(found.share),
        ", ".join(f"{n} {percent(found.held[n] / found.tried[n])}" for n in found.tried),
        str(len(found.failed)),
        ", ".join(f"{n} {np.sqrt(np.mean(np.square(z))):.2f}" for n, z in found.z.items()),
    ]


def page(found: Iterable[Recovery]) -> str:
    """The page of these results."""
    head = ["model", "sets", "held, %", "of each, %", "no fit", "rms of error / u"]
    return TEXT.format(sets=SETS, table=table(head, map(row, found)))


def make() -> str:
    """The page."""
    return page(recover(model, SETS) for model in _native.fit_models())
