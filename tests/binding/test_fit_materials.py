"""Fits as materials of Radiance and Mitsuba 3."""

import dataclasses
import xml.etree.ElementTree as ET

import gonio
import numpy as np
import pytest
from gonio.fit_materials import WORSE, Substitute, best_material, writable
from gonio.fit_mitsuba import mitsuba_material
from gonio.fit_outputs import read_fitted_model, save_fit
from gonio.fit_radiance import radiance_material
from gonio.materials import material
from gonio.radiance_colour import rgb_of_srgb

from tests.validation.rgl import synthetic, write_tensor_file

KD, F0, ALPHA = 0.3, 0.05, 0.2
MATT = {"model": "lambert", "rho": {"photopic": KD}}
GGX = {"model": "ggx", "f0": {"photopic": F0}, "alpha": {"photopic": ALPHA}}
INTERFACE = {"model": "ggx-dielectric", "eta": {"photopic": 1.5}, "alpha": {"photopic": ALPHA}}


@pytest.fixture(scope="module")
def plastic():
    return gonio.tabulate(material("plastic").bsdf, incidences=[(10, 0), (60, 0)], pitch=10, peak_pitch=2)


@pytest.fixture(scope="module")
def found(plastic):
    return gonio.fit(plastic, model="plastic")


def with_estimate(found, name, **changes):
    """The fit, with one estimate changed."""
    estimates = tuple(dataclasses.replace(e, **changes) if e.name == name else e for e in found.estimates)
    return dataclasses.replace(found, estimates=estimates)


@pytest.mark.parametrize(
    ("name", "changes", "says"),
    [
        ("color", {"open": "undetermined"}, r"color \(photopic\): found undetermined.*--fix color=VALUE"),
        (
            "specularity",
            {"value": 1.0, "u": 1e8, "open": "vague"},
            r"specularity: found 1 with a standard uncertainty of 1e\+08",
        ),
        ("alpha", {"open": "undetermined"}, "alpha: found undetermined"),
    ],
)
def test_a_fit_that_leaves_a_parameter_open_is_no_material(found, name, changes, says):
    opened = with_estimate(found, name, **changes)
    with pytest.raises(gonio.DomainError, match="Radiance material: " + says):
        radiance_material(opened)
    assert writable(opened) == ()
    assert writable(found) == ("Radiance",)
    with pytest.raises(gonio.DomainError, match="Mitsuba material: " + says):
        mitsuba_material(of(opened, "ggx", MATT, GGX))


def test_facets_without_absorption_are_a_material_although_no_slope_tells_k():
    parts = {"model": "lambert", "rho": 0.2}, {"model": "ggx-conductor", "eta": 3.4, "k": 0.0, "alpha": 0.3}
    sample = gonio.tabulate(
        gonio.analytic(*parts), incidences=[(15, 0), (40, 0), (60, 0)], pitch=10, peak_pitch=2
    )
    f = gonio.fit(sample, model="ggx-conductor", held_out=False)
    assert f.estimate("k").value == pytest.approx(0.0, abs=1e-3)
    surface = mitsuba_material(f).material["bsdf"]["bsdf_1"]
    assert surface["eta"]["value"] == pytest.approx([3.4] * 3, rel=1e-3)


def test_the_width_of_a_lobe_without_light_may_be_open(found):
    matt = with_estimate(with_estimate(found, "specularity", value=0.0, u=1e-5), "alpha", open="undetermined")
    assert radiance_material(matt).material.parameters["spec"] == 0.0


def of(found, model, *parts):
    """The fit, with the sum of another model."""
    return dataclasses.replace(found, model=model, parts=parts)


def ggx_in_mitsuba(theta_i, theta_s, phi):
    """f cos theta_s of a matt base and GGX facets, masked independently [Walter2007]."""
    wi = np.array([np.sin(theta_i), 0.0, np.cos(theta_i)])
    ws = np.array([np.sin(theta_s) * np.cos(phi), np.sin(theta_s) * np.sin(phi), np.cos(theta_s)])
    h = (wi + ws) / np.linalg.norm(wi + ws)
    tan2 = 1.0 / h[2] ** 2 - 1.0
    d = 1.0 / (np.pi * ALPHA**2 * h[2] ** 4 * (1.0 + tan2 / ALPHA**2) ** 2)
    g = 1.0
    for w in (wi, ws):
        g *= 2.0 / (1.0 + np.sqrt(1.0 + ALPHA**2 * (1.0 / w[2] ** 2 - 1.0)))
    n = (1.0 + np.sqrt(F0)) / (1.0 - np.sqrt(F0))
    c = wi @ h
    t = np.sqrt(1.0 - (1.0 - c * c) / n**2)
    f = 0.5 * (((c - n * t) / (c + n * t)) ** 2 + ((n * c - t) / (n * c + t)) ** 2)
    return KD / np.pi * ws[2] + d * g * f / (4.0 * wi[2])


def test_mitsuba_loads_the_material_and_adds_base_and_lobe(found):
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    mapped = mitsuba_material(of(found, "ggx", MATT, GGX))
    loaded = [mi.load_dict(mapped.material)]
    element = ET.fromstring(mapped.xml(name="paint")).find("bsdf")
    assert element.get("id") == "paint"
    loaded.append(mi.load_string(f'<bsdf version="3.0.0" type="twosided">{inner(element)}</bsdf>'))
    for bsdf in loaded:
        for theta_i, theta_s, phi in ((0.2, 0.3, 3.0), (1.0, 0.9, 3.1), (1.2, 0.4, 1.0)):
            si = mi.SurfaceInteraction3f()
            si.wi = mi.Vector3f(np.sin(theta_i), 0.0, np.cos(theta_i))
            ws = [np.sin(theta_s) * np.cos(phi), np.sin(theta_s) * np.sin(phi), np.cos(theta_s)]
            value = bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(*ws))
            assert list(value) == pytest.approx([ggx_in_mitsuba(theta_i, theta_s, phi)] * 3, rel=1e-3)


def inner(element):
    return "".join(ET.tostring(child, encoding="unicode") for child in element)


def test_the_losses_of_a_mitsuba_material_are_stated_with_their_size(found):
    losses = mitsuba_material(of(found, "ggx", MATT, GGX)).losses
    assert any("masks" in text and "theta_i = 60 deg" in text for text in losses)
    assert any("Schlick" in text for text in losses)
    slope = ALPHA * np.tan(np.radians(60.0))
    hidden = (np.sqrt(1.0 + slope**2) - 1.0) / 2.0
    lost = 100.0 * (1.0 - (1.0 + 2.0 * hidden) / (1.0 + hidden) ** 2)
    assert any(f"{lost:.2g} %" in text for text in losses)


def test_an_interface_is_a_rough_dielectric_unless_it_has_a_diffuse_part(found):
    pytest.importorskip("mitsuba").set_variant("scalar_rgb")
    mapped = mitsuba_material(of(found, "ggx-dielectric", INTERFACE))
    assert mapped.material["type"] == "roughdielectric"
    assert mapped.material["int_ior"] == 1.5
    pytest.importorskip("mitsuba").load_dict(mapped.material)
    with pytest.raises(gonio.DomainError, match="kd=0"):
        mitsuba_material(of(found, "ggx-dielectric", MATT, INTERFACE))


def test_models_that_mitsuba_does_not_have_are_refused_with_the_reason(found):
    with pytest.raises(gonio.DomainError, match="no Ward lobe"):
        mitsuba_material(found)
    with pytest.raises(gonio.DomainError, match="lambert, abg"):
        mitsuba_material(of(found, "abg", MATT, {"model": "abg"}))


def test_a_matt_sample_is_the_same_in_both(plastic):
    fit = gonio.fit(plastic, model="lambert", held_out=False)
    kd = fit.estimate("kd").value
    assert mitsuba_material(fit).losses == ()
    assert mitsuba_material(fit).material["bsdf"]["reflectance"]["value"] == pytest.approx([kd] * 3)
    found = radiance_material(fit).material
    assert found.parameters == pytest.approx({"red": kd, "green": kd, "blue": kd, "spec": 0, "rough": 0})


@pytest.mark.parametrize("kind", ["plastic2", "ward-gmd-anisotropic"])
def test_the_azimuth_of_an_anisotropic_lobe_reaches_radiance(kind):
    turned = gonio.analytic(
        {"model": "lambert", "rho": 0.1},
        {"model": "ward-gmd-anisotropic", "rho": 0.3, "alpha_x": 0.1, "alpha_y": 0.3, "phi_x": 30.0},
    )
    sample = gonio.tabulate(turned, incidences=[(20, 0), (50, 60)], pitch=10, peak_pitch=2)
    mapped = radiance_material(gonio.fit(sample, model=kind, held_out=False)).material
    at = {"theta_i": 40, "phi_i": 0, "theta_s": [20, 40, 50], "phi_s": [180, 160, 210]}
    np.testing.assert_allclose(mapped.bsdf().eval(**at, channel="green"), turned.eval(**at), rtol=1e-3)


def test_a_coloured_lobe_is_metal_and_what_one_number_loses_is_told():
    colour = {"red": 0.6, "green": 0.4, "blue": 0.2}
    coloured = gonio.analytic(
        {"model": "lambert", "rho": {c: 0.3 * v for c, v in colour.items()}},
        {"model": "ward-gmd", "rho": {c: 0.7 * v for c, v in colour.items()}, "alpha": 0.2},
    )
    sample = gonio.tabulate(coloured, incidences=[(20, 0), (50, 0)], pitch=10, peak_pitch=2)
    mapped = radiance_material(gonio.fit(sample, model="ward-gmd", held_out=False))
    assert mapped.material.type == "metal"
    assert mapped.material.parameters == pytest.approx(colour | {"spec": 0.7, "rough": 0.2}, rel=1e-3)
    assert mapped.losses == ()

    mixed = gonio.analytic(
        {"model": "lambert", "rho": {"red": 0.1, "green": 0.3, "blue": 0.2}},
        {"model": "ward-gmd", "rho": {"red": 0.2, "green": 0.3, "blue": 0.1}, "alpha": 0.2},
    )
    sample = gonio.tabulate(mixed, incidences=[(20, 0), (50, 0)], pitch=10, peak_pitch=2)
    losses = radiance_material(gonio.fit(sample, model="ward-gmd", held_out=False)).losses
    assert len(losses) == 1
    assert "differs between the channels by up to" in losses[0]


def test_a_saved_fit_is_read_back_as_the_same_model(found, plastic, tmp_path):
    saved = save_fit(found, out=tmp_path / "f", measurement=plastic)
    assert saved.files == ("fit.json", "material.rad", "residuals.html")
    at = {"theta_i": 40, "phi_i": 0, "theta_s": [20, 40, 50], "phi_s": [180, 160, 210]}
    np.testing.assert_allclose(
        read_fitted_model(tmp_path / "f").eval(**at), found.bsdf().eval(**at), rtol=1e-9
    )
    (tmp_path / "f" / "fit.json").write_text("{}")
    with pytest.raises(gonio.FormatError, match="gonio-fit"):
        read_fitted_model(tmp_path / "f")


def test_a_page_needs_the_measurement_that_was_fitted(found, tmp_path):
    other = gonio.tabulate(material("plastic").bsdf, incidences=[(30, 0)], pitch=10, peak_pitch=2)
    with pytest.raises(gonio.DomainError, match="those of the fit"):
        save_fit(found, out=tmp_path / "f", measurement=other)
    assert not (tmp_path / "f").exists()


def with_error(found, model, error):
    """The fit as that of another model with this error at one left-out incidence."""
    row = gonio.fit_results.HeldOut(theta_i=30.0, phi_i=0.0, relative_l1=error, residuals=())
    return dataclasses.replace(found, model=model, held_out=(row,) if error is not None else ())


@pytest.mark.parametrize(("error", "told"), [(0.14, False), (0.16, True)])
def test_a_substitute_much_worse_than_the_winner_is_warned_of(found, error, told):
    plastic = with_error(found, "plastic", error)
    ggx = with_error(found, "ggx", 0.1)
    ranking = gonio.Ranking(fits=(ggx, plastic), failed={}, sentence="")
    _, of, substitute = best_material(
        dataclasses.replace(ggx, ranking=ranking), "Radiance", radiance_material
    )
    assert of.model == "plastic"
    assert substitute.ratio == pytest.approx(error / 0.1)
    assert (substitute.ratio > WORSE) == told
    assert (substitute.warning is not None) == told
    if told:
        assert "the error of plastic is 1.6 times that of ggx (more than 1.5)" in substitute.warning
        assert "gonio export --to radiance-ttree" in substitute.warning
    assert "16.00 %, against 10.00 % of ggx" in Substitute("plastic", 0.16, "ggx", 0.1, "Radiance").text


def test_the_srgb_of_a_measured_material_becomes_radiances_rgb(tmp_path):
    path = tmp_path / "paint.bsdf"
    write_tensor_file(path, synthetic([0.0], None))
    f = gonio.fit(path, model="lambert", held_out=False)
    assert f.provenance["primaries"] == "sRGB"
    kd = np.array([f.estimate("kd", c).value for c in ("red", "green", "blue")])
    wanted = rgb_of_srgb(kd)
    assert wanted.min() > 0.0
    made = radiance_material(f)
    got = [made.material.parameters[c] for c in ("red", "green", "blue")]
    np.testing.assert_allclose(got, wanted, rtol=1e-9)
    (note,) = made.notes
    assert "linear sRGB of the readings, converted to Radiance's primaries (0.640 0.330" in note
    written = save_fit(f, out=tmp_path / "f", measurement=path)
    assert written.notes["material.rad"] == (note,)
    assert f"# note: {note}\n" in (tmp_path / "f" / "material.rad").read_text()
    # Mitsuba's numbers are linear sRGB themselves.
    matt = mitsuba_material(f).material["bsdf"]["reflectance"]["value"]
    np.testing.assert_allclose(matt, kd, rtol=1e-9)


def test_the_red_green_and_blue_of_other_readings_are_radiances(tmp_path):
    rgb = {"red": 0.5, "green": 0.3, "blue": 0.1}
    sample = gonio.tabulate(gonio.analytic({"model": "lambert", "rho": rgb}), pitch=20, peak_pitch=20)
    made = radiance_material(gonio.fit(sample, model="lambert", held_out=False))
    assert [made.material.parameters[c] for c in rgb] == pytest.approx([*rgb.values()], rel=1e-4)
    assert "taken for Radiance's primaries" in made.notes[0]
