# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Recipes: skin, leaves and snow by what they are made of, with arrays of parameters."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _lamina
from ._input import Doubles, Incidence, broadcast, doubles, number, one_of
from ._input import incidence as check_incidence
from ._input import wavelengths as check_wavelengths
from ._progress import Progress, progress_of
from ._result import Array, Result, quantity
from ._layers import Layers

#: The eight wavelengths of Donner et al. 2008, §7 [nm].
SPECTRAL_BANDS = (400.0, 435.0, 470.0, 505.0, 540.0, 575.0, 610.0, 645.0)

_CONSTANTS = ("calibrated", "paper", "calibrated_diffusion")


def _parameters(
    recipe: str, given: dict[str, ArrayLike | None]
) -> tuple[dict[str, Doubles], tuple[int, ...]]:
    """Checked against the ranges of the recipe, and broadcast."""
    ranges = {n: (low, high, is_length) for n, low, high, is_length in _ranges(recipe)}
    arrays = {}
    for name, value in given.items():
        if value is None:
            continue
        low, high, is_length = ranges[name]
        unit = "mm" if is_length else ""
        may_be_infinite = name in ("dermis_thickness", "thickness") and recipe != "leaf"
        arrays[name] = doubles(name, value, low, high, unit=unit, infinite=may_be_infinite)
    return broadcast(arrays) if arrays else ({}, ())


@functools.lru_cache(maxsize=None)
def _ranges(recipe: str) -> tuple[tuple[str, float, float, bool], ...]:
    return tuple(getattr(_lamina, f"{recipe}_parameter_ranges")())


def _layers(
    stacks: _lamina.LayerStacks, shape: tuple[int, ...], nm: list[float], names: tuple[str, ...]
) -> Layers:
    axes = tuple(f"axis_{i}" for i in range(len(shape))) + ("wavelength",)
    return Layers(stacks, axes, {"wavelength": np.array(nm)}, names)


def skin(
    *,
    melanin: ArrayLike | None = None,
    melanin_blend: ArrayLike | None = None,
    hemoglobin_epidermis: ArrayLike | None = None,
    hemoglobin_dermis: ArrayLike | None = None,
    carotene: ArrayLike | None = None,
    saturation_epidermis: ArrayLike | None = None,
    saturation_dermis: ArrayLike | None = None,
    baseline_scale: ArrayLike | None = None,
    scattering_scale: ArrayLike | None = None,
    scattering_power: ArrayLike | None = None,
    epidermis_thickness: ArrayLike | None = None,
    junction_absorption: ArrayLike | None = None,
    dermis_thickness: ArrayLike | None = None,
    constants: str = "calibrated",
    wavelengths: ArrayLike = SPECTRAL_BANDS,
) -> Layers:
    """Skin by what it is made of: epidermis over dermis, at each wavelength.

    Parameters are arrays that broadcast; what is None has the value of `constants`. The stacks
    have the parameters' shape and (wavelengths,). Source: Donner et al. 2008, Table 1 and
    Eqs. 10-12; docs/materials.md.

    :param melanin: volume fraction in the epidermis.
    :param melanin_blend: share of eumelanin in it.
    :param hemoglobin_epidermis: volume fraction of whole blood in the epidermis.
    :param hemoglobin_dermis: volume fraction of whole blood in the dermis.
    :param carotene: volume fraction of a 1 g/L solution in the epidermis.
    :param saturation_epidermis: oxygenated share of that blood.
    :param saturation_dermis: oxygenated share of that blood.
    :param baseline_scale: times the absorption of skin without blood and pigment.
    :param scattering_scale: times the scattering of Eq. 12.
    :param scattering_power: further factor (nm / 550)^power.
    :param epidermis_thickness: [mm].
    :param junction_absorption: of the sheet between the layers, natural, per crossing.
    :param dermis_thickness: [mm]; inf for a half-space.
    :param constants: "calibrated", to 100 measured forearms with exact totals; "paper";
        "calibrated_diffusion".
    :param wavelengths: [nm], in [350, 1000].
    :raises InvalidInput: naming the parameter, its range, and which element is out of it.

    >>> import lamina
    >>> pale_to_dark = lamina.skin(melanin=[0.01, 0.05, 0.2], wavelengths=[450, 550, 650])
    >>> lamina.slab(pale_to_dark, incidence="diffuse").diffuse_reflectance.round(2)
    array([[0.17, 0.21, 0.44],
           [0.05, 0.08, 0.18],
           [0.01, 0.01, 0.03]])
    """
    arguments = dict(locals())
    nm = check_wavelengths("wavelengths", arguments.pop("wavelengths"), 350.0, 1000.0)
    one_of("constants", arguments.pop("constants"), _CONSTANTS)
    arrays, shape = _parameters("skin", arguments)
    stacks = _lamina.skin_stacks(arrays, list(shape), constants, nm)
    return _layers(stacks, shape, nm, _skin_names(stacks.layer_count))


def _skin_names(count: int) -> tuple[str, ...]:
    names = {2: ("epidermis", "dermis"), 3: ("epidermis", "junction", "dermis")}
    return names.get(count, tuple(f"layer {i}" for i in range(count)))


def leaf(
    *,
    chlorophyll: ArrayLike | None = None,
    carotenoids: ArrayLike | None = None,
    anthocyanins: ArrayLike | None = None,
    brown_pigments: ArrayLike | None = None,
    water: ArrayLike | None = None,
    dry_matter: ArrayLike | None = None,
    structure: ArrayLike | None = None,
    palisade_share: ArrayLike | None = None,
    thickness: ArrayLike | None = None,
    wavelengths: ArrayLike = SPECTRAL_BANDS,
) -> Layers:
    """A leaf by what it holds per area: palisade cells over spongy cells.

    What is None is as in a green oak leaf. Source: absorption of Feret et al. 2017.

    :param chlorophyll: a and b [µg/cm²].
    :param carotenoids: [µg/cm²].
    :param anthocyanins: [µg/cm²].
    :param brown_pigments: of dying leaves; no unit.
    :param water: equivalent thickness [cm].
    :param dry_matter: [g/cm²].
    :param structure: reduced scattering optical thickness of the whole leaf.
    :param palisade_share: of what absorbs.
    :param thickness: [mm].
    :param wavelengths: [nm], in [400, 1000].
    :raises InvalidInput: as `skin`.

    >>> import lamina
    >>> oak = lamina.leaf(wavelengths=[550, 680, 850])
    >>> lamina.slab(oak).transmittance.round(2)
    array([0.12, 0.01, 0.52])
    """
    arguments = dict(locals())
    nm = check_wavelengths("wavelengths", arguments.pop("wavelengths"), 400.0, 1000.0)
    arrays, shape = _parameters("leaf", arguments)
    return _layers(_lamina.leaf_stacks(arrays, list(shape), nm), shape, nm, ("palisade", "spongy"))


def snow(
    *,
    grain_radius: ArrayLike | None = None,
    density: ArrayLike | None = None,
    soot: ArrayLike | None = None,
    dust: ArrayLike | None = None,
    thickness: ArrayLike | None = None,
    wavelengths: ArrayLike = SPECTRAL_BANDS,
) -> Layers:
    """Snow: grains of ice in air, with soot and dust between them.

    What is None is as in clean, settled snow. Source: docs/materials.md.

    :param grain_radius: of spheres with as much surface per volume [mm].
    :param density: [kg/m³].
    :param soot: black carbon, millionths of the mass.
    :param dust: mineral dust, millionths of the mass.
    :param thickness: [mm]; inf for deep snow.
    :param wavelengths: [nm], in [380, 1000].
    :raises InvalidInput: as `skin`.

    >>> import lamina
    >>> lamina.slab(lamina.snow(soot=[0.0, 0.5], wavelengths=[550])).diffuse_reflectance.round(2)
    array([[0.98],
           [0.91]])
    """
    arguments = dict(locals())
    nm = check_wavelengths("wavelengths", arguments.pop("wavelengths"), 380.0, 1000.0)
    arrays, shape = _parameters("snow", arguments)
    return _layers(_lamina.snow_stacks(arrays, list(shape), nm), shape, nm, ("snow",))


@dataclass(frozen=True, eq=False, repr=False)
class SkinColors(Result):
    """How much light skins reflect, and their colors."""

    reflectance: Array = quantity("reflected light, without what the surface mirrors", axes=("wavelength",))
    srgb_linear: Array = quantity("its color under D65, linear sRGB", axes=("channel",))
    specular_reflectance: float = quantity("what the surface mirrors")

    @property
    def srgb(self) -> Array:
        """The same encoded for screens, in [0, 1], axes (..., channel)."""
        linear = np.clip(self.srgb_linear, 0.0, 1.0)
        return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def skin_colors(
    *,
    melanin: ArrayLike | None = None,
    melanin_blend: ArrayLike | None = None,
    hemoglobin_epidermis: ArrayLike | None = None,
    hemoglobin_dermis: ArrayLike | None = None,
    carotene: ArrayLike | None = None,
    saturation_epidermis: ArrayLike | None = None,
    saturation_dermis: ArrayLike | None = None,
    baseline_scale: ArrayLike | None = None,
    scattering_scale: ArrayLike | None = None,
    scattering_power: ArrayLike | None = None,
    epidermis_thickness: ArrayLike | None = None,
    junction_absorption: float | None = None,
    constants: str = "calibrated",
    wavelengths: ArrayLike = SPECTRAL_BANDS,
    incidence: Incidence = "diffuse",
    progress: Progress = None,
) -> SkinColors:
    """Reflectance and color of many skins by radiative transfer, from a table: some 10 µs each.

    Parameters are those of `skin`, of a half-space. The table is made in the first call, in half a
    second, and kept; its error is below 1e-3 of the reflectance.

    :param incidence: "normal", "diffuse", or an angle [degrees] in [0, 90).
    :raises InvalidInput: as `skin`; Interrupted.

    >>> import lamina, numpy as np
    >>> tones = lamina.skin_colors(melanin=np.linspace(0.01, 0.3, 5)[:, None],
    ...                            hemoglobin_dermis=[0.005, 0.02])
    >>> tones.srgb_linear.shape
    (5, 2, 3)
    """
    arguments = dict(locals())
    for name in ("constants", "wavelengths", "incidence", "progress", "junction_absorption"):
        del arguments[name]
    nm = tuple(check_wavelengths("wavelengths", wavelengths, 350.0, 1000.0))
    one_of("constants", constants, _CONSTANTS)
    is_diffuse, theta = check_incidence(incidence)
    arrays, shape = _parameters("skin", arguments)
    junction = None
    if junction_absorption is not None:
        _, low, high, _ = next(r for r in _ranges("skin") if r[0] == "junction_absorption")
        junction = number("junction_absorption", junction_absorption, low, high)
        arrays["junction_absorption"] = np.full(shape, junction)
    table = _skin_table(nm, is_diffuse, theta, constants, junction, progress)
    reflectance = table.reflectance(arrays, list(shape), constants)
    return SkinColors(
        axes=tuple(f"axis_{i}" for i in range(len(shape))),
        coords={"wavelength": np.array(nm), "channel": np.array(["R", "G", "B"])},
        reflectance=reflectance,
        srgb_linear=reflectance @ table.color_weights,
        specular_reflectance=table.specular_reflectance,
    )


_tables: dict[Any, _lamina.SkinTable] = {}


def _skin_table(
    nm: tuple[float, ...],
    is_diffuse: bool,
    theta: float,
    constants: str,
    junction: float | None,
    progress: Progress,
) -> _lamina.SkinTable:
    key = (nm, is_diffuse, theta, constants, junction)
    table = _tables.get(key)
    if table is None:
        fixed = {} if junction is None else {"junction_absorption": np.array(junction)}
        with progress_of(progress, "table of skin") as callback:
            table = _lamina.SkinTable.made(list(nm), is_diffuse, theta, fixed, constants, callback)
        while len(_tables) >= 16:
            _tables.pop(next(iter(_tables)), None)
        _tables[key] = table
    return table
