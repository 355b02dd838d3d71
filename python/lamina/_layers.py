# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Layers of plain numbers: one stack, or an array of stacks of any shape."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _lamina
from ._input import Doubles, broadcast, doubles, name_text, one_of, refuse, shown
from ._lamina import InvalidInput

_PHASES = ("henyey_greenstein", "rayleigh")
_DISTRIBUTIONS = ("beckmann", "ggx")
_LARGEST = 1e9


def stacks_from_state(state: tuple[Any, ...]) -> _lamina.LayerStacks:
    """What a pickle keeps of stacks, as stacks."""
    return _lamina.LayerStacks.from_state(state)


class Layers:
    """Stacks of equally many layers, as an array of any shape, which every solver takes at once.

    Made by `layers`, by `Material.layers`, or by the recipes `skin`, `leaf` and `snow`. It can
    not be changed; it copies, pickles and compares.

    Attributes of numbers are arrays: of layers with the axes (..., layer), of what is around them
    with the axes (...).
    """

    __slots__ = ("_stacks", "axes", "coords", "names")

    _stacks: _lamina.LayerStacks
    axes: tuple[str, ...]
    coords: dict[str, Any]
    names: tuple[str, ...]

    def __init__(
        self,
        stacks: _lamina.LayerStacks,
        axes: tuple[str, ...],
        coords: dict[str, Any],
        names: Sequence[str],
    ) -> None:
        object.__setattr__(self, "_stacks", stacks)
        object.__setattr__(self, "axes", axes)
        object.__setattr__(self, "coords", coords)
        object.__setattr__(self, "names", tuple(names))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("layers cannot be changed; make others")

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the array of stacks."""
        return self._stacks.shape

    @property
    def layer_count(self) -> int:
        """Layers of each stack."""
        return self._stacks.layer_count

    @property
    def sigma_a(self) -> Doubles:
        """Absorption coefficient [1/mm], axes (..., layer)."""
        return self._stacks.sigma_a

    @property
    def sigma_s(self) -> Doubles:
        """Scattering coefficient [1/mm], axes (..., layer)."""
        return self._stacks.sigma_s

    @property
    def g(self) -> Doubles:
        """Mean cosine of the scattering angle, axes (..., layer)."""
        return self._stacks.g

    @property
    def ior(self) -> Doubles:
        """Refractive index, axes (..., layer)."""
        return self._stacks.ior

    @property
    def thickness(self) -> Doubles:
        """[mm], inf for a half-space, axes (..., layer)."""
        return self._stacks.thickness

    @property
    def roughness(self) -> Doubles:
        """Microfacet alpha of each layer's upper boundary, axes (..., layer)."""
        return self._stacks.roughness

    @property
    def ior_above(self) -> Doubles:
        """Refractive index above, axes (...)."""
        return self._stacks.ior_above

    @property
    def ior_below(self) -> Doubles:
        """Refractive index below, axes (...)."""
        return self._stacks.ior_below

    @property
    def ground_reflectance(self) -> Doubles:
        """Of a Lambertian ground below, axes (...)."""
        return self._stacks.ground_reflectance

    def flipped(self) -> Layers:
        """The same layers lit from below.

        :raises InvalidInput: for an infinite layer, or a ground that reflects.
        """
        return Layers(self._stacks.flipped(), self.axes, self.coords, self.names[::-1])

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Layers):
            return NotImplemented
        return bool(self._stacks.__getstate__() == other._stacks.__getstate__())

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> Any:
        return Layers, (self._stacks, self.axes, self.coords, self.names)

    def __copy__(self) -> Layers:
        return self

    def __deepcopy__(self, memo: object) -> Layers:
        return self

    def __repr__(self) -> str:
        axes = ", ".join(f"{a} {n}" for a, n in zip(self.axes, self.shape))
        count = f"{self.layer_count} layer{'s' if self.layer_count != 1 else ''}"
        return f"<Layers: {count}{' x (' + axes + ')' if axes else ''}>"


def _texts(name: str, value: Union[str, Sequence[str]], count: int, options: Sequence[str]) -> list[str]:
    if isinstance(value, str):
        return [one_of(name, value, options)] * count
    if not isinstance(value, (list, tuple)):
        raise refuse(name, f"be one of {', '.join(options)}, or a list of them", value)
    values = [one_of(f"{name}[{i}]", item, options) for i, item in enumerate(value)]
    if len(values) != count:
        raise InvalidInput(f"{name}: must be one or {count}, but are {len(values)}")
    return values


def layers(
    *,
    sigma_a: ArrayLike,
    sigma_s: ArrayLike,
    g: ArrayLike = 0.0,
    ior: ArrayLike = 1.0,
    thickness: ArrayLike = np.inf,
    roughness: ArrayLike = 0.0,
    phase: Union[str, Sequence[str]] = "henyey_greenstein",
    distribution: Union[str, Sequence[str]] = "beckmann",
    ior_above: ArrayLike = 1.0,
    ior_below: ArrayLike | None = None,
    ground_reflectance: ArrayLike = 0.0,
    ground_roughness: ArrayLike = 0.0,
    names: Sequence[str] | None = None,
    axes: Sequence[str] | None = None,
    wavelengths: ArrayLike | None = None,
) -> Layers:
    """Layers of plain numbers, from the lit surface downward.

    The last axis of what a layer has is the layer; a number stands for one layer, or for all.
    What lies before it is an array of stacks, by NumPy's broadcasting.

    :param sigma_a: absorption coefficient [1/mm], in [0, 1e9].
    :param sigma_s: scattering coefficient [1/mm], in [0, 1e9].
    :param g: mean cosine of the scattering angle, in (-1, 1).
    :param ior: refractive index, in [0.1, 10].
    :param thickness: [mm], > 0; inf for the last layer only.
    :param roughness: microfacet alpha of the upper boundary, in [0, 1].
    :param phase: "henyey_greenstein" or "rayleigh", of all layers or of each.
    :param distribution: of facets, "beckmann" or "ggx", of all layers or of each.
    :param ior_above: axes (...), without the layer.
    :param ior_below: the same; the last layer's where that is infinite, else 1.
    :param ground_reflectance: of a Lambertian ground below, in [0, 1], axes (...).
    :param ground_roughness: of the lowest boundary, in [0, 1], axes (...).
    :param names: of the layers, for plots.
    :param axes: names of the leading axes.
    :param wavelengths: [nm] along the last leading axis, which is then called "wavelength".
    :raises InvalidInput: naming what is out of its range, and where.

    >>> import lamina
    >>> marble = lamina.layers(sigma_a=0.003, sigma_s=2.6, ior=1.5)
    >>> lamina.slab(marble).diffuse_reflectance.round(3)
    0.791

    A thousand of them at once:

    >>> import numpy as np
    >>> many = lamina.layers(sigma_a=np.geomspace(1e-3, 1, 1000)[:, None], sigma_s=2.6, ior=1.5)
    >>> lamina.slab(many).diffuse_reflectance.shape
    (1000,)
    """
    of_layers = {
        "sigma_a": doubles("sigma_a", sigma_a, 0.0, _LARGEST, unit="1/mm"),
        "sigma_s": doubles("sigma_s", sigma_s, 0.0, _LARGEST, unit="1/mm"),
        "g": doubles("g", g, -1.0, 1.0, closed="()"),
        "ior": doubles("ior", ior, 0.1, 10.0),
        "thickness": doubles("thickness", thickness, 0.0, _LARGEST, closed="(]", unit="mm", infinite=True),
        "roughness": doubles("roughness", roughness, 0.0, 1.0),
    }
    of_layers = {n: a[None] if a.ndim == 0 else a for n, a in of_layers.items()}
    of_stack = {
        "ior_above": doubles("ior_above", ior_above, 0.1, 10.0),
        "ground_reflectance": doubles("ground_reflectance", ground_reflectance, 0.0, 1.0),
        "ground_roughness": doubles("ground_roughness", ground_roughness, 0.0, 1.0),
    }
    if ior_below is not None:
        of_stack["ior_below"] = doubles("ior_below", ior_below, 0.1, 10.0)
    # Together, so that shapes that do not fit are named as users gave them.
    spread, shape = broadcast({**of_layers, **{n: a[..., None] for n, a in of_stack.items()}})
    count = shape[-1]
    is_infinite = np.isinf(spread["thickness"][..., -1])
    if ior_below is None:
        below = np.where(is_infinite, spread["ior"][..., -1], 1.0)
        spread["ior_below"] = np.broadcast_to(below[..., None], shape)
    elif is_infinite.any():
        raise refuse("ior_below", "be left out under an infinite layer", ior_below)
    stack = {n: spread[n][..., 0] for n in ("ior_above", "ior_below", "ground_reflectance", "ground_roughness")}
    distributions = _texts("distribution", distribution, count, _DISTRIBUTIONS)
    stacks = _lamina.LayerStacks.made(
        spread["sigma_a"],
        spread["sigma_s"],
        spread["g"],
        spread["ior"],
        spread["thickness"],
        spread["roughness"],
        _texts("phase", phase, count, _PHASES),
        distributions + distributions[-1:],
        stack["ior_above"],
        stack["ior_below"],
        stack["ground_reflectance"],
        stack["ground_roughness"],
    )
    return Layers(stacks, *_named_axes(shape[:-1], axes, wavelengths), _layer_names(names, count))


def _layer_names(names: Sequence[str] | None, count: int) -> list[str]:
    if names is None:
        return [f"layer {i}" for i in range(count)]
    is_list = isinstance(names, (list, tuple))
    if not is_list or len(names) != count or not all(isinstance(n, str) for n in names):
        raise InvalidInput(f"names: must be {count} texts, one per layer, but are {shown(names)}")
    return [name_text(f"names[{i}]", name) for i, name in enumerate(names)]


def _named_axes(
    shape: tuple[int, ...], axes: Sequence[str] | None, wavelengths: ArrayLike | None
) -> tuple[tuple[str, ...], dict[str, Any]]:
    names = [f"axis_{i}" for i in range(len(shape))]
    if axes is not None:
        if not isinstance(axes, (list, tuple)) or not all(isinstance(a, str) for a in axes):
            raise refuse("axes", f"be {len(shape)} names", axes)
        names = list(axes)
    if len(names) != len(shape):
        raise InvalidInput(f"axes: must be {len(shape)} names, but are {len(names)}")
    coords: dict[str, Any] = {}
    if wavelengths is not None:
        nm = doubles("wavelengths", wavelengths, 200.0, 3000.0, unit="nm")
        if not shape or nm.shape != shape[-1:]:
            raise InvalidInput(
                f"wavelengths: must be as many as the last axis of the stacks has, {shape[-1:]}, "
                f"but have the shape {nm.shape}"
            )
        names[-1] = "wavelength"
        coords["wavelength"] = nm
    return tuple(names), coords
