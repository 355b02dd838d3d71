# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Materials for other programs."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Union, overload

from numpy.typing import ArrayLike

from . import _lamina
from ._files import SavedFolder
from ._input import PathLike, number, one_of, path_text, refuse, whole
from ._materials import MaterialLike
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
    found = material_of(material, wavelengths=wavelengths)
    with progress_of(progress, "export") as callback:
        exported = _lamina.export_files(
            found._material, list(names), number("mm_per_unit", mm_per_unit, 0.0, 1e9, closed="(]"),
            one_of("goal", goal, ("profile", "mean_square_radius")), whole("gaussians", gaussians, 1, 40),
            None if channels is None else one_of("channels", channels, ("rgb", "bands")),
            None if g is None else number("g", g, -0.99, 0.99),
            None if ior is None else number("ior", ior, 0.1, 10.0), callback)
    results = [
        Exported(axes=(), coords={}, format=name, files=files, notes=tuple(notes), misfits=misfits)
        for name, (files, notes, misfits) in zip(names, exported)]
    return results[0] if isinstance(formats, str) else results
