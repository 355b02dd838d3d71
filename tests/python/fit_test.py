# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Fits from Python: the command's numbers, dicts with arrays, many at once."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import lamina
import numpy as np
import pytest

SOURCE = Path(os.environ.get("LAMINA_SOURCE", Path(__file__).parents[2]))
COMMAND = Path(lamina.__file__).resolve().parents[2] / "lamina"
LIQUID = SOURCE / "examples/measurements/liquid.json"


def measurement(sigma_a: np.ndarray[Any, Any], sigma_s: float) -> dict[str, Any]:
    """Totals of a plate, exact, as if measured."""
    nm = 500.0 + 50.0 * np.arange(len(sigma_a))
    plate = lamina.layers(sigma_a=sigma_a[:, None], sigma_s=sigma_s, g=0.8, ior=1.4, thickness=1.0)
    totals = lamina.slab(plate, accuracy=1e-7)
    layer = {"sigma_a": 1.0, "sigma_s": 5.0, "g": 0.8, "ior": 1.4, "thickness": 1.0}
    free = {"per_band": True, "scale": "logarithmic", "low": 1e-4, "high": 1e3}
    return {
        "name": "plate",
        "material": {"lamina": "material", "version": 1, "length_unit": "mm", "bands": nm, "ior_below": 1.0,
                     "layers": [layer]},
        "free": [{"parameter": f"layers[0].{name}", **free} for name in ("sigma_a", "sigma_s")],
        "measured": [{"kind": "totals", "wavelength_nm": nm, "unit": "fraction", "specular": "excluded",
                      "reflectance": totals.diffuse_reflectance, "transmittance": totals.transmittance,
                      "sd": 0.002}],
    }  # fmt: skip


def test_numbers_are_those_of_the_command() -> None:
    if not COMMAND.exists():
        pytest.skip(f"there is no command at {COMMAND}")
    done = subprocess.run([str(COMMAND), "fit", str(LIQUID), "--json", "-"], check=True, capture_output=True)
    printed = json.loads(done.stdout)
    found = lamina.fit(LIQUID)
    assert isinstance(found, lamina.Fit)
    for entry in printed["free"] if "free" in printed else printed["parameters"]:
        assert found[entry["parameter"]].tolist() == entry["value"]
    assert found.chi_squared == printed["chi_squared"]


def test_known_plates_are_found_again() -> None:
    sigma_a = np.array([0.05, 0.2, 0.8])
    found = lamina.fit(measurement(sigma_a, 12.0))
    assert isinstance(found, lamina.Fit)
    assert found["layers[0].sigma_a"] == pytest.approx(sigma_a, rel=1e-3)
    assert found["sigma_s"] == pytest.approx([12.0] * 3, rel=1e-3)
    assert (found.error("sigma_a") > 0).all() and found.has_converged
    assert found.material.layers.sigma_a[:, 0] == pytest.approx(sigma_a, rel=1e-3)
    assert "sigma_a at 500" in repr(found)
    pytest.importorskip("matplotlib")
    assert found._repr_png_()


def test_many_are_fitted_at_once() -> None:
    levels = [0.03, 0.1, 0.3, 1.0]
    found = lamina.fit([measurement(np.array([level]), 8.0) for level in levels])
    assert isinstance(found, list)
    assert [float(one["sigma_a"]) for one in found] == pytest.approx(levels, rel=1e-3)


def test_wrong_measurements_are_refused(tmp_path: Path) -> None:
    good = measurement(np.array([0.1]), 5.0)
    wrong: list[tuple[Any, str]] = [
        ({**good, "fre": []}, 'measurement: unknown key "fre"'),
        ({**good, "free": []}, "free"),
        ({**good, "measured": [{**good["measured"][0], "sd": -1}]}, "sd"),
        ({**good, "measured": [{**good["measured"][0], "reflectance": [np.nan]}]}, "must be a finite number"),
        ([], "is empty"),
        (3, "measurement: must be a path or a dict"),
    ]
    for one, message in wrong:
        with pytest.raises(lamina.InvalidInput) as refused:
            lamina.fit(one)
        assert message in str(refused.value)
    with pytest.raises(lamina.FileError):
        lamina.fit(tmp_path / "none.json")
    fitted = lamina.fit(good)
    assert isinstance(fitted, lamina.Fit)
    with pytest.raises(lamina.InvalidInput, match="parameter: must be one of"):
        fitted["melanin"]
