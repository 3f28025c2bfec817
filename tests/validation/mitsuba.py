"""Microfacet models of gonio and of Mitsuba 3 at random parameters and directions.

Mitsuba masks with a product G1(wi) G1(ws), gonio with the height-correlated G2 in reflection; and Mitsuba
replaces the G1 of Beckmann facets by a rational approximation. Both are coded here a second time, apart from
gonio, and taken out of the comparison: what remains are the distribution, the Fresnel term, the Jacobians and
gonio's own masking.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from gonio import _native
from numpy.typing import NDArray
from scipy.special import erf, erfc

DISTRIBUTIONS = ("ggx", "beckmann")
Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Case:
    """One model with its parameters, and the pair of directions to compare at."""

    model: str
    parameters: dict[str, float]
    wi: Vector
    ws: Vector

    @property
    def distribution(self) -> str:
        return self.model.split("-", maxsplit=1)[0]


@dataclass(frozen=True)
class Comparison:
    """f |cos theta_s| and density, Mitsuba's over gonio's with Mitsuba's masking."""

    value: float
    pdf: float
    gain: float
    """Height-correlated over separable masking, less 1."""


class Mitsuba:
    """Mitsuba's plugins in its scalar single-precision variant, the most exact that its packages have."""

    def __init__(self, package: Any) -> None:
        package.set_variant("scalar_rgb")
        self.mi = package
        # Light traced from the source: radiance per irradiance, without a factor of squared indices.
        self.context = package.BSDFContext(package.TransportMode.Importance)

    def _plugin(self, case: Case) -> Any:
        p = case.parameters
        alpha_u = p.get("alpha_x", p.get("alpha"))
        alpha_v = p.get("alpha_y", p.get("alpha"))
        common = {
            "distribution": case.distribution,
            "alpha_u": alpha_u,
            "alpha_v": alpha_v,
            "sample_visible": True,
        }
        if "dielectric" in case.model:
            return self.mi.load_dict(
                {"type": "roughdielectric", "int_ior": p["eta"], "ext_ior": 1.0, **common}
            )
        if "conductor" in case.model:
            index = {"eta": {"type": "uniform", "value": p["eta"]}, "k": {"type": "uniform", "value": p["k"]}}
        else:
            index = {"material": "none"}  # reflects all light: f0 = 1
        return self.mi.load_dict({"type": "roughconductor", **index, **common})

    def __call__(self, case: Case) -> tuple[float, float]:
        """f |cos theta_s| and the density of sampling ws from wi."""
        bsdf = self._plugin(case)
        phi_x = np.radians(case.parameters.get("phi_x", 0.0))
        wi, ws = (self.mi.Vector3f(*_turned(v, -phi_x)) for v in (case.wi, case.ws))
        si = self.mi.SurfaceInteraction3f()
        si.wi = wi
        return float(bsdf.eval(self.context, si, ws)[0]), float(bsdf.pdf(self.context, si, ws))


def _turned(v: Vector, angle: float) -> list[float]:
    c, s = np.cos(angle), np.sin(angle)
    return [float(c * v[0] - s * v[1]), float(s * v[0] + c * v[1]), float(v[2])]


def _ratio(case: Case, v: Vector) -> float:
    """a = cos / |slopes of v stretched by the widths|."""
    p = case.parameters
    x, y, z = _turned(v, -np.radians(p.get("phi_x", 0.0)))
    return abs(z) / float(
        np.hypot(p.get("alpha_x", p.get("alpha")) * x, p.get("alpha_y", p.get("alpha")) * y)
    )


def _lambda(case: Case, v: Vector) -> float:
    a = _ratio(case, v)
    if case.distribution == "ggx":
        return float((np.sqrt(1.0 + 1.0 / a**2) - 1.0) / 2.0)
    return float(np.exp(-(a**2)) / (2.0 * a * np.sqrt(np.pi)) - erfc(a) / 2.0)


def _mitsuba_g1(case: Case, v: Vector) -> float:
    """Exact for GGX; for Beckmann the rational approximation of Walter 2007, eq. 27."""
    a = _ratio(case, v)
    if case.distribution == "ggx":
        return 1.0 / (1.0 + _lambda(case, v))
    if a >= 1.6:
        return 1.0
    return (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a)


def rational_error() -> float:
    """Largest relative error of the rational approximation of Beckmann's G1."""
    a = np.linspace(1e-3, 4.0, 40_001)
    exact = 1.0 / (1.0 + np.exp(-(a**2)) / (2.0 * a * np.sqrt(np.pi)) + (erf(a) - 1.0) / 2.0)
    rational = np.where(a < 1.6, (3.535 * a + 2.181 * a**2) / (1.0 + 2.276 * a + 2.577 * a**2), 1.0)
    return float(np.abs(rational / exact - 1.0).max())


def compare(case: Case, peer: tuple[float, float]) -> Comparison:
    """Mitsuba's value and density over gonio's, gonio's brought to Mitsuba's masking."""
    theta_i, phi_i = _angles(case.wi)
    theta_s, phi_s = _angles(case.ws)
    model = _native.analytic([{"model": case.model, **case.parameters}])
    angles = {"theta_i": theta_i, "phi_i": phi_i, "theta_s": theta_s, "phi_s": phi_s}
    dsf = float(model.eval(**angles)) * abs(case.ws[2])
    pdf = float(model.pdf(**angles))
    li, ls = _lambda(case, case.wi), _lambda(case, case.ws)
    g1_i, g1_s = _mitsuba_g1(case, case.wi), _mitsuba_g1(case, case.ws)
    reflected = case.wi[2] * case.ws[2] > 0.0
    masking = 1.0 / (1.0 + li + ls) if reflected else 1.0 / ((1.0 + li) * (1.0 + ls))
    dsf *= g1_i * g1_s / masking
    pdf *= g1_i * (1.0 + li)
    return Comparison(
        value=peer[0] / dsf if dsf > 0.0 else float(peer[0] == 0.0),
        pdf=peer[1] / pdf if pdf > 0.0 else 0.0,
        gain=masking * (1.0 + li) * (1.0 + ls) - 1.0,
    )


def _angles(v: Vector) -> tuple[float, float]:
    theta = float(np.degrees(np.arctan2(np.hypot(v[0], v[1]), v[2])))
    return theta, float(np.degrees(np.arctan2(v[1], v[0])))


def _direction(rng: np.random.Generator, low: float = 0.05) -> Vector:
    z, phi = rng.uniform(low, 1.0), rng.uniform(0.0, 2.0 * np.pi)
    r = np.sqrt(1.0 - z * z)
    return np.array([r * np.cos(phi), r * np.sin(phi), z])


def _facet(rng: np.random.Generator, p: dict[str, float]) -> Vector:
    """A facet normal of up to three widths, where the lobe has all but 1e-4 of its Beckmann light."""
    r, phi = 3.0 * np.sqrt(rng.uniform()), rng.uniform(0.0, 2.0 * np.pi)
    x = p.get("alpha_x", p.get("alpha", 0.0)) * r * np.cos(phi)
    y = p.get("alpha_y", p.get("alpha", 0.0)) * r * np.sin(phi)
    h = np.array([*_turned(np.array([x, y, 0.0]), np.radians(p.get("phi_x", 0.0)))[:2], 1.0])
    return h / np.linalg.norm(h)


def random_cases(model: str, count: int, seed: int) -> list[Case]:
    """Random parameters, incidences within 87 degrees of the normal and facets within three widths.

    A dielectric is lit from both sides; half of its pairs are refracted, where Snell's law allows.
    """
    rng = np.random.default_rng(seed)
    cases: list[Case] = []
    while len(cases) < count:
        p: dict[str, float] = {}
        if "dielectric" in model:
            p["eta"] = rng.uniform(1.1, 2.6)
        elif "conductor" in model:
            p["eta"], p["k"] = rng.uniform(0.1, 4.0), rng.uniform(0.0, 8.0)
        else:
            p["f0"] = 1.0
        if model.endswith("anisotropic"):
            p["alpha_x"], p["alpha_y"] = np.exp(rng.uniform(np.log(0.03), 0.0, 2))
            p["phi_x"] = rng.uniform(-180.0, 180.0)
        else:
            p["alpha"] = float(np.exp(rng.uniform(np.log(0.03), 0.0)))
        wi, h = _direction(rng), _facet(rng, p)
        facing = float(wi @ h)
        if facing <= 0.05:
            continue
        back = "dielectric" in model and bool(rng.uniform() < 0.5)
        refracted = "dielectric" in model and bool(rng.uniform() < 0.5)
        ws = 2.0 * facing * h - wi
        if refracted:
            ratio = p["eta"] if back else 1.0 / p["eta"]
            far2 = 1.0 - ratio**2 * (1.0 - facing**2)
            if far2 < 0.01:
                continue
            ws = (ratio * facing - np.sqrt(far2)) * h - ratio * wi
        if (-ws[2] if refracted else ws[2]) < 0.05:
            continue
        if back:
            wi, ws = wi * [1.0, 1.0, -1.0], ws * [1.0, 1.0, -1.0]
        cases.append(Case(model, p, wi, ws / np.linalg.norm(ws)))
    return cases


MODELS = tuple(
    f"{d}{kind}{axes}"
    for kind in ("", "-conductor", "-dielectric")
    for d in DISTRIBUTIONS
    for axes in ("", "-anisotropic")
)
