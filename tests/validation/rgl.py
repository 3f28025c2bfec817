"""RGL materials: the real files, synthetic ones, and Mitsuba's plugin `measured` as the oracle."""

import struct

import numpy as np

FILES = [
    "rgl-rgb/chm_orange_rgb.bsdf",
    "rgl-rgb/aurora_white_rgb.bsdf",
    "rgl-rgb/cm_military_green_rgb.bsdf",
    "rgl-rgb/irid_flake_paint1_rgb.bsdf",
]
CODES = {"uint8": 1, "float32": 10}


def write_tensor_file(path, fields):
    """Write arrays of uint8 and float32 as a tensor file."""
    offset = 18 + sum(13 + len(name) + 8 * a.ndim for name, a in fields.items())
    head = b"tensor_file\0" + bytes([1, 0]) + struct.pack("<I", len(fields))
    for name, a in fields.items():
        head += struct.pack("<H", len(name)) + name.encode()
        head += struct.pack(f"<HBQ{a.ndim}Q", a.ndim, CODES[a.dtype.name], offset, *a.shape)
        offset += a.nbytes
    path.write_bytes(head + b"".join(np.ascontiguousarray(a).tobytes() for a in fields.values()))


def synthetic(phi_i, channels, *, seed=1):
    """Fields of a material of smooth tables without meaning; one or two azimuths make it isotropic."""
    rng = np.random.default_rng(seed)

    def smooth(*shape):
        x, y = np.meshgrid(np.linspace(0, 1, shape[-1]), np.linspace(0, 1, shape[-2]))
        a = rng.random((*shape[:-2], 4, 1, 1))
        waves = 1.2 + a[..., 0, :, :] * np.sin(3 * x + 6 * a[..., 1, :, :])
        return (waves + a[..., 2, :, :] * np.cos(2 * np.pi * (y + a[..., 3, :, :]))).clip(0.05)

    n_p, n_t = len(phi_i), 5
    vndf = smooth(n_p, n_t, 16, 24) * np.linspace(0, 1, 24) ** 3
    sigma = 0.2 + smooth(8, 9)
    fields = {
        "phi_i": np.array(phi_i),
        "theta_i": np.linspace(0, np.pi / 2, n_t),
        "sigma": sigma,
        "ndf": smooth(12, 17),
        "vndf": vndf,
        "luminance": smooth(n_p, n_t, 11, 11),
        "rgb" if channels is None else "spectra": smooth(n_p, n_t, len(channels or "rgb"), 11, 11),
    }
    if channels is not None:
        fields["wavelengths"] = np.array(channels)
    if n_p <= 2:
        for name in ("sigma", "vndf", "luminance", "rgb", "spectra"):
            if name in fields:
                fields[name][:] = fields[name][:1]
    fields = {name: a.astype(np.float32) for name, a in fields.items()}
    return {**fields, "jacobian": np.ones(1, np.uint8), "description": np.frombuffer(b"nothing", np.uint8)}


def pairs(n, seed):
    """n pairs of directions above the horizon, half of them about the mirror direction; float32."""
    rng = np.random.default_rng(seed)

    def hemisphere():
        z, phi = rng.random(n), rng.uniform(0, 2 * np.pi, n)
        r = np.sqrt(1 - z**2)
        return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=1)

    wi, ws = hemisphere(), hemisphere()
    near = wi[: n // 2] * [-1, -1, 1] + rng.normal(scale=0.1, size=(n // 2, 3))
    near[:, 2] = np.abs(near[:, 2])
    ws[: n // 2] = near / np.linalg.norm(near, axis=1)[:, None]
    return wi.astype(np.float32).astype(float), ws.astype(np.float32).astype(float)


def angles(d):
    """Polar angle and azimuth, degrees."""
    return np.degrees(np.arctan2(np.hypot(d[:, 0], d[:, 1]), d[:, 2])), np.degrees(
        np.arctan2(d[:, 1], d[:, 0])
    )


def ours(model, wi, ws):
    """Values times the cosine, one column a channel, and densities."""
    (theta_i, phi_i), (theta_s, phi_s) = angles(wi), angles(ws)
    at = {"theta_i": theta_i, "phi_i": phi_i, "theta_s": theta_s, "phi_s": phi_s}
    f = np.stack([model.eval(**at, channel=c) for c in model.channels], axis=1)
    return f * ws[:, 2:], model.pdf(**at)


def theirs(mitsuba, path, wi, ws, wavelengths=None):
    """The same from Mitsuba, which does not raise negative values to 0: `f` here does."""
    plugin = mitsuba.load_dict({"type": "measured", "filename": str(path)})
    context = mitsuba.BSDFContext()
    values, density = [], []
    for i, s in zip(wi, ws, strict=True):
        at = mitsuba.SurfaceInteraction3f()
        at.wi = i
        if wavelengths is not None:
            at.wavelengths = wavelengths
        values.append(np.array(plugin.eval(context, at, s)).ravel())
        density.append(plugin.pdf(context, at, s))
    return np.maximum(values, 0), np.array(density)


def relative(a, b, floor):
    """Differences relative to the larger of `b` and `floor`, where the oracle is not NaN (0/0)."""
    known = np.isfinite(b)
    return (np.abs(a - b) / np.maximum(np.abs(b), floor))[known]
