"""Small measurements of a matt surface with a gloss lobe, for the report and the plots."""

import gonio
import numpy as np


def vectors(theta, phi):
    t, p = np.radians(theta), np.radians(phi)
    return np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=-1)


def lobe(theta_i, phi_i, theta_s, phi_s, *, alpha=0.2, through=0.05):
    """DSF of a Lambert base (0.5), a Gaussian lobe about the mirror direction and a matt transmission."""
    ws = vectors(theta_s, phi_s)
    mirror = vectors(theta_i, phi_i + 180.0)
    gloss = 0.3 / alpha**2 / np.pi * np.exp(-np.sum((ws - mirror) ** 2, axis=-1) / alpha**2)
    front = np.where(ws[:, 2] > 0.0, 0.5 / np.pi + gloss, through / np.pi)
    return front * np.abs(ws[:, 2])


def grid(step=6.0, *, front=True, back=True, limit=84.0):
    rings = [(0.0, 0.0)]
    for theta in np.arange(step, limit + 1e-9, step):
        count = max(6, round(360.0 * np.sin(np.radians(theta)) / step))
        rings += [(theta, 360.0 * k / count) for k in range(count)]
    theta, phi = np.array(rings).T
    parts = [part for wanted, part in ((front, theta), (back, 180.0 - theta)) if wanted]
    return np.concatenate(parts), np.tile(phi, len(parts))


def make_slice(theta_i=30.0, phi_i=0.0, channel="photopic", *, theta_s=None, phi_s=None, dsf=None, **kwargs):
    if theta_s is None:
        theta_s, phi_s = grid(front=kwargs.pop("front", True), back=kwargs.pop("back", True))
    theta_s, phi_s = np.asarray(theta_s, float), np.asarray(phi_s, float)
    if dsf is None:
        dsf = lobe(theta_i, phi_i, theta_s, phi_s)
    dsf = np.asarray(dsf, float)
    sides = [
        side for side, there in (("front", (theta_s <= 90).any()), ("back", (theta_s > 90).any())) if there
    ]
    integrals = [
        gonio.HemisphericalIntegral(
            side=side, value=0.9812, extrapolated=0.0123, u=0.00205, u_quadrature=0.001
        )
        for side in sides
    ]
    return gonio.Slice(
        theta_i=theta_i,
        phi_i=phi_i,
        channel=channel,
        theta_s=theta_s,
        phi_s=phi_s,
        dsf=dsf,
        u_dsf=kwargs.pop("u_dsf", np.abs(dsf) * 0.01 + 1e-4),
        omega=np.full(len(dsf), 0.01),
        flags=kwargs.pop("flags", ((dsf < 0.0) * gonio.FLAGS["negative"]).astype(np.uint16)),
        u_common=0.005,
        integrals=integrals,
    )


def measurement(slices, *, sample_name="white sheet", signature_fwhm=0.3, **kwargs):
    return gonio.Measurement(slices, sample_name=sample_name, signature_fwhm=signature_fwhm, **kwargs)


def verdicts():
    return [
        gonio.Verdict(
            id="energy",
            title="Energy",
            verdict="pass",
            sentence="DHR + DHT stays below 1.",
            value=0.98,
            unit="",
        ),
        gonio.Verdict(
            id="copies",
            title="Copies",
            verdict="fail",
            sentence="65° repeats 55°: measure again.",
            value=2.0,
            unit="scans",
        ),
        gonio.Verdict(id="floor", title="Noise floor", verdict="info", sentence="4.2 decades of range."),
        gonio.Verdict(
            id="gap",
            title="Grazing gap",
            verdict="warn",
            sentence="Nothing above 84°.",
            value=84.0,
            unit="deg",
        ),
    ]


def in_plane(theta_i=30.0):
    extended = np.r_[np.arange(-85.0, 86.0), np.arange(95.0, 266.0)]
    extended = extended[np.abs(extended + theta_i) > 5.0]  # the detector shades the beam
    theta = np.where(extended < 0, -extended, np.where(extended > 180, 360 - extended, extended))
    return theta, np.where((extended < 0) | (extended > 180), 0.0, 180.0)


def black():
    theta, phi = grid(back=False)
    dsf = -np.abs(np.random.default_rng(5).normal(1e-4, 5e-5, len(theta))) - 1e-7
    return make_slice(theta_s=theta, phi_s=phi, dsf=dsf)


def with_nan():
    theta, phi = grid()
    dsf = lobe(30.0, 0.0, theta, phi)
    dsf[::7] = np.nan
    return make_slice(theta_s=theta, phi_s=phi, dsf=dsf, u_dsf=np.where(np.isfinite(dsf), 1e-3, np.nan))


def cases():
    three = ([10.0, 40.0, 70.0], [0.0, 120.0, 240.0])
    theta, phi = in_plane()
    return {
        "single incidence": [make_slice()],
        "several incidences": [make_slice(t) for t in (0.0, 30.0, 60.0)],
        "reflection only": [make_slice(back=False)],
        "transmission only": [make_slice(front=False)],
        "incidence from the back": [make_slice(150.0)],
        "black sample, all negative": [black()],
        "NaN values": [with_nan()],
        "nothing but NaN": [make_slice(dsf=np.full(len(grid()[0]), np.nan))],
        "three readings": [make_slice(theta_s=three[0], phi_s=three[1])],
        "one reading": [make_slice(theta_s=[20.0], phi_s=[10.0])],
        "several channels": [make_slice(t, channel=c) for t in (0.0, 45.0) for c in ("red", "532nm")],
        "a channel that misses an incidence": [
            make_slice(0.0, channel="red"),
            make_slice(45.0, channel="blue"),
        ],
        "two azimuths": [make_slice(45.0, p) for p in (0.0, 90.0)],
        "in-plane only": [make_slice(theta_s=theta, phi_s=phi)],
        "no slice": [],
    }
