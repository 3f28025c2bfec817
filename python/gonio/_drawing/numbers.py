"""Numbers as a laboratory writes them."""

import math


def with_uncertainty(value: float, u: float, *, k: float = 2.0) -> str:
    """`value ± k u`, the expanded uncertainty rounded to two digits and the value to the same place.

    Without a finite, positive uncertainty the value is written alone with four digits; a NaN as "no value".

    >>> with_uncertainty(0.98123, 0.00205)
    '0.9812 ± 0.0041'
    """
    if not math.isfinite(value):
        return "no value"
    expanded = k * u
    if not math.isfinite(expanded) or expanded <= 0.0:
        return number(value)
    places = 1 - math.floor(math.log10(expanded))
    if float(f"{expanded:.1e}") >= 10.0 ** (2 - places):  # rounding carried into the next decade
        places -= 1
    if places - 1 >= -4 and places <= 6:
        places = max(places, 0)
        return f"{_minus(f'{value:.{places}f}')} ± {expanded:.{places}f}"
    exponent = math.floor(math.log10(abs(value))) if value else math.floor(math.log10(expanded))
    scale = 10.0**exponent
    digits = max(0, places + exponent)
    mantissa = _minus(f"{value / scale:.{digits}f}")
    return f"({mantissa} ± {expanded / scale:.{digits}f})·10{_superscript(exponent)}"


def number(value: float | None, digits: int = 4) -> str:
    """Write a number with `digits` significant digits and powers of ten; a NaN or None as "no value"."""
    if value is None or not math.isfinite(value):
        return "no value"
    if value == 0.0:
        return "0"
    exponent = math.floor(math.log10(abs(value)))
    if value == int(value) and exponent < 6:
        return _minus(str(int(value)))
    if -3 <= exponent < 6:
        return _minus(f"{value:.{max(0, digits - 1 - exponent)}f}")
    return f"{_minus(f'{value / 10.0**exponent:.{digits - 1}f}')}·10{_superscript(exponent)}"


def rounded(value: float, digits: int) -> float:
    """Round to `digits` significant digits; zero and values that are not finite stay.

    >>> rounded(2892.4, 3)
    2890.0
    """
    return float(f"{value:.{digits - 1}e}") if math.isfinite(value) else value


def angle(degrees: float) -> str:
    """Write an angle in degrees to 0.01, without trailing zeros.

    >>> angle(15.000000001)
    '15'
    """
    return _minus(f"{round(degrees, 2) + 0.0:g}")


def percent(fraction: float, digits: int = 2, *, sign: bool = False) -> str:
    """Write a fraction in percent; `sign` puts a plus before positive values."""
    if not math.isfinite(fraction):
        return "no value"
    shown = round(100.0 * fraction, digits) + 0.0  # + 0.0 turns a negative zero into zero
    plus = "+" if sign and shown > 0.0 else ""
    return f"{plus}{_minus(f'{shown:.{digits}f}')} %"


def _minus(text: str) -> str:
    return text.replace("-", "−")


def _superscript(exponent: int) -> str:
    return str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
