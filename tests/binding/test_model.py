import threading

import gonio
import numpy as np
import pytest


def lambertian(theta_i, *, rho=0.5, channel="photopic"):
    theta, phi = np.meshgrid(np.arange(2.0, 85.0, 6.0), np.arange(0.0, 360.0, 15.0))
    theta, phi = theta.ravel(), phi.ravel()
    dsf = rho / np.pi * np.cos(np.radians(theta))
    return gonio.Slice(
        theta_i=theta_i,
        phi_i=90.0,
        channel=channel,
        theta_s=theta,
        phi_s=phi,
        dsf=dsf,
        u_dsf=np.zeros_like(dsf),
        omega=np.zeros_like(dsf),
        flags=np.zeros(dsf.shape, dtype=np.uint16),
    )


def test_a_model_is_a_bsdf_in_degrees():
    model = gonio.build(gonio.Measurement([lambertian(t) for t in (10.0, 30.0, 50.0)]))
    assert isinstance(model, gonio.Bsdf)
    assert model.channels == ["photopic"]
    f = model.eval(theta_i=20.0, phi_i=0.0, theta_s=[5.0, 60.0, 89.0], phi_s=33.0)
    np.testing.assert_allclose(f, 0.5 / np.pi, rtol=1e-4)
    assert model.eval(theta_i=20.0, phi_i=0.0, theta_s=120.0, phi_s=0.0) == 0.0
    assert model.loo[0]["theta_i"] == pytest.approx(30.0)
    assert any("not measured" in w and "front transmission" in w for w in model.warnings)


def test_a_missing_channel_and_an_unknown_option_are_named():
    measurement = gonio.Measurement([lambertian(t) for t in (10.0, 30.0)])
    with pytest.raises(gonio.QuantityError, match=r"found red, allowed .*photopic"):
        gonio.build(measurement, channel="red")
    with pytest.raises(gonio.DomainError, match="symmetry"):
        gonio.build(measurement, symmetry="cubic")
    with pytest.raises(gonio.DomainError, match="naive"):
        gonio.build(measurement, candidate="magic")


def test_one_incidence_is_not_enough():
    with pytest.raises(gonio.FitError, match="found 1"):
        gonio.build(gonio.Measurement([lambertian(10.0)]))


def large():
    rng = np.random.default_rng(1)
    slices = []
    for theta_i in (10.0, 25.0, 40.0, 55.0, 70.0):
        theta = np.degrees(np.arccos(rng.uniform(0.05, 1.0, 20_000)))
        phi = rng.uniform(0, 360, theta.size)
        dsf = (0.4 + 0.2 * np.cos(np.radians(theta - theta_i))) / np.pi * np.cos(np.radians(theta))
        slices.append(
            gonio.Slice(
                theta_i=theta_i,
                phi_i=180.0,
                channel="photopic",
                theta_s=theta,
                phi_s=phi,
                dsf=dsf * (1 + 0.01 * rng.standard_normal(theta.size)),
                u_dsf=0.01 * dsf,
                omega=np.zeros_like(dsf),
                flags=np.zeros(dsf.shape, dtype=np.uint16),
            )
        )
    return gonio.Measurement(slices)


def test_progress_is_told_stage_by_stage_in_the_calling_thread():
    calls = []

    def progress(stage, done, total):
        calls.append((stage, done, total))
        assert threading.current_thread() is threading.main_thread()

    gonio.build(large(), progress=progress)
    assert calls[0] == ("building", 0, 1)
    assert calls[-1] == ("building", 1, 1)
    assert {stage for stage, _, _ in calls} & {"fitting bases", "slices", "leaving incidences out"}
    assert all(0 <= done <= total for _, done, total in calls)


def test_what_progress_raises_stops_the_build_and_leaves_no_file(tmp_path):
    def progress(stage, done, total):
        if stage != "building":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        gonio.reduce(large(), out=tmp_path / "model.nc", progress=progress)
    assert list(tmp_path.iterdir()) == []


def test_a_stated_error_says_how_the_incidence_is_known_and_what_light_goes_unread():
    model = gonio.build(gonio.Measurement([lambertian(t) for t in (10.0, 30.0, 50.0)]))
    stated = {t: model.stated_error(theta_i=t, phi_i=90.0) for t in (30.0, 40.0, 60.0)}
    assert [s["coverage"] for s in stated.values()] == ["measured", "interpolated", "extrapolated"]
    # The last ring stands at 80 degrees.
    past = np.cos(np.radians(80.0)) ** 2
    assert stated[30.0]["extrapolated"] == pytest.approx(past, abs=0.01)


def test_slices_of_one_incidence_are_counted_and_their_difference_is_told():
    slices = [lambertian(t) for t in (10.0, 30.0, 50.0)] + [lambertian(30.0, rho=0.52)]
    said = [w for w in gonio.build(gonio.Measurement(slices)).warnings if "averaged" in w]
    assert len(said) == 1
    assert "up to 2 slices" in said[0]
    assert "differ by 3.9 %" in said[0]
    assert "more than their noise" in said[0]
