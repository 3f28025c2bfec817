"""Colour of the parameters of a fit: a number a channel becomes red, green and blue."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from gonio._native import DomainError
from gonio.colours import colour_of_channels
from gonio.radiance_colour import luminance

RGB = ("red", "green", "blue")

Triple = tuple[float, float, float]


@dataclass
class Palette:
    """Makes RGB in Radiance's primaries of the values of a fit's channels.

    `channels` are those of the fit. `tint` is the colour, at any scale, that a fit of the photopic channel
    alone is given: its luminance becomes the photopic value. Without one such a fit is grey. `warnings`
    gather what the way to RGB lost.
    """

    channels: Sequence[str]
    tint: Triple | None = None
    illuminant: str = "D65"
    warnings: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        if self.tint is None:
            return
        if list(self.channels) != ["photopic"]:
            raise DomainError(
                f"colour: found one beside the channels {', '.join(self.channels)}, allowed for a fit of the "
                "photopic channel alone: the channels of this fit have their own"
            )
        if min(self.tint) < 0.0 or luminance(self.tint) <= 0.0:
            raise DomainError(f"colour: found {self.tint}, allowed three numbers from 0, not all 0")

    def rgb(self, values: Mapping[str, float]) -> Triple:
        """RGB of one value a channel.

        Raises
        ------
        DomainError, FormatError
            The channels make no colour: neither red, green and blue, nor photopic, nor wavelengths across the
            visible.
        """
        if self.tint is not None:
            scale = values["photopic"] / luminance(self.tint)
            red, green, blue = (scale * c for c in self.tint)
            return red, green, blue
        found = colour_of_channels(values, illuminant=self.illuminant)
        self.warnings += [w for w in found.warnings if w not in self.warnings]
        return found.rgb

    def grey(self, values: Mapping[str, float]) -> tuple[float, float]:
        """The one number that `values` come closest to in luminance, and the largest relative difference."""
        if len(values) == 1:
            return next(iter(values.values())), 0.0
        rgb = colour_of_channels(values, illuminant=self.illuminant).rgb
        mean = luminance(rgb)
        return mean, max(abs(c / mean - 1.0) for c in rgb) if mean > 0.0 else 0.0
