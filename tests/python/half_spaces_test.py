# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Media of colors from Python: laws, the solver of slabs, shapes, refusals."""

from __future__ import annotations

from typing import Any, Callable

import lamina
import numpy as np
import pytest


@pytest.mark.parametrize("definition", ["openpbr", "normal", "diffuse", "furnace"])
def test_slab_gives_the_color_that_was_inverted(definition: str) -> None:
    color = np.array([0.8, 0.4, 0.1])
    found = lamina.invert(color, ior=1.45, g=[0.0, 0.8, 0.9], definition=definition, radius=[1.0, 0.5, 0.2])
    assert 1 / (found.sigma_a + found.sigma_s) == pytest.approx(np.array([1.0, 0.5, 0.2]))
    layers = lamina.layers(
        sigma_a=found.sigma_a[:, None], sigma_s=found.sigma_s[:, None], g=np.array([0.0, 0.8, 0.9])[:, None], ior=1.45)
    totals = lamina.slab(layers, incidence="normal" if definition in ("openpbr", "normal") else "diffuse")
    first, rest = totals.specular_reflectance, totals.diffuse_reflectance
    out = {"openpbr": rest / (1 - first), "furnace": first + rest}.get(definition, rest)
    assert out == pytest.approx(color, rel=1e-3)


def test_colors_and_albedos_are_inverse() -> None:
    albedo = np.linspace(0.0, 1.0, 101)
    looks: dict[str, Any] = {"ior": 1.33, "g": 0.5, "roughness": 0.4, "distribution": "ggx", "definition": "furnace"}
    color = lamina.half_space_color(albedo, **looks)
    assert (np.diff(color) > 0).all() and color[-1] == 1.0
    assert lamina.invert(color, **looks).albedo == pytest.approx(albedo, abs=1e-9)
    assert lamina.half_space_color(0.9, **looks, solve=True) == pytest.approx(lamina.half_space_color(0.9, **looks), rel=1e-3)


def test_textures_broadcast_with_maps_of_looks() -> None:
    texture = np.full((5, 4, 3), [0.5, 0.3, 0.2])
    roughness = np.linspace(0.0, 1.0, 5)[:, None, None]
    albedo = lamina.invert(texture, roughness=roughness).albedo
    assert albedo.shape == (5, 4, 3)
    for row in range(5):
        alone = lamina.invert([0.5, 0.3, 0.2], roughness=roughness[row, 0, 0]).albedo
        assert (albedo[row] == alone).all()
    assert (np.diff(albedo[:, 0, 0]) != 0).all()


def test_colors_out_of_reach_take_the_nearest_if_asked() -> None:
    assert lamina.invert([0.99, 0.5], definition="normal", clamp=True).albedo[0] == 1.0
    assert lamina.invert([0.0, 0.5], definition="furnace", clamp=True).albedo[0] == 0.0


WRONG: list[tuple[Callable[[], Any], str]] = [
    (lambda: lamina.invert([0.5, 0.99], definition="normal"), "color[1]: must be in [0, 0.9722], which is all"),
    (lambda: lamina.invert(0.05, definition="furnace"), "color: must be in [0.0769, 1], which is all"),
    (lambda: lamina.invert(0.5, ior=1.7), "ior: must be in [1, 1.6], but is 1.7"),
    (lambda: lamina.invert(0.5, g=0.96), "g: must be in [-0.3, 0.95], but is 0.96"),
    (lambda: lamina.invert(0.5, definition="openpbrr"), 'definition: must be one of'),
    (lambda: lamina.invert(0.5, radius=0), "radius: must be in (0, 1000000000) mm"),
    (lambda: lamina.invert(1.0, radius_meaning="diffuse_mean_free_path"), "without end"),
    (lambda: lamina.invert([0.5] * 2, g=[0.5] * 3), "color (2,), g (3,)"),
    (lambda: lamina.half_space_color(1.5), "albedo: must be in [0, 1], but is 1.5"),
]


@pytest.mark.parametrize(("call", "message"), WRONG)
def test_wrong_input_is_named(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(lamina.InvalidInput) as error:
        call()
    assert message in str(error.value)
