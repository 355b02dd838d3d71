# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Single boundaries, spheres, and colors, over arrays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _lamina
from ._input import Doubles, broadcast, doubles, one_of, refuse, refuse_masked
from ._input import wavelengths as check_wavelengths
from ._lamina import InvalidInput


def fresnel(cosine: ArrayLike, eta: ArrayLike) -> Doubles:
    """Unpolarized reflectance of a smooth boundary; 1 at total reflection.

    :param cosine: of the angle of incidence, in [0, 1].
    :param eta: refractive index beyond the boundary over that before it, in [0.01, 100].
    :raises InvalidInput: naming what is out of its range.

    Source: Born & Wolf 1999, §1.5.2, Eq. 21.

    >>> import lamina
    >>> lamina.fresnel(1.0, [1.0, 1.4, 1.5]).round(4)
    array([0.    , 0.0278, 0.04  ])
    """
    arrays, _ = broadcast(
        {"cosine": doubles("cosine", cosine, 0.0, 1.0), "eta": doubles("eta", eta, 0.01, 100.0)})
    return _lamina.fresnel(arrays["cosine"], arrays["eta"])[..., 0]


def fresnel_diffuse(eta: ArrayLike) -> Doubles:
    """Fraction of diffuse light that a smooth boundary reflects, in closed form.

    :param eta: refractive index beyond the boundary over that before it; 1 / ior for light inside.
    :raises InvalidInput: unless in [0.01, 100].

    Source: Duntley 1942.

    >>> import lamina
    >>> lamina.fresnel_diffuse([1.4, 1 / 1.4]).round(4)
    array([0.0768, 0.529 ])
    """
    return _lamina.fresnel_diffuse(doubles("eta", eta, 0.01, 100.0))[..., 0]


class MieSphere(NamedTuple):
    """Scattering by a sphere: cross sections over the geometric one."""

    extinction: Doubles
    scattering: Doubles
    g: Doubles


class MieBulk(NamedTuple):
    """Coefficients of a suspension of spheres."""

    sigma_a: Doubles  #: [1/mm]
    sigma_s: Doubles  #: [1/mm]
    g: Doubles


def complexes(name: str, value: ArrayLike) -> np.ndarray[tuple[int, ...], np.dtype[np.complex128]]:
    """Refractive indices, as the Mie series takes them."""
    refuse_masked(name, value)
    try:
        array = np.asarray(value)
        result = array.astype(np.complex128) if array.dtype.kind in "fiuc" else np.empty(0, np.complex128)
    except ValueError:  # rows of other lengths, or more than fits into any memory
        raise refuse(name, "be numbers", value) from None
    if result.size == 0:
        raise refuse(name, "be numbers", value)
    if not ((result.real > 0) & (result.imag >= 0) & (np.abs(result) <= 100)).all():
        raise refuse(name, "have a real part > 0, an imaginary part >= 0 and a magnitude <= 100", value)
    return result


def mie_sphere(size_parameter: ArrayLike, relative_ior: ArrayLike) -> MieSphere:
    """Scattering of light by one sphere.

    :param size_parameter: circumference over the wavelength in the medium, in (0, 1e5].
    :param relative_ior: index of the sphere over that of the medium, of a magnitude of at most 100; an
        imaginary part absorbs.
    :raises InvalidInput: naming what is out of its range.

    Source: Bohren & Huffman 1983, Eqs. 4.52-4.62.

    >>> import lamina
    >>> [round(float(number), 4) for number in lamina.mie_sphere(3.0, 1.33)]
    [1.7534, 1.7534, 0.7832]
    """
    arrays, _ = broadcast({
        "size_parameter": doubles("size_parameter", size_parameter, 0.0, 1e5, closed="(]"),
        "relative_ior": complexes("relative_ior", relative_ior)})
    return MieSphere(*np.moveaxis(_lamina.mie_sphere(arrays["size_parameter"], arrays["relative_ior"]), -1, 0))


def mie_bulk(
    *,
    volume_fraction: ArrayLike,
    median_radius: ArrayLike,
    ior: ArrayLike,
    wavelength: ArrayLike,
    ior_medium: ArrayLike = 1.33,
    sigma_log_radius: ArrayLike = 0.0,
) -> MieBulk:
    """Coefficients of spheres in a medium, each scattering for itself: a few per cent by volume.

    :param volume_fraction: in [0, 1).
    :param median_radius: [mm], in (0, 10]; the radii are spread log-normally by number.
    :param ior: of the particles, of a magnitude of at most 100; an imaginary part absorbs.
    :param wavelength: in vacuum [nm], in [100, 20000].
    :param ior_medium: in [0.1, 10].
    :param sigma_log_radius: standard deviation of the logarithm of the radius, in [0, 1.5]. The spread
        has sizes of 12 of it around its middle, none above a size parameter of 1e5.
    :raises InvalidInput: naming what is out of its range.

    >>> import lamina
    >>> milk = lamina.mie_bulk(volume_fraction=0.03, median_radius=4e-4, ior=1.46, wavelength=[450, 650])
    >>> lamina.layers(sigma_a=milk.sigma_a[:, None], sigma_s=milk.sigma_s[:, None], g=milk.g[:, None]).shape
    (2,)
    """
    arrays, _ = broadcast({
        "volume_fraction": doubles("volume_fraction", volume_fraction, 0.0, 1.0, closed="[)"),
        "median_radius": doubles("median_radius", median_radius, 0.0, 10.0, closed="(]", unit="mm"),
        "sigma_log_radius": doubles("sigma_log_radius", sigma_log_radius, 0.0, 1.5),
        "ior_medium": doubles("ior_medium", ior_medium, 0.1, 10.0),
        "wavelength": doubles("wavelength", wavelength, 100.0, 20000.0, unit="nm"),
        "ior": complexes("ior", ior),
    })
    found = _lamina.mie_bulk(
        arrays["volume_fraction"], arrays["median_radius"], arrays["sigma_log_radius"], arrays["ior"],
        arrays["ior_medium"], arrays["wavelength"])
    return MieBulk(*np.moveaxis(found, -1, 0))


def spectrum_color(wavelengths: ArrayLike, spectrum: ArrayLike, *, illuminant: str = "d65") -> Doubles:
    """Linear sRGB of reflectances that are known at some wavelengths; 1 everywhere is white.

    :param wavelengths: [nm], ascending, in [200, 3000].
    :param spectrum: fractions of the illuminant's light, axes (..., wavelength).
    :param illuminant: "d65", "a" or "e", equal energy; its white is white.
    :raises InvalidInput: naming what is wrong.

    Source: CIE 15; between wavelengths the smoothest likely spectrum.

    >>> import lamina
    >>> lamina.spectrum_color([450, 550, 650], [1.0, 1.0, 1.0]).round(9)
    array([1., 1., 1.])
    """
    nm = check_wavelengths("wavelengths", wavelengths)
    values = doubles("spectrum", spectrum)
    if values.shape[-1:] != (len(nm),):
        raise InvalidInput(f"spectrum: must have {len(nm)} numbers along its last axis, but has the shape {values.shape}")
    weights = _lamina.band_weights(nm, one_of("illuminant", illuminant, ("d65", "a", "e")))
    result: Doubles = values @ weights
    return result


def _colors(name: str, value: ArrayLike) -> Doubles:
    colors = doubles(name, value)
    if colors.shape[-1:] != (3,):
        raise InvalidInput(f"{name}: must be colors, axes (..., 3), but has the shape {colors.shape}")
    return colors


def lab(srgb_linear: ArrayLike) -> Doubles:
    """CIELAB of linear sRGB under D65: lightness, a, b; axes (..., 3).

    :raises InvalidInput: for another shape.

    >>> import lamina
    >>> lamina.lab([1.0, 1.0, 1.0]).round(6) + 0.0
    array([100.,   0.,   0.])
    """
    colors = _colors("srgb_linear", srgb_linear)
    return _lamina.lab(colors, list(colors.shape))


def color_difference(first: ArrayLike, second: ArrayLike) -> Doubles:
    """CIEDE2000 of two colors in linear sRGB, axes (..., 3): 1 is about what an eye can tell.

    :raises InvalidInput: for another shape.

    Source: Sharma et al. 2005.

    >>> import lamina
    >>> float(lamina.color_difference([0.5, 0.4, 0.3], [0.5, 0.4, 0.3]))
    0.0
    """
    arrays, shape = broadcast({"first": _colors("first", first), "second": _colors("second", second)})
    return _lamina.color_difference(arrays["first"], arrays["second"], list(shape))[..., 0]
