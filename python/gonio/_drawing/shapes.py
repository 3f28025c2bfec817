"""What the drawings need of a measurement, as protocols: they draw any object with these attributes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from gonio._native import FLAGS

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]

UNUSABLE = FLAGS["sentinel"] | FLAGS["no_data"] | FLAGS["shadow"] | FLAGS["saturated"]
"""Flags that take a reading out of integrals, surfaces and profiles."""


class IntegralLike(Protocol):
    """A hemispherical integral: DHR or DHT with the extrapolated part and standard uncertainties."""

    @property
    def side(self) -> Any:
        """Receiver hemisphere, "front" or "back"."""

    @property
    def value(self) -> float:
        """Integral over the whole hemisphere."""

    @property
    def extrapolated(self) -> float:
        """The part of `value` from directions that were not measured."""

    @property
    def u(self) -> float:
        """Combined standard uncertainty."""


class SliceLike(Protocol):
    """One processed incidence and channel; angles in degrees, DSF and its standard uncertainty in 1/sr."""

    @property
    def theta_i(self) -> float:
        """Polar angle of incidence, degrees."""

    @property
    def phi_i(self) -> float:
        """Azimuth of incidence, degrees."""

    @property
    def channel(self) -> str:
        """Name of the spectral channel."""

    @property
    def theta_s(self) -> Floats:
        """Receiver polar angles, degrees, 0 to 180."""

    @property
    def phi_s(self) -> Floats:
        """Receiver azimuths, degrees."""

    @property
    def dsf(self) -> Floats:
        """DSF, 1/sr."""

    @property
    def u_dsf(self) -> Floats:
        """Combined standard uncertainty of the DSF, 1/sr."""

    @property
    def flags(self) -> npt.NDArray[np.uint16]:
        """Flags of each reading."""

    @property
    def u_common(self) -> float:
        """Relative standard uncertainty common to all readings."""

    @property
    def integrals(self) -> Sequence[Any]:
        """Hemispherical integrals, one a hemisphere that was measured."""


class MeasurementLike(Protocol):
    """A processed sample."""

    @property
    def slices(self) -> Sequence[Any]:
        """Slices in the order of the input."""

    @property
    def sample_name(self) -> str | None:
        """Name of the sample."""

    @property
    def signature_fwhm(self) -> float | None:
        """Full width at half maximum of the instrument signature, degrees."""

    @property
    def warnings(self) -> Sequence[str]:
        """Physics warnings found on the way."""

    @property
    def provenance(self) -> Any:
        """Files, versions and settings."""


class VerdictLike(Protocol):
    """The outcome of one check."""

    @property
    def id(self) -> str:
        """Stable identifier."""

    @property
    def title(self) -> str:
        """What was checked."""

    @property
    def verdict(self) -> str:
        """One of pass, warn, fail, info."""

    @property
    def value(self) -> float | None:
        """The number behind the verdict."""

    @property
    def unit(self) -> Any:
        """Unit of the number."""

    @property
    def sentence(self) -> str:
        """What a lab engineer can do about it."""


@dataclass(frozen=True)
class Snapshot:
    """A slice with its arrays fetched once; the attributes of `SliceLike`."""

    theta_i: float
    phi_i: float
    channel: str
    theta_s: Floats
    phi_s: Floats
    dsf: Floats
    u_dsf: Floats
    flags: npt.NDArray[np.uint16]
    u_common: float
    integrals: Sequence[Any]


def snapshot(slice_: SliceLike) -> Snapshot:
    """Fetch the arrays of a slice once: native slices hand out a copy at every access."""
    return Snapshot(
        theta_i=float(slice_.theta_i),
        phi_i=float(slice_.phi_i),
        channel=str(slice_.channel),
        theta_s=np.asarray(slice_.theta_s, dtype=float),
        phi_s=np.asarray(slice_.phi_s, dtype=float),
        dsf=np.asarray(slice_.dsf, dtype=float),
        u_dsf=np.asarray(slice_.u_dsf, dtype=float),
        flags=np.asarray(slice_.flags, dtype=np.uint16),
        u_common=float(slice_.u_common),
        integrals=list(slice_.integrals),
    )


class BsdfLike(Protocol):
    """A scattering model that can be asked for values."""

    @property
    def channels(self) -> Sequence[str]:
        """Names of the channels."""

    def eval(self, *, theta_i: Any, phi_i: Any, theta_s: Any, phi_s: Any, channel: str | None = None) -> Any:
        """BSDF in 1/sr; angles in degrees, broadcast."""


def unusable(flags: npt.ArrayLike, dsf: npt.ArrayLike) -> Bools:
    """Find the readings that must not enter a surface or profile: flagged so, or not finite."""
    bits = np.asarray(flags, dtype=np.int64)
    bad: Bools = ((bits & UNUSABLE) != 0) | ~np.isfinite(np.asarray(dsf, dtype=float))
    return bad
