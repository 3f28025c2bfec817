"""Colour of the parameters of a fit: a number a channel becomes red, green and blue."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from gonio._native import DomainError
from gonio.colours import RADIANCE_PRIMARIES, SRGB, Colour, colour_of_channels
from gonio.radiance_colour import luminance

RGB = ("red", "green", "blue")

Triple = tuple[float, float, float]


def check_tint(tint: Triple) -> None:
    """Refuse what is no colour.

    Raises
    ------
    DomainError
        A component that is negative or no number, or all 0.
    """
    if not all(math.isfinite(c) and c >= 0.0 for c in tint) or luminance(tint) <= 0.0:
        found = ", ".join(f"{c:g}" for c in tint)
        raise DomainError(f"colour: found {found}, allowed three finite numbers from 0, not all 0")


@dataclass
class Palette:
    """Makes RGB in Radiance's primaries of the values of a fit's channels.

    `channels` are those of the fit. `tint` is the colour, at any scale, that a fit of one channel is given:
    its luminance becomes the value of that channel. Without one a fit of the photopic channel is grey;
    `as_visible` makes one of any other channel grey, too. Channels red, green and blue are in `primaries`,
    one of `gonio.colours.PRIMARIES`. `warnings` gather what the way to RGB lost.
    """

    channels: Sequence[str]
    tint: Triple | None = None
    illuminant: str = "D65"
    as_visible: bool = False
    primaries: str = RADIANCE_PRIMARIES
    warnings: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        if self.tint is not None:
            check_tint(self.tint)
        if len(self.channels) > 1:
            asked = "colour" if self.tint is not None else "as_visible" if self.as_visible else None
            if asked is not None:
                raise DomainError(
                    f"{asked}: found it beside the channels {', '.join(self.channels)}, allowed for a fit of "
                    "one channel: the channels of this fit have their own colours"
                )
            return
        (channel,) = self.channels
        if channel != "photopic" and (self.tint is not None or self.as_visible):
            self.warnings.append(f"the values of the channel {channel} stand for the luminance, as asked for")

    def rgb(self, values: Mapping[str, float]) -> Triple:
        """RGB of one value a channel.

        Raises
        ------
        DomainError, FormatError
            The channels make no colour: neither red, green and blue, nor photopic, nor wavelengths across the
            visible; one channel that is not photopic, without `tint` and `as_visible`.
        """
        if len(self.channels) == 1:
            (channel,) = self.channels
            if self.tint is None and channel != "photopic" and not self.as_visible:
                raise DomainError(
                    f"colour: found the channel {channel} alone, which has none, allowed photopic, red, "
                    "green and blue, or wavelengths from 410 to 690 nm: state --colour or --colour-from "
                    "(colour=…), or take it for the visible with --as-visible (as_visible=True)"
                )
            tint = self.tint or (1.0, 1.0, 1.0)
            scale = values[channel] / luminance(tint)
            red, green, blue = (scale * c for c in tint)
            return red, green, blue
        found = self._colour(values)
        self.warnings += [w for w in found.warnings if w not in self.warnings]
        return found.rgb

    def grey(self, values: Mapping[str, float]) -> tuple[float, float]:
        """The one number that `values` come closest to in luminance, and the largest relative difference."""
        if len(values) == 1:
            return next(iter(values.values())), 0.0
        rgb = self._colour(values).rgb
        mean = luminance(rgb)
        return mean, max(abs(c / mean - 1.0) for c in rgb) if mean > 0.0 else 0.0

    @property
    def note(self) -> str | None:
        """What the red, green and blue of a material are, where the channels had them."""
        if not set(RGB) <= set(self.channels):
            return None
        known = "Radiance's primaries (0.640 0.330, 0.290 0.600, 0.150 0.060; equal-energy white)"
        if self.primaries == SRGB:
            return f"colours: the linear sRGB of the readings, converted to {known}"
        return f"colours: the red, green and blue of the readings, taken for {known}"

    def _colour(self, values: Mapping[str, float]) -> Colour:
        return colour_of_channels(values, illuminant=self.illuminant, primaries=self.primaries)
