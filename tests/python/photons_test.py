# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Photons from Python: tallies against the command, against each other and against radiative transfer."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import lamina
import numpy as np
import pytest

COMMAND = Path(lamina.__file__).resolve().parents[2] / "lamina"
PLATE = lamina.layers(sigma_a=[0.1, 0.5], sigma_s=[5.0, 10.0], g=0.7, ior=1.4, thickness=[0.5, 1.0])
ALL: dict[str, Any] = dict(
    photons=2e4, seed=3, r=(20, 0.1), angles=9, log_r=(10, 0.01, 10.0), depth=(6, 0.25), fluence=True,
    bsdf=(4, 6), orders=True, path_length=(30, 0.5), time=(20, 2.0), frequencies=[0.0, 100.0],
    detectors=[0.5, 1.0], detector_width=0.2, directions=[(30, 0), (120, 0)])  # fmt: skip


def test_tallies_are_those_of_the_command() -> None:
    if not COMMAND.exists():
        pytest.skip(f"there is no command at {COMMAND}")
    done = subprocess.run(
        [str(COMMAND), "photons", "leaf", "--photons", "5000", "--seed", "4", "--tally", "r,angle",
         "--r-bins", "10", "--dr", "0.05", "--angle-bins", "6", "--json", "-"],
        check=True, capture_output=True)  # fmt: skip
    printed = json.loads(done.stdout)
    found = lamina.photons("leaf", photons=5e3, seed=4, r=(10, 0.05), angles=6)
    text = json.dumps(printed)
    for value in (found["r_reflected"][0, 1], found["angle_transmitted"][1, 2], found["diffuse_reflectance"][2]):
        assert json.dumps(float(value)) in text


def test_all_tallies_add_up() -> None:
    p = lamina.photons(PLATE, **ALL)
    for name, value in p.values.items():
        assert value.shape == p.error(name).shape and len(p.axes_of(name)) == value.ndim, name
        for axis, length in zip(p.axes_of(name), value.shape):
            assert len(p.coords[axis]) == length, (name, axis)
        assert np.isfinite(value).all() and (p.error(name) >= 0).all()
    total = (p["specular_reflectance"] + p["diffuse_reflectance"] + p["transmittance"]
             + p["absorptance"].sum() + p["unfinished"])
    assert total == pytest.approx(1.0, abs=1e-6)
    radius = p.coords["r"]
    assert (p["r_reflected"] * 2 * np.pi * radius * 0.1).sum() == pytest.approx(p["diffuse_reflectance"], rel=1e-6)
    assert p["time_reflected"].sum() * 2.0 == pytest.approx(p["diffuse_reflectance"], rel=1e-6)
    assert p["modulation_reflected_amplitude"][0] == pytest.approx(p["diffuse_reflectance"], rel=1e-6)
    assert p["order_reflected"].sum() == pytest.approx(p["diffuse_reflectance"], rel=1e-6)
    assert p.unit_of("modulation_reflected_phase") == "rad" and p.unit_of("fluence") == "1/mm²"


def test_photons_agree_with_radiative_transfer() -> None:
    exact = lamina.slab(PLATE)
    p = lamina.photons(PLATE, photons=2e5, seed=9)
    for name in ("diffuse_reflectance", "transmittance", "absorptance"):
        off = np.abs(p[name] - getattr(exact, name)) / p.error(name)
        assert (off < 4.5).all(), name


def test_results_show_themselves() -> None:
    pytest.importorskip("matplotlib")
    for arguments in ({}, {"r": (20, 0.1)}, {"log_r": (10, 0.1, 5.0)}, {"angles": 9}):
        p = lamina.photons("jade", photons=2e3, **arguments)  # type: ignore[arg-type]
        assert p._repr_png_() and "Photons" in repr(p)
    pytest.importorskip("xarray")
    dataset = lamina.photons(PLATE, **ALL).to_xarray()
    assert dataset["fluence"].dims == ("r", "depth") and "fluence_error" in dataset


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"r": 5}, "r: must be (count, width), but is 5"),
    ({"r": (0, 1)}, "r[0]: must be a whole number in [1, 1e7]"),
    ({"r": (5, -1)}, "r[1]: must be in (0, 1000000000] mm"),
    ({"r": (10**7, 1.0), "depth": (10**7, 1.0)}, "memory"),
    ({"depth": (5, 1)}, "depth: goes with r"),
    ({"fluence": True}, "fluence: goes with r and depth"),
    ({"log_r": (5, 2, 1)}, "low must be < high"),
    ({"bsdf": (5,)}, "bsdf: must be (cosines, azimuths)"),
    ({"detectors": [1]}, "must be given together"),
    ({"directions": [(90, 0)]}, "must not be 90"),
    ({"directions": [3]}, "directions[0]: must be (theta, phi)"),
    ({"beam": "flat"}, "beam_radius: must be given for a flat beam"),
    ({"beam": "round"}, "beam: must be one of"),
    ({"angles": 2.5}, "angles: must be a whole number"),
    ({"frequencies": [-1]}, "frequencies[0]: must be in"),
]


@pytest.mark.parametrize(("arguments", "message"), WRONG)
def test_wrong_arguments_are_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises((lamina.InvalidInput, lamina.Error)) as refused:
        lamina.photons("jade", photons=100, **arguments)
    assert message in str(refused.value) or message == "memory"
    with pytest.raises(lamina.InvalidInput, match="name: must be one of"):
        lamina.photons("jade", photons=100)["r_reflected"]


MCI = """1.0  # version
1 # runs
plate.mco A
20000 # photons
0.01 0.01 # dz dr [cm]
20 30 5 # bins
1 # layers
1.0 # above
1.4 1.0 50.0 0.8 0.1 # n mua mus g d [cm]
1.0 # below
"""


def test_mcml_files_are_runs(tmp_path: Path) -> None:
    (tmp_path / "plate.mci").write_text(MCI)
    (run,) = lamina.mcml(tmp_path / "plate.mci")
    assert run.layers.sigma_s.tolist() == [5.0] and run.layers.thickness.tolist() == [1.0]  # in mm
    assert run.photon_count == 20000 and run.r == (30, pytest.approx(0.1)) and run.angles == 5
    found = run.photons(seed=2)
    exact = lamina.slab(run.layers)
    off = abs(found["diffuse_reflectance"] - exact.diffuse_reflectance) / found.error("diffuse_reflectance")
    assert off < 4.5
    (tmp_path / "bad.mci").write_text(MCI.replace("50.0", "-50"))
    with pytest.raises(lamina.InvalidInput, match="bad.mci:9"):
        lamina.mcml(tmp_path / "bad.mci")
