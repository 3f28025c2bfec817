"""Lamp spectra and detector responsivities: what a channel of an instrument sees of a material."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gonio._native import DomainError
from gonio.instrument_keys import Refuse
from gonio.instrument_tables import pair_rows

WAVELENGTH = np.arange(200.0, 3000.5, 1.0)
"""Nodes of spectral integrals, nm."""

_TABLE = """
3.9e-05 6.4e-05 0.00012 0.000217 0.000396 0.00064 0.00121 0.00218 0.004 0.0073 0.0116 0.01684 0.023
0.0298 0.038 0.048 0.06 0.0739 0.09098 0.1126 0.13902 0.1693 0.20802 0.2586 0.323 0.4073 0.503 0.6082
0.71 0.7932 0.862 0.91485 0.954 0.9803 0.99495 1 0.995 0.9786 0.952 0.9154 0.87 0.8163 0.757 0.6949
0.631 0.5668 0.503 0.4412 0.381 0.321 0.265 0.217 0.175 0.1382 0.107 0.0816 0.061 0.04458 0.032 0.0232
0.017 0.01192 0.00821 0.005723 0.004102 0.002929 0.002091 0.001484 0.001047 0.00074 0.00052 0.0003611
0.0002492 0.0001719 0.00012 8.48e-05 6e-05 4.24e-05 3e-05 2.12e-05 1.499e-05
"""

V_LAMBDA = np.array(_TABLE.split(), dtype=np.float64)
"""V(lambda) of CIE 1924 at 380 to 780 nm, 5 nm apart. The package that has it takes seconds to import."""

LUMINANCE = {"red": 0.265074126, "green": 0.670114631, "blue": 0.064811243}
"""Radiance's weights of its channels in the luminance."""

NAMED = ("photopic", "solar", "red", "green", "blue")
OUTSIDE = 0.02
"""Share of lamp times responsivity that may lie beyond the wavelengths of a model."""


@dataclass(frozen=True)
class Lamp:
    """A lamp: its kind and its relative spectral power at `WAVELENGTH`."""

    kind: str
    power: NDArray[np.float64]


@dataclass(frozen=True)
class Channel:
    """A detector: name of its channel, relative responsivity at `WAVELENGTH`, gain of its amplifier.

    `mismatch` is f1' against V(lambda) for a detector named photopic, else None.
    """

    name: str
    response: NDArray[np.float64]
    gain: float
    mismatch: float | None = None


def _planck(temperature: float) -> NDArray[np.float64]:
    metres = WAVELENGTH * 1e-9
    exponent = 0.014387768775 / (metres * temperature)
    radiance = metres**-5 / np.expm1(np.minimum(exponent, 700.0))
    return np.asarray(radiance / radiance.max(), dtype=np.float64)


def _gaussian(peak: float, fwhm: float) -> NDArray[np.float64]:
    return np.asarray(np.exp(-4.0 * np.log(2.0) * ((WAVELENGTH - peak) / fwhm) ** 2), dtype=np.float64)


def _tabulated(path: Path, key: str, refuse: Refuse) -> NDArray[np.float64]:
    nm, value = np.array(pair_rows(path, key=key, refuse=refuse)).T
    found = np.interp(WAVELENGTH, nm, value, left=0.0, right=0.0)
    if not found.max() > 0.0:
        raise refuse(key, f"{path}: nothing between 200 and 3000 nm", "a spectrum there")
    return np.asarray(found, dtype=np.float64)


def v_lambda(shift: float = 0.0) -> NDArray[np.float64]:
    """Return V(lambda) of the CIE 1924 observer at `WAVELENGTH`, moved by `shift` nm to the red."""
    nodes = np.arange(380.0, 781.0, 5.0)
    values = np.interp(WAVELENGTH - shift, nodes, V_LAMBDA, left=0.0, right=0.0)
    return np.asarray(values, dtype=np.float64)


def f1_prime(response: NDArray[np.float64]) -> float:
    """Return the spectral mismatch index f1' of a responsivity against V(lambda) [ISO19476].

    The responsivity is scaled to give illuminant A (a black body of 2856 K) the same signal; f1' is the
    integral of the difference's magnitude over that of V(lambda).
    """
    v, a = v_lambda(), _planck(2856.0)
    scaled = response * (np.sum(a * v) / np.sum(a * response))
    return float(np.sum(np.abs(scaled - v)) / np.sum(v))


def lamp(keys: Mapping[str, Any], *, refuse: Refuse, directory: Path) -> Lamp:
    """Make the lamp of a file's section.

    Halogen is a black body of `temperature` (3100 K), xenon one of 6000 K without the lines beyond 800 nm,
    a laser a line of 1 nm, table the file `spectrum` of rows nm value.
    """
    kind = keys["kind"]
    needed = {"laser": "wavelength", "table": "spectrum"}.get(kind)
    optional = {"xenon": "temperature", "halogen": "temperature"}.get(kind)
    for key in ("temperature", "wavelength", "spectrum"):
        given = keys[key] is not None
        if given and key not in (needed, optional):
            raise refuse(f"lamp.{key}", "it", f"none with kind {kind}")
        if not given and key == needed:
            raise refuse(f"lamp.{key}", "nothing", f"one with kind {kind}")
    if kind == "laser":
        return Lamp(kind, _gaussian(keys["wavelength"], 1.0))
    if kind == "table":
        return Lamp(kind, _tabulated(directory / keys["spectrum"], "lamp.spectrum", refuse))
    return Lamp(kind, _planck(keys["temperature"] or {"xenon": 6000.0, "halogen": 3100.0}[kind]))


def channel(row: Mapping[str, Any], *, lamp: Lamp, refuse: Refuse, directory: Path) -> Channel:
    """Make the detector of a file's section.

    `response` is V(lambda), gaussian, flat, or the name of a file of rows nm value.
    """
    name, response = row["name"], row["response"]
    if name not in NAMED and not re.fullmatch(r"[0-9]+(\.[0-9]+)?nm", name):
        raise refuse("detector.channel.name", repr(name), f"{', '.join(NAMED)}, or a wavelength as 532nm")
    shape = response == "gaussian"
    for key in ("peak", "fwhm"):
        if shape != (row[key] is not None):
            raise refuse(f"detector.channel.{key}", str(row[key]), "one with response gaussian alone")
    if row["shift"] != 0.0 and response != "V(lambda)":
        raise refuse("detector.channel.shift", str(row["shift"]), "one with response V(lambda) alone")
    if shape:
        found = _gaussian(row["peak"], row["fwhm"])
    elif response == "V(lambda)":
        found = v_lambda(row["shift"])
    elif response == "flat":
        found = np.ones_like(WAVELENGTH)
    else:
        found = _tabulated(directory / response, "detector.channel.response", refuse)
    if not np.sum(found * lamp.power) > 0.0:
        raise refuse("detector.channel.response", f"no light of the {lamp.kind} lamp for {name}", "some")
    mismatch = f1_prime(found) if name == "photopic" else None
    return Channel(name, found, float(row["gain"]), mismatch)


def outputs(
    channels: Sequence[Channel], *, lamp: Lamp, of: Sequence[str]
) -> list[tuple[str, float, list[float]]]:
    """Return what each detector records of a model with the channels `of`: name, power, weights.

    Of a model in wavelengths a detector sees the mean weighted with lamp times responsivity, linear between
    the wavelengths. Of Radiance's colours it sees the one of its name, photopic the luminance. A model of
    one channel is grey. Powers are lamp times responsivity times gain over that of the first without gain.

    Raises
    ------
    DomainError
        A detector sees light that the model says nothing of.
    """
    found = []
    first = float(np.sum(lamp.power * channels[0].response)) if channels else 1.0
    for c in channels:
        seen = lamp.power * c.response
        power = c.gain * float(np.sum(seen)) / first
        found.append((c.name, power, _weights(c.name, seen / np.sum(seen), of)))
    return found


def _weights(name: str, seen: NDArray[np.float64], of: Sequence[str]) -> list[float]:
    if len(of) == 1:
        return [1.0]
    nm = sorted((float(o.removesuffix("nm")), k) for k, o in enumerate(of) if o.endswith("nm"))
    nodes = np.array([n for n, _ in nm])
    outside = 1.0
    if len(nm) > 1:
        outside = float(np.sum(seen[np.clip(WAVELENGTH, nodes[0], nodes[-1]) != WAVELENGTH]))
    if name in of and (name in NAMED or outside > OUTSIDE):
        return [float(o == name) for o in of]
    if name == "photopic" and set(LUMINANCE) <= set(of):
        return [LUMINANCE.get(o, 0.0) for o in of]
    if len(nm) < 2:
        raise DomainError(f"channel: found {name} of the instrument, allowed {', '.join(of)} of the model")
    if outside > OUTSIDE:
        raise DomainError(
            f"channel: found {name} of the instrument, which sees {100 * outside:.0f} % of its light beyond "
            f"the model's {nodes[0]:g} to {nodes[-1]:g} nm, allowed {100 * OUTSIDE:.0f} %"
        )
    weights = [0.0] * len(of)
    for node, (_, k) in enumerate(nm):
        unit = np.zeros(len(nodes))
        unit[node] = 1.0
        weights[k] = float(np.sum(seen * np.interp(WAVELENGTH, nodes, unit)))
    return weights
