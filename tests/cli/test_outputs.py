"""Where results go: devices stay, nothing is left of what failed, messages name what the user named."""

import os
import resource
import stat
import subprocess
import sys

import gonio
import pytest

from tests.cli.conftest import listing, one_clear_error
from tests.cli.test_build import lambertian


@pytest.fixture
def measured(tmp_path):
    gonio.process([lambertian(t) for t in (0, 20, 40, 60, 80)], out=tmp_path / "m")
    return tmp_path / "m"


@pytest.mark.parametrize(
    "verb",
    [
        ["report"],
        *(["export", "--to", to] for to in ("csv", "parquet", "netcdf", "radiance-klems")),
    ],
    ids=lambda verb: verb[-1],
)
def test_a_pipe_or_device_is_not_replaced_by_a_file(run, measured, tmp_path, verb):
    os.mkfifo(tmp_path / "pipe")
    one_clear_error(run(verb[0], measured, *verb[1:], "-o", tmp_path / "pipe"), "pipe", "a file is needed")
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)
    assert listing(tmp_path) == ["m", "pipe"]


def test_a_link_stays_and_the_file_it_names_is_replaced(run, measured, tmp_path):
    (tmp_path / "real.csv").write_text("old")
    (tmp_path / "link.csv").symlink_to("real.csv")
    assert run("export", measured, "--to", "csv", "-o", "link.csv").code == 0
    assert (tmp_path / "link.csv").is_symlink()
    assert (tmp_path / "real.csv").read_text().startswith('"slice"')


@pytest.mark.parametrize("to", ["netcdf", "csv", "parquet", "radiance-klems"])
def test_an_export_to_a_full_disk_is_one_clear_error_and_leaves_nothing(run_apart, measured, tmp_path, to):
    def few_bytes():
        resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))

    done = run_apart("export", measured, "--to", to, "-o", "out.file", limits=few_bytes)
    one_clear_error(done, "out.file", "File too large")
    assert ".part" not in done.err
    assert "errno" not in done.err
    assert listing(tmp_path) == ["m"]


@pytest.mark.parametrize("netcdf", ["none/x.nc", "."])
def test_a_netcdf_that_cannot_be_written_is_told_before_the_work(process, tmp_path, netcdf):
    one_clear_error(process("--netcdf", tmp_path / netcdf))
    assert listing(tmp_path) == []


def test_the_netcdf_may_lie_in_the_new_directory(process, tmp_path):
    assert process("--netcdf", tmp_path / "out" / "x.nc").code == 0
    assert "x.nc" in listing(tmp_path / "out")


@pytest.mark.parametrize("options", [[], ["--json"]])
def test_a_full_standard_output_is_named(measured, tmp_path, options):
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "gonio", "check", measured, *options],
            check=False,
            cwd=tmp_path,
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
        )
    assert done.returncode == 2
    assert done.stderr.strip() == "gonio: standard output: No space left on device"


def test_what_is_no_measurement_directory_is_told(run, tmp_path):
    (tmp_path / "empty").mkdir()
    (tmp_path / "file.txt").touch()
    one_clear_error(run("check", "empty"), "gonio: empty: is no measurement directory")
    one_clear_error(run("check", "file.txt"), "gonio: file.txt: is a file")
    one_clear_error(run("check", "none"), "gonio: none: No such file")


INTERRUPTED = """
import sys
import gonio
from gonio.cli import main

def interrupted(*args, **kwargs):
    raise KeyboardInterrupt

gonio.demonstrating.build = interrupted
sys.argv = ["gonio", "demo", "--material", "lambert", "-o", "a/b"]
main()
"""


def test_an_interrupted_demo_leaves_nothing_or_tells_what_it_left(tmp_path):
    def call():
        command = [sys.executable, "-c", INTERRUPTED]
        return subprocess.run(command, check=False, cwd=tmp_path, capture_output=True, text=True)

    done = call()
    assert (done.returncode, done.stderr.strip()) == (130, "gonio: interrupted, nothing was written")
    assert listing(tmp_path) == []
    (tmp_path / "a" / "b").mkdir(parents=True)
    done = call()
    assert (done.returncode, done.stderr.strip()) == (
        130,
        "gonio: interrupted, a/b may hold files of this run beside older ones",
    )
    assert "raw" in listing(tmp_path / "a" / "b")
