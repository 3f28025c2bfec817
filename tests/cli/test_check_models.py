import json

import gonio
import pytest
from gonio import _native

from tests.cli.conftest import one_clear_error


def levels(model):
    return {v.id: v.verdict for v in gonio.check_model(model)}


def test_a_lawful_model_passes_every_check():
    model = _native.analytic([{"model": "lambert", "rho": 0.3}, {"model": "ggx", "f0": 0.3, "alpha": 0.2}])
    assert levels(model) == dict.fromkeys(("values", "energy", "reciprocity", "isotropy"), "pass")


def test_a_model_that_makes_light_fails_energy():
    bright = [{"model": "lambert", "rho": 0.9}, {"model": "ward-gmd", "rho": 0.5, "alpha": 0.2}]
    found = {v.id: v for v in gonio.check_model(_native.analytic(bright))}
    assert found["energy"].verdict == "fail"
    assert found["energy"].value == pytest.approx(1.4, abs=0.05)
    assert "theta_i" in found["energy"].sentence


def test_an_axis_is_seen_and_not_held_against_a_model_without_the_promise():
    brushed = {"model": "ward-gmd-anisotropic", "rho": 0.3, "alpha_x": 0.05, "alpha_y": 0.3, "phi_x": 0.0}
    found = {v.id: v for v in gonio.check_model(_native.analytic([brushed]))}
    assert found["isotropy"].verdict == "info"
    assert found["isotropy"].value > 0.1


def test_the_file_of_a_model_is_checked(run, tmp_path):
    (tmp_path / "paint.rad").write_text("void plastic paint\n0\n0\n5 .5 .4 .3 .04 .1\n")
    done = run("check", tmp_path / "paint.rad", "--json")
    assert done.code == 0, done.err
    assert [v["id"] for v in json.loads(done.out)["verdicts"]] == [
        "values",
        "energy",
        "reciprocity",
        "isotropy",
    ]
    one_clear_error(run("check", tmp_path / "paint.rad", "--isotropic"), "paint.rad", "measurement")


def test_an_xml_of_one_wavelength_is_checked_without_naming_it(run, tmp_path):
    model = _native.analytic([{"model": "lambert", "rho": 0.3}])
    gonio.export(model, to="radiance-klems", out=tmp_path / "white.xml")
    text = (tmp_path / "white.xml").read_text()
    (tmp_path / "red.xml").write_text(text.replace('unit="Integral">Visible<', 'unit="nm">650<'))
    done = run("check", tmp_path / "red.xml", "--json")
    assert done.code == 0, done.err
    assert {v["verdict"] for v in json.loads(done.out)["verdicts"]} <= {"pass", "info"}
