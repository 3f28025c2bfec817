"""Materials whose scattering is known exactly: what the demo measures and how far it may be off."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gonio import _native
from gonio._native import Bsdf, DomainError
from gonio.comparing import scatters
from gonio.model_files import read_bsdf
from gonio.radiance_materials import material_of_text
from gonio.readings import PathLike

Component = Literal["reflection", "transmission"]

_ISOTROPIC = tuple((theta, 0.0) for theta in (8.0, 20.0, 35.0, 50.0, 60.0, 70.0, 75.0))
_ANISOTROPIC = tuple((theta, phi) for theta in (10.0, 35.0, 55.0, 70.0, 75.0) for phi in (0.0, 45.0, 90.0))


@dataclass(frozen=True)
class Material:
    """A material of known scattering.

    `components` are the parts that scatter, `incidences` the (theta_i, phi_i) in degrees that a campaign
    measures unless told otherwise.
    """

    name: str
    description: str
    bsdf: Bsdf
    components: tuple[Component, ...]
    incidences: tuple[tuple[float, float], ...] = _ISOTROPIC

    def dsf(
        self, *, theta_i: ArrayLike, phi_i: ArrayLike, theta_s: ArrayLike, phi_s: ArrayLike
    ) -> NDArray[np.float64]:
        """Return the true DSF in 1/sr for directions in degrees; arguments broadcast."""
        f = self.bsdf.eval(theta_i=theta_i, phi_i=phi_i, theta_s=theta_s, phi_s=phi_s)
        cosine: NDArray[np.float64] = np.abs(np.cos(np.radians(np.asarray(theta_s, dtype=np.float64))))
        return f * cosine

    def directional_hemispherical(self, *, theta_i: float, phi_i: float, side: str) -> float:
        """Return the true DHR or DHT: the DSF integrated over hemisphere `side` (front, back), to 1e-6."""
        if side not in ("front", "back"):
            raise DomainError(f"side: found {side!r}, allowed front, back")
        reflected = (theta_i <= 90.0) == (side == "front")
        return _native.directional_albedo(
            self.bsdf,
            theta_i=theta_i,
            phi_i=phi_i,
            component="reflection" if reflected else "transmission",
        )


def _lambert(component: Component, albedo: float) -> dict[str, Any]:
    if component == "reflection":
        return {"model": "lambert", "rho": albedo}
    return {"model": "lambert-transmission", "tau": albedo}


def _gloss(rho: float, alpha_x: float, alpha_y: float | None = None) -> dict[str, Any]:
    return {
        "model": "ward-gmd-anisotropic",
        "rho": rho,
        "alpha_x": alpha_x,
        "alpha_y": alpha_x if alpha_y is None else alpha_y,
        "phi_x": 0.0,
    }


def _through(tau: float, alpha: float) -> dict[str, Any]:
    return {"model": "bounded-transmission-lobe", "tau": tau, "alpha": alpha}


def _plastic() -> Material:
    return Material(
        "plastic",
        "coloured plastic: diffuse .40 with a gloss lobe of .08, alpha .15",
        _native.analytic([_lambert("reflection", 0.40), _gloss(0.08, 0.15)]),
        ("reflection",),
    )


def _lambert_material() -> Material:
    return Material(
        "lambert",
        "ideal diffuse reflector of .60",
        _native.analytic([_lambert("reflection", 0.60)]),
        ("reflection",),
    )


def _metal() -> Material:
    return Material(
        "metal",
        "satin metal: a lobe of .75, alpha .1, nothing diffuse",
        _native.analytic([_gloss(0.75, 0.1)]),
        ("reflection",),
    )


def _brushed() -> Material:
    return Material(
        "brushed",
        "brushed metal: a lobe of .65, alpha .08 across and .25 along x and y, diffuse .05",
        _native.analytic([_lambert("reflection", 0.05), _gloss(0.65, 0.08, 0.25)]),
        ("reflection",),
        _ANISOTROPIC,
    )


def _satin_glass() -> Material:
    return Material(
        "satin-glass",
        "etched glass: through lobe of .65, alpha .12, diffuse .10 to either side, gloss .05, alpha .12",
        _native.analytic(
            [
                _lambert("reflection", 0.10),
                _gloss(0.05, 0.12),
                _lambert("transmission", 0.10),
                _through(0.65, 0.12),
            ]
        ),
        ("reflection", "transmission"),
    )


def _trans() -> Material:
    return Material(
        "trans",
        "translucent panel: diffuse reflection .40, diffuse transmission .30, through lobe of .15, alpha .2",
        _native.analytic([_lambert("reflection", 0.40), _lambert("transmission", 0.30), _through(0.15, 0.2)]),
        ("reflection", "transmission"),
    )


MATERIALS: Mapping[str, Callable[[], Material]] = {
    "plastic": _plastic,
    "lambert": _lambert_material,
    "metal": _metal,
    "brushed": _brushed,
    "satin-glass": _satin_glass,
    "trans": _trans,
}
"""The named materials; each entry makes its material."""


def material(name: str) -> Material:
    """Material of that name.

    Raises
    ------
    DomainError
        No material has this name.
    """
    make = MATERIALS.get(name)
    if make is None:
        raise DomainError(f"material: found {name!r}, allowed {', '.join(MATERIALS)}")
    return make()


def material_of_file(path: PathLike) -> Material:
    """Material whose scattering is that of a file of a model.

    Its components are those into which light from the front goes, its incidences those of the named
    materials.

    Raises
    ------
    DomainError
        Light from the front goes nowhere.
    FormatError, OSError
        The file cannot be read.
    """
    model = read_bsdf(path)
    names: tuple[Component, Component] = ("reflection", "transmission")
    components = tuple(c for c in names if scatters(model, "front", c))
    if not components:
        raise DomainError(f"{path}: found no light scattered from the front, allowed models that do")
    isotropic = model.properties["isotropic"]
    return Material(
        Path(path).stem,
        f"model of {Path(path).name}",
        model,
        components,
        _ISOTROPIC if isotropic else _ANISOTROPIC,
    )


def radiance(text: str, *, release: str = "6.1", ignore_modifier: bool = False) -> Bsdf:
    """Make the model of a Radiance material, such as `"void plastic paint 0 0 5 .5 .5 .5 .02 .1"`.

    Its channels are red, green and blue. It is what Radiance evaluates in its direct calculation
    (docs/models/radiance.md).

    Parameters
    ----------
    text
        Text of a Radiance scene with one material.
    release
        6.0 or 6.1: whose constant the approximation of Fresnel's law takes that smooth plastic, metal and
        trans have.
    ignore_modifier
        Leave out the pattern or texture that modifies the material.

    Raises
    ------
    FormatError
        The text does not follow the format or a parameter is out of range.
    DomainError
        Not one material, a modifier, an orientation that is not made of numbers, or no such release.
    """
    return material_of_text(text, release=release, ignore_modifier=ignore_modifier)
