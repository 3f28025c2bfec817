"""RGL materials written by gonio, as Mitsuba's plugin `measured` reads them."""

import gonio
import numpy as np
import pytest
from gonio import _native

from tests.validation import rgl
from tests.validation.places import SHARED

GLOSSY = [
    {"model": "lambert", "rho": 0.3},
    {"model": "ward-gmd", "rho": 0.15, "alpha": 0.2},
]
BRUSHED = [
    {"model": "lambert", "rho": 0.2},
    {"model": "ward-gmd-anisotropic", "rho": 0.2, "alpha_x": 0.15, "alpha_y": 0.4, "phi_x": 30.0},
]


@pytest.fixture(scope="module")
def mitsuba():
    package = pytest.importorskip("mitsuba")
    package.set_variant("scalar_rgb")
    return package


@pytest.mark.parametrize(("parts", "bound"), [(GLOSSY, 0.02), (BRUSHED, 0.02)])
def test_mitsuba_evaluates_a_written_material_as_its_model(tmp_path, mitsuba, parts, bound):
    model = _native.analytic(parts)
    path = tmp_path / "a.bsdf"
    written = gonio.export(model, to="rgl-bsdf", out=path)
    loss = written.report["loss"]["front", "reflection"]
    assert loss["rel_l1"] < bound
    read = gonio.read_bsdf(path)
    wi, ws = rgl.pairs(1500, seed=3)
    ours, density = rgl.ours(read, wi, ws)
    values, pdf = rgl.theirs(mitsuba, path, wi, ws)
    high = (wi[:, 2] > 0.3) & (ws[:, 2] > 0.3)  # single precision shows towards the horizon
    assert np.median(rgl.relative(ours, values, 1e-4)) < 1e-5
    assert rgl.relative(ours[high], values[high], 1e-4).max() < 5e-3
    assert np.median(rgl.relative(density, pdf, 1e-4)) < 1e-4
    (theta_i, phi_i), (theta_s, phi_s) = rgl.angles(wi), rgl.angles(ws)
    f = model.eval(theta_i=theta_i, phi_i=phi_i, theta_s=theta_s, phi_s=phi_s) * ws[:, 2]
    inside = wi[:, 2] > np.cos(np.radians(85))
    error = np.abs(values[inside].mean(axis=1) - f[inside]).sum() / f[inside].sum()
    assert error < 1.5 * bound


def test_a_real_material_survives_being_written_again(tmp_path):
    shared = SHARED / rgl.FILES[1]
    if not shared.exists():
        pytest.skip("shared data missing")
    model = gonio.read_bsdf(shared)
    written = gonio.export(model, to="rgl-bsdf", out=tmp_path / "a.bsdf")
    assert written.report["loss"]["front", "reflection"]["rel_l1"] < 0.02
    assert gonio.read_bsdf(tmp_path / "a.bsdf").channels == ["red", "green", "blue"]
