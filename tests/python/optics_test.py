# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Boundaries, spheres and colors from Python: laws, limits, published values."""

from __future__ import annotations

from typing import Any, Callable

import lamina
import numpy as np
import pytest


def test_fresnel_obeys_its_laws() -> None:
    cosine = np.linspace(0.0, 1.0, 200)
    assert lamina.fresnel(0.0, 1.5) == 1.0  # grazing
    assert lamina.fresnel(1.0, 1.5) == pytest.approx(0.04)
    beyond = np.sqrt(1 - (np.sqrt(1 - cosine**2) / 1.5) ** 2)
    assert lamina.fresnel(cosine, 1.5) == pytest.approx(lamina.fresnel(beyond, 1 / 1.5), abs=1e-12)
    diffuse = np.trapz(2 * cosine * lamina.fresnel(cosine, 1.4), cosine)
    assert diffuse == pytest.approx(float(lamina.fresnel_diffuse(1.4)), abs=1e-4)


def test_spheres_have_their_limits() -> None:
    small = lamina.mie_sphere([0.01, 0.02], 1.5)
    assert small.scattering[1] / small.scattering[0] == pytest.approx(16.0, rel=1e-3)  # Rayleigh
    # Bohren & Huffman 1983, Appendix A: x = 3, m = 1.33 + 1e-8 i.
    assert lamina.mie_sphere(3.0, 1.33 + 1e-8j).extinction == pytest.approx(1.753388, abs=1e-5)
    large = lamina.mie_sphere(5000.0, 1.5 + 0.1j)
    assert large.extinction == pytest.approx(2.0, abs=0.02)  # the extinction paradox
    bulk = lamina.mie_bulk(volume_fraction=[0.01, 0.02], median_radius=5e-4, ior=1.59, wavelength=600)
    assert bulk.sigma_s[1] == pytest.approx(2 * bulk.sigma_s[0]) and bulk.sigma_a[0] == pytest.approx(0, abs=1e-9)


def test_colors_are_those_of_the_tables() -> None:
    nm = np.arange(380, 781, 5)
    assert lamina.spectrum_color(nm, np.ones((2, nm.size)), illuminant="a") == pytest.approx(np.ones((2, 3)))
    red = lamina.spectrum_color(nm, (nm > 600).astype(float))
    assert red[0] > 0.5 and (red[1:] < 0.05).all()  # more saturated than sRGB: green is below 0
    gray = lamina.lab(np.full(3, 0.18418651851244416))
    assert gray == pytest.approx([50.0, 0.0, 0.0], abs=1e-6)
    difference = lamina.color_difference([0.2, 0.2, 0.2], [[0.2, 0.2, 0.2], [0.3, 0.2, 0.2]])
    assert difference[0] == 0.0 and 5.0 < difference[1] < 30.0


WRONG: list[tuple[Callable[[], Any], str]] = [
    (lambda: lamina.fresnel(1.1, 1.5), "cosine: must be in [0, 1], but is 1.1"),
    (lambda: lamina.fresnel([0.5] * 2, [1.5] * 3), "cosine (2,), eta (3,)"),
    (lambda: lamina.fresnel_diffuse(0), "eta: must be in"),
    (lambda: lamina.mie_sphere(0, 1.5), "size_parameter: must be in (0, 100000]"),
    (lambda: lamina.mie_sphere(1, -1.5), "relative_ior: must have a real part > 0"),
    (lambda: lamina.mie_sphere(1, "x"), "relative_ior: must be numbers"),
    (lambda: lamina.mie_bulk(volume_fraction=1, median_radius=1e-3, ior=1.5, wavelength=500), "volume_fraction"),
    (lambda: lamina.spectrum_color([500], [1, 2]), "spectrum: must have 1 numbers"),
    (lambda: lamina.spectrum_color([500], [1], illuminant="d50"), "illuminant: must be one of d65, a, e"),
    (lambda: lamina.lab([1, 2]), "srgb_linear: must be colors"),
    (lambda: lamina.color_difference([1, 2, 3], [1, 2, np.nan]), "second[2]: must be finite, but is nan"),
]


@pytest.mark.parametrize(("call", "message"), WRONG)
def test_wrong_numbers_are_refused(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(lamina.InvalidInput) as refused:
        call()
    assert message in str(refused.value)
