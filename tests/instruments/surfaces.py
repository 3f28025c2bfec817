"""Surfaces of known statistics, and a lobe of known width."""

import numpy as np


def gaussian_map(*, n, step, sigma, tau, tau_y=None, azimuth=0.0, seed=0):
    """A periodic surface of ACF sigma² exp(-(a / tau)² - (b / tau_y)²), a at `azimuth` degrees."""
    noise = np.random.default_rng(seed).standard_normal((n, n))
    k = 2 * np.pi * np.fft.fftfreq(n, step)
    kx, ky = np.meshgrid(k, k)
    c, s = np.cos(np.radians(azimuth)), np.sin(np.radians(azimuth))
    a, b = c * kx + s * ky, c * ky - s * kx
    filtered = np.exp(-((a * tau) ** 2 + (b * (tau_y or tau)) ** 2) / 8)
    z = np.fft.ifft2(np.fft.fft2(noise) * filtered).real
    return sigma * z / np.sqrt((filtered**2).mean())


def gaussian_profile(*, n, step, sigma, tau, seed=0):
    """A periodic Gaussian profile of ACF sigma² exp(-(x / tau)²)."""
    noise = np.random.default_rng(seed).standard_normal(n)
    filtered = np.exp(-((2 * np.pi * np.fft.fftfreq(n, step) * tau) ** 2) / 8)
    z = np.fft.ifft(np.fft.fft(noise) * filtered).real
    return sigma * z / np.sqrt((filtered**2).mean())
