"""A run of the renderer: progress, interruption, samples kept; what pictures and sensors share."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from gonio._native import DomainError, RenderWatch, Samples
from gonio.rendering_state import Job, forget, resume_or_new, save_state, state_path
from gonio.working import finishing


@dataclass(frozen=True)
class RenderProgress:
    """How far rendering is.

    `done` is the share of the samples that will be needed, by what is known, `error` the mean standard error
    over the mean luminance (inf at first), `remaining` the seconds to go (None at first).
    """

    done: float
    error: float
    remaining: float | None


Report: TypeAlias = Callable[[RenderProgress], None]
"""Called some twenty times a second."""


def unwatched(progress: RenderProgress) -> None:
    """Progress that nobody watches."""


Work: TypeAlias = Callable[[Samples, RenderWatch, int, float | None], None]


def fingerprint(probe: Samples, work: Work) -> bytes:
    """What a few paths of the scene bring: another scene brings something else."""
    work(probe, RenderWatch(), 16, None)
    sums: bytes = probe.to_arrays()["sum"].tobytes()
    return sums


def run(
    job: Job,
    work: Work,
    target: Path | None,
    *,
    resume: bool,
    samples: int,
    wanted: float | None,
    progress: Report,
) -> Samples:
    """Take samples for `job`, on top of those kept beside `target`; an interruption keeps them there."""
    taken = resume_or_new(target, job, resume=resume)
    watch = RenderWatch()
    start = time.monotonic()
    first: float | None = None

    def tick() -> None:
        nonlocal first
        done, error = watch.progress()
        if done <= 0.0:
            return
        first = done if first is None else first
        gained = done - first
        spent = time.monotonic() - start
        left = spent * (1.0 - done) / gained if gained > 0.0 else None
        progress(RenderProgress(done, error, left))

    stopped = finishing(lambda: work(taken, watch, samples, wanted), tick=tick, stop=watch.stop)
    if stopped is not None:
        if target is not None and isinstance(stopped, KeyboardInterrupt):
            save_state(target, job, taken)
            raise KeyboardInterrupt(
                f"{state_path(target)} keeps the samples so far; resume=True (--resume) goes on"
            ) from stopped
        raise stopped
    return taken


def tidy(target: Path, job: Job, taken: Samples, *, keep: bool) -> None:
    """Keep the samples beside the result `target`, or none."""
    if keep:
        save_state(target, job, taken)
    else:
        forget(target)


def check_effort(
    *, samples: int, relative_error: float | None, seed: int, bounces: int, threads: int | None
) -> None:
    """Refuse an effort that does not work."""
    check("samples", 1 <= samples < 2**31, samples, "1 to 2147483647")
    wanted = relative_error is None or 0.0 < relative_error < 1.0
    check("relative_error", wanted, relative_error, "above 0 and below 1, or None")
    check("seed", 0 <= seed < 2**64, seed, "0 to 2^64 - 1")
    check("bounces", 0 <= bounces < 2**32, bounces, "0 or more")
    check("threads", threads is None or threads >= 1, threads, "1 or more")


def check(field: str, good: bool, found: object, allowed: str) -> None:
    """Refuse a field that is not good."""
    if not good:
        raise DomainError(f"{field}: found {found}, allowed {allowed}")
