"""Every kind of broken input: one clear line, exit code 2, nothing left behind."""

import os
import resource
import signal
import subprocess
import sys
import time

import gonio
import numpy as np
import pytest

from tests.cli.conftest import listing, one_clear_error


def lines_of(path):
    return path.read_text().splitlines()


def first_reading(lines):
    return next(k for k, line in enumerate(lines) if line and not line.startswith("#"))


def replaced(lines, k, text):
    return [*lines[:k], text, *lines[k + 1 :]]


def cut_inside_the_header(lines):
    return lines[: first_reading(lines)]


def cut_inside_a_row(lines):
    return [*lines[:-1], lines[-1].split()[0]]


def fewer_rows_than_stated(lines):
    return lines[:-20]


def text_for_a_number(lines):
    return replaced(lines, first_reading(lines) + 2, "10 20 bright")


def one_column_too_many(lines):
    return replaced(lines, first_reading(lines) + 2, "10 20 1 2 3 4 5")


def theta_out_of_range(lines):
    return replaced(lines, first_reading(lines) + 2, "190 0 1")


def theta_not_a_number(lines):
    return replaced(lines, first_reading(lines) + 2, "nan 0 1")


@pytest.mark.parametrize(
    ("damage", "names_line"),
    [
        (cut_inside_the_header, False),
        (cut_inside_a_row, True),
        (fewer_rows_than_stated, False),
        (text_for_a_number, True),
        (one_column_too_many, True),
        (theta_out_of_range, True),
        (theta_not_a_number, True),
    ],
)
@pytest.mark.parametrize("verb", ["process", "inspect"])
def test_a_damaged_file_is_named_with_its_line(run, process, campaign, tmp_path, damage, names_line, verb):
    bad = tmp_path / "bad.txt"
    bad.write_text("\n".join(damage(lines_of(campaign / "sample.txt"))) + "\n")
    done = process(sample=bad) if verb == "process" else run("inspect", bad)
    one_clear_error(done, "bad.txt", *(["line"] if names_line else []), "found", "allowed")
    assert listing(tmp_path) == ["bad.txt"]


@pytest.mark.parametrize(
    "content",
    [b"", b"\x00" * 1000, b"\xff\xfe#\x00", os.urandom(4096), b"PAR1", b"hello world\n"],
    ids=["empty", "zeros", "utf-16", "random", "parquet magic", "prose"],
)
@pytest.mark.parametrize("name", ["bad.txt", "bad.parquet"])
def test_a_file_of_no_format_is_one_clear_error(process, tmp_path, content, name):
    (tmp_path / name).write_bytes(content)
    one_clear_error(process(sample=tmp_path / name), name, "found")
    assert listing(tmp_path) == [name]


def test_a_line_of_200_megabytes_is_one_clear_error(process, campaign, tmp_path):
    lines = lines_of(campaign / "sample.txt")
    head = "\n".join(lines[: first_reading(lines)]) + "\n"
    bad = tmp_path / "long.txt"
    with bad.open("wb") as file:
        file.write(head.encode())
        block = b"1" * 2**20
        for _ in range(200):
            file.write(block)
    done = process(sample=bad)
    one_clear_error(done, "long.txt", "line")
    assert len(done.err) < 600
    bad.unlink()


def test_a_directory_and_a_missing_file_are_one_clear_error(process, tmp_path):
    (tmp_path / "folder").mkdir()
    one_clear_error(process(sample=tmp_path / "folder"), "folder", "directory")
    one_clear_error(process(sample=tmp_path / "none.txt"), "none.txt", "No such file")
    one_clear_error(process(beam=tmp_path / "none.txt"), "none.txt", "No such file")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_a_file_without_permission_is_one_clear_error(process, tmp_path):
    (tmp_path / "secret.txt").touch(mode=0o000)
    one_clear_error(process(sample=tmp_path / "secret.txt"), "secret.txt", "ermission")


def scan(**changes):
    fields = {"theta_i": 30, "phi_i": 0, "theta_s": [10, 20, 30], "phi_s": [0, 0, 0], "value": [1, 2, 3]}
    return gonio.Scan(**{**fields, **changes})


def saved(path, *scans):
    gonio.Readings(scans).save(path)
    return path


def test_nan_readings_are_kept_as_no_data(process, campaign, tmp_path):
    sample = gonio.read(campaign / "sample.txt")[0]
    value = sample.value
    value[7] = np.nan
    hole = scan(theta_s=sample.theta_s, phi_s=sample.phi_s, value=value)
    assert process(sample=saved(tmp_path / "nan.parquet", hole)).code == 0
    flags = gonio.Measurement.load(tmp_path / "out").slices[0].flags
    assert np.flatnonzero(flags & gonio.FLAGS["no_data"]).tolist() == [7]


def test_repeated_directions_are_kept_and_flagged(process, campaign, tmp_path):
    sample = gonio.read(campaign / "sample.txt")[0]
    again = {
        name: np.append(getattr(sample, name), getattr(sample, name)[5])
        for name in ("theta_s", "phi_s", "value")
    }
    done = process(sample=saved(tmp_path / "twice.parquet", scan(**again)))
    assert done.code == 0, done.err
    measurement = gonio.Measurement.load(tmp_path / "out")
    flags = measurement.slices[0].flags
    assert np.flatnonzero(flags & gonio.FLAGS["repeated"]).tolist() == [5, len(flags) - 1]
    assert measurement.slices[0].integrals[0].value == pytest.approx(0.5, abs=0.005)


def test_a_scan_without_readings_is_named(process, tmp_path):
    empty = saved(tmp_path / "empty.parquet", scan(theta_s=[], phi_s=[], value=[]))
    one_clear_error(process(sample=empty), "empty.parquet")
    assert listing(tmp_path) == ["empty.parquet"]


def test_a_scan_of_nothing_but_nan_is_named(process, tmp_path):
    dead = saved(tmp_path / "dead.parquet", scan(value=[np.nan] * 3))
    one_clear_error(process(sample=dead), "dead.parquet")


def test_mixed_quantities_are_refused(process, tmp_path):
    mixed = saved(tmp_path / "mixed.parquet", scan(), scan(theta_i=40, quantity="bsdf"))
    one_clear_error(process(sample=mixed), "quantity", "signal", "bsdf")


def test_a_reference_scan_of_another_channel_is_refused(process, campaign, tmp_path):
    beam = gonio.read(campaign / "beam.txt")[0]
    red = gonio.Scan(
        kind="beam",
        channel="red",
        theta_i=0,
        phi_i=0,
        theta_s=beam.theta_s,
        phi_s=beam.phi_s,
        value=beam.value,
    )
    one_clear_error(
        process(beam=saved(tmp_path / "red.parquet", red), dark=None), "channel", "red", "photopic"
    )


def test_a_missing_reference_scan_is_named(process):
    one_clear_error(process(beam=None), "reference scan", "photopic")


def test_a_sample_in_place_of_the_beam_is_refused(process, campaign):
    one_clear_error(process(beam=campaign / "sample.txt"), "sample.txt", "kind", "beam")


@pytest.mark.parametrize(
    ("options", "name"),
    [
        (["--u-angle", "-1"], "u_angle"),
        (["--noise-readout", "nan"], "noise_readout"),
        (["--dark-method", "magic"], "magic"),
        (["--format", "word"], "word"),
        (["--quantity", "watts"], "watts"),
    ],
)
def test_an_option_out_of_range_is_named(process, tmp_path, options, name):
    one_clear_error(process(*options), name)
    assert listing(tmp_path) == []


def test_a_full_disk_is_one_clear_error_and_leaves_nothing(process, tmp_path):
    def few_bytes():
        resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))

    one_clear_error(process(limits=few_bytes), "out", "File too large")
    assert listing(tmp_path) == []


def test_an_older_result_survives_a_full_disk(process, tmp_path):
    assert process().code == 0
    before = (tmp_path / "out" / "measurement.json").read_bytes()

    def few_bytes():
        resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))

    one_clear_error(process(limits=few_bytes), "out", "File too large")
    assert (tmp_path / "out" / "measurement.json").read_bytes() == before
    assert listing(tmp_path) == ["out"]


def test_a_parent_that_does_not_exist_is_named(run, campaign, tmp_path):
    done = run("process", campaign / "sample.txt", "-o", tmp_path / "none" / "out")
    one_clear_error(done, "none")


def test_ctrl_c_exits_with_130_and_leaves_nothing(tmp_path):
    code = """
import signal, sys, time
import gonio
from gonio.cli import main

# A program started in the background ignores the signal, and so would this one.
signal.signal(signal.SIGINT, signal.default_int_handler)

def endless(*args, **kwargs):
    print("working", flush=True)
    time.sleep(60)

gonio._native.process = endless
sys.argv = ["gonio", "process", "sample.parquet", "-o", "out"]
main()
"""
    saved(tmp_path / "sample.parquet", scan(quantity="bsdf"))
    command = subprocess.Popen(
        [sys.executable, "-c", code], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert command.stdout.readline() == "working\n"
    time.sleep(0.2)
    command.send_signal(signal.SIGINT)
    _, err = command.communicate(timeout=30)
    assert command.returncode == 130
    assert err.strip() == "gonio: interrupted, nothing was written"
    assert listing(tmp_path) == ["sample.parquet"]
