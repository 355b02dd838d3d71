# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Maps of skin: made by recipes, loaded, edited, saved."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lamina
from ._files import FileLike, SavedFolder, folder_of, opened, settings_of
from ._input import PathLike, doubles, name_text, number, one_of, path_text, shown, suggestion, whole
from ._lamina import InvalidInput
from ._progress import Progress, progress_of
from ._recipes import _CONSTANTS, _ranges
from ._result import Array, Result, quantity, setting

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Map = NDArray[np.float32]


@dataclass(frozen=True, eq=False, repr=False)
class SkinMaps(Result):
    """Skin whose numbers are maps. `patch` takes it; `edit` changes it; it draws its look."""

    maps: dict[str, Map] = setting("by parameter, or ink_NAME, axes (y, x)")
    numbers: dict[str, float] = setting("parameters that are the same everywhere")
    mm_per_pixel: float | None = quantity("of the maps; None: over a mesh", unit="mm")
    constants: str = setting("of skin")
    deviations: dict[str, Map] = setting("standard deviations of maps, where they are known")
    clamped: dict[str, int] = setting("texels that an edit has taken to the end of their range")
    warnings: tuple[str, ...] = setting("a line each")
    _skin: Any = None

    def arguments(self) -> dict[str, Any]:
        """Arguments of `patch`: maps and numbers as they are, to compute with; inks are left out."""
        known = {name for name, *_ in _ranges("skin")}
        arguments: dict[str, Any] = {n: v for n, v in self.numbers.items() if n not in self.maps}
        arguments.update({n: v for n, v in self.maps.items() if n in known})
        return {**arguments, "mm_per_pixel": self.mm_per_pixel, "constants": self.constants}

    def edit(self, kind: str, amount: Any, **where: Any) -> SkinMaps:
        """The same maps after an edit; see `edit`."""
        return edit(self, kind, amount, **where)

    def preview(self, *, longest_side: int = 512, progress: Progress = None) -> Map:
        """What it looks like in even white light, without what its surface mirrors: linear sRGB,
        axes (y, x, channel).

        :param longest_side: [pixels], in [16, 4096].
        :raises InvalidInput: for another size; Interrupted.
        """
        side = whole("longest_side", longest_side, 16, 4096)
        with progress_of(progress, "light through layers") as callback:
            picture: Map = self.editable().preview(side, callback)
        return picture

    def save(self, folder: PathLike, *, edited_from: str = "") -> None:
        """Writes an EXR for each map and patch.json or material.json that loads them.

        :param edited_from: what the files shall say of where they come from.
        :raises WriteError: if they cannot be written.
        """
        self.editable().save(path_text("folder", folder), name_text("edited_from", edited_from, "be text"))

    def editable(self) -> Any:
        """The library's own, with inks."""
        if self._skin is not None:
            return self._skin
        known = {name for name, *_ in _ranges("skin")}
        maps = {n: m for n, m in self.maps.items() if n in known}
        return _lamina.EditableSkin.made(maps, self.numbers, self.constants, self.mm_per_pixel or 0.0)

    def __reduce__(self) -> Any:
        # Inks and what else the library knows travel as the files that hold it.
        return _restored, (self.to_dict(), None if self._skin is None else folder_of(self.save))

    def _draw(self, ax: Axes) -> None:
        linear = np.clip(self.preview(), 0.0, 1.0)
        encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
        first = next(iter(self.maps.values()))
        scale = self.mm_per_pixel or 1.0
        ax.imshow(encoded, extent=(0.0, first.shape[1] * scale, first.shape[0] * scale, 0.0))
        ax.set(xlabel="mm" if self.mm_per_pixel else "texel", ylabel="mm" if self.mm_per_pixel else "texel")


def _restored(fields: dict[str, Any], files: dict[str, bytes] | None) -> SkinMaps:
    if files is None:
        return SkinMaps(**fields)
    with tempfile.TemporaryDirectory(prefix="lamina_") as folder:
        SavedFolder(files).save(folder)
        skin = _lamina.EditableSkin.load(folder)
    for array in (*fields["maps"].values(), *fields["deviations"].values()):
        array.flags.writeable = False
    return SkinMaps(**fields, _skin=skin)


def maps_of_skin(skin: Any, clamped: dict[str, int] | None = None) -> SkinMaps:
    """What is the library's, as arrays, which cannot be written: they are copies of it."""
    made, deviations = skin.maps, skin.deviations
    for array in (*made.values(), *deviations.values()):
        array.flags.writeable = False
    return SkinMaps(
        axes=(), coords={}, maps=made, numbers=skin.numbers, mm_per_pixel=skin.mm_per_pixel,
        constants=skin.constants, deviations=deviations, clamped=clamped or {},
        warnings=tuple(skin.warnings), _skin=skin)


def maps(
    source: FileLike,
    *,
    folder: PathLike | None = None,
    changes: Mapping[str, Any] | None = None,
    seed: int | None = None,
    progress: Progress = None,
) -> SkinMaps:
    """Maps of skin with freckles, veins, hair follicles, tattoos: from a recipe.

    :param source: the path of a maps file, or a dict with its keys, where arrays may stand for
        images; docs/heterogeneous_skin.md. With "surface" the maps are those of a mesh.
    :param folder: where paths in a dict begin; the current folder.
    :param changes: values of the recipe by their paths.
    :param seed: in place of the recipe's, in [0, 2^53].
    :raises InvalidInput: naming the key that is wrong.
    :raises FileError: if a file cannot be read; Interrupted after Ctrl-C.

    >>> import lamina
    >>> spotted = lamina.maps({"width": 32, "height": 32, "mm_per_pixel": 0.2, "skin": {"melanin": 0.01},
    ...                        "features": [{"freckles": {"density": 9}}]})
    >>> spotted.maps["melanin"].shape
    (32, 32)
    """
    chosen = None if seed is None else whole("seed", seed, 0, 2**53)
    with opened("maps", "maps", source, folder) as (path, text), progress_of(progress, "making maps") as callback:
        skin = _lamina.EditableSkin.from_recipe(path, text, settings_of(changes), chosen, callback)
    return maps_of_skin(skin)


def load_maps(path: PathLike) -> SkinMaps:
    """Maps of skin that `lamina maps`, `acquire` or `edit`, or `SkinMaps.save`, have left.

    :param path: a folder with patch.json or material.json, or such a file.
    :raises FileError: if there is none; InvalidInput naming what is wrong in it.
    """
    return maps_of_skin(_lamina.EditableSkin.load(path_text("path", path)))


#: What `edit` takes: maps, a path as `load_maps` takes, or arguments of `patch`.
MapsLike = Union["SkinMaps", str, "os.PathLike[str]", Mapping[str, Any]]


def _editable(name: str, source: object) -> Any:
    if isinstance(source, SkinMaps):
        return source.editable()
    if isinstance(source, (str, os.PathLike)):
        return _lamina.EditableSkin.load(path_text(name, source))
    if isinstance(source, Mapping):
        given = dict(source)
        size = number("mm_per_pixel", given.pop("mm_per_pixel", 0.1), 1e-3, 100.0, unit="mm")
        constants = one_of("constants", given.pop("constants", "calibrated"), _CONSTANTS)
        arrays, numbers = maps_and_numbers(given)
        return _lamina.EditableSkin.made(arrays, numbers, constants, size)
    as_maps = getattr(source, "skin_maps", None)
    if callable(as_maps):
        return as_maps().editable()
    raise InvalidInput(f"{name}: must be maps, their folder or a dict of arrays, but is {type(source).__name__}")


def maps_and_numbers(given: Mapping[str, Any]) -> tuple[dict[str, Array], dict[str, float]]:
    """Arrays (y, x), and numbers, of skin, checked."""
    ranges = {name: (low, high) for name, low, high, _ in _ranges("skin")}
    arrays: dict[str, Array] = {}
    numbers: dict[str, float] = {}
    for name, value in given.items():
        if name not in ranges:
            raise InvalidInput(f"there is no number of skin {shown(name)}{suggestion(str(name), list(ranges))}")
        array = doubles(name, value, *ranges[name], infinite=name == "dermis_thickness")
        if array.ndim not in (0, 2):
            raise InvalidInput(f"{name}: must be a number or a map (y, x), but has the shape {array.shape}")
        if array.ndim:
            arrays[name] = array
        else:
            numbers[name] = float(array)
    return arrays, numbers


def edit(
    maps: MapsLike,
    kind: str,
    amount: Any,
    *,
    number: str | None = None,
    mask: ArrayLike | None = None,
    size: float | None = None,
    strength: float = 1.0,
) -> SkinMaps:
    """Skin after an edit: of what it is made of, so that a tan looks like one in any light.

    :param maps: `SkinMaps`, an acquired skin, the folder of maps, or a dict of arguments of `patch`.
    :param kind: "tan", "flush", "pale", "saturation", "cyanosis", "freckles", "even", "foundation",
        "blush", "lipstick": how skin looks; "scale", "add", "set", "gamma", "blur" and "transfer", of
        one `number`; "homogenize". docs/edit.md says what each does.
    :param amount: of the edit; of "transfer" the new map (y, x); of "homogenize" other maps.
    :param number: which one, as "melanin".
    :param mask: array (y, x) in [0, 1], of the proportions of the maps: where. "blush" and
        "lipstick" need one.
    :param size: [mm] of the surroundings of "freckles", "even" and "foundation", in [0.01, 1000].
    :param strength: how far the edit goes, in [0, 1].
    :raises InvalidInput: naming what is wrong; FileError if maps cannot be read.

    >>> import lamina
    >>> import numpy as np
    >>> skin = {"melanin": np.full((16, 16), 0.02), "mm_per_pixel": 0.1}
    >>> tanned = lamina.edit(skin, "tan", 0.5)
    >>> f"{tanned.maps['melanin'].mean():.3f}"
    '0.030'
    """
    kinds = _lamina.edit_kinds()
    low, high, has_size, has_number, needs_mask = kinds[one_of("kind", kind, list(kinds))]
    skin = _editable("maps", maps)
    what: dict[str, Any] = {"strength": _number("strength", strength, 0.0, 1.0)}
    if has_number != (number is not None):
        raise InvalidInput(f"number: must {'be given' if has_number else 'be left out'} of {kind}")
    if number is not None:
        what["number"] = name_text("number", number)
    if size is not None:
        if not has_size:
            raise InvalidInput(f"size: is for freckles, even and foundation, but the edit is {kind}")
        what["size"] = _number("size", size, 0.01, 1000.0, unit="mm")
    if mask is not None:
        what["mask"] = _plane("mask", mask, 0.0, 1.0)
    elif needs_mask:
        raise InvalidInput(f"mask: must be given of {kind}")
    if kind == "transfer":
        what["image"] = _plane("amount", amount, -1e30, 1e30)
    elif kind == "homogenize":
        what["reference"] = _editable("amount", amount)
    else:
        what["amount"] = _number("amount", amount, low, high)
    edited, clamped = skin.edited(kind, what)
    return maps_of_skin(edited, clamped)


_number = number


def _plane(name: str, value: ArrayLike, low: float, high: float) -> Array:
    array = doubles(name, value, low, high)
    if array.ndim != 2:
        raise InvalidInput(f"{name}: must be an array (y, x), but has the shape {array.shape}")
    return array


def persons(
    maps: MapsLike, count: int, *, population: str | os.PathLike[str] = "forearms", seed: int = 0
) -> list[SkinMaps]:
    """The maps on other persons: means of each number are theirs, what differs from place to place
    stays.

    :param maps: as `edit` takes.
    :param count: how many, in [1, 10000].
    :param population: "forearms", or a population file; docs/fit.md.
    :param seed: of who is drawn, in [0, 2^64).
    :raises InvalidInput: naming what is wrong; FileError.
    """
    found = _editable("maps", maps).persons(
        path_text("population", population), whole("count", count, 1, 10000), whole("seed", seed, 0, 2**64 - 1))
    return [maps_of_skin(skin) for skin in found]
