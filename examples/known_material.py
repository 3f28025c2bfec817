"""Measure a known material with the virtual goniophotometer and see whether the result keeps its word.

Replace `campaign.sample`, `campaign.beam` and `campaign.dark` by your own files to process a real recording.
"""

import tempfile
from pathlib import Path

import gonio
from gonio.truth import compare

with tempfile.TemporaryDirectory() as directory:
    campaign = gonio.simulate(
        material="metal",
        seed=7,
        incidences=[(15.0, 0.0), (60.0, 0.0)],
        out=Path(directory) / "raw",
    )
    measurement = gonio.process(campaign.sample, beam=campaign.beam, dark=campaign.dark)
    for integral in compare(measurement, material=campaign.material).integrals:
        print(
            f"{integral.name} at {integral.theta_i:.0f} degrees: {integral.value:.4f}, "
            f"truth {integral.truth:.4f}, error {100 * integral.error:+.2f} %, "
            f"claimed ± {100 * integral.expanded:.2f} %"
        )
