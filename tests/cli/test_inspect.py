import json

import gonio
import numpy as np
import pytest

from tests.cli.conftest import one_clear_error


@pytest.fixture
def raw(tmp_path):
    path = tmp_path / "sample.txt"
    scan = gonio.Scan(theta_i=30, phi_i=0, theta_s=[1, 2, 2], phi_s=[3, 40, 40], value=[1, np.nan, -3])
    gonio.Readings([scan]).save(path)
    return path


def test_inspect_shows_what_is_in_a_file(run, raw):
    done = run("inspect", raw)
    assert done.code == 0
    for text in ("gonio-raw", "theta_i 30", "3 readings", "1 negative", "1 no data", "1 repeated"):
        assert text in done.out
    assert "--beam or --standard" in done.err
    assert "--dark" in done.err


def test_inspect_does_not_ask_for_a_dark_that_is_among_the_files(run, raw, tmp_path):
    dark = gonio.Scan(theta_i=0, phi_i=0, theta_s=[0, 0], phi_s=[0, 0], value=[1, 2], kind="dark")
    gonio.Readings([dark]).save(tmp_path / "dark.txt")
    assert "--dark" not in run("inspect", raw, tmp_path / "dark.txt").err


def test_inspect_json_is_one_object_and_nothing_else(run, raw):
    done = run("inspect", "--json", raw)
    assert done.code == 0
    found = json.loads(done.out)
    assert found["readings"] == 3
    assert found["incidences"] == [[30.0, 0.0]]
    assert found["files"][0]["format"] == "gonio-raw"
    assert len(found["files"][0]["sha256"]) == 64


def test_the_version_is_printed(run_apart):
    assert run_apart("--version").out.strip() == f"gonio {gonio.__version__}"


def test_debug_shows_the_traceback(run, tmp_path):
    done = run("inspect", "--debug", tmp_path / "none")
    assert done.code == 2
    assert "Traceback" in done.err


def test_a_missing_file_and_a_directory_are_one_clear_error(run, tmp_path):
    one_clear_error(run("inspect", tmp_path / "none.txt"), "none.txt", "No such file")
    one_clear_error(run("inspect", tmp_path), tmp_path, "directory")
