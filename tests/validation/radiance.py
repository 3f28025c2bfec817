"""RADIANCE as the oracle: its programs and its BSDF library, from the pyradiance wheel."""

import os
import subprocess
from pathlib import Path

import numpy as np

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


LAMBERT = {"model": "lambert", "rho": 0.3}
MODELS = {
    "isotropic": [
        LAMBERT,
        {"model": "ward-gmd-anisotropic", "rho": 0.2, "alpha_x": 0.15, "alpha_y": 0.15, "phi_x": 0.0},
    ],
    "anisotropic": [
        LAMBERT,
        {"model": "ward-gmd-anisotropic", "rho": 0.25, "alpha_x": 0.1, "alpha_y": 0.3, "phi_x": 20.0},
    ],
    "transmitting": [
        {"model": "lambert", "rho": 0.3},
        {"model": "bounded-transmission-lobe", "tau": 0.4, "alpha": 0.2},
    ],
}
FILES = [
    "lbnl-wincalc/2011-SA1.XML",
    "lbnl-afc-shades/e-screen-5pct-white.xml",
    "nist-ptfe-mountain/oracle_radiance_ptfe532_klems.xml",
    "nist-ptfe-mountain/oracle_radiance_ptfe532_t3.xml",
]


def pairs(n, seed):
    """n pairs of directions uniform in projected solid angle on both sides, degrees."""
    rng = np.random.default_rng(seed)
    theta = np.degrees(np.arcsin(np.sqrt(rng.random((2, n)))))
    theta = np.where(rng.random((2, n)) < 0.5, theta, 180 - theta)
    phi = rng.uniform(0, 360, (2, n))
    return theta[0], phi[0], theta[1], phi[1]


def differences(radiance, path, model, seed=1, n=4000):
    """Relative differences from RADIANCE over random pairs of both sides, and our values."""
    handle = radiance.load(path)
    ti, pi, ts, ps = pairs(n, seed)
    ours = model.eval(theta_i=ti, phi_i=pi, theta_s=ts, phi_s=ps)
    theirs = np.array([radiance.query(handle, *row) for row in zip(ti, pi, ts, ps, strict=True)])
    if np.any((ours > 0) != (theirs > 0)):
        raise AssertionError("one scatters where the other does not")
    lit = ours > 0
    return np.abs(ours[lit] / theirs[lit] - 1), ours[lit]
