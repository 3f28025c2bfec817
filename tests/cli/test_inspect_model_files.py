"""`gonio inspect` of MERL binaries and Zemax tabular BSDFs."""

import gonio
from gonio import _native

from tests.cli.conftest import one_clear_error

GLOSSY = [{"model": "lambert", "rho": 0.2}, {"model": "ward-gmd", "rho": 0.1, "alpha": 0.2}]


def test_the_channel_of_a_monochrome_file_has_to_be_stated(tmp_path, run):
    path = tmp_path / "a.bsdf"
    gonio.export(_native.analytic(GLOSSY), to="zemax-bsdf", out=path)
    done = run("inspect", path)
    one_clear_error(done, "channel: found none")
    done = run("inspect", path, "--channel", "650nm")
    assert done.code == 0
    assert "zemax-bsdf" in done.out


def test_a_merl_binary_is_a_model_with_empty_cells(run, tmp_path):
    path = tmp_path / "a.binary"
    gonio.export(_native.analytic(GLOSSY), to="merl", out=path)
    done = run("inspect", path, "--channel", "red")
    assert done.code == 0, done.err
    assert "merl" in done.out
    assert "of the cells hold no value" in done.out + done.err
