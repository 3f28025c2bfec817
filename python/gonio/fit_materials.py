"""Materials of other programs: of the fitted model, or of the best ranked one that they can hold."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

from gonio._native import DomainError, FormatError
from gonio.fit_known import require_known
from gonio.fit_mitsuba import has_mitsuba
from gonio.fit_radiance import has_radiance, idle
from gonio.fit_results import Fit

T = TypeVar("T")

RADIANCE = "Radiance"
MITSUBA = "Mitsuba"


WORSE = 1.5
"""Error of a substitute over that of the fitted model above which it is another material."""


RESOLVED = 1e-4
"""An error below this counts as this: no instrument reads so well."""


@dataclass(frozen=True)
class Substitute:
    """The model in a material of another program, where that program has not the fitted one.

    The errors are those at left-out incidences (relative L1), None without any. `ratio` is that of the
    substitute over that of the fitted model; with a single incidence that of the errors there.
    """

    model: str
    held_out_error: float | None
    fitted: str
    fitted_error: float | None
    program: str
    ratio: float | None = None

    @property
    def text(self) -> str:
        """What to know before the material is used."""
        return (
            f"the material is {self.model}, the best ranked model that can be written for {self.program}: "
            f"error at left-out incidences {_percent(self.held_out_error)}, against "
            f"{_percent(self.fitted_error)} of {self.fitted}"
        )

    @property
    def warning(self) -> str | None:
        """What speaks against the material, where its error is more than `WORSE` times that of the fit."""
        if self.ratio is None or self.ratio <= WORSE:
            return None
        other = "radiance-ttree" if self.program == RADIANCE else "rgl-bsdf"
        return (
            f"the error of {self.model} is {self.ratio:.2g} times that of {self.fitted} (more than "
            f"{WORSE:g}): it is no stand-in for the sample; write the data-driven model instead "
            f"(gonio export --to {other})"
        )


def writable(fit: Fit) -> tuple[str, ...]:
    """Return the programs that have the form of the fitted model, where the fit knows its parameters.

    Colours above 1 and channels that make no colour are seen only when the material is made.
    """
    return tuple(
        program
        for program, has, ignored in (
            (RADIANCE, has_radiance, idle),
            (MITSUBA, has_mitsuba, _none),
        )
        if has(fit) and _known(fit, program, ignored(fit))
    )


def best_material(fit: Fit, program: str, make: Callable[[Fit], T]) -> tuple[T, Fit, Substitute | None]:
    """Make a material of a fit or, where that cannot be, of the best ranked model of its comparison.

    Returns what `make` gave, the fit it is of, and the `Substitute` where that is not `fit`.

    Raises
    ------
    DomainError, FormatError
        None of the models can be written. It tells why `fit` cannot and, where the program has not its form,
        why the best ranked model that it has cannot.
    """
    has = has_radiance if program == RADIANCE else has_mitsuba
    ranked = () if fit.ranking is None else fit.ranking.fits
    others = [f for f in ranked if f.model != fit.model and has(f)]
    reasons: list[tuple[Fit, DomainError | FormatError]] = []
    for candidate in [fit, *others]:
        try:
            made = make(candidate)
        except (DomainError, FormatError) as error:
            reasons.append((candidate, error))
            continue
        if candidate is fit:
            return made, fit, None
        substitute = Substitute(
            model=candidate.model,
            held_out_error=candidate.held_out_error,
            fitted=fit.model,
            fitted_error=fit.held_out_error,
            program=program,
            ratio=_ratio(candidate, fit),
        )
        return made, candidate, substitute
    raise _summed_up(fit, reasons, has_form=has(fit))


def _summed_up(
    fit: Fit, reasons: Sequence[tuple[Fit, DomainError | FormatError]], *, has_form: bool
) -> DomainError | FormatError:
    first = reasons[0][1]
    if has_form or len(reasons) == 1:
        return first
    other, error = reasons[1]
    return DomainError(f"{first}; nor can {other.model}, the best ranked of these, be written: {error}")


def _ratio(candidate: Fit, fit: Fit) -> float:
    """Error of a model over that of another, at left-out incidences or else at those of the fit."""
    if candidate.held_out_error is not None and fit.held_out_error is not None:
        ours, theirs = candidate.held_out_error, fit.held_out_error
    else:
        ours, theirs = (_own_error(f) for f in (candidate, fit))
    return ours / max(theirs, RESOLVED)


def _own_error(fit: Fit) -> float:
    """Mean error at the incidences that were fitted."""
    errors = [r.relative_l1 for r in fit.residuals]
    return math.fsum(errors) / max(len(errors), 1)


def _known(fit: Fit, program: str, ignored: set[str]) -> bool:
    try:
        require_known(fit, program, without=ignored)
    except DomainError:
        return False
    return True


def _none(fit: Fit) -> set[str]:
    return set()


def _percent(error: float | None) -> str:
    return "not known" if error is None else f"{100.0 * error:.2f} %"
