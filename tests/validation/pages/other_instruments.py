"""Integrating sphere, surfaces, spectra: what comes back of known ones."""

from __future__ import annotations

import json

import colour as colour_science
import gonio
import numpy as np
from gonio import _native
from gonio.port import port_capture

from ...instruments.surfaces import gaussian_map, gaussian_profile
from ..places import SHARED
from . import Skipped, table

TEXT = """# Parameters from other instruments

Made by `python -m tests.validation other-instruments`; docs/other-instruments.md says what is computed.

## Integrating sphere: a plastic of diffuse 0.40 and specularity 0.06

What a sphere at 8° reads is integrated from the model (400 x 400 midpoints over the port's cone, a way of its own); then
`gonio.specularity` takes the readings apart. "Sphere" is the specularity without `alpha`, u the standard uncertainty
for u(rho) = 0.002 of both readings (correlation 0.9) and u(alpha) of 5 %.

{sphere}
## Surfaces of Gaussian autocorrelation, σ = 1

`alpha` over the true 2 σ / τ, mean and scatter of 20 surfaces (maps of 512² points, profiles of 20,000), and the
root mean square of the stated u(alpha) over that scatter.

{surfaces}
## Spectra

Photopic value of the generic 3 mm clear glass of the IGSDB, D65: the database's own figure, and gonio's from its table of
four digits.

{glass}
Largest difference of X, Y, Z from colour-science's ASTM E308 summation, five smooth spectra:

{summation}"""


def make() -> str:
    """The page."""
    files = [SHARED / "lbnl-igsdb" / name for name in ("igsdb_v2_clear_3.json", "CLEAR_3.DAT")]
    missing = [str(f) for f in files if not f.exists()]
    if missing:
        raise Skipped(f"{', '.join(missing)} not there")
    stated = json.loads(files[0].read_text())["integrated_spectral_averages_summaries"][0]["photopic"]
    return TEXT.format(
        sphere=table(["alpha", "Δ", "q", "sphere", "S", "u(S)"], _sphere()),
        surfaces=table(["kind", "τ in steps", "alpha / true", "scatter", "u / scatter"], _surfaces()),
        glass=table(["", "IGSDB", "gonio"], _glass(stated, gonio.colour(files[1]))),
        summation=table(["light", "steps of 5 nm", "10 nm", "20 nm"], _summation()),
    )


def _sphere() -> list[list[str]]:
    rows = []
    for alpha in (0.01, 0.02, 0.05, 0.1, 0.15):
        for half in (3.0, 5.0, 10.0):
            out, everything = _readings(alpha, half)
            found = gonio.specularity(
                rho_total=everything,
                rho_diffuse=everything - out,
                u_rho_total=0.002,
                u_rho_diffuse=0.002,
                correlation=0.9,
                port_half_angle=half,
                alpha=alpha,
                u_alpha=0.05 * alpha,
            )
            q = port_capture(alpha=alpha, half_angle=half)
            numbers = (q, found.specularity_sphere, found.specularity, found.u)
            rows.append([f"{alpha:g}", f"{half:g}°", *(f"{v:.4f}" for v in numbers)])
    return rows


def _readings(alpha: float, half: float, n: int = 400) -> tuple[float, float]:
    """What leaves through the port, and all of it."""
    model = _native.analytic(
        [{"model": "ward-gmd", "rho": 0.06, "alpha": alpha}, {"model": "lambert", "rho": 0.4}]
    )
    i = np.radians(8.0)
    g = (np.arange(n) + 0.5) * np.radians(half) / n
    g, chi = np.meshgrid(g, (np.arange(n) + 0.5) * 2 * np.pi / n, indexing="ij")
    across = np.sin(g) * np.cos(chi)
    w = [
        -np.cos(g) * np.sin(i) - across * np.cos(i),
        np.sin(g) * np.sin(chi),
        np.cos(g) * np.cos(i) - across * np.sin(i),
    ]
    theta, phi = np.degrees(np.arccos(w[2])), np.degrees(np.arctan2(w[1], w[0])) % 360
    f = model.eval(theta_i=8.0, phi_i=0.0, theta_s=theta.ravel(), phi_s=phi.ravel()).reshape(g.shape)
    out = float((f * w[2] * np.sin(g)).sum() * np.radians(half) / n * 2 * np.pi / n)
    return out, _native.directional_albedo(model, theta_i=8.0, phi_i=0.0, component="reflection")


def _surfaces() -> list[list[str]]:
    rows = []
    options = {"spacing": 1.0, "x_unit": "um", "z_unit": "um"}
    for kind in ("map", "profile"):
        for tau in (2.0, 3.0, 5.0, 10.0, 20.0):
            found = []
            for seed in range(20):
                z = (
                    gaussian_map(n=512, step=1.0, sigma=1.0, tau=tau, seed=seed)
                    if kind == "map"
                    else gaussian_profile(n=20_000, step=1.0, sigma=1.0, tau=tau, seed=seed)
                )
                found.append(gonio.roughness(z, **options))
            ratio = np.array([f.alpha for f in found]) * tau / 2
            u = np.sqrt(np.mean([(f.u_alpha * tau / 2) ** 2 for f in found]))
            scatter = ratio.std(ddof=1)
            rows.append([kind, f"{tau:g}", f"{ratio.mean():.4f}", f"{scatter:.4f}", f"{u / scatter:.2f}"])
    return rows


def _glass(stated: dict, found: list[gonio.Colour]) -> list[list[str]]:
    names = ("transmittance_front", "reflectance_front", "reflectance_back")
    return [
        [name.replace("_", ", "), f"{float(stated[name]['direct_direct']):.5f}", f"{c.photopic:.5f}"]
        for name, c in zip(names, found, strict=True)
    ]


def _summation() -> list[list[str]]:
    observer = colour_science.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    rows = []
    for light in gonio.colours.ILLUMINANTS:
        largest = []
        for interval in (5.0, 10.0, 20.0):
            at = np.arange(360.0, 781.0, interval)
            spectra = np.stack([_smooth(seed, at) for seed in range(5)], axis=1)
            ours = gonio.colours.colours_of_spectra(at, spectra, names=list("abcde"), illuminant=light)
            theirs = [
                colour_science.sd_to_XYZ(
                    colour_science.SpectralDistribution(s, at),
                    cmfs=observer,
                    illuminant=colour_science.SDS_ILLUMINANTS[light],
                )
                for s in spectra.T
            ]
            largest.append(np.abs([c.xyz for c in ours] - np.array(theirs) / 100).max())
        rows.append([light, *(f"{v:.1e}" for v in largest)])
    return rows


def _smooth(seed: int, at: np.ndarray) -> np.ndarray:
    rng = np.random.default_rng(seed)
    centres, widths, heights = rng.uniform(380, 720, 3), rng.uniform(40, 90, 3), rng.uniform(0.1, 0.3, 3)
    lobes = zip(centres, widths, heights, strict=True)
    return 0.05 + sum(h * np.exp(-(((at - c) / b) ** 2)) for c, b, h in lobes)
