# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""The solvers from Python: laws that hold whatever the numbers, and the command's own results."""

from __future__ import annotations

import copy
import json
import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import lamina
import numpy as np
import pytest

COMMAND = Path(lamina.__file__).resolve().parents[2] / "lamina"


def command(*arguments: str) -> Any:
    if not COMMAND.exists():
        pytest.skip(f"there is no command at {COMMAND}")
    done = subprocess.run([str(COMMAND), *arguments, "--json", "-"], check=True, capture_output=True)
    return json.loads(done.stdout)


def test_slab_is_what_the_command_prints() -> None:
    printed = command("slab", "donner_jensen_skin", "--incidence", "diffuse")
    found = lamina.slab("donner_jensen_skin", incidence="diffuse")
    for name in ("specular_reflectance", "diffuse_reflectance", "transmittance", "estimated_error"):
        assert getattr(found, name) == pytest.approx(printed[name], rel=1e-14), name
    assert found.absorptance.T == pytest.approx(np.array(printed["absorptance"]), rel=1e-14)


def test_photons_are_those_of_the_command() -> None:
    arguments = ("--method", "monte_carlo", "--photons", "20000", "--seed", "7", "--independent-bands")
    printed = command("slab", "marble", *arguments)
    found = lamina.slab("marble", method="monte_carlo", photons=2e4, seed=7, independent_bands=True)
    assert found.diffuse_reflectance.tolist() == printed["diffuse_reflectance"]
    assert found.standard_error is not None
    error = found.standard_error["diffuse_reflectance"].tolist()
    assert error == printed["standard_error"]["diffuse_reflectance"]


@pytest.mark.parametrize("method", ["radiative_transfer", "diffusion", "dipole", "monte_carlo"])
def test_profile_is_what_the_command_prints(method: str) -> None:
    more = ["--photons", "20000"] if method == "monte_carlo" else []
    printed = command("profile", "marble", "--method", method, "--radii", "16", *more)
    photons = 2e4 if more else None
    found = lamina.profile("marble", method=method, radii=16, photons=photons)
    assert found.r == pytest.approx(printed["r_mm"], rel=1e-14)
    assert found.reflectance.T == pytest.approx(np.array(printed["reflectance_profile"]), rel=1e-12)
    assert found.total_reflectance == pytest.approx(printed["total_reflectance"], rel=1e-12)
    assert found.per == printed["per"]


def test_oblique_beams_are_what_the_command_prints() -> None:
    grid = ("--radii", "8", "--r-min", ".05", "--r-max", "2", "--moments", "3")
    printed = command("profile", "jade", "--incidence", "45", *grid)
    found = lamina.oblique_profile("jade", 45, radii=8, r_min=0.05, r_max=2, moments=3)
    turned = np.array(printed["reflectance_moments"]).transpose(2, 0, 1)  # [band][r][m]
    assert found.reflectance_moments == pytest.approx(turned, rel=1e-9)
    assert found.reflectance(0.0) == pytest.approx(turned.sum(axis=-1), rel=1e-9)


def test_waves_are_what_the_command_prints() -> None:
    grid = ("--radii", "2", "--r-min", "1", "--r-max", "2", "--accuracy", ".1")
    printed = command("profile", "jade", "--domain", "frequency", "--derivatives", *grid)
    found = lamina.spatial_frequency("jade", printed["k_per_mm"], accuracy=0.1, derivatives=True)
    assert found.reflectance.T == pytest.approx(np.array(printed["reflectance"]), rel=1e-9)
    assert found.derivatives is not None
    by_sigma_a = np.array(printed["derivatives"]["reflectance"]["by_sigma_a"])  # [layer][k][band]
    ours = found.derivatives["reflectance"]["sigma_a"]
    assert ours == pytest.approx(by_sigma_a.transpose(2, 1, 0), rel=1e-9)


def test_gaussians_add_up_to_the_profile() -> None:
    sums = lamina.gaussians("marble", 12)
    exact = lamina.profile("marble", radii=8, r_min=0.5, r_max=4.0)
    total = sums.reflectance_weights.sum(axis=-1)
    assert total == pytest.approx(exact.total_reflectance, rel=0.01)
    assert sums.reflectance(exact.r) == pytest.approx(exact.reflectance, rel=0.1)


def test_light_is_conserved_in_any_stack() -> None:
    random = np.random.default_rng(1)
    shape = (50, 3)
    stacks = lamina.layers(
        sigma_a=random.uniform(0, 1, shape),
        sigma_s=random.uniform(0, 20, shape),
        g=random.uniform(-0.5, 0.9, shape),
        ior=random.uniform(1, 1.6, shape),
        thickness=random.uniform(0.01, 3, shape),
    )
    for incidence in ("normal", "diffuse", 60.0):
        t = lamina.slab(stacks, incidence=incidence)
        reflected = t.specular_reflectance + t.diffuse_reflectance
        total = reflected + t.transmittance + t.absorptance.sum(axis=-1)
        assert total == pytest.approx(np.ones(50), abs=1e-4)


def test_derivatives_are_those_of_the_totals() -> None:
    def reflected(sigma_a: float) -> float:
        one = lamina.layers(sigma_a=sigma_a, sigma_s=4.0, g=0.5, ior=1.3, thickness=1.0)
        return float(lamina.slab(one, accuracy=1e-9).diffuse_reflectance)

    stack = lamina.layers(sigma_a=0.2, sigma_s=4.0, g=0.5, ior=1.3, thickness=1.0)
    found = lamina.slab(stack, derivatives=True, accuracy=1e-9)
    assert found.derivatives is not None
    slope = (reflected(0.201) - reflected(0.199)) / 0.002
    assert found.derivatives["diffuse_reflectance"]["sigma_a"][0] == pytest.approx(slope, rel=1e-4)


def test_stacks_at_once_are_stacks_one_by_one() -> None:
    sigma_a = np.geomspace(0.01, 1.0, 6).reshape(2, 3)
    many = lamina.slab(lamina.layers(sigma_a=sigma_a[..., None], sigma_s=3.0, ior=1.4))
    assert many.diffuse_reflectance.shape == (2, 3) and many.absorptance.shape == (2, 3, 1)
    for at in np.ndindex(2, 3):
        one = lamina.slab(lamina.layers(sigma_a=sigma_a[at], sigma_s=3.0, ior=1.4))
        assert one.diffuse_reflectance.shape == ()
        assert one.diffuse_reflectance == many.diffuse_reflectance[at]
    turned = lamina.layers(sigma_a=[0.1, 0.5], sigma_s=2.0, thickness=[0.2, 1.0]).flipped()
    assert turned.sigma_a.tolist() == [0.5, 0.1] and turned.thickness.tolist() == [1.0, 0.2]


def test_a_recipe_is_the_material_of_its_file() -> None:
    nm = [450.0, 550.0, 650.0]
    file = lamina.material({"length_unit": "mm", "bands": nm, "skin": {"melanin": 0.07}})
    recipe = lamina.skin(melanin=[0.01, 0.07], wavelengths=nm)
    assert recipe.axes == ("axis_0", "wavelength")
    assert recipe.sigma_a[1] == pytest.approx(file.layers.sigma_a, rel=1e-12)
    assert recipe.names == file.layer_names
    by_file = lamina.slab(file, incidence="diffuse").diffuse_reflectance
    by_recipe = lamina.slab(recipe, incidence="diffuse").diffuse_reflectance
    assert by_recipe[1] == pytest.approx(by_file, rel=1e-12)


def test_skin_colors_are_those_of_the_solver() -> None:
    melanin, blood = np.array([0.01, 0.05, 0.2])[:, None], np.array([0.004, 0.02])
    table = lamina.skin_colors(melanin=melanin, hemoglobin_dermis=blood)
    skins = lamina.skin(melanin=melanin, hemoglobin_dermis=blood)
    solved = lamina.slab(skins, incidence="diffuse")
    assert table.reflectance == pytest.approx(solved.diffuse_reflectance, rel=1e-3)
    assert table.specular_reflectance == pytest.approx(solved.specular_reflectance[0, 0, 0], rel=1e-3)
    red, green, blue = table.srgb_linear[0, 0]
    assert red > green > blue  # skin
    assert (table.srgb >= 0).all() and (table.srgb <= 1).all()


def test_values_pickle_copy_and_compare() -> None:
    values: list[Any] = [
        lamina.material("jade"),
        lamina.material("skin_type_2"),
        lamina.skin(melanin=[0.1, 0.2]),
        lamina.layers(sigma_a=[0.1, 1.0], sigma_s=1.0, thickness=[1.0, 2.0], phase="rayleigh"),
    ]
    for value in values:
        assert pickle.loads(pickle.dumps(value)) == value
        assert copy.deepcopy(value) == value and copy.copy(value) == value
    jade = lamina.material("jade")
    assert jade != lamina.material("marble")
    assert lamina.skin(melanin=0.1) != lamina.skin(melanin=0.2)
    assert lamina.material(jade.to_dict()).to_json() == jade.to_json()
    with pytest.raises(AttributeError):
        jade.name = "other"  # type: ignore[misc]
    result = lamina.slab("jade")
    again = pickle.loads(pickle.dumps(result))
    assert (again.diffuse_reflectance == result.diffuse_reflectance).all()
    assert again.method == result.method


def test_a_material_is_taken_at_other_wavelengths() -> None:
    skin = lamina.material("skin_type_2").at([500, 600])
    assert skin.wavelengths is not None and skin.wavelengths.tolist() == [500, 600]
    assert skin.at([450]).layers == lamina.material("skin_type_2", wavelengths=[450]).layers
    with pytest.raises(lamina.InvalidInput):
        lamina.material("jade").at([500])


def test_a_million_numbers_are_not_copied() -> None:
    from lamina._input import doubles

    numbers = np.linspace(0.0, 1.0, 10**6)
    assert np.shares_memory(doubles("x", numbers), numbers)
    # Results belong to the library's own memory, which NumPy only looks at.
    assert lamina.skin_colors(melanin=np.full(1000, 0.1)).reflectance.base is not None


def test_nothing_heavy_is_imported() -> None:
    """The time itself is measured in benchmarks/."""
    code = "import sys, lamina; print([m for m in ('matplotlib', 'xarray', 'scipy') if m in sys.modules])"
    place = {**os.environ, "PYTHONPATH": str(Path(lamina.__file__).parents[1])}
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, env=place)
    assert done.stdout.strip() == "[]"


def test_a_swatch_shows_the_material() -> None:
    picture = lamina.material("jade").swatch(side=16, samples=1)
    red, green, blue = picture.image[8, 6]
    assert green > red and green > blue  # jade
    assert lamina.material("green_leaf").swatch(side=8, samples=1).image.shape == (8, 8, 3)
