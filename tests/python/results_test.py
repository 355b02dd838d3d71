# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""What results can do: units, dicts, tables, pictures."""

from __future__ import annotations

from typing import Any

import lamina
import numpy as np
import pytest


@pytest.fixture(scope="module")
def results() -> list[Any]:
    return [
        lamina.slab("donner_jensen_skin"),
        lamina.slab(lamina.skin(), derivatives=True),
        lamina.slab(lamina.skin(melanin=[0.1, 0.2]), method="diffusion"),
        lamina.slab("jade", method="monte_carlo", photons=2000),
        lamina.profile("leaf", method="diffusion", radii=16),
        lamina.profile(lamina.layers(sigma_a=0.1, sigma_s=1.0), method="dipole", radii=16),
        lamina.spatial_frequency("jade", [0.0, 1.0], accuracy=0.1),
        lamina.gaussians("jade", 4, accuracy=0.05),
        lamina.oblique_profile("jade", 30, radii=8, r_min=0.1, r_max=3),
    ]


def test_every_quantity_says_what_it_is(results: list[Any]) -> None:
    for result in results:
        doc = type(result).__doc__ or ""
        for name, unit in type(result).units().items():
            assert f"    {name}: " in doc, (type(result), name)
            assert unit == "1" or f"[{unit}]" in doc
        assert set(type(result).units()) <= set(result.to_dict())


def test_results_are_tables(results: list[Any]) -> None:
    pytest.importorskip("xarray")
    for result in results:
        dataset = result.to_xarray()
        assert len(dataset.data_vars) > 1
        for name, variable in dataset.data_vars.items():
            assert (variable.values == getattr(result, name)).all()
            assert variable.attrs["units"] == type(result).units()[name]
    skin = lamina.slab(lamina.skin(melanin=[0.1, 0.2])).to_xarray()
    assert skin.diffuse_reflectance.dims == ("axis_0", "wavelength")
    assert skin.diffuse_reflectance.sel(wavelength=540.0).shape == (2,)
    assert skin.absorptance.sel(layer="dermis").shape == (2, 8)


def test_results_show_themselves(results: list[Any]) -> None:
    for result in results:
        assert type(result).__name__ in repr(result)
        html = result._repr_html_()
        assert html.count("<tr>") == html.count("</tr>") > 1
        assert len(repr(result)) < 3000


def test_results_plot_themselves(results: list[Any]) -> None:
    pytest.importorskip("matplotlib")
    for result in results:
        picture = result._repr_png_()
        assert picture.startswith(b"\x89PNG"), type(result)
        assert result.plot().get_ylabel()


def test_results_cannot_be_changed() -> None:
    result = lamina.slab("jade")
    with pytest.raises(AttributeError):
        result.method = "other"  # type: ignore[misc]
    assert isinstance(result.diffuse_reflectance, np.ndarray)
