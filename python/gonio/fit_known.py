"""Whether a fit knows the parameters that a material is made of."""

from __future__ import annotations

from collections.abc import Collection

from gonio._native import DomainError
from gonio.fit_parameters import Estimate
from gonio.fit_results import Fit

NEGLIGIBLE = 1e-3
"""Shares of the light below this do not make the shape of their lobe matter."""

SAME_WIDTHS = 0.01
"""Relative difference of two widths below which the azimuth of their axes does not matter."""


def require_known(fit: Fit, what: str, *, without: Collection[str] = ()) -> None:
    """Refuse a fit that leaves open a parameter of the material `what`.

    A parameter is open where the readings do not depend on it, or say hardly more of it than its bounds do
    (`Estimate.open`): specularity 1 with u = 1e8. A shape at the end of its range still is a material. The
    names `without` do not matter, nor does the azimuth of a lobe as wide along x as along y.

    Raises
    ------
    DomainError
        It names the parameter and says what to do.
    """
    ignored = {*without, *_azimuths_of_round_lobes(fit)}
    for e in fit.estimates:
        reason = None if e.name in ignored else _open(e)
        if reason is not None:
            raise DomainError(
                f"{what}: {e.label}: found {reason}, needed a value: fix it from another instrument "
                f"(--fix {e.name}=VALUE), fit a model without it, or measure more incidences"
            )


def _open(e: Estimate) -> str | None:
    if e.open == "undetermined":
        return "undetermined (the readings do not depend on it)"
    if e.open == "vague":
        return f"{e.value:.4g} with a standard uncertainty of {e.u:.2g}"
    return None


def _azimuths_of_round_lobes(fit: Fit) -> list[str]:
    values = {e.name: e.value for e in fit.estimates}
    names = []
    for name in values:
        if not name.startswith("phi_x"):
            continue
        part = name.removeprefix("phi_x")
        x, y = values.get(f"alpha_x{part}"), values.get(f"alpha_y{part}")
        if x is not None and y is not None and abs(x - y) <= SAME_WIDTHS * max(x, y):
            names.append(name)
    return names
