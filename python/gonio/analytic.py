"""Analytic scattering models by name: what there is, and a `Bsdf` of any sum of them."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

from gonio import _native
from gonio._native import Bsdf, DomainError

Component: TypeAlias = Literal["reflection", "transmission"]

Part: TypeAlias = Mapping[str, "str | float | Mapping[str, float]"]
"""One model of a sum: `model` and its parameters, each a number or a dict from channel to number."""


@dataclass(frozen=True)
class ModelParameter:
    """One parameter of an analytic model; angles are degrees.

    `role` is amplitude (one value a channel in a fit), width, angle, index or exponent.
    """

    name: str
    unit: str
    low: float
    high: float
    default: float
    role: str
    meaning: str


@dataclass(frozen=True)
class Model:
    """An analytic model as data.

    `source` names keys of docs/references.bib; `scatters` is reflection, transmission or both; `breaks` names
    the laws (reciprocity, energy) that it breaks by design, with the measured amount.
    """

    name: str
    title: str
    source: str
    scatters: str
    parameters: tuple[ModelParameter, ...]
    breaks: Mapping[str, str]


@functools.cache
def models() -> tuple[Model, ...]:
    """Return every analytic model that `analytic` evaluates."""
    return tuple(
        Model(**row | {"parameters": tuple(ModelParameter(**p) for p in row["parameters"])})
        for row in _native.model_families()
    )


def analytic(*parts: Part) -> Bsdf:
    """Return the sum of analytic models.

    Parameters
    ----------
    parts
        One mapping a model: `model` is a name of `models`, the other keys are all of that model's parameters
        (angles in degrees), each a number for every channel or a dict from channel to number. The sum has the
        channels that the dicts name, or the photopic one.

    Returns
    -------
    Bsdf
        Evaluates, samples and integrates; the same from the front and from the back unless the model says
        otherwise.

    Raises
    ------
    DomainError
        No part, an unknown model, a missing, unknown or out-of-range parameter, or a channel without a value.

    Examples
    --------
    >>> plastic = analytic({"model": "lambert", "rho": 0.4}, {"model": "ward-gmd", "rho": 0.05, "alpha": 0.1})
    >>> float(plastic.eval(theta_i=0, phi_i=0, theta_s=60, phi_s=0).round(4))
    0.1273
    """
    if not parts:
        raise DomainError("parts: found none, allowed at least one model")
    return _native.analytic([dict(p) for p in parts])


def directional_albedo(
    model: Bsdf,
    *,
    theta_i: float,
    phi_i: float = 0.0,
    component: Component = "reflection",
    channel: str | None = None,
) -> float:
    """Return the directional-hemispherical reflectance or transmittance of a model by adaptive quadrature.

    Parameters
    ----------
    model
        Any scattering model.
    theta_i, phi_i
        Incidence in degrees, theta_i from 0 to 180.
    component
        reflection gives the DHR, transmission the DHT.
    channel
        Name of the channel; without it the first.

    Raises
    ------
    DomainError, QuantityError
        An angle or component outside its range; a channel the model does not have.
    """
    return _native.directional_albedo(
        model, theta_i=theta_i, phi_i=phi_i, component=component, channel=channel
    )
