import json
import re
from importlib.resources import files

import gonio
import pytest
from gonio.materials import MATERIALS
from gonio.simulating import INSTRUMENT

from tests.cli.conftest import listing, one_clear_error


def test_simulate_writes_raw_files_and_replaces_those_of_an_earlier_campaign(run, tmp_path):
    for theta in ("60,0", "30,0"):
        done = run("simulate", "-o", "camp", "--incidence", theta, "--component", "reflection", "--json")
        assert done.code == 0, done.err
    found = json.loads(done.out)
    assert found["readings"] > 1000
    assert listing(tmp_path / "camp") == [
        "beam.txt",
        "campaign.json",
        "dark.txt",
        "sample_theta030.0_phi000.0.txt",
    ]
    assert listing(tmp_path) == ["camp"]


@pytest.mark.parametrize(
    ("options", "name"),
    [
        (["--material", "cheese"], "cheese"),
        (["--seed", "-1"], "-1"),
        (["--incidence", "90,0"], "90"),
        (["--instrument", "warp=9"], "warp"),
    ],
)
def test_a_wrong_setting_is_named_and_nothing_is_written(run, tmp_path, options, name):
    one_clear_error(run("simulate", "-o", "camp", *options), name)
    assert listing(tmp_path) == []


def test_help_names_materials_and_every_setting_of_the_core(run, tmp_path):
    refused = run("simulate", "-o", "camp", "--instrument", "warp=9").err
    assert tuple(refused.split("allowed ")[1].strip().split(", ")) == INSTRUMENT
    words = re.sub(r"[\s│]+", "", run("simulate", "--help").out)
    for name in (*INSTRUMENT, *MATERIALS):
        assert name in words


@pytest.mark.parametrize("options", [["--incidence", "30"], ["--instrument", "power=much"]])
def test_a_malformed_option_is_a_usage_error(run, options):
    one_clear_error(run("simulate", "-o", "camp", *options), options[0], "found", "gonio simulate --help")


def test_the_back_scatters_as_the_front_does(tmp_path):
    front, back = (
        gonio.simulate(material="lambert", incidences=[(theta, 0)], out=tmp_path / str(theta))
        for theta in (30, 150)
    )
    (a,), (b,) = (
        gonio.process(c.sample, beam=c.beam, dark=c.dark).slices[0].integrals for c in (front, back)
    )
    assert (a.side, b.side) == ("front", "back")
    assert b.value == pytest.approx(a.value, abs=2 * (a.u + b.u))


def test_a_described_instrument_measures_and_its_path_is_written_and_drawn(run, tmp_path):
    done = run(
        "simulate", "-o", "camp", "--incidence", "30,0", "--instrument", "in-plane",
        "--path-table", "path.csv", "--plot-path", "path.png", "--json",
    )  # fmt: skip
    assert done.code == 0, done.err
    readings = json.loads(done.out)["readings"]
    rows = (tmp_path / "path.csv").read_text().splitlines()
    assert len(rows) == readings + 1
    assert (tmp_path / "path.png").read_bytes().startswith(b"\x89PNG")
    (scan,) = gonio.read(tmp_path / "camp" / "sample_theta030.0_phi000.0.txt")
    assert scan.channel == "550nm"
    assert set(scan.phi_s.round(6)) == {0.0, 180.0}
    # The written path is one that an instrument file takes.
    text = files("gonio").joinpath("presets", "in-plane.toml").read_text()
    (tmp_path / "again.toml").write_text(text.replace("planes = [0.0, 180.0]", "table = 'path.csv'"))
    again = run("simulate", "-o", "again", "--incidence", "30,0", "--instrument", "again.toml", "--json")
    assert again.code == 0, again.err
    assert json.loads(again.out)["readings"] == readings
    one_clear_error(
        run("simulate", "-o", "more", "--incidence", "40,0", "--instrument", "again.toml"),
        "incidences of the path's table",
    )


def test_instruments_are_listed_and_a_wrong_file_is_one_error(run, tmp_path):
    listed = run("simulate", "--list-instruments")
    assert listed.code == 0
    assert all(name in listed.out for name in ("pgII-like", "RT-300S-like", "in-plane"))
    (tmp_path / "bad.toml").write_text('format = "gonio-instrument 1"\ncolour = 1\n')
    one_clear_error(run("simulate", "-o", "camp", "--instrument", "bad.toml"), "bad.toml", "colour")
    one_clear_error(run("simulate", "-o", "camp", "--instrument", "pgIII"), "pgIII", "pgII-like")
    strict = ["--instrument", "in-plane", "--instrument", "overfill=0", "--incidence", "80,0"]
    one_clear_error(run("simulate", "-o", "camp", *strict), "overfill = true")
    assert listing(tmp_path) == ["bad.toml"]


PLATE = """void plastic grey
0
0
5 .4 .4 .4 0 0
grey polygon plate
0
0
12 0 0 0 1 0 0 1 1 0 0 1 0
"""


def test_the_bsdf_of_geometry_is_written_as_xml(run, tmp_path):
    (tmp_path / "plate.rad").write_text(PLATE)
    options = ["--geometry", "plate.rad", "--periodic", "--basis", "quarter", "--rays", "1024"]
    done = run("simulate", *options, "-o", "plate.xml", "--json")
    assert done.code == 0, done.err
    found = json.loads(done.out)
    assert found["rays"] == 1024
    assert found["albedo_normal"]["front reflection"] == pytest.approx(0.4, rel=0.1)
    model = gonio.read_bsdf(tmp_path / "plate.xml")
    assert model.albedo(side="front", component="reflection").mean() == pytest.approx(0.4, rel=0.05)


def test_the_bsdf_of_geometry_is_written_as_a_tensor_tree(run, tmp_path):
    (tmp_path / "plate.rad").write_text(PLATE)
    options = ["--geometry", "plate.rad", "--periodic", "--basis", "ttree4", "--levels", "3", "--rays", "256"]
    done = run("simulate", *options, "-o", "plate.xml")
    assert done.code == 0, done.err
    assert "cells in all" in done.out
    assert "front reflection: albedo 0.4" in done.out or "front reflection: albedo 0.39" in done.out
    assert "TensorTree4" in (tmp_path / "plate.xml").read_text()
    assert gonio.read_bsdf(tmp_path / "plate.xml").rank == 4


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--window", "0,0,3,3"], "window: found 0 0 3 3"),
        (["--basis", "ttree4", "--levels", "9"], "levels: found 9"),
        (["--window", "here"], "--window"),
        (["--basis", "third"], "basis: found third"),
    ],
)
def test_a_wrong_setting_of_geometry_is_named(run, tmp_path, options, words):
    (tmp_path / "plate.rad").write_text(PLATE)
    one_clear_error(run("simulate", "--geometry", "plate.rad", "-o", "plate.xml", *options), words)
    assert listing(tmp_path) == ["plate.rad"]
