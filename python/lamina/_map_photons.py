# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Photons through layers whose absorption varies from place to place, and through vessels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _lamina
from ._input import Incidence, doubles, flag, number, refuse, shown, suggestion, whole
from ._input import incidence as check_incidence
from ._lamina import InvalidInput
from ._layers import Layers
from ._materials import MaterialLike, layers_of
from ._progress import Progress, interrupted_with, progress_of
from ._result import Array, Result, quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False, repr=False)
class PatchPhotons(Result):
    """Light that leaves layers of varying absorption, by photons: the truth that `patch` is held to."""

    light: Array = quantity("that leaves at the top, in the unit of what arrives", axes=("y", "x"), shared=True)
    light_error: Array = quantity("its standard error", axes=("y", "x"), shared=True)
    transmitted: Array = quantity("that leaves below", axes=("y", "x"), shared=True)
    transmitted_error: Array = quantity("its standard error", axes=("y", "x"), shared=True)
    photons: float = quantity("that were followed")

    def _draw(self, ax: Axes) -> None:
        shown = ax.imshow(self.light, cmap="gray")
        ax.set(xlabel="texel", ylabel="texel")
        ax.figure.colorbar(shown, ax=ax)


def patch_photons(
    layers: Layers,
    mm_per_pixel: float,
    *,
    light: ArrayLike = 1.0,
    incidence: Incidence = "normal",
    photons: float = 1e6,
    seed: int = 0,
    progress: Progress = None,
) -> PatchPhotons:
    """Photons through layers whose absorption varies along the surface; the patch repeats.

    :param layers: of the shape (y, x), as of `layers`, or of `skin` at one wavelength: they may
        differ in `sigma_a` only, with smooth boundaries.
    :param mm_per_pixel: size of a texel [mm], in [1e-3, 100].
    :param light: that arrives, a number or an array (y, x).
    :param incidence: "normal", "diffuse", or an angle [degrees] in [0, 90).
    :param photons: in [1, 1e15].
    :param seed: in [0, 2^64).
    :raises InvalidInput: naming what is wrong.
    :raises Interrupted: after Ctrl-C; `result` has what there is by then.

    Source: Hanrahan & Krueger 1993, Figure 7, with absorption along the path.

    >>> import lamina
    >>> import numpy as np
    >>> spot = np.full((8, 8, 1), 0.01)
    >>> spot[4, 4] = 1.0
    >>> found = lamina.patch_photons(lamina.layers(sigma_a=spot, sigma_s=2.0, ior=1.4), 0.5, photons=1e5)
    >>> bool(found.light[4, 4] < found.light[0, 0])
    True
    """
    if not isinstance(layers, Layers):
        raise refuse("layers", "be Layers", type(layers).__name__)
    shape = layers.shape[:-1] if len(layers.shape) == 3 and layers.shape[-1] == 1 else layers.shape
    if len(shape) != 2:
        raise InvalidInput(f"layers: must have the shape (y, x), but have {layers.shape}")
    arriving = doubles("light", light, 0.0, 1e30)
    if arriving.shape not in ((), shape):
        raise InvalidInput(f"light: must be a number or of the shape {shape}, but has {arriving.shape}")
    if not arriving.max() > 0.0:
        raise refuse("light", "not be 0 everywhere", light)
    is_diffuse, theta = check_incidence(incidence)
    with progress_of(progress, "photons") as callback:
        found = _lamina.patch_photons(
            layers._stacks, list(shape), np.broadcast_to(arriving, shape),
            number("mm_per_pixel", mm_per_pixel, 1e-3, 100.0, unit="mm"), whole("photons", photons, 1, 10**15),
            whole("seed", seed, 0, 2**64 - 1), is_diffuse, theta, callback)
    interrupted = found.pop("was_interrupted")
    (above, above_error), (below, below_error) = found["light"], found["transmitted"]
    result = PatchPhotons(
        axes=(), coords={}, light=above, light_error=above_error, transmitted=below, transmitted_error=below_error,
        photons=found["photons"])
    if interrupted:
        raise interrupted_with(result)
    return result


@dataclass(frozen=True, eq=False, repr=False)
class CylinderPhotons(Result):
    """What becomes of light in layers with vessels: fractions of it, by photons."""

    specular_reflectance: float = quantity("reflected before the light enters")
    diffuse_reflectance: float = quantity("all other light that leaves at the top")
    transmittance: float = quantity("what leaves at the bottom")
    through_sides: float = quantity("what leaves at open sides")
    absorptance: Array = quantity("in each layer without its vessels", axes=("layer",), shared=True)
    absorptance_of_cylinders: Array = quantity("in each vessel", axes=("cylinder",), shared=True)
    reflectance_by_column: Array = quantity("parts of the reflectance over x", axes=("x",), shared=True)
    standard_error: dict[str, Any] = quantity("of each of these")
    photons: float = quantity("that were followed")

    def _draw(self, ax: Axes) -> None:
        at = np.arange(len(self.reflectance_by_column))
        ax.errorbar(at, self.reflectance_by_column, self.standard_error["reflectance_by_column"], fmt=".-")
        ax.set(xlabel="column over x", ylabel="fraction of the light", ylim=(0.0, None))


_CYLINDER = ("x", "depth", "radius", "sigma_a", "sigma_s", "g")


def cylinder_photons(
    material: MaterialLike,
    cylinders: Sequence[Mapping[str, float]],
    *,
    width: float,
    length: float,
    repeats: bool = True,
    beam_radius: float | None = None,
    columns: int = 1,
    photons: float = 1e6,
    seed: int = 0,
    progress: Progress = None,
) -> CylinderPhotons:
    """Photons through flat layers with vessels, endless cylinders along y; lit from above.

    :param material: of one band, with smooth boundaries: `Layers` of one stack, a dict, …
    :param cylinders: a dict each: x and depth of its axis [mm], radius [mm], sigma_a and sigma_s
        [1/mm], g. Each lies within one layer, whose index it has.
    :param width: of the box over x [mm], in [1e-3, 1e6].
    :param length: over y [mm], in [1e-3, 1e6].
    :param repeats: whether the box repeats without end; else light is gone at its sides.
    :param beam_radius: of a disc in the middle that is lit [mm]; all of the box.
    :param columns: of the reflectance over x, in [1, 100000].
    :param photons: in [1, 1e15].
    :param seed: in [0, 2^64).
    :raises InvalidInput: if a cylinder leaves its layer or meets another, or a boundary is rough.
    :raises Interrupted: after Ctrl-C; `result` has what there is by then.

    >>> import lamina
    >>> dermis = lamina.layers(sigma_a=0.02, sigma_s=10.0, g=0.8, ior=1.4)
    >>> vein = {"x": 2.0, "depth": 1.0, "radius": 0.3, "sigma_a": 2.0, "sigma_s": 20.0, "g": 0.95}
    >>> found = lamina.cylinder_photons(dermis, [vein], width=4.0, length=1.0, photons=1e4)
    >>> bool(found.absorptance_of_cylinders[0] > 0.0)
    True
    """
    layers = layers_of(material, None)
    if int(np.prod(layers.shape)) != 1:
        raise InvalidInput(f"material: must be one stack of layers, but has the shape {layers.shape}")
    if not isinstance(cylinders, (list, tuple)):
        raise refuse("cylinders", "be dicts in a list", type(cylinders).__name__)
    checked = []
    for i, one in enumerate(cylinders):
        if not isinstance(one, Mapping):
            raise refuse(f"cylinders[{i}]", "be a dict", one)
        for key in one:
            if key not in _CYLINDER:
                raise InvalidInput(f"cylinders[{i}]: there is no {shown(key)}{suggestion(str(key), _CYLINDER)}")
        for key in ("x", "depth", "radius"):
            if key not in one:
                raise InvalidInput(f"cylinders[{i}]: must have {key}")
        ranges = {"g": (-1.0, 1.0, "()"), "radius": (0.0, 1e6, "(]")}
        checked.append({
            key: number(f"cylinders[{i}].{key}", one.get(key, 0.0), *ranges.get(key, (0.0, 1e9, "[]"))[:2],
                        closed=ranges.get(key, (0.0, 1e9, "[]"))[2]) for key in _CYLINDER})
    with progress_of(progress, "photons") as callback:
        found = _lamina.cylinder_photons(
            layers._stacks, checked, number("width", width, 1e-3, 1e6, unit="mm"),
            number("length", length, 1e-3, 1e6, unit="mm"), flag("repeats", repeats),
            None if beam_radius is None else number("beam_radius", beam_radius, 0.0, 1e6, closed="(]", unit="mm"),
            whole("columns", columns, 1, 100000), whole("photons", photons, 1, 10**15),
            whole("seed", seed, 0, 2**64 - 1), callback)
    interrupted = found.pop("was_interrupted")
    values: dict[str, Any] = {}
    errors: dict[str, Any] = {}
    for name in ("diffuse_reflectance", "transmittance", "through_sides"):
        values[name], errors[name] = (float(array[0]) for array in found.pop(name))
    for name in ("absorptance", "absorptance_of_cylinders", "reflectance_by_column"):
        values[name], errors[name] = found.pop(name)
    result = CylinderPhotons(
        axes=(), coords={"layer": np.array(layers.names)}, standard_error=errors, **values, **found)
    if interrupted:
        raise interrupted_with(result)
    return result
