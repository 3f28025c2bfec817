"""Files of models beside the Radiance ones: MERL binaries, RGL materials and Zemax tabular BSDFs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gonio import _native
from gonio._native import Bsdf, QuantityError
from gonio.working import interruptible

_COLOURS = ("red", "green", "blue")
_FRONT_REFLECTION = ("front", "reflection")


@dataclass(frozen=True)
class Target:
    """The file that a writer makes, and what of the model goes into it (as in `export`)."""

    path: Path
    channel: str | None
    components: Sequence[tuple[str, str]] | None
    title: str


def _one_component(
    to: str, components: Sequence[tuple[str, str]] | None, allowed: Sequence[tuple[str, str]]
) -> tuple[str, str]:
    """Return the component that a file of one is to hold; front reflection unless asked otherwise."""
    asked = list(components or [_FRONT_REFLECTION])
    if len(asked) != 1 or asked[0] not in allowed:
        found = ", ".join("-".join(c) for c in asked)
        choices = ", ".join("-".join(c) for c in allowed)
        raise QuantityError(f"component: found {found}, needed one for {to}: {choices}")
    return asked[0]


def _colours(model: Bsdf, channel: str | None) -> tuple[tuple[str, str, str], list[str]]:
    """Channels of the model for red, green and blue, and what is to be told of them.

    Its own unless `channel` is given; grey from `channel` or from the only one.
    """
    if channel is None and set(_COLOURS) <= set(model.channels):
        return _COLOURS, []
    if channel is None and len(model.channels) > 1:
        raise QuantityError(
            f"channel: found {', '.join(model.channels)}, "
            "needed red, green and blue, or one named for a grey file"
        )
    one = channel if channel is not None else model.channels[0]
    return (one, one, one), [f"red, green and blue hold the same, channel {one}"]


def _without_ideal_part(model: Bsdf) -> list[str]:
    if not model.has_delta:
        return []
    return ["the ideal part (mirror, unbent) of the model has no BSDF and is left out"]


def write_merl(model: Bsdf, target: Target) -> tuple[dict[str, Any], list[str]]:
    """Write a MERL binary: its report with the table read back as a model, and what is to be told.

    Without `channel` the model's red, green and blue; grey from `channel` or from the only one. The format
    has no place for a title.
    """
    _one_component("merl", target.components, [_FRONT_REFLECTION])
    channels, notes = _colours(model, target.channel)
    notes += _without_ideal_part(model)
    table = interruptible(lambda: _native.write_merl(target.path, model, channels))
    return {"reduced": table, "channel": channels[0]}, notes


def write_rgl(model: Bsdf, target: Target) -> tuple[dict[str, Any], list[str]]:
    """Write an RGL material: its report with what was written as a model, and what is to be told.

    Spectral where the model has two or more channels, all of them wavelengths, and none is named; else red,
    green and blue as `write_merl`.
    """
    _one_component("rgl-bsdf", target.components, [_FRONT_REFLECTION])
    spectral = [c for c in model.channels if c.endswith("nm")]
    if target.channel is None and len(spectral) == len(model.channels) > 1:
        names = sorted(spectral, key=lambda c: float(c.removesuffix("nm")))
        channels, notes = [(c, c) for c in names], list[str]()
    else:
        taken, notes = _colours(model, target.channel)
        channels = list(zip(_COLOURS, taken, strict=True))
    notes += _without_ideal_part(model)
    written = interruptible(lambda: _native.write_rgl(target.path, model, channels, description=target.title))
    return {"reduced": written, "channel": channels[0][1]}, notes


def write_zemax(model: Bsdf, target: Target) -> tuple[dict[str, Any], list[str]]:
    """Write a Zemax tabular BSDF: symmetry and number of its values, and what is to be told."""
    allowed = [_FRONT_REFLECTION, ("front", "transmission")]
    _, component = _one_component("zemax-bsdf", target.components, allowed)
    one = target.channel or (model.channels[0] if len(model.channels) == 1 else None)
    comments = "\n".join(
        line for line in (target.title, f"channel {one}, {component}, written by gonio") if line
    )
    symmetry, values = interruptible(
        lambda: _native.write_zemax(target.path, model, channel=one, component=component, comments=comments)
    )
    notes = []
    if symmetry == "ASymmetrical4D":
        notes.append("OpticStudio reads files of one sample rotation only; this one has several")
    notes += _without_ideal_part(model)
    return {"symmetry": symmetry, "values": values}, notes


Writer = Callable[[Bsdf, Target], tuple[dict[str, Any], list[str]]]

MODEL_WRITERS: dict[str, Writer] = {
    "merl": write_merl,
    "rgl-bsdf": write_rgl,
    "zemax-bsdf": write_zemax,
}
