"""RADIANCE as the oracle: its programs and its BSDF library, from the pyradiance wheel."""

import os
import subprocess
from pathlib import Path

import pytest

HANDLES = []  # dropping a handle while others are in use crashes pyradiance


class Radiance:
    """The programs of the wheel and its BSDF query."""

    def __init__(self, package):
        self.root = Path(package.__file__).parent
        self.bsdf = package.bsdf

    def load(self, path):
        handle = self.bsdf.load_file(str(path))
        HANDLES.append(handle)
        return handle

    def query(self, handle, theta_i, phi_i, theta_s, phi_s):
        """Value at incidence i and exit s, degrees."""
        return self.bsdf.query(handle, theta_i, phi_i, theta_s, phi_s)[1]

    def run(self, *command, cwd, stdin=None):
        """Standard output of a program of the wheel."""
        environment = {
            **os.environ,
            "PATH": f"{self.root / 'bin'}:{os.environ['PATH']}",
            "RAYPATH": f".:{self.root / 'lib'}",
        }
        done = subprocess.run(command, cwd=cwd, env=environment, input=stdin, capture_output=True, check=True)
        return done.stdout


@pytest.fixture(scope="session")
def radiance():
    package = pytest.importorskip("pyradiance", reason="pyradiance has no wheel for this platform")
    return Radiance(package)


@pytest.fixture(scope="session")
def shared():
    """Folder of real measurements."""
    root = os.environ.get("GONIO_SHARED_DATA")
    path = Path(root) if root else Path(__file__).parents[3] / "shared" / "data"
    if not path.is_dir():
        pytest.skip("the real measurements are not on this machine")
    return path
