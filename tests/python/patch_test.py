# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Patches from Python: the command's light, and gradients against differences."""

from __future__ import annotations

import json
import os
import pickle
import subprocess
from pathlib import Path
from typing import Any

import lamina
import numpy as np
import pytest

SOURCE = Path(os.environ.get("LAMINA_SOURCE", Path(__file__).parents[2]))
COMMAND = Path(lamina.__file__).resolve().parents[2] / "lamina"

random = np.random.default_rng(5)
MELANIN = random.uniform(0.02, 0.2, (24, 32))
BLOOD = random.uniform(0.005, 0.05, (24, 32))
ARGUMENTS: dict[str, Any] = dict(
    melanin=MELANIN, hemoglobin_dermis=BLOOD, wavelengths=[500, 600], mm_per_pixel=0.2)


def test_the_light_is_that_of_the_command(tmp_path: Path) -> None:
    if not COMMAND.exists():
        pytest.skip(f"there is no command at {COMMAND}")
    lamina.save_image(tmp_path / "melanin.exr", MELANIN[..., None].astype(np.float32), channels=["Y"])
    file = {
        "mm_per_pixel": 0.2, "bands": [500, 600],
        "skin": {"melanin": {"map": "melanin.exr"}, "hemoglobin_dermis": 0.02},
    }  # fmt: skip
    (tmp_path / "p.json").write_text(json.dumps({"lamina": "patch", "version": 1, **file}))
    subprocess.run(
        [str(COMMAND), "patch", str(tmp_path / "p.json"), "-o", str(tmp_path / "p.exr")],
        check=True, capture_output=True)  # fmt: skip
    printed, channels = lamina.load_image(tmp_path / "p.exr")
    by_dict = lamina.patch(file, folder=tmp_path)
    by_path = lamina.patch(tmp_path / "p.json")
    exact = MELANIN.astype(np.float32)
    by_arrays = lamina.patch(
        melanin=exact, hemoglobin_dermis=0.02, wavelengths=[500, 600], mm_per_pixel=0.2)
    for found in (by_dict, by_path, by_arrays):
        for i, name in enumerate(("500nm", "600nm")):
            assert (found.light[..., i] == printed[..., channels.index(name)]).all()
        assert (found.srgb_linear[..., 0] == printed[..., channels.index("R")]).all()


def test_differentiable_light_is_the_same_light() -> None:
    """Maps that change from texel to texel differ more: see DifferentiableSkinPatch."""
    y, x = np.mgrid[0:48, 0:64]
    arguments = {**ARGUMENTS, "melanin": 0.05 + 0.04 * np.sin(x / 6) * np.cos(y / 7), "hemoglobin_dermis": 0.02,
                 "wavelengths": [600]}  # fmt: skip
    plain = lamina.patch(**arguments)
    solved = lamina.patch(**arguments, derivatives=True)
    assert solved.light == pytest.approx(plain.light, rel=2e-2)
    assert solved.srgb_linear == pytest.approx(plain.srgb_linear, rel=2e-2)


@pytest.mark.parametrize("name", ["melanin", "hemoglobin_dermis", "saturation_dermis", "junction_absorption"])
def test_gradients_are_differences(name: str) -> None:
    """Of a weighted sum of all light, along a random change of one map."""
    arguments = {**ARGUMENTS, "saturation_dermis": np.full((24, 32), 0.7),
                 "junction_absorption": np.full((24, 32), 0.1)}  # fmt: skip
    weights = random.uniform(-1.0, 1.0, (24, 32, 2))
    solved = lamina.patch(**arguments, derivatives=True)
    gradient = solved.gradient(weights)[name]
    change = 0.02 * arguments[name] * random.uniform(0.5, 1.0, (24, 32))

    def loss(scale: float) -> float:
        moved = {**arguments, name: arguments[name] + scale * change}
        # The same ranges of absorption for all: those of the tables change with the maps.
        return float((lamina.patch(**moved, derivatives=True).light.astype(float) * weights).sum())

    expected = (loss(1.0) - loss(-1.0)) / 2.0
    size = float((np.abs(gradient) * change).sum())
    assert float((gradient * change).sum()) == pytest.approx(expected, abs=0.02 * size)
    assert size > 0.0


def test_even_maps_have_a_gradient() -> None:
    """Where a fit begins: all texels alike, and as many derivatives as of one number for all."""
    even = {**ARGUMENTS, "melanin": np.full((24, 32), 0.05), "hemoglobin_dermis": 0.02, "wavelengths": [600]}
    found = lamina.patch(**even, derivatives=True).gradient(np.ones((24, 32, 1)))["melanin"].sum()

    def all_light(melanin: float) -> float:
        nm = even["wavelengths"]
        skin = lamina.skin(melanin=melanin, hemoglobin_dermis=0.02, wavelengths=nm)
        return 24 * 32 * float(lamina.slab(skin, accuracy=1e-8).diffuse_reflectance.sum())

    assert found == pytest.approx((all_light(0.051) - all_light(0.049)) / 0.002, rel=0.02)


def test_gradients_of_light_and_colors() -> None:
    light = random.uniform(0.5, 1.5, (24, 32))
    solved = lamina.patch(**ARGUMENTS, light=light, derivatives=True)
    weights = random.uniform(0.0, 1.0, (24, 32, 2))
    # Light is linear: the gradient times the light is the loss.
    found = solved.gradient(weights)["light"]
    assert (found * light).sum() == pytest.approx((solved.light * weights).sum(), rel=1e-4)
    of_colors = random.uniform(0.0, 1.0, (24, 32, 3))
    by_colors = solved.gradient(by_srgb=of_colors)["light"]
    assert (by_colors * light).sum() == pytest.approx((solved.srgb_linear * of_colors).sum(), rel=1e-3)


def test_values_copy_and_show_themselves() -> None:
    solved = lamina.patch(**ARGUMENTS, derivatives=True)
    copy = pickle.loads(pickle.dumps(solved))
    assert (copy.light == solved.light).all()
    with pytest.raises(lamina.InvalidInput, match="derivatives=True"):
        copy.gradient(np.ones(copy.light.shape))
    pytest.importorskip("matplotlib")
    assert solved._repr_png_()


def test_maps_make_a_patch() -> None:
    recipe = SOURCE / "examples/skin/freckles.json"
    made = lamina.maps(recipe, changes={"width": 48, "height": 48})
    assert made.maps["melanin"].shape == (48, 48)
    assert (made.maps["melanin"] == lamina.maps(recipe, changes={"width": 48, "height": 48}).maps["melanin"]).all()
    other = lamina.maps(recipe, changes={"width": 48, "height": 48}, seed=77)
    assert (made.maps["melanin"] != other.maps["melanin"]).any()
    light = lamina.patch(**made.arguments(), wavelengths=[550])
    assert light.light.shape == (48, 48, 1)


WRONG: list[tuple[dict[str, Any], str]] = [
    ({}, "maps must be arrays (y, x) of one size, but are none"),
    ({"melanin": 0.1}, "but are none"),
    ({"melanin": [0.1]}, "melanin: must be a number or a map (y, x), but has the shape (1,)"),
    ({"melanin": np.full((4, 4), 0.1), "carotene": np.zeros((4, 5))}, "melanin (4, 4), carotene (4, 5)"),
    ({"melanin": np.full((4, 4), 9.0)}, "melanin[0, 0]: must be in [0, 0.5], but is 9"),
    ({"melanin": np.full((4, 4), np.nan)}, "but is nan"),
    ({"melanin": np.full((1, 20000), 0.1)}, "at most 16384"),
    ({"melanin": np.full((4, 4), 0.1), "light": -1}, "light: must be in"),
    ({"melanin": np.full((4, 4), 0.1), "mm_per_pixel": 0}, "mm_per_pixel: must be in"),
    ({"epidermis_thickness": np.full((4, 4), 0.1), "derivatives": True}, "must be a number with derivatives"),
    ({"source": "p.json", "melanin": 0.1}, "source: must be left out"),
    ({"source": {"skn": {}}}, 'patch: unknown key "skn"'),
    ({"source": 3}, "patch: must be a path or a dict"),
]


@pytest.mark.parametrize(("arguments", "message"), WRONG)
def test_wrong_patches_are_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(lamina.InvalidInput) as refused:
        lamina.patch(**arguments)
    assert message in str(refused.value)


def test_wrong_gradients_are_refused() -> None:
    solved = lamina.patch(**ARGUMENTS, derivatives=True)
    for by_light in (np.ones((3, 3, 3)), np.ones((24, 32)), "x", np.full((24, 32, 2), np.inf)):
        with pytest.raises(lamina.InvalidInput, match="by_light"):
            solved.gradient(by_light)
