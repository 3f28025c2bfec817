"""Long work: progress and interruption."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TypeAlias, TypeVar

Progress: TypeAlias = Callable[[str, int, int], None]
"""Called with the name of the stage, how many parts are done and how many there are."""

T = TypeVar("T")


def silent(stage: str, done: int, total: int) -> None:
    """Progress that nobody watches."""


def nothing() -> None:
    """A step that does nothing."""


def interruptible(
    work: Callable[[], T], *, tick: Callable[[], None] = nothing, stop: Callable[[], None] = nothing
) -> T:
    """Result of `work`, run beside the calling thread so that Ctrl-C is heard while native code computes.

    An exception of `work` is raised here. Meanwhile `tick` is called in the calling thread, some twenty times
    a second. When that or Ctrl-C raises, `stop` is called, the work is left to itself (its result is
    dropped), and the exception goes on to the caller.
    """
    results: list[T] = []
    errors: list[BaseException] = []

    def run() -> None:
        try:
            results.append(work())
        except BaseException as error:
            errors.append(error)

    thread = threading.Thread(target=run, name="gonio-work", daemon=True)
    thread.start()
    try:
        while thread.is_alive():
            thread.join(0.05)
            tick()
    except BaseException:
        stop()
        raise
    if errors:
        raise errors[0]
    return results[0]


def finishing(
    work: Callable[[], None], *, tick: Callable[[], None] = nothing, stop: Callable[[], None] = nothing
) -> BaseException | None:
    """Run `work` as `interruptible` does, but wait for its end in any case.

    When `tick` or Ctrl-C raises, `stop` is called, the work ends by itself soon, and the exception is
    returned; another one meanwhile goes on to the caller. An exception of `work` is raised.
    """
    errors: list[BaseException] = []
    came: BaseException | None = None

    def run() -> None:
        try:
            work()
        except BaseException as error:
            errors.append(error)

    thread = threading.Thread(target=run, name="gonio-work", daemon=True)
    thread.start()
    try:
        while thread.is_alive():
            thread.join(0.05)
            tick()
    except BaseException as error:
        came = error
        stop()
        thread.join()
    if errors:
        raise errors[0]
    return came
