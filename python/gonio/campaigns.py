"""Do scans belong together? What is asked before they are processed as one measurement."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from gonio._native import QuantityError, Scan

SHOWN = 4
"""Files named in a message; the others are counted."""


def one_sample(scans: Sequence[Scan]) -> None:
    """Refuse scans that name different samples; scans without a name go with any.

    Raises
    ------
    QuantityError
        Two or more names.
    """
    first: dict[str, Scan] = {}
    for scan in scans:
        name = scan.meta.get("sample_name")
        if name:
            first.setdefault(str(name), scan)
    if len(first) > 1:
        found = _some([f"{name!r} ({source(scan)})" for name, scan in first.items()])
        raise QuantityError(
            f"sample name: found {found}, needed one sample; name (--name) states that they are one"
        )


def beam_for_each(sample: Sequence[Scan], beam: Sequence[Scan]) -> None:
    """Refuse raw signals of a channel that no reference scan has.

    Raises
    ------
    QuantityError
        It names the first such file and what reference scans there are.
    """
    known = {scan.channel for scan in beam}
    for scan in sample:
        if scan.quantity != "signal" or scan.channel in known:
            continue
        if not beam:
            raise QuantityError(
                f"{source(scan)}: reference scan: found none for signals of channel {scan.channel}, needed "
                "beam (--beam), or standard (--standard)"
            )
        have = _some(dict.fromkeys(f"{b.channel} ({source(b)})" for b in beam))
        raise QuantityError(
            f"{source(scan)}: channel of the reference scan: found {have}, needed {scan.channel}"
        )


def idle_beam(sample: Sequence[Scan], beam: Sequence[Scan]) -> list[str]:
    """A warning when reference scans are given for values that need no division by the beam power."""
    quantities = list(dict.fromkeys(scan.quantity for scan in sample))
    if not beam or not quantities or "signal" in quantities:
        return []
    return [
        f"the reference scan ({_some(dict.fromkeys(map(source, beam)))}) states the resolution only: the "
        f"sample's values are {', '.join(quantities)} already and are not divided by the beam power"
    ]


def repeated_incidences(scans: Sequence[Scan]) -> list[str]:
    """A warning when an incidence was scanned more than once over the same side in one channel."""
    groups: dict[tuple[str, float, float, str], list[Scan]] = {}
    for scan in scans:
        phi = scan.phi_i % 360.0 if 0.0 < scan.theta_i < 180.0 else 0.0
        theta_s = scan.theta_s
        for side, there in (("front", theta_s < 90.0), ("back", theta_s > 90.0)):
            if np.any(there):
                key = (scan.channel, round(scan.theta_i, 6), round(phi, 6), side)
                groups.setdefault(key, []).append(scan)
    repeated = [(key, found) for key, found in groups.items() if len(found) > 1]
    if not repeated:
        return []
    (channel, theta, phi, side), found = repeated[0]
    return [
        f"scanned more than once over the same side: {len(repeated)} of {len(groups)} incidences, first "
        f"{channel} at theta_i {theta:.4g}, phi_i {phi:.4g} deg, {side} side ({_some(map(source, found))}); "
        "each scan is a slice of its own: are they of one sample?"
    ]


def source(scan: Scan) -> str:
    """File of a scan, as far as it is known."""
    return str(scan.meta.get("source") or "scan without a file")


def _some(texts: Iterable[str]) -> str:
    every = list(texts)
    more = len(every) - SHOWN
    return ", ".join(every[:SHOWN]) + (f" and {more} more" if more > 0 else "")
