# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""BRDFs from Python: the command's values, energy, reciprocity."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import lamina
import numpy as np
import pytest

COMMAND = Path(lamina.__file__).resolve().parents[2] / "lamina"


@pytest.mark.parametrize("method", ["radiative_transfer", "first_order", "layered_bsdf"])
def test_values_are_those_of_the_command(method: str) -> None:
    if not COMMAND.exists():
        pytest.skip(f"there is no command at {COMMAND}")
    arguments = [str(COMMAND), "bsdf", "leaf", "--theta-i", "45", "--method", method, "--json", "-"]
    printed = json.loads(subprocess.run(arguments, check=True, capture_output=True).stdout)
    found = lamina.bsdf("leaf", 45, theta_o=printed["theta_o_deg"], phi=printed["phi_o_deg"], method=method)
    for name in ("brdf", "btdf"):
        wanted = np.array(printed[name]).transpose(2, 0, 1)
        assert getattr(found, name) == pytest.approx(wanted, rel=1e-9, abs=1e-12)
    assert found.unscattered_reflectance == pytest.approx(printed["unscattered_reflectance"], rel=1e-9)


def test_what_leaves_is_the_total() -> None:
    plate = lamina.layers(sigma_a=0.1, sigma_s=5.0, g=0.5, ior=1.4, thickness=1.0)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    cosines = (nodes + 1.0) / 2.0
    phi = np.linspace(0.0, 180.0, 25)
    found = lamina.bsdf(plate, 30, theta_o=np.degrees(np.arccos(cosines)), phi=phi)
    even = np.trapz(found.brdf, np.radians(phi), axis=-1) * 2.0
    total = float((even * cosines * weights / 2.0).sum() + found.unscattered_reflectance)
    exact = lamina.slab(plate, incidence=30.0)
    assert total == pytest.approx(float(exact.specular_reflectance + exact.diffuse_reflectance), abs=2e-3)


def test_directions_may_be_exchanged() -> None:
    there = lamina.bsdf("marble", 20, theta_o=[60], phi=[90]).brdf
    back = lamina.bsdf("marble", 60, theta_o=[20], phi=[90]).brdf
    assert there == pytest.approx(back, rel=5e-3)


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"theta_i": 90}, "theta_i: must be in [0, 90) degrees, but is 90"),
    ({"theta_i": 30, "theta_o": [95]}, "theta_o[0]: must be in [0, 90) degrees"),
    ({"theta_i": 30, "theta_o": 5}, "theta_o: must be angles in one row"),
    ({"theta_i": 30, "method": "photons"}, "method: must be one of"),
    ({"theta_i": 30, "method": "first_order", "accuracy": 0.1}, "accuracy: is for method"),
]


@pytest.mark.parametrize(("arguments", "message"), WRONG)
def test_wrong_angles_are_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(lamina.InvalidInput) as refused:
        lamina.bsdf("jade", **arguments)
    assert message in str(refused.value)


def test_lobes_are_drawn() -> None:
    pytest.importorskip("matplotlib")
    assert lamina.bsdf("leaf", 45)._repr_png_()
