"""Verdicts on models: what scattering must do, and what a file promises."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gonio import _native
from gonio._native import Bsdf, Klems, TensorTree, Verdict
from gonio.comparing import KEYS, PHI_I, THETA_I
from gonio.working import interruptible

Array = NDArray[np.float64]
Level = Literal["pass", "warn", "fail", "info"]

PAIRS = 20_000
"""Pairs of directions that are looked at, on both sides, the same every time."""

ALBEDO_WARN, ALBEDO_FAIL = 1.001, 1.02

RECIPROCITY_WARN = 0.05
PROMISED = 2e-3
"""Relative difference that rounding may make of a law a model promises to keep."""


def check_model(model: Bsdf) -> list[Verdict]:
    """Check a model: finite values, energy, Helmholtz reciprocity, isotropy.

    Parameters
    ----------
    model
        Any model.

    Returns
    -------
    list of Verdict
        In this order; one for each law. `value` is the largest albedo, the reciprocity as `gonio.compare`
        has it (largest over channels and components of the mean over incidences), or for isotropy the
        relative L1 difference `sum c_i c_s |f - f'| / sum c_i c_s (f + f') / 2` over pairs of directions. A
        law that the model promises (`properties`) and breaks is a failure, one that it does not promise a
        warning.
    """
    return interruptible(lambda: list(_verdicts(model)))


def _verdicts(model: Bsdf) -> Iterator[Verdict]:
    wi, ws = _directions()
    f = _values(model, wi, ws)
    yield _finite(f)
    yield _energy(model)
    promised = model.properties
    yield _law(
        "reciprocity",
        "reciprocity",
        _reciprocity(model),
        RECIPROCITY_WARN,
        promised=promised["reciprocal"],
        what="values with source and receiver exchanged",
    )
    turned = [(theta, phi + 37.0) for theta, phi in (wi, ws)]
    yield _law(
        "isotropy",
        "isotropy",
        _difference(f, _values(model, *turned)),
        None,
        promised=promised["isotropic"],
        what="values of the sample turned by 37 degrees",
    )


def _directions() -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    rng = np.random.default_rng(1)
    theta = np.degrees(np.arcsin(np.sqrt(rng.uniform(0, 0.998, (2, PAIRS)))))
    theta = np.where(rng.random((2, PAIRS)) < 0.5, theta, 180 - theta)
    phi = rng.uniform(0, 360, (2, PAIRS))
    # Half of the pairs stand near the mirror or through direction, where lobes are.
    near = PAIRS // 2
    theta[1, :near] = np.where(rng.random(near) < 0.5, theta[0, :near], 180 - theta[0, :near])
    theta[1, :near] = np.clip(np.abs(theta[1, :near] + rng.normal(0, 5, near)), 0, 180)
    phi[1, :near] = phi[0, :near] + 180 + rng.normal(0, 5, near)
    return (theta[0], phi[0]), (theta[1], phi[1])


def _values(model: Bsdf, wi: tuple[Array, Array], ws: tuple[Array, Array]) -> Array:
    """Values times both cosines, one row a pair."""
    at = {"theta_i": wi[0], "phi_i": wi[1], "theta_s": ws[0], "phi_s": ws[1]}
    f = np.stack([model.eval(**at, channel=channel) for channel in model.channels], axis=-1)
    cosines = np.abs(np.cos(np.radians(wi[0])) * np.cos(np.radians(ws[0])))
    weighted: Array = f * cosines[:, None]
    return weighted


def _difference(a: Array, b: Array) -> float | None:
    size = 0.5 * float(np.sum(a + b))
    return float(np.sum(np.abs(a - b))) / size if size > 0 else None


def _finite(f: Array) -> Verdict:
    wrong = int(np.sum(~np.isfinite(f) | (f < 0)))
    sentence = (
        f"{wrong} of {f.size} values are negative or not finite"
        if wrong
        else f"{f.size} values are finite and not negative"
    )
    return _verdict("values", "values", "fail" if wrong else "pass", sentence)


def _energy(model: Bsdf) -> Verdict:
    """The same number as `gonio export` and `gonio reduce` print."""
    where, u = "", 0.0
    if isinstance(model, (Klems, TensorTree)):
        highest = model.max_albedo
    else:
        found = _native.largest_albedo(model)
        highest, u = found["value"], found["error"]
        where = f", at theta_i {found['theta_i']:g}, phi_i {found['phi_i']:g} ({found['channel']})"
    if highest == 0:
        return _verdict("energy", "energy", "warn", "no light leaves at any incidence", 0.0)
    sure = highest - 2 * u
    level: Level = "fail" if sure > ALBEDO_FAIL else "warn" if sure > ALBEDO_WARN else "pass"
    than = "no more light leaves than arrives" if level == "pass" else "more light leaves than arrives"
    return _verdict("energy", "energy", level, f"{than}: at most {highest:.4f} of it{where}", highest)


def _reciprocity(model: Bsdf) -> float | None:
    """Largest over channels and components of what `gonio compare` prints; None where nothing is known."""
    phis = (0.0,) if model.properties["isotropic"] else PHI_I
    means = []
    for channel in model.channels:
        for side, component in KEYS:
            found = [
                _native.model_reciprocity(
                    model,
                    theta_i=theta if side == "front" else 180.0 - theta,
                    phi_i=phi,
                    component=component,
                    channel=channel,
                )
                for theta in THETA_I
                for phi in phis
            ]
            known = [v for v in found if math.isfinite(v)]
            if known:
                means.append(sum(known) / len(known))
    return max(means, default=None)


def _law(
    name: str, title: str, difference: float | None, limit: float | None, *, promised: bool, what: str
) -> Verdict:
    if difference is None:
        return _verdict(name, title, "info", "nothing scatters, or nothing is known of it")
    kept = difference <= PROMISED
    level: Level
    if promised:
        level = "pass" if kept else "fail"
    elif limit is None:
        level = "info"
    else:
        level = "pass" if difference <= limit else "warn"
    promise = "the model promises no difference" if promised else "the model promises nothing of it"
    sentence = f"{what} differ by {100 * difference:.2g} %; {promise}"
    return _verdict(name, title, level, sentence, difference)


def _verdict(name: str, title: str, level: Level, sentence: str, value: float | None = None) -> Verdict:
    return Verdict(id=name, title=title, verdict=level, sentence=sentence, value=value, unit="1")
