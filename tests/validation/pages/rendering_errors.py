"""Stated and true errors of pictures and sensors."""

from __future__ import annotations

from collections.abc import Callable

from .. import rendering_errors as errors
from ..rendering_errors import Array, Coverage
from . import table

SEEDS = range(1, 33)
COUNTS = (64, 256, 1024, 4096)

TEXT = """# Standard errors: stated and true

Made by `python -m tests.validation rendering-errors`; `tests/validation/test_rendering_errors.py` repeats parts of it. gonio states an error from the
scatter of batches of 8 paths. Its intervals are those of Student's t with one degree less than batches (68.27 and 95.45 %); the truth
is exact (lamp: case 5.3 of CIE 171; window: case 5.12, clear sky) or 8 pictures of 4096 paths a pixel (Cornell box, {side} x {side} pixels,
which share paths in tiles). {seeds} seeds each.

{coverage}
- **Reflected light** (Cornell box): stated errors are true within a tenth, on the safe side.
- **Light straight from a lamp or a window**: the paths of all batches fill each other's gaps, so the error falls faster than the
  scatter of batches tells. Stated errors are then too large, the more so the more paths; stopping by them takes more paths than it must.
- **64 paths** are eight batches; where light is even, batches that agree by chance state too small an error. The interval of 95 % of the
  lamp holds {least:.0f} % at the least.

## How errors fall
The slope of the logarithm of the true error over that of the paths, 64 to 4096; independent paths have -1/2. The error of the Cornell box's
truth itself flattens its slope by 0.01, and its pixels, which share paths, make it less sure than stated.

{slopes}
`crates/trace/tests/light/unbiased.rs` tests the same from 4 paths on (a sensor and a view in a room: -0.58 and -0.52, straight light alone: -0.80, all ± 0.01), and
that 1, 2, 4 and 16 paths have the mean of half a million.

## Stopping by the error
Mean of the Cornell box when pixels stop at a relative error, over the truth less 1 ({seeds} seeds, at most 16 384 paths):

{stopping}
With 95 % confidence the bias is below {share:.0f} % of the wanted error.
"""


def _row(name: str, count: int, found: Coverage) -> list[str]:
    return [
        name,
        str(count),
        f"{100.0 * found.true:.2f} %",
        f"{found.ratio:.2f}",
        f"{100.0 * found.within_68:.1f} %",
        f"{100.0 * found.within_95:.1f} %",
    ]


def make() -> str:
    """The page."""
    truth = errors.cornell_truth(4096)

    def cornell(samples: int, seeds: range) -> tuple[Array, Array, Array]:
        return *errors.cornell(samples, seeds), truth

    cases: dict[str, Callable[[int, range], tuple[Array, Array, Array]]] = {
        "Cornell box": cornell,
        "lamp": errors.lamp,
        "window": errors.window,
    }
    rows, slopes, least, share = [], [], 1.0, 0.0
    for name, case in cases.items():
        counts = COUNTS[:-1] if name == "Cornell box" else COUNTS
        true = []
        for count in counts:
            values = case(count, SEEDS)
            found = errors.coverage(*values, count)
            rows.append(_row(name, count, found))
            true.append(found.true)
            least = min(least, found.within_95) if name == "lamp" else least
        steep, error = errors.slope(list(counts), true, values[0].size)
        slopes.append([name, f"{steep:.3f} ± {error:.3f}"])
    stopping = []
    for wanted in (0.2, 0.1, 0.05):
        bias, error, paths = errors.stopping_bias(wanted, SEEDS, truth)
        low, high = (100.0 * (bias + k * 1.96 * error) for k in (-1, 1))
        share = max(share, abs(low) / wanted, abs(high) / wanted)
        stopping.append(
            [f"{wanted:g}", f"{paths:.0f}", f"{100.0 * bias:+.2f} %", f"{low:+.2f} to {high:+.2f} %"]
        )
    head = ["scene", "paths", "true error", "stated over true, median", "within 68 %", "within 95 %"]
    return TEXT.format(
        side=errors.SIDE,
        seeds=len(SEEDS),
        coverage=table(head, rows),
        least=100.0 * least,
        share=share,
        slopes=table(["scene", "slope"], slopes),
        stopping=table(["wanted", "paths a pixel", "bias", "95 %"], stopping),
    )
