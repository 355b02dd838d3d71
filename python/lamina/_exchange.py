# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Materials for other programs."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Union, overload

import numpy as np
from numpy.typing import ArrayLike

from . import _lamina
from ._files import SavedFolder
from ._input import PathLike, doubles, flag, number, one_of, path_text, refuse, whole
from ._materials import Material, MaterialLike
from ._materials import material as material_of
from ._progress import Progress, progress_of
from ._result import Result, setting


class ExportFormat(NamedTuple):
    """A format that `export` writes."""

    name: str
    about: str


def export_formats() -> tuple[ExportFormat, ...]:
    """The formats that `export` writes.

    >>> import lamina
    >>> "mcml" in [one.name for one in lamina.export_formats()]
    True
    """
    return tuple(ExportFormat(*one) for one in _lamina.export_formats())


@dataclass(frozen=True, eq=False, repr=False)
class Exported(Result):
    """A material as another program reads it."""

    format: str = setting("its name")
    files: dict[str, bytes] = setting("by name; the first is the one to open")
    notes: tuple[str, ...] = setting("what the format cannot say, or says in another way")
    misfits: dict[str, Any] = setting("by channel, of reflectance and transmittance: totals, radii and profiles, wanted and obtained")

    def save(self, folder: PathLike) -> list[str]:
        """Writes the files; returns their paths.

        :raises WriteError: if they cannot be written.
        """
        SavedFolder(self.files).save(path_text("folder", folder))
        return [os.path.join(folder, name) for name in self.files]


@overload
def export(
    material: MaterialLike,
    formats: str,
    *,
    wavelengths: ArrayLike | None = None,
    mm_per_unit: float = 1.0,
    channels: str | None = None,
    g: float | None = None,
    ior: float | None = None,
    goal: str = "profile",
    gaussians: int = 6,
    mesh: bytes = b"",
    scatter: bool = False,
    progress: Progress = None,
) -> Exported: ...
@overload
def export(
    material: MaterialLike,
    formats: list[str] | tuple[str, ...],
    *,
    wavelengths: ArrayLike | None = None,
    mm_per_unit: float = 1.0,
    channels: str | None = None,
    g: float | None = None,
    ior: float | None = None,
    goal: str = "profile",
    gaussians: int = 6,
    mesh: bytes = b"",
    scatter: bool = False,
    progress: Progress = None,
) -> list[Exported]: ...
def export(
    material: MaterialLike,
    formats: Union[str, Sequence[str]],
    *,
    wavelengths: ArrayLike | None = None,
    mm_per_unit: float = 1.0,
    channels: str | None = None,
    g: float | None = None,
    ior: float | None = None,
    goal: str = "profile",
    gaussians: int = 6,
    mesh: bytes = b"",
    scatter: bool = False,
    progress: Progress = None,
) -> Exported | list[Exported]:
    """A material for other programs: layers as they are, as one medium with its misfit, as sums of
    Gaussians or tables.

    :param material: a built-in name, a path, a dict or a `Material`.
    :param formats: a name of `export_formats`, or several.
    :param wavelengths: [nm], in place of the material's own bands.
    :param mm_per_unit: of the scene that the files are for, in (0, 1e9].
    :param channels: "rgb" or "bands"; what the format has best.
    :param g: of the one medium that stands for layers, in [-0.99, 0.99].
    :param ior: the same, in [0.1, 10].
    :param goal: of that medium: "profile" or "mean_square_radius".
    :param gaussians: how many a sum has, in [1, 40].
    :param mesh: of "gltf": the bytes of a GLB whose copy gets the material.
    :param scatter: of "gltf": writes the draft KHR_materials_scatter for thick materials.
    :raises InvalidInput: if a format cannot say what the material is; Interrupted after Ctrl-C.

    >>> import lamina
    >>> sorted(lamina.export("marble", "mcml").files)[0].endswith(".mci")
    True
    """
    names = [formats] if isinstance(formats, str) else formats
    if not isinstance(names, (list, tuple)) or not names or not all(isinstance(n, str) for n in names):
        raise refuse("formats", "be a name or several", formats)
    for name in names:
        one_of("formats", name, [one.name for one in export_formats()])
    if not isinstance(mesh, bytes):
        raise refuse("mesh", "be the bytes of a GLB", mesh)
    found = material_of(material, wavelengths=wavelengths)
    with progress_of(progress, "export") as callback:
        exported = _lamina.export_files(
            found._material, list(names), number("mm_per_unit", mm_per_unit, 0.0, 1e9, closed="(]"),
            one_of("goal", goal, ("profile", "mean_square_radius")), whole("gaussians", gaussians, 1, 40),
            None if channels is None else one_of("channels", channels, ("rgb", "bands")),
            None if g is None else number("g", g, -0.99, 0.99),
            None if ior is None else number("ior", ior, 0.1, 10.0), mesh, flag("scatter", scatter), callback)
    results = [
        Exported(axes=(), coords={}, format=name, files=files, notes=tuple(notes), misfits=misfits)
        for name, (files, notes, misfits) in zip(names, exported)]
    return results[0] if isinstance(formats, str) else results


def import_material(
    source: str,
    color: ArrayLike,
    radius: ArrayLike,
    *,
    scale: float = 1.0,
    g: float = 0.0,
    ior: float = 1.5,
    roughness: float = 0.3,
    blender: str = "4",
    mm_per_unit: float = 1.0,
    progress: Progress = None,
) -> Material:
    """The material that looks like the subsurface parameters of another renderer.

    :param source: "openpbr", "principled" (of Blender) or "arnold".
    :param color: linear, R, G, B, or one number, in [0, 1].
    :param radius: the same, in units of its scene, in (0, 1e9].
    :param scale: of the radius, in (0, 1e9].
    :param g: anisotropy, in [0, 0.9].
    :param ior: of the surface, in [1, 1.6].
    :param roughness: of the surface, as the slider has it, in [0, 1].
    :param blender: of "principled": "3" for 3.0 to 3.6, "4" for 4.0 to 5.1, "5.2" and later.
    :param mm_per_unit: of its scene, in (0, 1e9].
    :raises InvalidInput: naming what is out of its range; Interrupted after Ctrl-C.

    >>> import lamina
    >>> lamina.import_material("openpbr", 0.5, [2.0, 1.0, 0.5]).bands
    ('R', 'G', 'B')
    """
    def three(name: str, value: ArrayLike, low: float, high: float) -> list[float]:
        array = doubles(name, value, low, high)
        if array.shape not in ((), (1,), (3,)):
            raise refuse(name, "be one number or three", value)
        return [float(x) for x in np.broadcast_to(array, (3,))]

    with progress_of(progress, "import") as callback:
        text = _lamina.import_text(
            one_of("source", source, ("openpbr", "principled", "arnold")),
            one_of("blender", blender, ("3", "4", "5.2")), three("color", color, 0.0, 1.0), three("radius", radius, 1e-9, 1e9),
            number("scale", scale, 1e-9, 1e9), number("g", g, 0.0, 0.9), number("ior", ior, 1.0, 1.6),
            number("roughness", roughness, 0.0, 1.0), number("mm_per_unit", mm_per_unit, 1e-9, 1e9), callback)
    return material_of(json.loads(text))
