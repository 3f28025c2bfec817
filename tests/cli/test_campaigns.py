"""Scans that do not belong together are refused or noted."""

import gonio
import pytest

from tests.cli.conftest import listing, one_clear_error
from tests.cli.test_build import lambertian


def renamed(scan, name, **changes):
    fields = {
        "theta_i": scan.theta_i,
        "phi_i": scan.phi_i,
        "quantity": scan.quantity,
        "channel": scan.channel,
        "theta_s": scan.theta_s,
        "phi_s": scan.phi_s,
        "value": scan.value,
        "meta": {"sample_name": name} if name else None,
    }
    return gonio.Scan(**{**fields, **changes})


def saved(path, scan):
    gonio.Readings([scan]).save(path)
    return path


@pytest.fixture
def two_samples(tmp_path):
    return [
        saved(tmp_path / "a.txt", renamed(lambertian(20), "ptfe")),
        saved(tmp_path / "b.txt", renamed(lambertian(40), "spectralon")),
    ]


def test_files_that_name_different_samples_are_refused(run, two_samples, tmp_path):
    one_clear_error(run("process", *two_samples, "-o", "m"), "ptfe", "a.txt", "spectralon", "b.txt", "--name")
    assert listing(tmp_path) == ["a.txt", "b.txt"]


def test_a_given_name_joins_them(run, two_samples, tmp_path):
    assert run("process", *two_samples, "-o", "m", "--name", "white").code == 0
    assert gonio.Measurement.load(tmp_path / "m").sample_name == "white"


def test_a_given_name_names_a_sample_that_has_none(tmp_path):
    measurement = gonio.process([lambertian(20)], name="tile", out=tmp_path / "m")
    assert measurement.sample_name == "tile"
    assert gonio.Measurement.load(tmp_path / "m").sample_name == "tile"
    assert gonio.process([lambertian(20)]).sample_name is None


def test_the_same_incidence_twice_is_a_warning_that_names_the_files(run, tmp_path):
    files = [saved(tmp_path / f"{k}.txt", renamed(lambertian(20), "tile")) for k in "ab"]
    done = run("process", *files, "-o", "m")
    assert done.code == 0
    assert "scanned more than once" in done.err
    assert "a.txt" in done.err
    assert "b.txt" in done.err
    assert any("scanned more than once" in w for w in gonio.Measurement.load(tmp_path / "m").warnings)


def test_many_repeated_incidences_are_one_warning():
    (warning,) = gonio.process([lambertian(t) for t in (20, 40, 60, 20, 40)]).warnings
    assert "2 of 3 incidences" in warning


def test_two_sides_channels_or_incidences_are_no_repetition():
    front = lambertian(20)
    back = renamed(front, None, theta_s=180 - front.theta_s)
    red = renamed(front, None, channel="red")
    turned = renamed(front, None, phi_i=90.0)
    assert gonio.process([front, back, red, turned]).warnings == []


def test_azimuths_of_normal_incidence_are_one_incidence():
    (warning,) = gonio.process([lambertian(0), renamed(lambertian(0), None, phi_i=90.0)]).warnings
    assert "scanned more than once" in warning


def test_a_reference_scan_of_finished_values_is_noted(campaign):
    (warning,) = gonio.process([lambertian(20)], beam=campaign / "beam.txt").warnings
    assert "beam.txt" in warning
    assert "not divided" in warning


def test_a_missing_reference_scan_names_the_file_and_the_option(process):
    one_clear_error(process(beam=None), "sample.txt", "--beam")


def test_a_reference_scan_of_another_channel_names_both_files(process, campaign, tmp_path):
    (beam,) = gonio.read(campaign / "beam.txt")
    fields = {n: getattr(beam, n) for n in ("kind", "theta_i", "phi_i", "theta_s", "phi_s", "value")}
    red = saved(tmp_path / "red.txt", gonio.Scan(channel="red", **fields))
    one_clear_error(process(beam=red), "sample.txt", "photopic", "red (", "red.txt")
