"""Zemax tabular BSDFs as Python and the command line see them."""

import gonio
import numpy as np
import pytest
from gonio import _native

from tests.validation.places import SHARED

SPHERE = SHARED / "ansys-formats" / "test_13_planesymmetric_brdf_zemax.bsdf"
GLOSSY = [
    {"model": "lambert", "rho": 0.2},
    {"model": "ward-gmd", "rho": 0.1, "alpha": 0.2},
]


def test_readings_of_a_written_model_are_the_model(tmp_path):
    model = _native.analytic(GLOSSY)
    path = tmp_path / "a.bsdf"
    written = gonio.export(model, to="zemax-bsdf", out=path, name="paint")
    assert written.report["symmetry"] == "PlaneSymmetrical"
    readings = gonio.read(path, channel="photopic")
    assert len(readings) == 18
    for scan in readings:
        assert scan.meta["other"]["comments"].startswith("paint")
        f = model.eval(theta_i=scan.theta_i, phi_i=scan.phi_i, theta_s=scan.theta_s, phi_s=scan.phi_s)
        np.testing.assert_allclose(scan.value, f, rtol=1e-6)


def test_files_hold_one_component_of_the_front(tmp_path):
    model = _native.analytic(GLOSSY)
    with pytest.raises(gonio.QuantityError, match="component: found back-reflection"):
        gonio.export(model, to="zemax-bsdf", out=tmp_path / "a", components=[("back", "reflection")])
    with pytest.raises(gonio.QuantityError, match="component: found front-transmission, needed one for merl"):
        gonio.export(model, to="merl", out=tmp_path / "a", components=[("front", "transmission")])
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(not SPHERE.exists(), reason="shared data missing")
def test_a_file_of_the_imaging_sphere_is_processed_to_its_total_scatter(tmp_path):
    readings = gonio.read(SPHERE, channel="photopic")
    measurement = gonio.process(SPHERE, channel="photopic")
    assert len(measurement) == len(readings) == 13
    for scan, part in zip(readings[:6], measurement.slices[:6], strict=True):
        (integral,) = part.integrals
        assert integral.value == pytest.approx(float(scan.meta["other"]["tis"]), rel=0.06)
