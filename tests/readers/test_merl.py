"""MERL binaries as Python and the command line see them."""

import gonio
import numpy as np
import pytest
from gonio import _native


def glossy():
    return _native.analytic([{"model": "ward-gmd", "rho": 0.2, "alpha": 0.3}])


@pytest.fixture(scope="module")
def grey(tmp_path_factory):
    path = tmp_path_factory.mktemp("merl") / "grey.binary"
    return path, gonio.export(glossy(), to="merl", out=path)


def test_a_model_of_one_channel_is_written_grey_with_its_loss(grey):
    path, written = grey
    assert "red, green and blue hold the same" in written.warnings[0]
    loss = written.report["loss"]["front", "reflection"]
    assert 0.001 < loss["rel_l1"] < 0.03  # the size of the cells
    assert abs(loss["dhr_difference"]) < 0.002
    assert path.stat().st_size == 34_992_012


def test_a_written_file_is_a_model_again(grey):
    model = gonio.read_bsdf(grey[0])
    assert model.channels == ["red", "green", "blue"]
    assert model.properties == {"reciprocal": True, "energy_conserving": False, "isotropic": True}
    angles = {"theta_i": 30.3, "phi_i": 0.0, "theta_s": np.linspace(1, 70, 40), "phi_s": 170.0}
    f = model.eval(**angles, channel="green")
    np.testing.assert_allclose(f, glossy().eval(**angles), rtol=0.12)
    with pytest.raises(gonio.QuantityError, match="channel: found 550nm"):
        gonio.read_bsdf(grey[0], channel="550nm")


def test_anisotropic_models_are_refused(tmp_path):
    part = {"model": "ward-gmd-anisotropic", "rho": 0.2, "alpha_x": 0.1, "alpha_y": 0.3, "phi_x": 0.0}
    with pytest.raises(gonio.DomainError, match="anisotropic"):
        gonio.export(_native.analytic([part]), to="merl", out=tmp_path / "a.binary")
    assert not list(tmp_path.iterdir())
