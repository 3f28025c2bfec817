"""Long work: progress and interruption."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Generic, TypeAlias, TypeVar

Progress: TypeAlias = Callable[[str, int, int], None]
"""Called with the name of the stage, how many parts are done and how many there are."""

T = TypeVar("T")


def silent(stage: str, done: int, total: int) -> None:
    """Progress that nobody watches."""


def nothing() -> None:
    """A step that does nothing."""


class _Beside(Generic[T]):
    """Work in a thread of its own, and what comes of it."""

    def __init__(self, work: Callable[[], T]) -> None:
        self._work = work
        self._results: list[T] = []
        self._errors: list[BaseException] = []
        # Not the end of the thread: interrupted in `join`, Python 3.11 takes one that still runs for ended.
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="gonio-work", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        try:
            self._results.append(self._work())
        except BaseException as error:
            self._errors.append(error)
        finally:
            self._ended.set()

    def watch(self, tick: Callable[[], None]) -> None:
        """Wait for the end and call `tick` meanwhile, some twenty times a second."""
        while not self._ended.wait(0.05):
            tick()
        tick()

    def end(self) -> T:
        """Wait for the end; the result, or the exception of the work."""
        self._ended.wait()
        if self._errors:
            raise self._errors[0]
        return self._results[0]


def interruptible(
    work: Callable[[], T], *, tick: Callable[[], None] = nothing, stop: Callable[[], None] = nothing
) -> T:
    """Result of `work`, run beside the calling thread so that Ctrl-C is heard while native code computes.

    An exception of `work` is raised here. Meanwhile `tick` is called in the calling thread, some twenty times
    a second. When that or Ctrl-C raises, `stop` is called, the work is left to itself (its result is
    dropped), and the exception goes on to the caller.
    """
    beside = _Beside(work)
    try:
        beside.watch(tick)
    except BaseException:
        stop()
        raise
    return beside.end()


def finishing(
    work: Callable[[], None], *, tick: Callable[[], None] = nothing, stop: Callable[[], None] = nothing
) -> BaseException | None:
    """Run `work` as `interruptible` does, but wait for its end in any case.

    When `tick` or Ctrl-C raises, `stop` is called, the work ends by itself soon, and the exception is
    returned; another one meanwhile goes on to the caller. An exception of `work` is raised.
    """
    beside = _Beside(work)
    came: BaseException | None = None
    try:
        beside.watch(tick)
    except BaseException as error:
        came = error
        stop()
    beside.end()
    return came
