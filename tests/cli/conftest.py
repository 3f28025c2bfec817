"""Small real files and the installed command."""

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import gonio
import numpy as np
import pytest
from gonio.cli import main


@dataclass
class Result:
    code: int
    out: str
    err: str


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    """The command inside this process: exit code and streams are what a user gets."""

    def call(*arguments):
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", ["gonio", *map(str, arguments)])
        capsys.readouterr()
        with pytest.raises(SystemExit) as ended:
            main()
        return Result(int(ended.value.code or 0), *capsys.readouterr())

    return call


@pytest.fixture
def run_apart(tmp_path):
    """The command in a process of its own, under limits of the operating system."""

    def call(*arguments, limits=None):
        command = [sys.executable, "-m", "gonio", *map(str, arguments)]
        done = subprocess.run(
            command,
            check=False,
            cwd=tmp_path,
            capture_output=True,
            text=True,
            preexec_fn=limits,
            timeout=300,
        )
        return Result(done.returncode, done.stdout, done.stderr)

    return call


def one_clear_error(result: Result, *names: object) -> None:
    """Exit code 2, nothing on stdout, one line on stderr that names what it must."""
    assert result.code == 2, result
    assert result.out == ""
    lines = [line for line in result.err.splitlines() if line]
    assert len(lines) == 1, result.err
    assert lines[0].startswith("gonio: ")
    for name in names:
        assert str(name) in lines[0]


def listing(directory: Path) -> list[str]:
    return sorted(p.name for p in directory.iterdir())


@pytest.fixture(scope="session")
def campaign(tmp_path_factory):
    """A small campaign of a Lambertian sample of reflectance 0.5: sample.txt, beam.txt, dark.txt."""
    directory = tmp_path_factory.mktemp("campaign")
    step = np.radians(0.1)
    y, x = np.mgrid[-10:11, -10:11] * step
    gamma, azimuth = np.hypot(x, y), np.arctan2(y, x)
    width = np.radians(0.3)
    beam = np.exp(-((gamma / width) ** 2)) / (np.pi * width**2)
    theta, phi = (a.ravel() for a in np.meshgrid(np.arange(2.5, 90, 5), np.arange(0, 360, 10)))
    told = {"theta_i": 30.0, "phi_i": 0.0, "channel": "photopic"}
    meta = {"sample_name": "half white", "noise_readout": 1e-6, "noise_relative": 1e-4}
    lambertian = 0.5 * np.cos(np.radians(theta)) / np.pi
    scans = {
        "sample": gonio.Scan(theta_s=theta, phi_s=phi, value=lambertian + 0.01, meta=meta, **told),
        "beam": gonio.Scan(
            kind="beam",
            theta_s=180 - np.degrees(gamma).ravel(),
            phi_s=np.degrees(azimuth).ravel(),
            value=beam.ravel() + 0.01,
            meta=meta,
            **{**told, "theta_i": 0.0},
        ),
        "dark": gonio.Scan(
            kind="dark", theta_s=np.zeros(50), phi_s=np.zeros(50), value=np.full(50, 0.01), meta=meta, **told
        ),
    }
    for name, scan in scans.items():
        gonio.Readings([scan]).save(directory / f"{name}.txt")
    return directory


@pytest.fixture
def process(run, run_apart, campaign, tmp_path):
    """`gonio process` of the campaign into tmp_path/out, with files replaced by keyword."""

    def call(*options, limits=None, **files):
        path = {name: files.get(name, campaign / f"{name}.txt") for name in ("sample", "beam", "dark")}
        chosen = [o for name in ("beam", "dark") if path[name] for o in (f"--{name}", path[name])]
        arguments = ["process", path["sample"], *chosen, "-o", tmp_path / "out", *options]
        return run_apart(*arguments, limits=limits) if limits else run(*arguments)

    return call
