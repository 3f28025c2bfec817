"""Albedos of Klems matrices against patch averages of their models, by quadrature of its own."""

import numpy as np
import pytest
from gonio import _native

GLOSSY = [{"model": "lambert", "rho": 0.3}, {"model": "ward-gmd", "rho": 0.4, "alpha": 0.08}]
BRUSHED = [
    {"model": "lambert", "rho": 0.2},
    {"model": "ward-gmd-anisotropic", "rho": 0.4, "alpha_x": 0.1, "alpha_y": 0.3, "phi_x": 20.0},
]
VEIL = [
    {"model": "lambert", "rho": 0.2},
    {"model": "lambert-transmission", "tau": 0.2},
    {"model": "bounded-transmission-lobe", "tau": 0.5, "alpha": 0.12},
]
WHITE = [{"model": "ggx-compensated", "f0": 1.0, "alpha": 0.3}]
RINGS = {
    "full": ((0, 5, 15, 25, 35, 45, 55, 65, 75, 90), (1, 8, 16, 20, 24, 24, 24, 16, 12)),
    "quarter": ((0, 9, 27, 45, 63, 90), (1, 8, 12, 12, 8)),
}


def disk(n):
    """Centres of n x n cells of the square, as direction cosines of equal projected solid angles."""
    a, b = np.meshgrid(*[2 * (np.arange(n) + 0.5) / n - 1] * 2)
    wide = np.abs(a) > np.abs(b)
    r, other = np.where(wide, a, b), np.where(wide, b, a)
    angle = np.where(wide, np.pi / 4 * other / r, np.pi / 2 - np.pi / 4 * other / r)
    x, y = (r * np.cos(angle)).ravel(), (r * np.sin(angle)).ravel()
    return np.stack([x, y, np.sqrt(np.maximum(1 - x * x - y * y, 0))], axis=-1)


def albedo(model, wi, component, ws):
    sign = wi[2] if component == "reflection" else -wi[2]
    f = model.eval_directions(wi=wi, ws=ws * np.array([1, 1, np.sign(sign)]))[0]
    return np.pi * f.mean()


def patch_average(model, ring, basis, component, ws):
    """Over the incident patch of a ring that is centred at azimuth 0, weighted by the cosine of incidence."""
    bounds, counts = RINGS[basis]
    low, high = (np.sin(np.radians(bounds[ring + k])) ** 2 for k in (0, 1))
    half = 180 / counts[ring]
    azimuths = [0.0] if model.properties["isotropic"] else half * np.array([-0.75, -0.25, 0.25, 0.75])
    found = []
    for sine2 in low + (high - low) * (np.arange(8) + 0.5) / 8:
        for phi in np.radians(azimuths):
            # patches are numbered by where light goes on to: incident directions lie opposite
            s, z = np.sqrt(sine2), np.sqrt(1 - sine2)
            found.append(albedo(model, np.array([-s * np.cos(phi), -s * np.sin(phi), z]), component, ws))
    return np.mean(found)


def readings(truth, transmits):
    """A measurement of 8 incidences, without noise."""
    ws, slices = disk(120), []
    ws = ws[ws[:, 2] > np.cos(np.radians(88))]
    for theta_i in (0.0, 12.0, 25.0, 38.0, 50.0, 60.0, 70.0, 80.0):
        t = np.radians(theta_i)
        around = np.stack(np.meshgrid(*[np.linspace(-0.3, 0.3, 61)] * 2), axis=-1).reshape(-1, 2)
        near = np.array([-np.sin(t), 0]) + around
        near = near[(near**2).sum(axis=1) < 0.998]
        near = np.column_stack([near, np.sqrt(1 - (near**2).sum(axis=1))])
        w = np.concatenate([ws, near])
        theta = np.degrees(np.arccos(w[:, 2] * (-1 if transmits else 1)))
        phi = np.degrees(np.arctan2(w[:, 1], w[:, 0])) % 360
        f = truth.eval(theta_i=theta_i, phi_i=0.0, theta_s=theta, phi_s=phi)
        omega = _native.hemisphere_weights(theta, phi, side="back" if transmits else "front")[0]
        dsf = f * w[:, 2]
        slices.append(
            _native.Slice(
                theta_i=theta_i,
                phi_i=0.0,
                channel="photopic",
                theta_s=theta,
                phi_s=phi,
                dsf=dsf,
                u_dsf=0.01 * dsf + 1e-5,
                omega=omega,
                flags=np.zeros(dsf.size, np.uint16),
            )
        )
    return slices


def built(parts):
    """The data-driven model of readings of a known one, reflection and what is transmitted."""
    truth = _native.analytic(parts)
    slices = readings(truth, False)
    if any("tau" in p for p in parts):
        slices += readings(truth, True)
    return _native.build(_native.MeasurementData(slices), symmetry="isotropic")


@pytest.mark.parametrize(
    ("make", "basis", "components"),
    [
        (lambda: _native.analytic(GLOSSY), "full", ["reflection"]),
        (lambda: _native.analytic(BRUSHED), "quarter", ["reflection"]),
        (lambda: _native.analytic(VEIL), "full", ["reflection", "transmission"]),
        (lambda: built(GLOSSY), "full", ["reflection"]),
        (lambda: built(VEIL), "full", ["reflection", "transmission"]),
    ],
    ids=["glossy", "brushed", "veil", "data-driven glossy", "data-driven veil"],
)
def test_albedos_are_the_patch_averages_of_the_model_and_at_most_one(make, basis, components):
    model = make()
    wanted = [("front", c) for c in components]
    klems = _native.to_klems(model, basis=basis, components=wanted)
    total = sum(klems.albedo(side="front", component=c) for c in components)
    assert total.max() <= 1
    assert klems.report["max_albedo"] <= 1
    ws = disk(260)
    first = np.cumsum([0, *RINGS[basis][1][:-1]])
    for component in components:
        found = klems.albedo(side="front", component=component)[first]
        want = [patch_average(model, k, basis, component, ws) for k in range(len(first))]
        np.testing.assert_allclose(found, want, rtol=5e-3)


def test_a_white_furnace_stays_white_and_capped_at_one():
    model = _native.analytic(WHITE)
    klems = _native.to_klems(model, components=[("front", "reflection")], cap_albedo=True)
    found = klems.albedo(side="front", component="reflection")
    assert found.max() <= 1 + 1e-6  # values are kept in single precision
    assert found.min() > 0.995
