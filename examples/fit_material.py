"""Measure a known plastic with the virtual goniophotometer, fit it, and write it as a Radiance material.

Replace the simulation by `gonio.process` of your own files, or by the directory of a saved measurement.
"""

import tempfile
from pathlib import Path

import gonio
from gonio.fit_outputs import save_fit

with tempfile.TemporaryDirectory() as directory:
    campaign = gonio.simulate(
        material="plastic",
        seed=3,
        incidences=[(10.0, 0.0), (35.0, 0.0), (60.0, 0.0)],
        instrument={"pitch_across": 8.0, "pitch_along": 2.0, "patch_pitch": 1.0},
        out=Path(directory) / "raw",
    )
    measurement = gonio.process(campaign.sample, beam=campaign.beam, dark=campaign.dark)

    found = gonio.fit(measurement, models=["lambert", "plastic", "abg"])
    if found.ranking is not None:
        print(found.ranking.sentence)
    for e in found.estimates:
        print(f"{e.label} = {e.value:.4f}, 95 % in {e.low:.4f} to {e.high:.4f}")

    saved = save_fit(found, out=Path(directory) / "fit", measurement=measurement, colour=(0.8, 0.4, 0.2))
    print((saved.out / "material.rad").read_text())
