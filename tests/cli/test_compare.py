import json

import gonio
import numpy as np
import pytest
from gonio import analytic

from tests.cli.conftest import one_clear_error

FRONT = [("front", "reflection")]


@pytest.fixture
def matte():
    return analytic({"model": "lambert", "rho": 0.5})


def test_models_that_differ_by_a_factor_differ_by_it_everywhere(matte):
    brighter = analytic({"model": "lambert", "rho": 0.6})
    found = gonio.compare(matte, brighter, components=FRONT)
    assert [row.theta_i for row in found.rows] == [0, 15, 30, 45, 60, 75]
    for row in found.rows:
        assert row.rel_l1 == pytest.approx(0.2, rel=1e-6)
        assert row.rel_rms == pytest.approx(0.2, rel=1e-6)
        assert row.peak_ratio == pytest.approx(1.2, rel=1e-6)
        assert (row.dhr_a, row.dhr_b) == pytest.approx((0.5, 0.6), rel=2e-3)
        assert row.peak_shift == 0
        assert row.reciprocity_a == pytest.approx(0, abs=1e-12)


def test_a_shifted_lobe_is_shifted_by_its_angle_and_the_albedo_that_of_quadrature():
    lobe = {"model": "ward-gmd-anisotropic", "rho": 0.3, "alpha_x": 0.05, "alpha_y": 0.2, "phi_x": 0.0}
    a = analytic(lobe)
    b = analytic(lobe | {"alpha_y": 0.05})
    found = gonio.compare(a, b, components=FRONT, incidences=[(45.0, 0.0), (45.0, 90.0), (120.0, 0.0)])
    assert len(found.rows) == 2
    for row in found.rows:
        exact = gonio.directional_albedo(a, theta_i=row.theta_i, phi_i=row.phi_i, component="reflection")
        assert row.dhr_a == pytest.approx(exact, rel=2e-3)
        # a lobe four times as narrow is four times as high
        assert row.peak_ratio == pytest.approx(4.0, rel=0.05)


def test_components_and_channels_that_only_one_has_are_told():
    a = analytic({"model": "lambert", "rho": {"red": 0.5, "green": 0.4}})
    b = analytic(
        {"model": "lambert", "rho": {"green": 0.4, "blue": 0.2}},
        {"model": "lambert-transmission", "tau": {"green": 0.1, "blue": 0.1}},
    )
    found = gonio.compare(a, b)
    assert found.channels == [("green", "green")]
    assert sum("only b scatters" in text for text in found.warnings) == 2
    dark = [row for row in found.rows if row.component == "transmission"]
    assert dark
    assert all(np.isnan(row.rel_l1) and row.dhr_a == 0 for row in dark)
    with pytest.raises(gonio.QuantityError, match="red"):
        gonio.compare(a, b, channel="red")
    with pytest.raises(gonio.QuantityError, match="in common"):
        gonio.compare(a, analytic({"model": "lambert", "rho": {"blue": 0.5, "532nm": 0.4}}))


def test_compare_of_a_measurement_and_its_model_prints_a_table_and_draws(run, tmp_path):
    theta, phi = (v.ravel() for v in np.meshgrid(np.arange(2.5, 90, 5), np.arange(0, 360, 10)))
    scans = [
        gonio.Scan(
            quantity="bsdf",
            theta_i=t,
            phi_i=0,
            theta_s=theta,
            phi_s=phi,
            value=np.full(len(theta), 0.5 / np.pi),
            meta={"noise_readout": 1e-5, "sample_name": "chalk"},
        )
        for t in (10, 40, 70)
    ]
    gonio.process(scans, out=tmp_path / "m")
    done = run("build", "m", "-o", "chalk.nc", "--json")
    reduction = json.loads(done.out)["reduction"]
    assert reduction["loss"]["summary"][0]["rel_l1"] < 0.01
    assert gonio.inspect([tmp_path / "chalk.nc"]).files[0].sample_name == "chalk"
    done = run("compare", "m", "chalk.nc", "--incidence", "30,0", "--picture", "difference.png")
    assert done.code == 0
    assert "relative L1" in done.out
    assert (tmp_path / "difference.png").read_bytes().startswith(b"\x89PNG")
    found = json.loads(run("compare", "m", "chalk.nc", "--json").out)
    assert max(row["rel_l1"] for row in found["rows"]) < 0.02


def test_one_channel_of_each_is_compared_where_their_names_differ(run, tmp_path):
    green = gonio.analytic({"model": "lambert", "rho": {"532nm": 0.5, "633nm": 0.2}})
    grey = gonio.analytic({"model": "lambert", "rho": 0.6})
    with pytest.raises(gonio.QuantityError, match="--channel-b"):
        gonio.compare(green, grey)
    found = gonio.compare(green, grey, channel="532", channel_b="photopic", components=FRONT)
    assert found.channels == [("532nm", "photopic")]
    assert found.rows[0].rel_l1 == pytest.approx(0.2, rel=1e-6)


def test_wrong_words_are_refused_in_one_line(run, tmp_path):
    gonio.reduce(analytic({"model": "lambert", "rho": 0.5}), out=tmp_path / "a.nc", components=FRONT)
    one_clear_error(run("compare", "a.nc", "gone.nc"), "gone.nc", "No such file")
    one_clear_error(run("compare", "a.nc", "a.nc", "--component", "up-down"), "up-down", "front-reflection")
    one_clear_error(run("compare", "a.nc", "a.nc", "--incidence", "30"), "30", "THETA,PHI")
    one_clear_error(run("compare", "a.nc", "a.nc", "--incidence", "90,0"), "(90, 0)", "but 90")
    one_clear_error(run("compare", "a.nc", "a.nc", "--incidence", "150,0"), "(150, 0)", "side that scatters")
    one_clear_error(run("compare", "a.nc", "a.nc", "--picture", "a.txt"), ".txt", ".png")


def test_a_component_in_which_nothing_scatters_is_refused_not_compared():
    white = gonio._native.analytic([{"model": "lambert", "rho": 0.3}])
    grey = gonio._native.analytic([{"model": "lambert", "rho": 0.2}])
    with pytest.raises(gonio.QuantityError, match="front-transmission, where neither scatters"):
        gonio.compare(white, grey, components=[("front", "transmission")])
    with pytest.raises(gonio.QuantityError, match="front-transmission, where the model does not scatter"):
        gonio.reduce(white, components=[("front", "transmission")])
