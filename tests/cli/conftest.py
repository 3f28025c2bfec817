"""Small real files and the installed command."""

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest


@dataclass
class Result:
    code: int
    out: str
    err: str


@pytest.fixture
def run(tmp_path):
    """The command in a process of its own: exit code and streams are what a user gets."""

    def call(*arguments, cwd=tmp_path, limits=None):
        command = [sys.executable, "-c", "from gonio.cli import main; main()", *map(str, arguments)]
        done = subprocess.run(
            command, check=False, cwd=cwd, capture_output=True, text=True, preexec_fn=limits, timeout=300
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
