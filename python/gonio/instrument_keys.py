"""Kinds of values that the keys of an instrument file take."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from gonio._native import FormatError

Refuse = Callable[[str, str, str], FormatError]
"""Makes the error of a key from the key, what was found there and what is allowed."""


@dataclass(frozen=True)
class Key:
    """A key: whether it must be there, what it is without, and the setting of the core it becomes."""

    required: bool = False
    default: Any = None
    setting: str = ""
    factor: float = 1.0

    @property
    def allowed(self) -> str:
        """What an error says is allowed."""
        raise NotImplementedError

    def holds(self, value: Any) -> bool:
        """Whether `value` is one that the key takes."""
        raise NotImplementedError


@dataclass(frozen=True, init=False)
class Number(Key):
    """A number within limits; required where it has no default unless told otherwise."""

    low: float = -math.inf
    high: float = math.inf

    def __init__(
        self,
        low: float,
        high: float,
        default: float | None = None,
        *,
        required: bool = True,
        setting: str = "",
        factor: float = 1.0,
    ) -> None:
        object.__setattr__(self, "low", low)
        object.__setattr__(self, "high", high)
        object.__setattr__(self, "default", default)
        object.__setattr__(self, "required", required and default is None)
        object.__setattr__(self, "setting", setting)
        object.__setattr__(self, "factor", factor)

    @property
    def allowed(self) -> str:
        """The limits."""
        return f"a number of {self.low:g} to {self.high:g}"

    def holds(self, value: Any) -> bool:
        """Whether it is a number within the limits; true and false are none."""
        return _number(value) and self.low <= value <= self.high


@dataclass(frozen=True, init=False)
class Numbers(Key):
    """A list of numbers within limits."""

    count: int | None = None
    low: float = -math.inf
    high: float = math.inf

    def __init__(self, count: int | None, low: float, high: float, *, required: bool = True) -> None:
        object.__setattr__(self, "count", count)
        object.__setattr__(self, "low", low)
        object.__setattr__(self, "high", high)
        object.__setattr__(self, "default", None)
        object.__setattr__(self, "required", required)
        object.__setattr__(self, "setting", "")
        object.__setattr__(self, "factor", 1.0)

    @property
    def allowed(self) -> str:
        """How many, and the limits."""
        many = "a list of" if self.count is None else f"a list of {self.count}"
        return f"{many} numbers of {self.low:g} to {self.high:g}"

    def holds(self, value: Any) -> bool:
        """Whether it is a list of as many numbers within the limits."""
        return (
            isinstance(value, list)
            and (len(value) == self.count if self.count is not None else bool(value))
            and all(_number(v) and self.low <= v <= self.high for v in value)
        )


@dataclass(frozen=True, init=False)
class Word(Key):
    """A text, one of `words` where there are any."""

    words: tuple[str, ...] = ()

    def __init__(self, words: tuple[str, ...] = (), *, required: bool = True) -> None:
        object.__setattr__(self, "words", words)
        object.__setattr__(self, "default", None)
        object.__setattr__(self, "required", required)
        object.__setattr__(self, "setting", "")
        object.__setattr__(self, "factor", 1.0)

    @property
    def allowed(self) -> str:
        """The words."""
        return ", ".join(self.words) or "a text"

    def holds(self, value: Any) -> bool:
        """Whether it is a text, one of the words."""
        return isinstance(value, str) and bool(value) and (not self.words or value in self.words)


@dataclass(frozen=True)
class Flag(Key):
    """True or false; false without."""

    default: Any = False

    @property
    def allowed(self) -> str:
        """Both."""
        return "true, false"

    def holds(self, value: Any) -> bool:
        """Whether it is one of them."""
        return isinstance(value, bool)


@dataclass(frozen=True)
class Section(Key):
    """A table of keys, or with `many` a list of tables."""

    required: bool = True
    many: bool = False

    @property
    def allowed(self) -> str:
        """A section or several."""
        return "sections in double brackets" if self.many else "a section"

    def holds(self, value: Any) -> bool:
        """Whether it is a table, or a list of tables."""
        if self.many:
            return isinstance(value, list) and all(isinstance(v, dict) for v in value)
        return isinstance(value, dict)


@dataclass(frozen=True, init=False)
class Pair(Key):
    """Two of some words, required."""

    words: tuple[str, ...] = ()

    def __init__(self, words: tuple[str, ...]) -> None:
        super().__init__(required=True)
        object.__setattr__(self, "words", words)

    @property
    def allowed(self) -> str:
        """The words."""
        return f"two of {', '.join(self.words)}"

    def holds(self, value: Any) -> bool:
        """Whether it is a list of two of the words."""
        return isinstance(value, list) and len(value) == 2 and all(v in self.words for v in value)


def _number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def parse_toml(text: str, *, source: str, kind: str) -> dict[str, Any]:
    """Parse TOML whose `format` is `kind`; a file of another kind is refused as such.

    Raises
    ------
    FormatError
        Not TOML, another format; the message names `source`.
    """
    try:
        raw = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise FormatError(f"{source}: {error}") from None
    found = raw.get("format", kind)
    if found != kind:
        raise FormatError(f"{source}: format: found {found!r}, allowed {kind!r}: it is another kind of file")
    return raw


def read_section(keys: Mapping[str, Key], raw: Any, *, name: str, refuse: Refuse) -> dict[str, Any]:
    """The values of the section `name` of a file (empty at its top), defaults filled in.

    Raises
    ------
    FormatError
        An unknown key, one that is missing, a value that its key does not take.
    """
    prefix = f"{name}." if name else ""
    for key in raw:
        if key not in keys:
            raise refuse(prefix + key, "an unknown key", ", ".join(keys))
    found = {}
    for key, kind in keys.items():
        if key not in raw:
            if kind.required:
                raise refuse(prefix + key, "nothing", kind.allowed)
            found[key] = kind.default
        elif not kind.holds(raw[key]):
            raise refuse(prefix + key, repr(raw[key]), kind.allowed)
        else:
            found[key] = raw[key]
    return found
