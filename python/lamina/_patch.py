# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""A flat piece of skin whose numbers are maps, under a pattern of light; with the gradient."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lamina
from ._input import PathLike, doubles, flag, number, one_of
from ._input import wavelengths as check_wavelengths
from ._lamina import InvalidInput
from ._progress import Progress, progress_of
from ._recipes import _CONSTANTS, _ranges, SPECTRAL_BANDS
from ._render import file_or_text, settings_of
from ._result import Array, Result, quantity, setting

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Map = NDArray[np.float32]

#: Numbers of skin that change scattering: maps of them have no gradient.
_SCATTERING = ("scattering_scale", "scattering_power", "epidermis_thickness", "dermis_thickness")


@dataclass(frozen=True, eq=False, repr=False)
class PatchLight(Result):
    """The light that leaves a patch; mirror reflection is left out."""

    light: Map = quantity("that leaves, in the unit of what arrives", axes=("y", "x", "band"), shared=True)
    srgb_linear: Map = quantity("its color under D65, linear sRGB", axes=("y", "x", "channel"), shared=True)
    mm_per_pixel: float = quantity("of the maps", unit="mm")
    transmitted: Map | None = quantity(
        "light that leaves below", axes=("y", "x", "band"), shared=True, optional=True)
    mean_reflectance: Array | None = quantity(
        "all that leaves over all that arrives", axes=("band",), shared=True, optional=True)
    fit_error: Array | None = quantity(
        "the largest of the tables of Gaussians", axes=("band",), shared=True, optional=True)
    color_weights: Array | None = quantity(
        "that make colors of bands", axes=("band", "channel"), shared=True, optional=True)
    warnings: tuple[str, ...] = ()
    _solver: Any = None

    def gradient(
        self,
        by_light: ArrayLike | None = None,
        *,
        by_srgb: ArrayLike | None = None,
        progress: Progress = None,
    ) -> dict[str, Map]:
        """Derivatives of a scalar by every texel of every map, by the adjoint; `light` is that of the
        light that arrives. Call `patch` with `derivatives=True` first.

        :param by_light: its derivatives by `light`, axes (y, x, band).
        :param by_srgb: its derivatives by `srgb_linear`, axes (y, x, channel).
        :raises InvalidInput: for another shape, or without `derivatives=True`; Interrupted.
        """
        if self._solver is None:
            raise InvalidInput("gradient: patch must be called with derivatives=True")
        total = np.zeros(self.light.shape)
        for name, given, like in (("by_light", by_light, self.light), ("by_srgb", by_srgb, self.srgb_linear)):
            if given is None:
                continue
            array = doubles(name, given)
            if array.shape != like.shape:
                raise InvalidInput(f"{name}: must have the shape {like.shape}, but has {array.shape}")
            total += array if name == "by_light" else array @ self.color_weights.T  # type: ignore[union-attr]
        planes = np.ascontiguousarray(np.moveaxis(total, -1, 0), dtype=np.float32)
        with progress_of(progress, "gradient") as callback:
            found: dict[str, Map] = self._solver.gradient(planes, callback)
        return found

    def __reduce__(self) -> Any:
        # A copy has no gradient: what it needs is the library's.
        fields = {name: value for name, value in self.to_dict().items() if name != "_solver"}
        return _restored, (fields,)

    def _draw(self, ax: Axes) -> None:
        linear = np.clip(self.srgb_linear, 0.0, 1.0)
        encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
        height, width = linear.shape[:2]
        scale = self.mm_per_pixel
        ax.imshow(encoded, extent=(0.0, width * scale, height * scale, 0.0))
        ax.set(xlabel="mm", ylabel="mm")


def _restored(fields: dict[str, Any]) -> PatchLight:
    return PatchLight(**fields)


PatchLike = Union[str, "os.PathLike[str]", Mapping[str, Any]]


def patch(
    source: PatchLike | None = None,
    *,
    folder: PathLike | None = None,
    changes: Mapping[str, Any] | None = None,
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
    light: ArrayLike = 1.0,
    mm_per_pixel: float | None = None,
    wavelengths: ArrayLike | None = None,
    angle: float = 0.0,
    constants: str = "calibrated",
    derivatives: bool = False,
    progress: Progress = None,
) -> PatchLight:
    """A flat piece of skin whose numbers are maps, under a pattern of light: what leaves, per texel.

    Maps are arrays (y, x) of one size; numbers hold everywhere. Beyond its edges the patch goes on as
    its mirror image. Either `source` or maps are given.

    :param source: the path of a patch file, or a dict with its keys; docs/heterogeneous_skin.md.
    :param folder: where paths in a dict begin; the current folder.
    :param changes: values of the file by their paths.
    :param melanin, …: as in `skin`, each a number or a map.
    :param light: that arrives, a number or a map.
    :param mm_per_pixel: size of a texel [mm], in [1e-3, 100]; 0.1.
    :param wavelengths: [nm], in [350, 1000]; the eight of `SPECTRAL_BANDS`.
    :param angle: of the light from the normal [degrees], in [0, 90).
    :param constants: of skin, as in `skin`.
    :param derivatives: keeps what `PatchLight.gradient` needs; maps of what absorbs only.
    :raises InvalidInput: naming what is wrong.
    :raises FileError: if a file cannot be read; Interrupted after Ctrl-C.

    Source: Donner et al. 2008, Eqs. 5-8; docs/heterogeneous_skin.md.

    >>> import lamina
    >>> import numpy as np
    >>> freckle = np.full((32, 32), 0.02)
    >>> freckle[12:20, 12:20] = 0.2
    >>> p = lamina.patch(melanin=freckle, mm_per_pixel=0.1, wavelengths=[550], derivatives=True)
    >>> p.light.shape
    (32, 32, 1)
    >>> bool(p.gradient(np.ones(p.light.shape))["melanin"].sum() < 0)  # melanin takes light
    True
    """
    given = {
        name: value
        for name, value in (
            ("melanin", melanin), ("melanin_blend", melanin_blend),
            ("hemoglobin_epidermis", hemoglobin_epidermis), ("hemoglobin_dermis", hemoglobin_dermis),
            ("carotene", carotene), ("saturation_epidermis", saturation_epidermis),
            ("saturation_dermis", saturation_dermis), ("baseline_scale", baseline_scale),
            ("scattering_scale", scattering_scale), ("scattering_power", scattering_power),
            ("epidermis_thickness", epidermis_thickness), ("junction_absorption", junction_absorption),
            ("dermis_thickness", dermis_thickness),
        )
        if value is not None
    }  # fmt: skip
    is_differentiated = flag("derivatives", derivatives)
    if source is not None:
        if given or wavelengths is not None or mm_per_pixel is not None:
            raise InvalidInput("source: must be left out with maps, wavelengths or mm_per_pixel")
        path, text = file_or_text("patch", "patch", source, folder)
        made = _lamina.load_patch(path, text, settings_of(changes))
        if is_differentiated:
            raise InvalidInput("derivatives: are for maps as arrays, not for files")
        return _solved(made, progress)
    if changes is not None or folder is not None:
        raise InvalidInput("changes, folder: are for a source, which is not given")
    nm = check_wavelengths("wavelengths", SPECTRAL_BANDS if wavelengths is None else wavelengths, 350.0, 1000.0)
    one_of("constants", constants, _CONSTANTS)
    size = number("mm_per_pixel", 0.1 if mm_per_pixel is None else mm_per_pixel, 1e-3, 100.0, unit="mm")
    theta = np.radians(number("angle", angle, 0.0, 90.0, closed="[)", unit="degrees"))
    maps, numbers = _maps_and_numbers(given)
    arriving = doubles("light", light, 0.0, 1e30)
    shapes = {n: m.shape for n, m in maps.items()}
    if arriving.ndim:
        shapes["light"] = arriving.shape
    if len(set(shapes.values())) != 1 or any(len(s) != 2 for s in shapes.values()):
        sizes = ", ".join(f"{n} {s}" for n, s in shapes.items()) or "none"
        raise InvalidInput(f"maps must be arrays (y, x) of one size, but are {sizes}")
    shape = next(iter(shapes.values()))
    if max(shape) > 16384:
        raise InvalidInput(f"maps must be at most 16384 wide and high, but are {shape}")
    if is_differentiated:
        for name in maps:
            if name in _SCATTERING:
                raise InvalidInput(f"{name}: must be a number with derivatives, but is a map")
    made = _lamina.SkinPatch(
        maps, numbers, np.broadcast_to(arriving, shape), size, nm, float(theta), constants)
    if not is_differentiated:
        return _solved(made, progress)
    with progress_of(progress, "light through layers") as callback:
        solver = _lamina.DifferentiablePatch(made, callback)
    bands = np.moveaxis(solver.light, 0, -1)
    weights = _lamina.patch_color_weights(made)
    return PatchLight(
        axes=(), coords={"band": np.array(nm), "channel": np.array(["R", "G", "B"])}, light=bands,
        srgb_linear=(bands @ weights).astype(np.float32), mm_per_pixel=size, color_weights=weights,
        _solver=solver)


def _maps_and_numbers(given: dict[str, ArrayLike]) -> tuple[dict[str, Array], dict[str, float]]:
    ranges = {name: (low, high) for name, low, high, _ in _ranges("skin")}
    maps: dict[str, Array] = {}
    numbers: dict[str, float] = {}
    for name, value in given.items():
        array = doubles(name, value, *ranges[name], infinite=name == "dermis_thickness")
        if array.ndim:
            maps[name] = array
        else:
            numbers[name] = float(array)
    return maps, numbers


def _solved(made: _lamina.SkinPatch, progress: Progress) -> PatchLight:
    with progress_of(progress, "light through layers") as callback:
        found = _lamina.solve_patch(made, callback)
    pixels, channels = found["pixels"], found["channels"]
    nm = found["wavelengths"]
    count = 3 if nm is None else len(nm)
    below = next((i for i, c in enumerate(channels) if c.startswith("transmitted.")), None)
    return PatchLight(
        axes=(),
        coords={"band": np.array(["R", "G", "B"]) if nm is None else nm, "channel": np.array(["R", "G", "B"])},
        light=pixels[..., :count],
        srgb_linear=pixels[..., channels.index("R") :][..., :3],
        transmitted=None if below is None else pixels[..., below : below + count],
        mm_per_pixel=found["mm_per_pixel"],
        mean_reflectance=found["mean_reflectance"],
        fit_error=found["fit_error"],
        warnings=tuple(found["warnings"]),
    )


@dataclass(frozen=True, eq=False, repr=False)
class SkinMaps(Result):
    """Maps of skin, which `patch` takes: `lamina.patch(**maps.arguments())`."""

    maps: dict[str, Map] = setting("by parameter, axes (y, x)")
    numbers: dict[str, float] = setting("parameters that are the same everywhere")
    mm_per_pixel: float = quantity("of the maps", unit="mm")
    constants: str = setting("of skin")

    def arguments(self) -> dict[str, Any]:
        """Arguments of `patch`; numbers that a map gives are left out."""
        known = {name for name, *_ in _ranges("skin")}
        arguments: dict[str, Any] = {n: v for n, v in self.numbers.items() if n not in self.maps}
        arguments.update({n: v for n, v in self.maps.items() if n in known})
        return {**arguments, "mm_per_pixel": self.mm_per_pixel, "constants": self.constants}


def maps(
    source: PatchLike,
    *,
    folder: PathLike | None = None,
    changes: Mapping[str, Any] | None = None,
    seed: int | None = None,
    progress: Progress = None,
) -> SkinMaps:
    """Maps of skin with freckles, veins, hair follicles, tattoos: from a recipe.

    :param source: the path of a maps file, or a dict with its keys; docs/heterogeneous_skin.md.
        Maps on meshes ("surface") are made by the command.
    :param folder: where paths in a dict begin; the current folder.
    :param changes: values of the recipe by their paths.
    :param seed: in place of the recipe's.
    :raises InvalidInput: naming the key that is wrong.
    :raises FileError: if a file cannot be read; Interrupted after Ctrl-C.
    """
    path, text = file_or_text("maps", "maps", source, folder)
    settings = settings_of(changes)
    if seed is not None:
        settings.append(f"seed={int(number('seed', seed, 0, 2**53))}")
    with progress_of(progress, "making maps") as callback:
        made, numbers, size, constants = _lamina.skin_maps(path, text, settings, callback)
    return SkinMaps(axes=(), coords={}, maps=made, numbers=numbers, mm_per_pixel=size, constants=constants)
