import json

import gonio
import numpy as np
import pytest
from gonio.building import CANDIDATES

from tests.cli.conftest import one_clear_error


def lambertian(theta_i, *, channel="photopic"):
    theta, phi = (a.ravel() for a in np.meshgrid(np.arange(2.5, 90, 5), np.arange(0, 360, 10)))
    return gonio.Scan(
        quantity="bsdf",
        channel=channel,
        theta_i=theta_i,
        phi_i=0,
        theta_s=theta,
        phi_s=phi,
        value=np.full(len(theta), 0.5 / np.pi),
        meta={"noise_readout": 1e-5},
    )


@pytest.fixture
def measured(tmp_path):
    gonio.process([lambertian(t) for t in (10, 30, 50, 70)], out=tmp_path / "m")
    return tmp_path / "m"


def test_a_model_of_constant_readings_is_constant_and_predicts_left_out_incidences(measured):
    model = gonio.build(measured)
    f = model.eval(theta_i=[[20.0], [40.0]], phi_i=0.0, theta_s=[5.0, 30.0, 60.0], phi_s=[0.0, 90.0, 200.0])
    assert f.shape == (2, 3)
    np.testing.assert_allclose(f, 0.5 / np.pi, rtol=1e-3)
    assert model.loo_error < 1e-3
    assert model.properties["isotropic"]


def test_the_uncertainty_of_a_value_has_a_part_for_each_source(measured):
    model = gonio.build(measured)
    u = model.uncertainty(theta_i=[[30.0], [40.0]], phi_i=0.0, theta_s=[5.0, 60.0, 150.0], phi_s=90.0)
    assert set(u) == {"noise", "calibration", "slice", "incidence", "total"}
    assert all(part.shape == (2, 3) for part in u.values())
    assert np.isnan(u["total"][:, 2]).all()
    parts = np.stack([u[name][:, :2] for name in ("noise", "calibration", "slice", "incidence")])
    np.testing.assert_allclose(u["total"][:, :2], np.sqrt((parts**2).sum(axis=0)))
    assert (u["noise"][:, :2] > 0).all()


def test_build_json_carries_the_errors(run, measured):
    found = json.loads(run("build", "--json", measured).out)
    assert found["loo_error"] < 1e-3
    assert [row["theta_i"] for row in found["loo"]] == pytest.approx([30, 50])


def test_build_shows_the_errors(run, measured):
    done = run("build", measured)
    assert done.code == 0
    assert "predicted from the others" in done.out
    assert "of the light goes where nothing was read" in done.out


def test_the_candidates_named_are_those_of_the_core(run, measured):
    done = run("build", measured, "--candidate", "magic")
    assert tuple(done.err.split("allowed ")[1].strip().split("; ")) == CANDIDATES


def test_one_incidence_is_too_few(run, tmp_path):
    gonio.process([lambertian(10)], out=tmp_path / "one")
    one_clear_error(run("build", tmp_path / "one"), "incidences", "found 1", "2")
    with pytest.raises(gonio.FitError):
        gonio.build(tmp_path / "one")


def test_a_channel_must_be_named_among_several(run, tmp_path):
    scans = [lambertian(t, channel=c) for c in ("red", "blue") for t in (10, 40)]
    gonio.process(scans, out=tmp_path / "two")
    one_clear_error(run("build", tmp_path / "two"), "channel", "red, blue")
    one_clear_error(run("build", tmp_path / "two", "--channel", "green"), "green", "red, blue")
    assert run("build", tmp_path / "two", "--channel", "red").code == 0


@pytest.mark.parametrize(("option", "value"), [("--symmetry", "fivefold"), ("--candidate", "magic")])
def test_an_option_out_of_range_is_named(run, measured, option, value):
    one_clear_error(run("build", measured, option, value), value)
