"""`gonio inspect` on text of a Radiance scene."""

import json

from tests.cli.conftest import one_clear_error

TEXT = """void plastic paint 0 0 5 .8 .4 .2 .02 .1
grain metal2 brushed 4 0 1 0 . 0 6 .9 .8 .7 .9 .05 .2
void polygon wall 0 0 9 0 0 0 1 0 0 1 1 0
"""


def test_materials_are_listed_with_their_parameters(run, tmp_path):
    (tmp_path / "a.rad").write_text(TEXT)
    done = run("inspect", "a.rad")
    assert (done.code, done.err) == (0, "")
    assert done.out.startswith("a.rad (radiance-material, 2 materials)")
    paint, brushed = done.out.splitlines()[1:3]
    assert " ".join(paint.split()) == "paint plastic red 0.8 green 0.4 blue 0.2 spec 0.02 rough 0.1"
    assert brushed.endswith("vrough 0.2  0 1 0 .  modified by grain")
    found = json.loads(run("inspect", "a.rad", "--json").out)
    (file,) = found["files"]
    assert [(m["type"], m["id"], m["line"]) for m in file["materials"]] == [
        ("plastic", "paint", 1),
        ("metal2", "brushed", 2),
    ]
    assert file["materials"][0]["parameters"]["spec"] == 0.02
    assert found["problems"] == []


def test_a_command_in_a_scene_is_refused_with_its_line_and_not_run(run, tmp_path):
    (tmp_path / "a.rad").write_text("\n!touch ran\n")
    one_clear_error(run("inspect", "a.rad"), "a.rad, line 2: command: found", "commands are not run")
    assert not (tmp_path / "ran").exists()


def test_a_scene_without_materials_says_so(run, tmp_path):
    (tmp_path / "a.rad").write_text("# nothing\n")
    assert "a.rad: holds no material" in run("inspect", "a.rad").err
