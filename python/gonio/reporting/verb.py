"""`gonio.report`: the report of a measurement, saved or in memory."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from gonio import _native
from gonio.checking import MeasurementOrPath, check, loaded
from gonio.readings import PathLike
from gonio.working import Progress, interruptible, silent


def report(
    measurement: MeasurementOrPath,
    *,
    out: PathLike,
    verdicts: Sequence[_native.Verdict] | None = None,
    model: _native.Bsdf | None = None,
    truth: _native.Bsdf | None = None,
    title: str | None = None,
    progress: Progress = silent,
) -> Path:
    """Write the report of a measurement as one HTML file that opens without a network.

    Parameters
    ----------
    measurement
        A measurement or the directory of a saved one.
    out
        The HTML file; an older one is replaced when the new one is complete.
    verdicts
        Outcome of the checks; None runs `gonio.check`.
    model, truth
        A model built from the readings and, for simulated samples, the known truth: drawn over the readings.
    title
        Heading; None takes the name of the sample.
    progress
        Called with stage, parts done and parts in all.

    Returns
    -------
    Path
        `out`.

    Raises
    ------
    FormatError
        The saved measurement is damaged.
    OSError
        The operating system refuses; nothing is left behind.
    """
    # Drawing libraries take half a second to load, which every other verb would pay.
    from gonio.reporting.page import render_report  # noqa: PLC0415

    shown = loaded(measurement)
    progress("checking", 0, 1)
    found = check(shown) if verdicts is None else list(verdicts)
    progress("checking", 1, 1)
    progress("drawing", 0, 1)
    path = interruptible(lambda: render_report(shown, found, out=out, model=model, truth=truth, title=title))
    progress("drawing", 1, 1)
    return path
