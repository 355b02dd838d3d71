# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Acquisition from Python: the command's maps, arrays for photographs, Ctrl-C; and the choice of bands."""

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

random = np.random.default_rng(2)
MELANIN = np.where(np.hypot(*(np.mgrid[0:12, 0:16] - 6.0)) < 3.0, 0.06, 0.015)
BLOOD = np.linspace(0.008, 0.016, 16) * np.ones((12, 1))
BANDS = [420.0, 540.0]


@pytest.fixture(scope="module")
def photograph() -> Any:
    """In two bands, with light that travels sideways and noise."""
    light = lamina.patch(melanin=MELANIN, hemoglobin_dermis=BLOOD, wavelengths=BANDS, mm_per_pixel=0.2).light
    return (light * (1.0 + 0.002 * random.standard_normal(light.shape))).astype(np.float32)


def capture(photograph: Any, **more: Any) -> dict[str, Any]:
    return {
        "name": "spot", "mm_per_pixel": 0.2, "incidence": "normal", "population": "none",
        "numbers": ["melanin", "hemoglobin_dermis"],
        "images": [{"image": photograph, "encoding": "linear", "sensor": {"wavelength_nm": BANDS}}], **more,
    }  # fmt: skip


def test_maps_are_found_again(photograph: Any) -> None:
    found = lamina.acquire(capture(photograph))
    assert isinstance(found, lamina.AcquiredSkin) and found.lateral == "transport"
    assert found.maps["melanin"][5:8, 5:8].mean() == pytest.approx(0.06, rel=0.1)
    assert np.median(found.maps["melanin"]) == pytest.approx(0.015, rel=0.05)
    assert found.maps["hemoglobin_dermis"].mean(axis=0)[2:-2] == pytest.approx(BLOOD[0, 2:-2], rel=0.15)
    assert found.mask.all() and (found.residual < 0.02).all()
    assert (found.deviations["melanin"] > 0.0).all() and found.prior_share["melanin"] < 0.2
    assert list(found.coords["band"]) == ["420nm", "540nm"]
    again = pickle.loads(pickle.dumps(found))
    assert (again.maps["melanin"] == found.maps["melanin"]).all()
    light = lamina.patch(found.skin_maps(), wavelengths=BANDS).light
    assert light == pytest.approx(photograph, rel=0.05)
    pytest.importorskip("matplotlib")
    assert found._repr_png_()


def test_maps_are_those_of_the_command(tmp_path: Path) -> None:
    if not COMMAND.exists():
        pytest.skip(f"there is no command at {COMMAND}")
    colors = lamina.skin_colors(melanin=MELANIN, hemoglobin_dermis=BLOOD).srgb_linear.astype(np.float32)
    lamina.save_image(tmp_path / "colors.exr", colors)
    image = {"encoding": "linear", "sensor": "srgb"}
    (tmp_path / "c.json").write_text(
        json.dumps({"lamina": "capture", "version": 1, "images": [{"image": "colors.exr", **image}]}))
    subprocess.run([str(COMMAND), "acquire", str(tmp_path / "c.json"), "-o", str(tmp_path / "c")],
                   check=True, capture_output=True)
    printed = json.loads((tmp_path / "c/result.json").read_text())
    by_arrays = lamina.acquire({"images": [{"image": colors, **image}]})
    by_arrays.save(tmp_path / "again")
    for entry in printed["numbers"]:
        for suffix in (".exr", ".sd.exr"):
            theirs, _ = lamina.load_image(tmp_path / "c" / (entry["name"] + suffix))
            ours, _ = lamina.load_image(tmp_path / "again" / (entry["name"] + suffix))
            assert (theirs == ours).all()
        assert by_arrays.prior_share[entry["name"]] == pytest.approx(entry["prior_share"], rel=1e-9)
    assert by_arrays.residual == pytest.approx(printed["residual"], rel=1e-9)
    assert isinstance(by_arrays, lamina.AcquiredSkin)
    assert by_arrays.mean_ciede2000 == pytest.approx(printed["mean_ciede2000"], rel=1e-9)


def test_a_stop_hands_over_the_maps_so_far(photograph: Any) -> None:
    # After the table of uniform skin, within the steps.
    with pytest.raises(lamina.Interrupted) as stopped:
        lamina.acquire(capture(photograph), most_forwards=60, progress=lambda f: f < 0.15)
    partial: Any = stopped.value.result
    assert partial.maps["melanin"].shape == (12, 16) and not partial.has_errors
    more = lamina.acquire(capture(photograph), start=partial, most_forwards=20)
    assert isinstance(more, lamina.AcquiredSkin) and more.has_errors
    assert more.maps["melanin"][5:8, 5:8].mean() > 0.04


def test_leaves_are_acquired() -> None:
    nm = np.arange(500.0, 801.0, 20.0)
    leaves = lamina.slab(lamina.leaf(chlorophyll=np.linspace(20.0, 60.0, 6), wavelengths=nm))
    cube = np.broadcast_to(leaves.diffuse_reflectance[None], (4, 6, len(nm))) + 0.002 * random.standard_normal((4, 6, len(nm)))
    found = lamina.acquire({
        "incidence": "normal", "leaf": {"ground": 0.0, "has_background": False},
        "images": [{"image": cube, "encoding": "linear", "sensor": {"wavelength_nm": nm}}]})
    assert isinstance(found, lamina.AcquiredLeaf)
    across = np.nanmedian(found.maps["chlorophyll"], axis=0)
    assert (np.diff(across) > 0).all() and across[0] < 35 < 45 < across[-1]


WRONG: list[tuple[Any, dict[str, Any], str]] = [
    ({"images": []}, {}, "images"),
    ({"images": [{"image": np.ones((2, 2, 3)), "encoding": "linear", "sensor": "srgp"}]}, {}, "sensor"),
    ({"images": [{"image": np.ones((2, 2, 2, 3)), "encoding": "linear", "sensor": "srgb"}]}, {}, "image: must be an array"),
    ({"images": [{"image": np.ones((2, 2, 3)), "encoding": "linear", "sensor": "srgb"}]}, {"lateral": "transport"}, "mm_per_pixel"),
    ({"images": [{"image": np.full((2, 2, 3), 0.3), "encoding": "linear", "sensor": "srgb"}]}, {"robust": 3.0}, "are not read"),
    ({"images": [{"image": np.full((2, 2, 3), np.nan), "encoding": "linear", "sensor": "srgb"}]}, {}, ""),
    ({}, {"lateral": "sideways"}, "lateral: must be one of"),
    ({}, {"start": 3}, "start: must be an AcquiredSkin"),
    (3, {}, "capture: must be a path or a dict"),
]


@pytest.mark.parametrize(("source", "options", "message"), WRONG)
def test_wrong_captures_are_refused(source: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises(lamina.Error) as refused:
        lamina.acquire(source, **options)
    assert message in str(refused.value)


def test_bands_are_those_of_the_command() -> None:
    if not COMMAND.exists():
        pytest.skip(f"there is no command at {COMMAND}")
    numbers = ["melanin", "hemoglobin_dermis"]
    done = subprocess.run([str(COMMAND), "filters", "--count", "2", "--numbers", ",".join(numbers), "--compare", "450,600",
                           "--json", "-"], check=True, capture_output=True)
    printed = {row["name"]: row for row in json.loads(done.stdout)["sets"]}
    found = lamina.filters(2, numbers=numbers, compare=[450, 600])
    for ours, theirs in (("best", "best"), ("evenly_spaced", "evenly spaced"), ("compared", "compared"), ("all", "all")):
        assert found.sets[ours]["wavelengths"].tolist() == printed[theirs]["wavelength_nm"]
        assert found.sets[ours]["score"] == pytest.approx(printed[theirs]["score"], rel=1e-9)
    assert found.wavelengths.tolist() == printed["best"]["wavelength_nm"]
    pytest.importorskip("matplotlib")
    assert found._repr_png_()


@pytest.mark.parametrize(("arguments", "message"), [
    ({"count": 3}, "count: must lie in [5, 31]"),
    ({"numbers": "melanin"}, "numbers: must be a list of names"),
    ({"numbers": ["melanine"]}, "melanin"),
    ({"candidates": [500, 400]}, "candidates: must be ascending"),
    ({"widths": [1.0, 2.0]}, "widths: must be one or 31"),
    ({"compare": [405.5]}, "compare: must be of the candidates"),
    ({"noise": 0}, "noise: must be in"),
])  # fmt: skip
def test_wrong_choices_are_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(lamina.InvalidInput) as refused:
        lamina.filters(**arguments)
    assert message in str(refused.value)
