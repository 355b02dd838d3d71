# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Media that have a color, by radiative transfer."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _lamina
from ._input import Doubles, broadcast, doubles, flag, number_text, one_of, place
from ._lamina import InvalidInput

_DEFINITIONS = ("openpbr", "normal", "diffuse", "furnace")
_DISTRIBUTIONS = ("beckmann", "ggx")
_MEANINGS = ("mean_free_path", "reduced_mean_free_path", "diffuse_mean_free_path")


class InvertedColor(NamedTuple):
    """The medium of a half-space that has a color."""

    albedo: Doubles  #: of single scattering
    sigma_a: Doubles  #: [1/mm]
    sigma_s: Doubles  #: [1/mm]


def _looks(ior: ArrayLike, g: ArrayLike, roughness: ArrayLike, distribution: str, definition: str) -> dict[str, Doubles]:
    one_of("distribution", distribution, _DISTRIBUTIONS)
    one_of("definition", definition, _DEFINITIONS)
    return {"ior": doubles("ior", ior, 1.0, 1.6), "g": doubles("g", g, -0.3, 0.95),
            "roughness": doubles("roughness", roughness, 0.0, 1.0)}


def invert(
    color: ArrayLike,
    *,
    ior: ArrayLike = 1.4,
    g: ArrayLike = 0.0,
    roughness: ArrayLike = 0.0,
    distribution: str = "beckmann",
    definition: str = "openpbr",
    radius: ArrayLike = 1.0,
    radius_meaning: str = "mean_free_path",
    clamp: bool = False,
) -> InvertedColor:
    """The albedo with which a half-space has a color, and its coefficients.

    :param color: linear, any shape: a texture, (y, x, channel), or one color.
    :param ior: refractive index, in [1, 1.6], under vacuum.
    :param g: mean cosine of Henyey and Greenstein's phase function, in [-0.3, 0.95].
    :param roughness: microfacet alpha of the surface, in [0, 1].
    :param distribution: of its facets: "beckmann" or "ggx".
    :param definition: "openpbr": of light at 0 degrees, what leaves over what gets in; "normal": over
        what arrives, without the first reflection; "diffuse": the same under a uniform sky;
        "furnace": with the first reflection.
    :param radius: mean free path [mm].
    :param radius_meaning: "mean_free_path", 1 / sigma_t; "reduced_mean_free_path", 1 / sigma_t_prime;
        "diffuse_mean_free_path", 1 / sigma_tr.
    :param clamp: colors out of reach take the nearest one.
    :raises InvalidInput: naming what is out of its range, or the first color that no albedo has.

    Colors of .01 to .99 come out within .1 %.

    >>> import lamina
    >>> lamina.invert([0.8, 0.5, 0.2], g=0.8).albedo.round(4)
    array([0.9996, 0.9955, 0.9705])
    """
    one_of("radius_meaning", radius_meaning, _MEANINGS)
    arrays, _ = broadcast({
        "color": doubles("color", color),
        "radius": doubles("radius", radius, 0.0, 1e9, closed="()", unit="mm"),
        **_looks(ior, g, roughness, distribution, definition)})
    looks = (arrays["ior"], arrays["g"], arrays["roughness"], distribution, definition)
    if not flag("clamp", clamp):
        reached = _lamina.color_range(*looks)
        is_out = ~((arrays["color"] >= reached[..., 0]) & (arrays["color"] <= reached[..., 1]))
        if is_out.any():
            index = np.unravel_index(int(np.argmax(is_out)), is_out.shape)
            low, high = np.ceil(reached[index][0] * 1e4) / 1e4, np.floor(reached[index][1] * 1e4) / 1e4
            at = f"color{place(index)}" if index else "color"
            raise InvalidInput(
                f"{at}: must be in [{number_text(low)}, {number_text(high)}], which is all that this surface "
                f"reaches, but is {number_text(float(arrays['color'][index]))}")
    found = _lamina.invert(arrays["color"], arrays["radius"], *looks, radius_meaning)
    return InvertedColor(*np.moveaxis(found, -1, 0))


def half_space_color(
    albedo: ArrayLike,
    *,
    ior: ArrayLike = 1.4,
    g: ArrayLike = 0.0,
    roughness: ArrayLike = 0.0,
    distribution: str = "beckmann",
    definition: str = "openpbr",
    solve: bool = False,
) -> Doubles:
    """The color of a half-space of an albedo: the way back of `invert`.

    :param albedo: of single scattering, in [0, 1]; the others as for `invert`.
    :param solve: by adding-doubling in place of the table: milliseconds, half a second if rough.
    :raises InvalidInput: naming what is out of its range.

    >>> import lamina
    >>> lamina.half_space_color([0.5, 0.9, 1.0], definition="furnace").round(3)
    array([0.13 , 0.326, 1.   ])
    """
    arrays, _ = broadcast({"albedo": doubles("albedo", albedo, 0.0, 1.0), **_looks(ior, g, roughness, distribution, definition)})
    return _lamina.half_space_color(
        arrays["albedo"], arrays["ior"], arrays["g"], arrays["roughness"], distribution, definition,
        flag("solve", solve))[..., 0]
