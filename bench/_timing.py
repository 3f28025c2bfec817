"""CPU time of calls."""

from __future__ import annotations

import resource
from collections.abc import Callable
from typing import Any


def cpu(who: int) -> float:
    """User and system seconds so far: `RUSAGE_SELF` with all threads, or `RUSAGE_CHILDREN`."""
    used = resource.getrusage(who)
    return used.ru_utime + used.ru_stime


def seconds(call: Callable[[], Any]) -> tuple[float, Any]:
    """User and system seconds of this process and all its threads during `call`, and what it returns."""
    before = cpu(resource.RUSAGE_SELF)
    result = call()
    return cpu(resource.RUSAGE_SELF) - before, result


def cpu_seconds(call: Callable[[], Any]) -> float:
    """The seconds alone."""
    return seconds(call)[0]
