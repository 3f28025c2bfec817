"""Readings as a slice."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from gonio import _native

Array = npt.NDArray[np.float64]


def photopic(
    incidence: tuple[float, float], angles: tuple[Array, Array], dsf: Array, sigma: Array, omega: Array
) -> _native.Slice:
    """Readings of the photopic channel: incidence and `angles` of the receiver as (theta, phi) in degrees."""
    return _native.Slice(
        theta_i=incidence[0],
        phi_i=incidence[1],
        channel="photopic",
        theta_s=angles[0],
        phi_s=angles[1],
        dsf=dsf,
        u_dsf=sigma,
        omega=omega,
        flags=np.zeros(dsf.size, np.uint16),
    )
