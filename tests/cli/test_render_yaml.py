"""`gonio render` of scenes in YAML, and of scenes with gonio's own models."""

import json
import math

import pytest
from gonio.fit_outputs import FORMAT, FORMAT_VERSION

from tests.cli.conftest import one_clear_error

QUICK = ("--size", 16, "--samples", 32)

FLOOR = "v -5 -5 0\nv 5 -5 0\nv 5 5 0\nv -5 5 0\nusemtl Floor\nf 1 2 3 4\n"
SCENE = """materials:
  Floor: {plastic: [.5, .5, .5, 0, 0]}
objects:
  - file: floor.obj
sky: {kind: uniform, sun: {altitude: 30, azimuth: 180}, illuminance: 10000}
view: -vtv -vp 0 0 2 -vd 0 0 -1 -vu 0 1 0 -vh 20 -vv 20
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "floor.obj").write_text(FLOOR)
    (tmp_path / "scene.yaml").write_text(SCENE)
    return tmp_path


def test_a_scene_in_yaml_is_rendered_with_the_view_that_it_names(run, folder):
    done = run("render", "scene.yaml", "-o", "a.exr", "--json", *QUICK)
    found = json.loads(done.out)
    assert found["view"].startswith("-vtv -vp 0 0 2")
    # An even sky of 10000 lx over a floor of reflectance 0.5.
    assert found["mean_luminance"] == pytest.approx(0.5 * 10000 / math.pi, rel=0.02)
    done = run(
        "render", "scene.yaml", "-o", "b.exr", "--view", "-vp 1 1 2 -vd 0 0 -1 -vu 0 1 0", "--json", *QUICK
    )
    assert json.loads(done.out)["view"].startswith("-vtv -vp 1 1 2")


def test_sensors_of_a_scene_in_yaml_read_its_illuminance(run, folder):
    (folder / "points.txt").write_text("0 0 0 0 0 1\n")
    done = run("render", "scene.yaml", "--sensors", "points.txt", "--lux", "--json")
    assert json.loads(done.out)["illuminance"][0] == pytest.approx(10000, rel=0.02)


def test_what_is_wrong_in_yaml_is_one_line_with_its_place(run, folder):
    for change, words in [
        (("Floor: {", "Floor: {wood: 1, "), ("bad.yaml, line 2", "materials.Floor", "wood")),
        (("floor.obj", "none.obj"), ("bad.yaml, line 4", "objects[1].file", "none.obj")),
        (("uniform", "blue"), ("bad.yaml, line 5", "sky.kind", "blue")),
        (("-vtv", "-vtq"), ("bad.yaml, line 6", "view")),
        (("view: ", "views: "), ("bad.yaml, line 6", "views")),
        (("- file", "file"), ("bad.yaml, line 4",)),
    ]:
        (folder / "bad.yaml").write_text(SCENE.replace(*change))
        one_clear_error(run("render", "bad.yaml", "-o", "a.png", *QUICK), *words)
    (folder / "blind.yaml").write_text(SCENE.split("view", maxsplit=1)[0])
    one_clear_error(run("render", "blind.yaml", "-o", "a.png", *QUICK), "--view")
    one_clear_error(run("render", "scene.yaml", "-o", "a.png", "--size", 0), "size")
    one_clear_error(run("render", "scene.yaml", "-o", "a.png", "--size", "5x0"), "size")
    one_clear_error(run("render", "scene.yaml", "-o", "a.png", "--size", "x"), "size")
    assert not list(folder.glob("*.png"))


def test_the_model_of_a_fit_is_a_material_of_scenes_and_of_previews(run, folder):
    plain = {"format": FORMAT, "format_version": FORMAT_VERSION, "parts": [{"model": "lambert", "rho": 0.5}]}
    (folder / "fit.json").write_text(json.dumps(plain))
    assert run("render", "--preview", "fit.json", "-o", "ball.png", *QUICK).code == 0
    assert run("render", "--preview", ".", "-o", "ball2.png", *QUICK).code == 0
    (folder / "model.yaml").write_text(SCENE.replace("{plastic: [.5, .5, .5, 0, 0]}", "{model: fit.json}"))
    plastic = json.loads(run("render", "scene.yaml", "-o", "a.exr", "--json", *QUICK).out)
    model = json.loads(run("render", "model.yaml", "-o", "a.exr", "--json", *QUICK).out)
    assert model["mean_luminance"] == pytest.approx(plastic["mean_luminance"], rel=0.02)
    plain["parts"] = []
    (folder / "fit.json").write_text(json.dumps(plain))
    one_clear_error(run("render", "model.yaml", "-o", "a.exr", *QUICK), "model.yaml, line 2", "fit.json")


def test_files_that_a_scene_names_are_found_along_raypath(run, folder, monkeypatch):
    library = folder / "library"
    library.mkdir()
    (folder / "floor.obj").rename(library / "floor.obj")
    one_clear_error(run("render", "scene.yaml", "-o", "a.exr", *QUICK), "floor.obj")
    monkeypatch.setenv("RAYPATH", f".:{library}")
    assert run("render", "scene.yaml", "-o", "a.exr", *QUICK).code == 0
    monkeypatch.delenv("RAYPATH")
    assert run("render", "scene.yaml", "-o", "a.exr", "-I", library, *QUICK).code == 0
