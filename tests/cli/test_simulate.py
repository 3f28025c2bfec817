import json
import re

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
