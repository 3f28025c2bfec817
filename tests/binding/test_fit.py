"""`gonio.fit` and `gonio.fit_models` from Python."""

import json
from dataclasses import FrozenInstanceError

import gonio
import numpy as np
import pytest
from gonio.fitting import LOSSES, METRICS, WEIGHTS
from gonio.materials import material

from tests.validation.rgl import synthetic, write_tensor_file

TRUTH = {"color": 0.4 / 0.92, "specularity": 0.08, "alpha": 0.15}


@pytest.fixture(scope="module")
def plastic():
    """Values of a known plastic without noise, stated as uncertain by 1 %."""
    return gonio.tabulate(
        material("plastic").bsdf, incidences=[(10, 0), (40, 0), (65, 0)], pitch=8, peak_pitch=1
    )


@pytest.fixture(scope="module")
def found(plastic):
    return gonio.fit(plastic, model="plastic")


def changed(measurement, change):
    """The measurement with `change` made to a dict of each slice's columns."""
    slices = []
    for s in measurement:
        columns = {n: getattr(s, n) for n in ("theta_s", "phi_s", "dsf", "u_dsf", "omega", "flags")}
        columns |= change(columns)
        slices.append(gonio.Slice(theta_i=s.theta_i, phi_i=s.phi_i, channel=s.channel, **columns))
    return gonio.Measurement(slices, sample_name="changed")


def test_exact_values_give_the_parameters_they_were_made_with(found):
    assert found.converged
    for name, value in TRUTH.items():
        e = found.estimate(name)
        assert e.value == pytest.approx(value, rel=1e-5)
        assert e.low < value < e.high
        assert e.kind == "value"
    assert found.parameters == {"photopic": pytest.approx(TRUTH, rel=1e-5)}
    with pytest.raises(gonio.DomainError, match="found 'gloss', allowed color, specularity"):
        found.estimate("gloss")


def test_the_text_of_a_fit_is_short(found):
    assert str(found) == repr(found)
    assert str(found).startswith("<Fit plastic: color (photopic) 0.43")
    assert len(str(found)) < 200


def test_the_estimate_of_one_of_several_channels_asks_for_it():
    model = gonio.analytic({"model": "lambert", "rho": {"red": 0.5, "green": 0.3, "blue": 0.1}})
    f = gonio.fit(gonio.tabulate(model, pitch=20, peak_pitch=20), model="lambert", held_out=False)
    assert f.estimate("kd", "green").value == pytest.approx(0.3, rel=1e-4)
    for channel, says in ((None, "found none for kd"), ("photopic", "found photopic for kd")):
        with pytest.raises(gonio.DomainError, match=f"channel: {says}, allowed red, green, blue"):
            f.estimate("kd", channel)


def test_the_fitted_model_and_its_parts_are_the_material(found):
    at = {"theta_i": 40, "phi_i": 0, "theta_s": [10, 35, 60], "phi_s": [180, 178, 90]}
    truth = material("plastic").bsdf.eval(**at)
    np.testing.assert_allclose(found.bsdf().eval(**at), truth, rtol=1e-4)
    np.testing.assert_allclose(gonio.analytic(*found.parts).eval(**at), truth, rtol=1e-4)


def test_predictions_and_residuals_belong_to_the_readings(plastic, found):
    assert [len(p) for p in found.predicted] == [len(s) for s in plastic]
    for s, p in zip(plastic, found.predicted, strict=True):
        used = np.isfinite(p)
        np.testing.assert_array_equal(used, s.theta_s <= 85)
        np.testing.assert_allclose(p[used], s.dsf[used], rtol=1e-3)
    assert sum(int(np.isfinite(p).sum()) for p in found.predicted) == found.readings
    assert found.excluded == {"grazing": sum(len(s) for s in plastic) - found.readings}
    assert [r.theta_i for r in found.residuals] == pytest.approx([10, 40, 65])
    assert all(r.relative_l1 < 1e-3 for r in found.residuals)


def test_covariance_and_correlation_belong_together(found):
    u = np.sqrt(np.diag(found.covariance))
    np.testing.assert_allclose(u, [e.u for e in found.estimates], rtol=1e-6)
    np.testing.assert_allclose(found.correlation, found.covariance / np.outer(u, u), atol=1e-9)
    assert all(abs(c.value) >= 0.8 for c in found.notable_correlations)


def test_held_out_incidences_are_predicted_unless_not_asked_for(plastic, found):
    assert [h.theta_i for h in found.held_out] == pytest.approx([10, 40, 65])
    assert found.held_out_error < 1e-3
    assert gonio.fit(plastic, model="plastic", held_out=False).held_out_error is None


def test_a_fit_is_plain_data(found):
    plain = json.loads(json.dumps(found.to_dict()))
    assert plain["parameters"]["photopic"]["alpha"] == pytest.approx(0.15, rel=1e-5)
    assert plain["provenance"]["settings"]["metric"] == "chi2"
    assert "predicted" not in plain
    with pytest.raises(FrozenInstanceError):
        found.model = "metal"


def test_auto_ranks_the_models_and_says_which_one_holds(plastic):
    rng = np.random.default_rng(1)
    noisy = changed(plastic, lambda c: {"dsf": rng.normal(c["dsf"], c["u_dsf"])})
    best = gonio.fit(noisy, models=["lambert", "ward-duer", "trans", "plastic"])
    assert best.model == "plastic"
    assert [f.model for f in best.ranking.fits] == ["plastic", "trans", "ward-duer", "lambert"]
    assert best.ranking.sentence.startswith("plastic describes the sample best")
    assert "trans fit these readings exactly as well" in best.ranking.sentence
    rows = best.ranking.to_dict()["models"]
    assert rows[0]["delta_aicc"] == pytest.approx(0, abs=0.01)
    assert rows[-1]["held_out_error"] > 0.1
    assert all(f.ranking is None for f in best.ranking.fits)


def test_a_fixed_parameter_stays_and_has_no_uncertainty(plastic):
    e = gonio.fit(plastic, model="plastic", fixed={"specularity": 0.07}).estimate("specularity")
    assert (e.value, e.kind, e.u) == (0.07, "fixed", 0)


def test_every_option_named_is_one_of_the_core(plastic):
    options = {"metric": METRICS, "loss": LOSSES, "weights": WEIGHTS}
    for option, names in options.items():
        for name in names:
            got = gonio.fit(plastic, model="plastic", held_out=False, **{option: name})
            assert getattr(got, option) == name
        with pytest.raises(gonio.DomainError, match=", ".join(names)):
            gonio.fit(plastic, model="plastic", **{option: "magic"})


def test_colours_have_a_value_a_channel_and_widths_one_for_all():
    rgb = {"red": 0.5, "green": 0.3, "blue": 0.1}
    paint = gonio.analytic({"model": "lambert", "rho": rgb}, {"model": "ward-gmd", "rho": 0.05, "alpha": 0.2})
    sample = gonio.tabulate(paint, incidences=[(20, 0), (50, 0)], pitch=8, peak_pitch=1)
    f = gonio.fit(sample, model="plastic")
    assert [e.label for e in f.estimates[:3]] == ["color (red)", "color (green)", "color (blue)"]
    for channel, value in rgb.items():
        assert f.estimate("color", channel).value == pytest.approx(value / 0.95, rel=1e-4)
    assert f.estimate("alpha").channel is None
    only = gonio.fit(sample, model="plastic", channels=["green"])
    assert only.channels == ("green",)


def test_angles_are_degrees():
    brushed = material("brushed").bsdf
    sample = gonio.tabulate(brushed, incidences=[(20, 0), (50, 45)], pitch=8, peak_pitch=1)
    f = gonio.fit(sample, model="plastic2", held_out=False)
    phi = f.estimate("phi_x")
    assert phi.unit == "degree"
    assert min(phi.value % 180, 180 - phi.value % 180) < 0.1 or abs(phi.value % 180 - 90) < 0.1
    widths = sorted([f.estimate("alpha_x").value, f.estimate("alpha_y").value])
    assert widths == pytest.approx([0.08, 0.25], rel=1e-3)


def test_a_file_of_the_rgl_database_is_fitted(tmp_path):
    path = tmp_path / "paint.bsdf"
    write_tensor_file(path, synthetic([0.0], None))
    f = gonio.fit(path, model="ward-gmd", channels=["green"], held_out=False)
    assert f.channels == ("green",)
    assert f.provenance["inputs"][0]["name"] == "paint.bsdf"


def test_the_uncertainty_of_a_tabulated_material_is_stated_by_the_user(tmp_path):
    path = tmp_path / "paint.bsdf"
    write_tensor_file(path, synthetic([0.0], None))
    options = {"model": "lambert", "channels": ["green"], "held_out": False}
    asked = {"u_relative": 0.03, "u_floor": 0.001}
    f = gonio.fit(path, **options, **asked)
    same = gonio.fit(gonio.tabulate(path, channels=["green"], **asked), **options)
    assert (f.estimate("kd").value, f.noise_ratio) == (same.estimate("kd").value, same.noise_ratio)
    assert f.noise_ratio < 0.5 * gonio.fit(path, **options).noise_ratio
    settings = f.provenance["settings"]
    assert {name: settings[name] for name in asked} == asked
    with pytest.raises(gonio.DomainError, match=r"u_relative: found 0.03 for a measurement, which states"):
        gonio.fit(gonio.tabulate(path, channels=["green"]), u_relative=0.03)


def test_readings_that_contradict_reciprocity_are_told_with_every_model(plastic):
    assert all(w.code != "reciprocity" for w in gonio.fit(plastic, model="plastic").warnings)
    factors = iter((1.0, 0.7, 0.5))
    tilted = changed(plastic, lambda c: {"dsf": next(factors) * c["dsf"]})
    verdict = next(v for v in gonio.check(tilted) if v.id == "reciprocity")
    assert verdict.verdict == "fail"
    f = gonio.fit(tilted, models=["lambert", "plastic"])
    for fitted in (f, *f.ranking.fits):
        (told,) = (w.text for w in fitted.warnings if w.code == "reciprocity")
        assert told.startswith(f"the check of reciprocity fails: {verdict.sentence}")


def test_what_speaks_against_a_model_is_data():
    rng = np.random.default_rng(1)
    white = gonio.tabulate(gonio.analytic({"model": "lambert", "rho": 0.9}), pitch=10, peak_pitch=10, reach=0)
    noisy = changed(white, lambda c: {"dsf": rng.normal(c["dsf"], c["u_dsf"])})
    best = gonio.fit(noisy)
    assert best.model == "lambert"
    assert all(e.open is None for e in best.estimates)
    assert best.albedo.value == pytest.approx(best.estimate("kd").value, abs=1e-5)
    assert best.albedo.u == pytest.approx(best.estimate("kd").u, rel=0.01)
    plain = best.to_dict()
    assert plain["albedo"]["theta_i"] in {s.theta_i for s in noisy}
    assert plain["ranking"]["passed_over"] == dict(best.ranking.passed_over)
    lobe = next(f for f in best.ranking.fits if f.model == "plastic")
    assert {e.name for e in lobe.estimates if e.open} & {"specularity", "alpha"}


def test_fit_models_are_data_and_all_of_them_can_be_named(plastic):
    names = [m.name for m in gonio.fit_models()]
    assert {"plastic", "metal", "trans", "ward-gmd", "abg", "lambert"} <= set(names)
    for m in gonio.fit_models():
        assert set(m.parts) <= {a.name for a in gonio.models()}
        assert all(p.low <= p.default <= p.high for p in m.parameters)
    with pytest.raises(gonio.DomainError) as error:
        gonio.fit(plastic, model="velvet")
    assert all(name in str(error.value) for name in names)


@pytest.mark.parametrize(
    ("change", "kind", "says"),
    [
        (lambda c: {"dsf": 0 * c["dsf"]}, gonio.FitError, "nothing to fit. Check the dark"),
        (lambda c: {"dsf": np.nan * c["dsf"]}, gonio.FitError, "readings: found 0 that can be used"),
        (lambda c: {n: v[:1] for n, v in c.items()}, gonio.FitError, "fewer parameters"),
        (lambda c: {"theta_s": 180 - c["theta_s"]}, gonio.FitError, "check the convention of theta_s"),
    ],
    ids=["all zero", "all NaN", "three readings", "reversed hemisphere"],
)
def test_readings_that_cannot_be_fitted_say_what_to_do(plastic, change, kind, says):
    with pytest.raises(kind, match=says):
        gonio.fit(changed(plastic, change), model="plastic")


def test_holes_in_the_readings_change_little_and_are_told(plastic):
    def holes(columns):
        dsf = columns["dsf"].copy()
        dsf[::3] = np.nan
        return {"dsf": dsf}

    f = gonio.fit(changed(plastic, holes), model="plastic")
    assert f.estimate("alpha").value == pytest.approx(0.15, rel=1e-3)
    assert "missing_readings" in [w.code for w in f.warnings]


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"fixed": {"gloss": 1.0}}, "gloss.*color, specularity, alpha"),
        ({"fixed": {"alpha": 7.0}}, "alpha fixed at 7"),
        ({"max_theta_s": 0}, "max_theta_s"),
        ({"retro_radius": -1}, "retro_radius"),
        ({"component": "sideways"}, "reflection, transmission"),
        ({"models": ["metal"]}, "with model 'plastic', allowed only with auto"),
        ({"compare": "chi2"}, "compare"),
    ],
)
def test_an_option_out_of_range_is_named(plastic, options, says):
    with pytest.raises(gonio.DomainError, match=says):
        gonio.fit(plastic, model="plastic", **options)


def test_a_channel_that_was_not_measured_is_named(plastic):
    with pytest.raises(gonio.QuantityError, match="photopic"):
        gonio.fit(plastic, model="plastic", channels=["red"])


def test_a_saved_measurement_is_fitted_like_the_one_in_memory(tmp_path):
    # A beam nearly as wide as the lobe: without its second moment alpha would come out wide.
    campaign = gonio.simulate(
        material="metal",
        incidences=[(20, 0), (50, 0)],
        instrument={"beam_radius": 1.5, "pitch_across": 8, "pitch_along": 2, "patch_pitch": 1},
        out=tmp_path / "raw",
    )
    measured = gonio.process(campaign.sample, beam=campaign.beam, dark=campaign.dark)
    measured.save(tmp_path / "measured")
    now = gonio.fit(measured, model="metal")
    later = gonio.fit(gonio.Measurement.load(tmp_path / "measured"), model="metal")
    for a, b in zip(now.estimates, later.estimates, strict=True):
        assert b.value == pytest.approx(a.value, rel=1e-6)
        assert b.u == pytest.approx(a.u, rel=1e-4)
