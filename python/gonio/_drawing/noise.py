"""The noise floor of a slice, from the uncertainties of its weakest readings."""

import numpy as np

from gonio._drawing.shapes import SliceLike, unusable


def noise_floor(slice_: SliceLike) -> float | None:
    """DSF in 1/sr that equals two standard uncertainties of the weakest tenth of the usable readings.

    The part of the uncertainty common to all readings is taken out. `None` without a positive uncertainty.
    """
    usable = ~unusable(slice_.flags, slice_.dsf)
    dsf, u_dsf = np.asarray(slice_.dsf, float)[usable], np.asarray(slice_.u_dsf, float)[usable]
    good = np.isfinite(u_dsf) & (u_dsf > 0.0)
    if not good.any():
        return None
    dsf, u_dsf = dsf[good], u_dsf[good]
    weakest = np.argsort(np.abs(dsf))[: max(1, len(dsf) // 10)]
    common = slice_.u_common if np.isfinite(slice_.u_common) else 0.0
    own = np.sqrt(np.maximum(u_dsf[weakest] ** 2 - (common * dsf[weakest]) ** 2, 0.0))
    floor = 2.0 * float(np.median(own))
    return floor if floor > 0.0 else None
