"""Sections and keys of an instrument file (docs/formats/instrument-toml.md)."""

from __future__ import annotations

from collections.abc import Mapping

from gonio.instrument_keys import Flag, Key, Number, Numbers, Section, Word

FORMAT = "gonio-instrument 1"

PATCH = {
    "radius": Number(0.1, 90.0),
    "pitch": Number(0.012, 28.0),
    "growth": Number(0.0, 1.0, 0.0),
    "along": Number(0.1, 2.0, 0.6),
}

SECTIONS: Mapping[str, Mapping[str, Key]] = {
    "": {
        "format": Word((FORMAT,)),
        "name": Word(),
        "u_calibration": Number(0.0, 0.5, 0.0),
        "lamp": Section(),
        "beam": Section(),
        "optics": Section(required=False),
        "holder": Section(),
        "detector": Section(),
        "path": Section(),
    },
    "lamp": {
        "kind": Word(("xenon", "halogen", "laser", "table")),
        "temperature": Number(1500.0, 20000.0, required=False),
        "wavelength": Number(200.0, 3000.0, required=False),
        "spectrum": Word(required=False),
        "power": Number(1e-12, 1e12, setting="power"),
        "drift_per_hour": Number(-0.5, 0.5, 0.0, setting="lamp_drift"),
        "flicker": Number(0.0, 0.2, 0.0, setting="lamp_flicker"),
        "flicker_time": Number(1e-4, 1e4, 1.0, setting="lamp_flicker_time"),
    },
    "beam": {
        "focus": Word(("detector", "sample")),
        "profile": Word(("gaussian", "top-hat", "table")),
        "half_width": Number(0.006, 5.7, required=False, setting="beam_half_width"),
        "radius": Number(0.006, 5.7, required=False, setting="beam_radius"),
        "table": Word(required=False),
        "spot_diameter_mm": Number(0.0, 100.0, required=False, setting="spot_diameter", factor=1e-3),
    },
    "optics": {
        "source_diameter_mm": Number(1e-3, 100.0),
        "focal_length_mm": Number(1.0, 1e4),
        "aperture_diameter_mm": Number(0.1, 500.0),
        "lens_to_sample_mm": Number(1.0, 1e5),
    },
    "holder": {
        "sample_diameter_mm": Number(0.1, 1e4, required=False, setting="sample_diameter", factor=1e-3),
        "sample_width_mm": Number(0.1, 1e4, required=False, setting="sample_width", factor=1e-3),
        "sample_height_mm": Number(0.1, 1e4, required=False, setting="sample_height", factor=1e-3),
        "overfill": Flag(setting="overfill"),
        "tilt": Numbers(2, -11.0, 11.0, required=False),
        "offset_mm": Number(-50.0, 50.0, 0.0, setting="offset", factor=1e-3),
        "radius_mm": Number(0.0, 1e4, 40.0, setting="holder_radius", factor=1e-3),
        "theta_i": Numbers(2, 0.0, 180.0, required=False),
        "phi_i": Numbers(2, 0.0, 360.0, required=False),
    },
    "detector": {
        "distance_mm": Number(50.0, 1e5, 1020.0, setting="distance", factor=1e-3),
        "aperture": Number(6e-4, 5.7, required=False, setting="aperture"),
        "aperture_diameter_mm": Number(0.01, 1e3, required=False),
        "speed": Number(0.006, 5700.0, required=False, setting="speed"),
        "rate": Number(0.1, 1e5, 100.0, setting="rate"),
        "integration": Number(0.0, 1.0, 0.0, setting="integration"),
        "shadow": Number(0.0, 28.0, 3.0, setting="shadow"),
        "pointing": Number(0.0, 5.7, 0.0, setting="pointing"),
        "noise_readout": Number(0.0, 1e12, 0.0, setting="noise_readout"),
        "noise_shot": Number(0.0, 1e12, 0.0, setting="noise_shot"),
        "noise_relative": Number(0.0, 0.5, 0.0, setting="noise_relative"),
        "dark_level": Number(-1e12, 1e12, 0.0, setting="dark_level"),
        "dark_swing": Number(0.0, 1e12, 0.0, setting="dark_swing"),
        "dark_period": Number(60.0, 1e9, 7200.0, setting="dark_period"),
        "saturation": Number(1e-300, 1e300, 1e9, setting="saturation"),
        "bits": Number(0.0, 32.0, 0.0, setting="bits"),
        "range": Section(many=True, required=False),
        "channel": Section(many=True, required=False),
    },
    "detector.range": {
        "full_scale": Number(1e-300, 1e300),
        "noise_readout": Number(0.0, 1e12),
        "gain_error": Number(-0.2, 0.2, 0.0),
    },
    "detector.channel": {
        "name": Word(),
        "response": Word(),
        "shift": Number(-50.0, 50.0, 0.0),
        "peak": Number(200.0, 3000.0, required=False),
        "fwhm": Number(0.1, 1000.0, required=False),
        "gain": Number(1e-12, 1e12, 1.0),
    },
    "path": {
        "pitch_across": Number(0.06, 28.0, 3.0, setting="pitch_across"),
        "pitch_along": Number(0.06, 28.0, 0.5, setting="pitch_along"),
        "theta_max": Number(6.0, 89.99, 89.0, setting="theta_max"),
        "jitter": Number(0.0, 0.3, 0.0, setting="jitter"),
        "planes": Numbers(None, -360.0, 360.0, required=False),
        "table": Word(required=False),
        "region": Section(many=True, required=False),
        "prescan": Section(required=False),
    },
    "path.region": {
        "around": Word(("mirror", "through", "retro", "direction")),
        "direction": Numbers(2, -1e300, 1e300, required=False),
        **PATCH,
    },
    "path.prescan": {
        "pitch": Number(0.3, 28.0, 5.0),
        "threshold": Number(1.1, 1e6, 3.0),
        "count": Number(1.0, 100.0, 5.0),
        "region_radius": Number(0.1, 90.0, 10.0),
        "region_pitch": Number(0.012, 28.0, 0.3),
        "region_growth": Number(0.0, 1.0, 0.04),
        "region_along": Number(0.1, 2.0, 0.6),
    },
}
"""Keys of every section with what they allow."""
