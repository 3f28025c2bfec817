"""`gonio.tabulate` and `gonio.read_bsdf` from Python."""

import gonio
import numpy as np
import pytest
from gonio.materials import material

from tests.validation.rgl import synthetic, write_tensor_file


@pytest.fixture
def paint(tmp_path):
    path = tmp_path / "paint.bsdf"
    write_tensor_file(path, synthetic([0.0], None))
    return path


def test_any_model_becomes_a_measurement_that_can_be_saved(tmp_path):
    model = material("plastic").bsdf
    found = gonio.tabulate(
        model, incidences=[(30, 0), (60, 90)], u_relative=0.02, u_floor=0.001, sample_name="plastic"
    )
    assert (found.sample_name, found.channels) == ("plastic", ["photopic"])
    assert [(s.theta_i, s.phi_i) for s in found] == [(30, 0), (60, 90)]
    s = found.slices[0]
    f = model.eval(theta_i=30, phi_i=0, theta_s=s.theta_s, phi_s=s.phi_s)
    np.testing.assert_allclose(s.bsdf, f, rtol=1e-9)
    np.testing.assert_allclose(s.u_dsf, np.hypot(0.001, 0.02 * s.dsf))
    assert model.has_data(theta_i=30, phi_i=0, theta_s=[[10], [170]], phi_s=0).shape == (2, 1)
    found.save(tmp_path / "out")
    again = gonio.Measurement.load(tmp_path / "out")
    np.testing.assert_array_equal(again.slices[1].dsf, found.slices[1].dsf)
    assert again.provenance["settings"]["incidences"] == [[30, 0], [60, 90]]


def test_a_material_file_is_tabulated_where_it_was_measured(paint):
    found = gonio.tabulate(paint)
    assert found.sample_name == "nothing"
    assert found.channels == ["red", "green", "blue"]
    assert [s.theta_i for s in found][::3] == pytest.approx([0, 22.5, 45, 67.5])
    assert found.provenance["inputs"][0]["role"] == "model"
    assert gonio.tabulate(paint, channels=["blue"], incidences=[(10, 0)]).channels == ["blue"]


def test_what_cannot_be_tabulated_is_refused_by_name(paint):
    with pytest.raises(gonio.QuantityError, match="photopic"):
        gonio.tabulate(paint, channels=["photopic"])
    with pytest.raises(gonio.DomainError, match="no data"):
        gonio.tabulate(paint, incidences=[(80, 0)])
    with pytest.raises(gonio.DomainError, match="theta_max"):
        gonio.tabulate(paint, theta_max=95)
    with pytest.raises(gonio.QuantityError, match="red, green, blue"):
        gonio.read_bsdf(paint, channel="photopic")


def test_a_spoilt_file_is_one_clear_error(paint):
    whole = paint.read_bytes()
    paint.write_bytes(whole[:1000])
    with pytest.raises(gonio.FormatError, match=r"paint\.bsdf: .*found float32 of shape"):
        gonio.read_bsdf(paint)
    with pytest.raises(FileNotFoundError):
        gonio.read_bsdf(paint.with_name("none.bsdf"))
    with pytest.raises(gonio.FormatError, match="RGL material: a model"):
        gonio.read(paint)


def test_inspect_tells_what_a_material_file_holds(paint):
    found = gonio.inspect(paint)
    model = found.files[0].model
    assert (found.files[0].format, model.name) == ("rgl-bsdf", "nothing")
    assert [c.channel for c in model.components] == ["red", "green", "blue"]
    assert model.components[0].resolution == "5 x 1 incidences, 11 x 11"
    assert "measured up to theta_i 67.50" in model.notes[0]
    assert any("read_bsdf" in p for p in found.problems)
