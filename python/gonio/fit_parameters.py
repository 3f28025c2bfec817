"""The parameters of fit models, before and after a fit."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class FitParameter:
    """One parameter of a fit model; angles are degrees.

    `role` is amplitude, width, angle, index, exponent or offset; `per_channel` tells whether every channel
    has its own value.
    """

    name: str
    unit: str
    low: float
    high: float
    default: float
    role: str
    per_channel: bool
    meaning: str


@dataclass(frozen=True)
class FitModel:
    """A model that `gonio.fit` knows; `parts` are the names in `gonio.models` whose sum it is."""

    name: str
    title: str
    parameters: tuple[FitParameter, ...]
    parts: tuple[str, ...]


@dataclass(frozen=True)
class Estimate:
    """A fitted parameter; angles are degrees.

    Attributes
    ----------
    name, unit, role, meaning
        As in `FitParameter`.
    channel
        The channel it belongs to; None: all of them.
    value
        The value at the minimum.
    u
        Standard uncertainty from noise, from correlated residuals and from what all readings share.
    u_common
        The part of `u` that all readings share: the beam power.
    u_model
        Largest difference to the value that another metric prefers: what the model, not the noise, leaves
        open.
    low, high
        Ends of the 95 % interval that belongs to `u`.
    kind
        value, upper_limit (the beam hides the lobe: below `high` is all that is known), fixed, undetermined.
    interval
        Where `low` and `high` come from: quadratic (curvature at the minimum) or profile.
    open
        Why the readings leave the value open: undetermined (they do not depend on it), vague (they say hardly
        more than the bounds do) or range (a shape at the end of its range); None where they determine it.
        docs/fit.md has the limits.
    """

    name: str
    unit: str
    role: str
    channel: str | None
    value: float
    u: float
    u_common: float
    u_model: float
    low: float
    high: float
    kind: str
    interval: str
    meaning: str
    open: str | None = None

    @property
    def label(self) -> str:
        """Name with its channel, such as `color (red)`."""
        return self.name if self.channel is None else f"{self.name} ({self.channel})"
