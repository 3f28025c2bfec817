"""What `gonio fit -o` writes where the best model has no counterpart, or leaves parameters open."""

import json
import xml.etree.ElementTree as ET

import gonio
import pytest

from tests.cli.conftest import listing, one_clear_error
from tests.validation.rgl import synthetic, write_tensor_file


def saved(path, *parts, channels=None, **options):
    """A measurement of a sum of models without noise, saved."""
    given = {"incidences": [(15, 0), (50, 0)], "pitch": 10, "peak_pitch": 2} | options
    gonio.tabulate(gonio.analytic(*parts), channels=channels, **given).save(path)
    return path


@pytest.fixture(scope="module")
def facets(tmp_path_factory):
    """Readings that GGX facets describe and Radiance's lobe does not."""
    directory = tmp_path_factory.mktemp("facets")
    parts = ({"model": "lambert", "rho": 0.2}, {"model": "ggx", "f0": 0.3, "alpha": 0.3})
    return saved(directory / "m", *parts)


COMPARED = [o for m in ("ggx", "plastic", "ward-gmd", "lambert") for o in ("--compare", m)]


def test_the_best_ranked_material_is_written_where_the_winner_has_none(run, facets, tmp_path):
    done = run("fit", facets, *COMPARED, "-o", tmp_path / "f")
    assert done.code == 0, done.err
    found = json.loads((tmp_path / "f" / "fit.json").read_text())
    assert found["model"] == "ggx"
    ranked = {row["model"]: row for row in found["ranking"]["models"]}
    order = [m for m in ranked if "Radiance" in ranked[m]["materials"]]
    told = found["materials"]["substituted"]
    assert list(told) == ["material.rad"]
    assert told["material.rad"] == {
        "model": order[0],
        "held_out_error": ranked[order[0]]["held_out_error"],
        "fitted": "ggx",
        "fitted_error": ranked["ggx"]["held_out_error"],
        "program": "Radiance",
        "ratio": ranked[order[0]]["held_out_error"] / 1e-4,
    }
    assert "times that of ggx (more than 1.5)" in " ".join(done.err.split())
    assert "# warning: the error of " in (tmp_path / "f" / "material.rad").read_text()
    errors = [f"{100 * ranked[m]['held_out_error']:.2f} %" for m in (order[0], "ggx")]
    sentence = f"the material is {order[0]}, the best ranked model that can be written for Radiance"
    head = (tmp_path / "f" / "material.rad").read_text().splitlines()[0]
    for text in (head, " ".join(done.out.split()), (tmp_path / "f" / "residuals.html").read_text()):
        assert sentence in text
        for error in errors:
            assert error in text
    (paint,) = gonio.read_materials(tmp_path / "f" / "material.rad")
    assert paint.type == "plastic"
    if order[0] == "plastic":
        assert paint.parameters["rough"] == pytest.approx(ranked["plastic"]["values"]["photopic"]["alpha"])
    assert "roughconductor" in (tmp_path / "f" / "mitsuba.xml").read_text()


def test_the_uncertainty_of_a_measured_material_is_stated_on_the_command_line(run, facets, tmp_path):
    path = tmp_path / "paint.bsdf"
    write_tensor_file(path, synthetic([0.0], None))
    ours = ("--model", "lambert", "--channel", "green", "--u-relative", 0.05, "--u-floor", 0.002, "--json")
    done = run("fit", path, *ours)
    assert done.code == 0, done.err
    settings = json.loads(done.out)["provenance"]["settings"]
    assert (settings["u_relative"], settings["u_floor"]) == (0.05, 0.002)
    one_clear_error(run("fit", facets, "--u-relative", 0.05), "u_relative", "found 0.05", "gonio process")


def test_the_ranking_tells_what_can_be_written_for_which_program(run, facets):
    done = run("fit", facets, *COMPARED)
    rows = {line.split()[0]: line for line in done.out.splitlines() if " deg: " in line}
    assert rows["ggx"].endswith(" Mitsuba")
    assert rows["plastic"].endswith(" Radiance")
    assert rows["lambert"].endswith(" Radiance, Mitsuba")


def test_a_substitute_for_mitsuba_is_named_in_the_head_of_its_scene(run, tmp_path):
    source = saved(
        tmp_path / "m", {"model": "lambert", "rho": 0.2}, {"model": "ward-gmd", "rho": 0.1, "alpha": 0.2}
    )
    compared = [o for m in ("ggx", "plastic") for o in ("--compare", m)]
    assert run("fit", source, *compared, "-o", tmp_path / "f", "--name", "paint").code == 0
    text = (tmp_path / "f" / "mitsuba.xml").read_text()
    assert text.startswith(
        "<!-- note: the material is ggx, the best ranked model that can be written for Mitsuba"
    )
    assert ET.fromstring(text).find("bsdf").get("id") == "paint"


def test_a_model_chosen_by_name_has_no_substitute(run, facets, tmp_path):
    done = run("fit", facets, "--model", "ggx", "-o", tmp_path / "f")
    assert "no material.rad: Radiance material: found the model ggx" in done.out
    assert "material.rad" not in listing(tmp_path / "f")


def test_an_undetermined_colour_is_no_material(run, tmp_path):
    """Diffuse light behind the sample alone: `trans` and `color` of a trans show in their product only."""
    source = saved(
        tmp_path / "m",
        {"model": "lambert-transmission", "tau": 0.3},
        components=["transmission"],
        peak_pitch=8,
    )
    done = run("fit", source, "--model", "trans", "-o", tmp_path / "f")
    assert done.code == 0, done.err
    found = json.loads((tmp_path / "f" / "fit.json").read_text())
    reason = found["materials"]["refused"]["material.rad"]
    assert "material.rad" not in listing(tmp_path / "f")
    named = reason.split(": ")[1]
    assert named in {e["name"] for e in found["estimates"]} | {"color (photopic)"}
    assert "--fix" in reason
    assert f"no material.rad: Radiance material: {named}" in done.out


def test_a_fit_of_one_wavelength_becomes_a_material_when_it_is_told_how(run, tmp_path):
    source = saved(tmp_path / "m", {"model": "lambert", "rho": {"650nm": 0.3}}, channels=["650nm"])
    fit = ["fit", source, "--model", "lambert", "--force", "-o", tmp_path / "f"]
    done = run(*fit)
    assert "no material.rad: colour: found the channel 650nm alone" in done.out
    assert "--as-visible" in done.out
    assert "e+02" not in done.out
    done = run(*fit, "--as-visible")
    (paint,) = gonio.read_materials(tmp_path / "f" / "material.rad")
    assert [paint.parameters[c] for c in ("red", "green", "blue")] == pytest.approx([0.3] * 3, rel=1e-4)
    assert "650nm stand for the luminance" in done.out
    assert run(*fit, "--colour", "0.2,0.1,0.1").code == 0
    (paint,) = gonio.read_materials(tmp_path / "f" / "material.rad")
    assert paint.parameters["red"] / paint.parameters["blue"] == pytest.approx(2)
    for name in ("material.rad", "mitsuba.xml"):
        assert name in listing(tmp_path / "f")


def test_channels_with_colours_of_their_own_are_not_labelled_visible(run, tmp_path):
    source = saved(tmp_path / "m", {"model": "lambert", "rho": {"red": 0.5, "green": 0.3, "blue": 0.1}})
    done = run("fit", source, "--model", "lambert", "-o", tmp_path / "f", "--as-visible")
    one_clear_error(done, "as_visible", "red, green, blue")


@pytest.mark.parametrize("colour", ["nan,2,3", "inf,1,1", "-1,2,3", "0,0,0"])
def test_what_is_no_colour_is_refused_before_the_fit(run, tmp_path, colour):
    """There is no measurement: had the fit begun, it would say so."""
    done = run("fit", tmp_path / "nothing", "--model", "plastic", "-o", tmp_path / "f", f"--colour={colour}")
    one_clear_error(done, "colour", "finite numbers")


def test_the_fit_of_another_measurement_is_not_drawn(run, facets, tmp_path):
    other = saved(tmp_path / "other", {"model": "lambert", "rho": 0.3})
    assert run("fit", other, "--model", "lambert", "-o", tmp_path / "f").code == 0
    done = run("report", facets, "--fit", tmp_path / "f", "-o", tmp_path / "r.html")
    one_clear_error(done, "provenance.inputs", "found a fit of", "allowed one of", "SHA-256")
    assert not (tmp_path / "r.html").exists()
    assert run("report", other, "--fit", tmp_path / "f", "-o", tmp_path / "r.html").code == 0


def test_a_fit_of_other_channels_is_not_drawn(run, facets, tmp_path):
    red = gonio.tabulate(gonio.analytic({"model": "lambert", "rho": {"red": 0.3}}), pitch=20, peak_pitch=10)
    gonio.fit_outputs.save_fit(gonio.fit(red, model="lambert", held_out=False), out=tmp_path / "f")
    done = run("report", facets, "--fit", tmp_path / "f", "-o", tmp_path / "r.html")
    one_clear_error(done, "channels", "found red", "photopic")


def test_a_component_without_readings_is_told(run, facets):
    for model in ("auto", "plastic"):
        done = run("fit", facets, "--model", model, "--component", "transmission")
        one_clear_error(done, "component: found no transmission readings", "allowed reflection")


def test_a_zemax_file_is_sent_to_the_verb_that_reads_it(run, tmp_path):
    path = tmp_path / "a.bsdf"
    gonio.export(gonio.analytic({"model": "lambert", "rho": 0.2}), to="zemax-bsdf", out=path)
    one_clear_error(run("fit", path, "--model", "lambert"), "Zemax", "gonio process a.bsdf")
    with pytest.raises(
        gonio.FormatError, match=r"readings \(Zemax tabular BSDF\), needed a model.*gonio process"
    ):
        gonio.read_bsdf(path)


def test_the_radiance_materials_of_the_fit_are_described(run):
    done = run("models", "plastic")
    assert done.code == 0, done.err
    assert done.out.startswith("plastic: ")
    assert "specularity" in done.out
    listed = json.loads(run("models", "--json").out)
    names = ["plastic", "metal", "trans", "plastic2", "metal2", "trans2"]
    assert [m["name"] for m in listed["materials"]] == names
    fitted = {m.name for m in gonio.fit_models()}
    for model in listed["models"]:
        assert model["fitted"] == (model["name"] in fitted)
        assert ("not in gonio fit" in run("models", model["name"]).out) == (not model["fitted"])
    one_clear_error(run("models", "velvet"), "velvet", "plastic", "ggx")
