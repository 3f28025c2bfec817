"""`gonio render`."""

import json
import math

import pytest

from tests.cli.conftest import one_clear_error

QUICK = ("--size", 24, "--samples", 32)


def test_a_preview_is_written_and_summed_up(run, tmp_path):
    done = run("render", "--preview", "metal", "-o", "ball.png", *QUICK)
    assert done.code == 0
    assert "24 x 24 pixels" in done.out
    assert (tmp_path / "ball.png").read_bytes().startswith(b"\x89PNG")
    done = run("render", "--preview", "metal", "-o", "ball.exr", "--json", *QUICK)
    found = json.loads(done.out)
    assert found["out"] == "ball.exr"
    assert 0.0 < found["relative_error"] < 1.0
    assert (tmp_path / "ball.exr").read_bytes().startswith(b"\x76\x2f\x31\x01")


def test_what_cannot_be_shown_is_one_line(run, tmp_path):
    one_clear_error(run("render", "--preview", "nowhere.xml", "-o", "a.png", *QUICK), "nowhere.xml", "metal")
    one_clear_error(run("render", "--preview", "metal", "-o", "a.bmp", *QUICK), ".bmp", ".png")
    one_clear_error(run("render", "--preview", "metal", "-o", "a.png", "--size", 0), "size")
    one_clear_error(run("render", "--preview", "metal", "-o", "no/a.png", *QUICK), "no/a.png")
    one_clear_error(run("render", "-o", "a.png"), "--view", "--sensors", "--preview")
    one_clear_error(run("render", "--preview", "metal"), "--out")
    (tmp_path / "bad.rad").write_text("void plastic p 0 0 2 1 1\n")
    one_clear_error(run("render", "--preview", "bad.rad", "-o", "a.png", *QUICK), "bad.rad")
    assert not list(tmp_path.glob("*.png"))


SCENE = """void light lamp 0 0 3 10 10 10
lamp polygon window
0 0 12 -.5 -.5 .8  -.5 .5 .8  .5 .5 .8  .5 -.5 .8
void plastic grey 0 0 5 .5 .5 .5 0 0
grey polygon floor
0 0 12 -4 -4 0  4 -4 0  4 4 0  -4 4 0
"""


def scene_of(folder):
    (folder / "room.rad").write_text(SCENE)
    (folder / "room.vf").write_text("rvu -vtv -vp 0 -3 .5 -vd 0 1 -.1 -vu 0 0 1 -vh 50 -vv 30\n")
    (folder / "points.txt").write_text("0 0 0.001 0 0 1\n\n0 0 0.001 0 0 -2\n")


def test_sensors_of_a_scene_are_printed_as_rtrace_prints_them(run, tmp_path):
    scene_of(tmp_path)
    done = run("render", "room.rad", "--sensors", "points.txt", "--bounces", 1, "--relative-error", 0.002)
    assert done.code == 0
    rows = [[float(word) for word in line.split()] for line in done.out.splitlines()]
    side = 0.5 / 0.799 / math.hypot(1.0, 0.5 / 0.799)
    wanted = 10.0 * 4.0 * side * math.atan(side)
    assert rows[0] == pytest.approx([wanted] * 3, rel=0.008)
    assert rows[1] == [0.0, 0.0, 0.0]
    done = run("render", "room.rad", "--sensors", "points.txt", "--bounces", 1, "--lux", "-o", "lux.txt")
    assert done.code == 0
    lux, error = map(float, (tmp_path / "lux.txt").read_text().splitlines()[0].split())
    assert lux == pytest.approx(179.0 * wanted, abs=4.0 * error)
    assert 0.0 < error < 0.01 * lux


def test_a_picture_of_a_scene_shows_its_floor(run, tmp_path):
    scene_of(tmp_path)
    options = ("--view", "room.vf", "--size", 60, "--samples", 64)
    done = run("render", "room.rad", *options, "-o", "room.hdr")
    assert done.code == 0
    assert "60 x 34 pixels" in done.out
    assert (tmp_path / "room.hdr").read_bytes().startswith(b"#?RADIANCE\n")
    first = json.loads(run("render", "room.rad", *options, "-o", "a.exr", "--resume", "--json").out)
    more = ("--view", "room.vf", "--size", 60, "--samples", 256)
    grown = json.loads(run("render", "room.rad", *more, "-o", "a.exr", "--resume", "--json").out)
    at_once = json.loads(run("render", "room.rad", *more, "-o", "b.exr", "--json").out)
    assert grown["mean_luminance"] == at_once["mean_luminance"] != first["mean_luminance"]
    assert grown["samples"] == 256
    assert not (tmp_path / "b.exr.samples.npz").exists()


def test_a_scene_without_light_is_said_to_be_dark(run, tmp_path):
    (tmp_path / "dark.rad").write_text("void plastic" + SCENE.split("void plastic")[1])
    (tmp_path / "points.txt").write_text("0 0 0.001 0 0 1\n")
    done = run("render", "dark.rad", "--sensors", "points.txt")
    assert done.code == 0
    assert "no light" in done.err
    (tmp_path / "night.rad").write_text(
        "!gendaylit 6 21 0 -W 0 0\nskyfunc glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n"
    )
    assert "no light" in run("render", "night.rad", "dark.rad", "--sensors", "points.txt").err
    scene_of(tmp_path)
    assert "no light" not in run("render", "room.rad", "--sensors", "points.txt", "--bounces", 1).err


def test_false_colours_lie_between_the_ends_that_are_given(run, tmp_path):
    scene_of(tmp_path)
    options = ("--view", "room.vf", "--size", 24, "--samples", 16)
    assert run("render", "room.rad", *options, "-o", "a.png").code == 0
    assert run("render", "room.rad", *options, "-o", "b.png", "--colours", "1,1e5").code == 0
    assert (tmp_path / "a.png").read_bytes() != (tmp_path / "b.png").read_bytes()


def test_what_cannot_be_rendered_is_one_line(run, tmp_path):
    scene_of(tmp_path)
    picture = ("render", "room.rad", "--view", "room.vf", "-o", "a.hdr")
    one_clear_error(run(*picture, "--size", "0x5"), "size")
    one_clear_error(run(*picture, "--size", "wide"), "--size", "wide")
    one_clear_error(run(*picture, "--samples", 0), "samples")
    one_clear_error(run("render", "no.rad", "--view", "room.vf", "-o", "a.hdr"), "no.rad")
    one_clear_error(run("render", "room.rad", "--view", "no.vf", "-o", "a.hdr"), "no.vf")
    one_clear_error(run("render", "room.rad", "--view", "-vtq", "-o", "a.hdr"), "-vt")
    one_clear_error(run("render", "room.rad", "--sensors", "no.txt"), "no.txt")
    (tmp_path / "bad.txt").write_text("0 0 0 0 0 1\n1 2 3\n")
    one_clear_error(run("render", "room.rad", "--sensors", "bad.txt"), "bad.txt:2")
    (tmp_path / "flat.txt").write_text("0 0 0 0 0 0\n")
    one_clear_error(run("render", "room.rad", "--sensors", "flat.txt"), "flat.txt:1", "normal")
    one_clear_error(run("render", "room.rad", "--sensors", "points.txt", "-o", "a.png"), ".png", "text")
    one_clear_error(run("render", "room.rad", "-o", "a.hdr"), "--view", "names none")
    one_clear_error(run(*picture, "--colours", "1,10"), "--colours", ".png")
    one_clear_error(run(*picture[:-1], "a.png", "--colours", "10,1"), "--colours", "LOW < HIGH")
    (tmp_path / "blind.rad").write_text("<?xml version='1.0'?>\n<WindowElement/>\n")
    one_clear_error(run("render", "blind.rad", "--view", "room.vf", "-o", "a.hdr"), "XML", "--preview")
    (tmp_path / "old.rad").write_text("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n")
    one_clear_error(run("render", "old.rad", "--view", "room.vf", "-o", "a.hdr"), "a picture")
    (tmp_path / "bad.rad").write_text("void light lamp 0 0 3 1 1\n")
    one_clear_error(run("render", "bad.rad", "--sensors", "points.txt"), "bad.rad")
    one_clear_error(run("render", "--view", "room.vf", "-o", "a.hdr"), "SCENE")
    assert not (tmp_path / "a.hdr").exists()
