import json

import gonio
import pytest

from tests.cli.conftest import listing, one_clear_error


@pytest.fixture
def measured(campaign, tmp_path):
    gonio.process(
        campaign / "sample.txt", beam=campaign / "beam.txt", dark=campaign / "dark.txt", out=tmp_path / "m"
    )
    return tmp_path / "m"


def test_check_prints_a_sentence_a_check(run, measured):
    done = run("check", measured)
    assert done.code == 0, done
    assert "pass" in done.out


def test_json_carries_every_field(run, measured):
    found = json.loads(run("check", "--json", measured).out)
    assert {"id", "title", "verdict", "value", "unit", "sentence"} == set(found["verdicts"][0])


def test_a_saved_measurement_gives_the_verdicts_it_gave_in_memory(campaign, tmp_path):
    measurement = gonio.process(
        campaign / "sample.txt", beam=campaign / "beam.txt", dark=campaign / "dark.txt", out=tmp_path / "m"
    )
    in_memory = [(v.id, v.verdict) for v in gonio.check(measurement)]
    assert [(v.id, v.verdict) for v in gonio.check(tmp_path / "m")] == in_memory


def test_a_measurement_that_creates_energy_fails_with_exit_code_1(run, campaign, tmp_path):
    sample = gonio.read(campaign / "sample.txt")[0]
    bright = gonio.Scan(
        quantity="bsdf",
        theta_i=30,
        phi_i=0,
        theta_s=sample.theta_s,
        phi_s=sample.phi_s,
        value=[0.6] * len(sample),
    )
    gonio.process([bright], out=tmp_path / "bright")
    done = run("check", tmp_path / "bright")
    assert done.code == 1
    assert "fail" in done.out


def test_repeats_add_the_repeatability(run, measured):
    done = run("check", measured, "--repeat", measured, "--json")
    assert "repeatability" in [v["id"] for v in json.loads(done.out)["verdicts"]]


def test_report_writes_one_file_that_needs_no_network(run, measured, tmp_path):
    done = run("report", measured, "-o", "r.html", "--json")
    assert done.code == 0, done.err
    assert json.loads(done.out)["bytes"] == (tmp_path / "r.html").stat().st_size
    page = (tmp_path / "r.html").read_text()
    assert "half white" in page
    assert 'src="http' not in page


@pytest.mark.parametrize("verb", ["check", "report"])
def test_what_is_no_measurement_is_one_clear_error(run, tmp_path, verb, measured):
    one_clear_error(run(verb, tmp_path / "none"), "none", "No such file")
    (measured / "measurement.json").write_text("{")
    one_clear_error(run(verb, measured), "measurement.json", "JSON")
    assert listing(tmp_path) == ["m"]
