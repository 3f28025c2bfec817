"""Words of the core and of files in the notation of the page: symbols, degree signs, powers of ten, dates."""

import re
from datetime import datetime, timedelta

from gonio._drawing.numbers import angle

_DIRECTION = re.compile(r"theta_([is]) (-?[\d.]+), phi_\1 (-?[\d.]+) deg\b")
_DEGREES = re.compile(r"(?<=\d) deg\b")
_POWER = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e([+-]?\d+)(?![\w.])")
_MINUS = re.compile(r"(?<![\w.)\]-])-(?=\d)")
_WAVELENGTH = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)nm\b")
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def in_symbols(sentence: str) -> str:
    r"""Write angles, powers of ten, minus signs and wavelengths of a sentence as a printed page does.

    >>> in_symbols("floor 1.5e-4 1/sr (532nm at theta_i 8.00, phi_i 0.00 deg), ends 1.6 deg above")
    'floor 1.5·10⁻⁴ 1/sr (532\xa0nm at θi\xa08°, φi\xa00°), ends 1.6° above'
    """
    text = _DIRECTION.sub(lambda m: f"θ{m[1]}\u00a0{_degrees(m[2])}, φ{m[1]}\u00a0{_degrees(m[3])}", sentence)
    text = _DEGREES.sub("°", text)
    text = _POWER.sub(lambda m: f"{m[1]}·10{str(int(m[2])).translate(_RAISED)}", text)
    return _WAVELENGTH.sub("\\1\u00a0nm", _MINUS.sub("−", text))


def channel_label(channel: str) -> str:
    """Name of a channel for the reader: a wavelength with its unit set apart."""
    return _WAVELENGTH.sub("\\1\u00a0nm", channel)


def when(stamp: str | None) -> str | None:
    """Date and minute of an ISO 8601 time stamp; a text that is none stays as it is.

    >>> when("2026-01-05T08:00:00Z")
    '2026-01-05 08:00 UTC'
    """
    if stamp is None:
        return None
    try:
        moment = datetime.fromisoformat(stamp)
    except ValueError:
        return stamp
    if "T" not in stamp and " " not in stamp:
        return stamp
    zone = moment.utcoffset()
    suffix = "" if zone is None else " UTC" if zone == timedelta(0) else moment.strftime(" %z")
    return moment.strftime("%Y-%m-%d %H:%M") + suffix


def _degrees(text: str) -> str:
    try:
        return f"{angle(float(text))}°"
    except ValueError:
        return f"{text}°"
