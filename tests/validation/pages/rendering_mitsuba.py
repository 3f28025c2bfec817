"""Pictures beside those of Mitsuba 3."""

from __future__ import annotations

import numpy as np

from ..mitsuba_pictures import BOUNCES, TWINS, agreement, pictures, ready
from . import Skipped, table

SIZE, SAMPLES, RUNS = 64, 128, 32

TEXT = """# Pictures: Mitsuba 3

Made by `python -m tests.validation rendering-mitsuba`; `tests/validation/test_rendering_mitsuba.py` repeats it with smaller pictures.
{size} x {size} pixels, {runs} seeds of {samples} paths a pixel in each program ({total} million paths a picture), Mitsuba {version}
(llvm_ad_rgb, `path`, independent sampler, box filter), paths of at most {bounces} surfaces. Patches of 2 x 2 pixels are compared (rare
bright paths make the noise of a single pixel skewed). The error of a patch is the scatter over the seeds, of both; the difference of the means
over its error is Student's t, `z` its normal score. Where both follow the same light, `z` is standard normal: mean 0, variance 1, 0.27 %
beyond 3.

{table}
`mean z` is the difference averaged over the patches, each over its error, and `z of the picture` of the two means: both over their own
scatter from seed to seed. `p` is that of Kolmogorov and Smirnov.

Pixels of gonio share paths within tiles of 64, so that their errors go together; `noise` is gonio's error over Mitsuba's, median of the
pixels. Where it is small, `z` tests the light against independent pixels.

## What is brought together
- Mitsuba masks reflection by GGX with `G1 G1`; gonio has the height-correlated form. In the test Mitsuba's surfaces get gonio's by a plugin that multiplies
  by the ratio of the two, coded a second time ([microfacet](microfacet.md)).
- The sky of Mitsuba is a picture of 1024 rows, gonio's a formula. Patches whose error is below 1e-4 (the sky itself) are left out: there, the steps of
  that picture and single precision are larger.
- Mitsuba counts thin panes among the surfaces of a path, gonio does not: paths are long enough that it does not matter.
- RGL materials are left out: the tables are not reciprocal, Mitsuba asks them from the eye, gonio from the light.
"""


def make() -> str:
    """The page."""
    try:
        mitsuba = ready()
    except ImportError as e:
        raise Skipped("mitsuba has no wheel for this platform") from e
    if mitsuba is None:
        raise Skipped("Mitsuba needs LLVM from 19 on (DRJIT_LIBLLVM_PATH)")
    rows = []
    for twin in TWINS:
        ours, theirs = pictures(mitsuba, twin, size=SIZE, samples=SAMPLES, runs=RUNS)
        found = agreement(ours, theirs)
        noisy = theirs.std(axis=0) > 0.0
        noise = np.median(ours.std(axis=0)[noisy] / theirs.std(axis=0)[noisy])
        n = len(found.z)
        rows.append(
            [
                twin.title,
                f"{found.means[0]:.5f}",
                f"{found.means[1]:.5f}",
                f"{found.mean_z:+.2f}",
                str(n),
                f"{found.even_z:+.2f}",
                f"{found.z.var():.3f}",
                f"{100.0 * found.beyond_3:.2f} %",
                f"{found.kolmogorov:.2g}",
                f"{noise:.2f}",
            ]
        )
    head = ["scene", "mean, gonio", "mean, Mitsuba", "z of the picture", "patches with noise"]
    head += ["mean z", "variance", "beyond 3", "p", "noise"]
    return TEXT.format(
        size=SIZE,
        runs=RUNS,
        samples=SAMPLES,
        total=round(SIZE * SIZE * RUNS * SAMPLES / 1e6),
        version=mitsuba.__version__,
        bounces=BOUNCES,
        table=table(head, rows),
    )
