# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""A flat piece of skin whose numbers are maps, under a pattern of light; with the gradient."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _lamina
from ._files import FileLike, opened, settings_of
from ._input import PathLike, doubles, flag, number, one_of
from ._input import wavelengths as check_wavelengths
from ._lamina import InvalidInput
from ._progress import Progress, progress_of
from ._maps import Map, SkinMaps, maps_and_numbers
from ._recipes import _CONSTANTS, SPECTRAL_BANDS
from ._result import Array, Result, quantity, setting

if TYPE_CHECKING:
    from matplotlib.axes import Axes

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
            raise InvalidInput("gradient: patch must be called with derivatives=True, in this process: a pickle has no gradient")
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
        # Unpickled light has no gradient: what that needs is the library's.
        return _restored, (self.to_dict(),)

    def _draw(self, ax: Axes) -> None:
        linear = np.clip(self.srgb_linear, 0.0, 1.0)
        encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
        height, width = linear.shape[:2]
        scale = self.mm_per_pixel
        ax.imshow(encoded, extent=(0.0, width * scale, height * scale, 0.0))
        ax.set(xlabel="mm", ylabel="mm")


def _restored(fields: dict[str, Any]) -> PatchLight:
    return PatchLight(**fields)


def patch(
    source: FileLike | SkinMaps | None = None,
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

    :param source: `SkinMaps`; or the path of a patch file, or a dict with its keys, where arrays may
        stand for images; docs/heterogeneous_skin.md.
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
    is_file = source is not None and not isinstance(source, SkinMaps)
    if source is not None and (given or mm_per_pixel is not None):
        raise InvalidInput("source: must be left out with maps or mm_per_pixel")
    if is_file:
        if wavelengths is not None:
            raise InvalidInput("wavelengths: are those of the source; take changes={'bands': ...}")
        if is_differentiated:
            raise InvalidInput("derivatives: are for maps as arrays, not for files")
        with opened("patch", "patch", source, folder) as (path, text):
            made = _lamina.load_patch(path, text, settings_of(changes))
        return _solved(made, progress)
    if changes is not None or folder is not None:
        raise InvalidInput("changes, folder: are for a source, which is not given")
    nm = check_wavelengths("wavelengths", SPECTRAL_BANDS if wavelengths is None else wavelengths, 350.0, 1000.0)
    theta = float(np.radians(number("angle", angle, 0.0, 90.0, closed="[)", unit="degrees")))
    arriving = doubles("light", light, 0.0, 1e30)
    if arriving.ndim not in (0, 2):
        raise InvalidInput(f"light: must be a number or a map (y, x), but has the shape {arriving.shape}")
    if isinstance(source, SkinMaps):
        size = source.mm_per_pixel or 0.0
        maps: Mapping[str, Any] = source.maps
        if not maps or not size:
            raise InvalidInput("source: must have maps whose mm_per_pixel is known")
        shape = next(iter(maps.values())).shape[:2]
        if arriving.ndim and arriving.shape != shape:
            raise InvalidInput(f"light: must be of the size of the first map, {shape}, but is {arriving.shape}")
        made = source.editable().patch(np.broadcast_to(arriving, shape), nm, theta)
    else:
        one_of("constants", constants, _CONSTANTS)
        size = number("mm_per_pixel", 0.1 if mm_per_pixel is None else mm_per_pixel, 1e-3, 100.0, unit="mm")
        arrays, numbers = maps_and_numbers(given)
        shape = _shape_of(arrays, arriving)
        maps = arrays
        made = _lamina.SkinPatch.made(arrays, numbers, np.broadcast_to(arriving, shape), size, nm, theta, constants)
    if is_differentiated:
        for name in maps:
            if name in _SCATTERING:
                raise InvalidInput(f"{name}: must be a number with derivatives, but is a map")
    if not is_differentiated:
        return _solved(made, progress)
    with progress_of(progress, "light through layers") as callback:
        solver = _lamina.DifferentiablePatch.made(made, callback)
    bands = np.moveaxis(solver.light, 0, -1)
    weights = _lamina.patch_color_weights(made)
    return PatchLight(
        axes=(), coords={"band": np.array(nm), "channel": np.array(["R", "G", "B"])}, light=bands,
        srgb_linear=(bands @ weights).astype(np.float32), mm_per_pixel=size, color_weights=weights,
        _solver=solver)


def _shape_of(maps: dict[str, Array], light: Array) -> tuple[int, int]:
    """The one size of all maps."""
    shapes = {n: m.shape for n, m in maps.items()}
    if light.ndim:
        shapes["light"] = light.shape
    if len(set(shapes.values())) != 1 or any(len(s) != 2 for s in shapes.values()):
        sizes = ", ".join(f"{n} {s}" for n, s in shapes.items()) or "none"
        raise InvalidInput(f"maps must be arrays (y, x) of one size, but are {sizes}")
    height, width = next(iter(shapes.values()))
    if max(height, width) > 16384:
        raise InvalidInput(f"maps must be at most 16384 wide and high, but are {(height, width)}")
    return height, width


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
