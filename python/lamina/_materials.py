# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Materials: those that lamina brings, files, and dicts."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _lamina
from ._input import Doubles, PathLike, json_text, name_text
from ._input import wavelengths as check_wavelengths
from ._lamina import InvalidInput
from ._layers import Layers


class Material:
    """A layered material. Made by `material`; cannot be changed; copies, pickles and compares."""

    __slots__ = ("_material", "_place", "_text")

    _material: _lamina.Material
    _place: str
    _text: str

    def __init__(self, material: _lamina.Material, place: str = "", text: str = "") -> None:
        object.__setattr__(self, "_material", material)
        object.__setattr__(self, "_place", place)  # built-in name or path, or
        object.__setattr__(self, "_text", text)  # what a file would say

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("a material cannot be changed; make another by `material`")

    @property
    def name(self) -> str:
        """What lists and plots call it."""
        return self._material.name

    @property
    def source(self) -> str:
        """Where its numbers come from."""
        return self._material.source

    @property
    def bands(self) -> tuple[str, ...]:
        """Names of the bands: R, G, B, or wavelengths [nm]."""
        return tuple(self._material.band_names)

    @property
    def wavelengths(self) -> Doubles | None:
        """[nm], axes (wavelength); None for R, G, B."""
        return self._material.wavelengths

    @property
    def layer_names(self) -> tuple[str, ...]:
        """From the lit surface downward."""
        return tuple(n or f"layer {i}" for i, n in enumerate(self._material.layer_names))

    @property
    def layers(self) -> Layers:
        """Its layers, a stack for each band."""
        nm = self.wavelengths
        axis = "band" if nm is None else "wavelength"
        coords = {axis: np.array(self.bands) if nm is None else nm}
        return Layers(self._material.layer_stacks(), (axis,), coords, self.layer_names)

    def at(self, wavelengths: ArrayLike) -> Material:
        """The same material at other wavelengths [nm].

        :raises InvalidInput: if it has numbers for its own bands only.
        """
        nm = check_wavelengths("wavelengths", wavelengths)
        if self._place:
            return Material(_lamina.find_material(self._place, nm), self._place)
        return Material(_lamina.decode_material(self._text, "material", nm), text=self._text)

    def to_json(self) -> str:
        """The text of a material file, in millimetres, with the same numbers."""
        return self._material.text()

    def to_dict(self) -> dict[str, Any]:
        """The same as a dict, which `material` takes."""
        result: dict[str, Any] = json.loads(self.to_json())
        return result

    def swatch(self, *, side: int = 256, samples: int = 64, progress: Any = None) -> Any:
        """A `Picture` of a ball of 20 mm, lit by a window and, from behind, by a lamp.

        :param side: of the picture [pixels], in [1, 16384].
        :param samples: per pixel, in [1, 2^24].
        :raises InvalidInput: for other numbers; Interrupted.
        """
        from ._input import whole
        from ._render import render

        scene = json.loads(_lamina.swatch_scene(self._material, whole("side", side, 1, 16384)))
        return render(scene, samples=samples, progress=progress)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Material):
            return NotImplemented
        return self.to_json() == other.to_json()

    def __hash__(self) -> int:
        return hash(self.to_json())

    def __reduce__(self) -> Any:
        return _unpickle, (self.to_json(),)

    def __copy__(self) -> Material:
        return self

    def __deepcopy__(self, memo: object) -> Material:
        return self

    def __repr__(self) -> str:
        count = len(self.layer_names)
        return f"<Material {self.name!r}: {count} layer{'s' if count != 1 else ''}, bands {', '.join(self.bands)}>"

    def _repr_html_(self) -> str:
        import html

        stacks = self.layers
        rows = "".join(
            f"<tr><td>{html.escape(name)}</td><td>{_range(stacks.sigma_a[..., i])}</td>"
            f"<td>{_range(stacks.sigma_s[..., i])}</td><td>{_range(stacks.g[..., i])}</td>"
            f"<td>{_range(stacks.ior[..., i])}</td><td>{_range(stacks.thickness[..., i])}</td></tr>"
            for i, name in enumerate(self.layer_names)
        )
        return (
            f"<b>{html.escape(self.name)}</b> ({html.escape(', '.join(self.bands))})"
            "<table><tr><th>layer</th><th>σ<sub>a</sub> [1/mm]</th><th>σ<sub>s</sub> [1/mm]</th><th>g</th>"
            f"<th>index</th><th>thickness [mm]</th></tr>{rows}</table><small>{html.escape(self.source)}</small>"
        )


def _range(values: Doubles) -> str:
    low, high = float(values.min()), float(values.max())
    return f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}"


def _unpickle(text: str) -> Material:
    return Material(_lamina.decode_material(text, "material", []), text=text)


#: What stands for a material wherever one is asked for.
MaterialLike = Union[Material, Layers, str, "os.PathLike[str]", Mapping[str, Any]]


def material(what: MaterialLike, *, wavelengths: ArrayLike | None = None) -> Material:
    """A material.

    :param what: the name of a built-in one (`materials()`), the path of a file, or a dict with
        the keys of such a file; "lamina" and "version" may be missing.
    :param wavelengths: [nm], ascending, in [200, 3000], in place of its own bands.
    :raises InvalidInput: naming the key that is wrong, with the command's message.
    :raises FileError: if there is no such file.

    >>> import lamina
    >>> lamina.material("jade")
    <Material 'jade': 1 layer, bands R, G, B>
    >>> wax = lamina.material({
    ...     "name": "wax", "length_unit": "mm", "bands": "rgb",
    ...     "layers": [{"sigma_a": [0.003, 0.005, 0.02], "sigma_s": 7.5, "g": 0.8, "ior": 1.44,
    ...                 "thickness": "infinite"}]})
    >>> wax.layers.sigma_a[:, 0]
    array([0.003, 0.005, 0.02 ])
    """
    nm = [] if wavelengths is None else check_wavelengths("wavelengths", wavelengths)
    if isinstance(what, Material):
        return what.at(nm) if nm else what
    if isinstance(what, Layers):
        raise InvalidInput("material: must be a name, path, dict or Material, but is Layers")
    if isinstance(what, Mapping):
        text = json_text("material", {"lamina": "material", "version": 1, **what})
        return Material(_lamina.decode_material(text, "material", nm), text=text)
    if isinstance(what, (str, os.PathLike)):
        name = name_text("material", os.fspath(what), "be a name, path, dict or Material")
        return Material(_lamina.find_material(name, nm), name)
    raise InvalidInput(
        f"material: must be a name, path, dict or Material, but is {type(what).__name__}")


def materials() -> tuple[str, ...]:
    """Names of the built-in materials.

    >>> import lamina
    >>> "jade" in lamina.materials()
    True
    """
    return tuple(_lamina.builtin_material_names())


def layers_of(what: MaterialLike, wavelengths: ArrayLike | None = None) -> Layers:
    """Layers of whatever stands for a material, as every solver takes it."""
    if isinstance(what, Layers):
        if wavelengths is not None:
            raise InvalidInput("wavelengths: must be left out with layers, which have their own")
        return what
    return material(what, wavelengths=wavelengths).layers


def material_text(name: PathLike) -> str:
    """The text of a built-in material's file, with comments on where each number comes from.

    :raises InvalidInput: if there is no such material.
    """
    return _lamina.builtin_material_text(name_text("name", name, "be that of a built-in material"))
