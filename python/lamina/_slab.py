# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Totals of layers: what is reflected, transmitted, absorbed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _lamina
from ._input import Incidence, flag, number, one_of
from ._input import incidence as check_incidence
from ._photons import effort_of, require_unused
from ._progress import Progress, interrupted_with, progress_of
from ._result import Array, Result, quantity, setting
from ._materials import MaterialLike, layers_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

METHODS = ("radiative_transfer", "diffusion", "monte_carlo")


@dataclass(frozen=True, eq=False, repr=False)
class SlabTotals(Result):
    """What becomes of the light that arrives on layers, as fractions of it; axes as of the layers."""

    method: str = setting("how they were found")
    specular_reflectance: Array = quantity("the first reflection at the top surface only")
    diffuse_reflectance: Array = quantity("all other light that leaves at the top")
    transmittance: Array = quantity("what leaves at the bottom, unscattered light included")
    absorptance: Array = quantity("absorbed in each layer", axes=("layer",))
    unscattered_reflectance: Array | None = quantity(
        "mirrored, and what comes back from inside unscattered", optional=True)
    unscattered_transmittance: Array | None = quantity("part of the transmittance", optional=True)
    estimated_error: Array | None = quantity("of each total, absolute", optional=True)
    standard_error: dict[str, Array] | None = quantity("of each total by photons", optional=True)
    unfinished: Array | None = quantity("light given up after very many events", optional=True)
    photons: Array | None = quantity("that were spent", optional=True)
    derivatives: dict[str, dict[str, Array]] | None = quantity(
        "of a total by sigma_a [mm], sigma_s [mm], g and thickness [1/mm] of each layer",
        axes=("layer",), optional=True)

    def _draw(self, ax: Axes) -> None:
        names = list(self.coords.get("layer", range(self.absorptance.shape[-1])))
        parts = [("mirrored", self.specular_reflectance), ("reflected", self.diffuse_reflectance)]
        parts += [(f"absorbed: {n}", self.absorptance[..., i]) for i, n in enumerate(names)]
        parts += [("transmitted", self.transmittance)]
        flat = [(label, np.atleast_1d(value).reshape(-1)) for label, value in parts]
        if "wavelength" in self.axes and len(self.axes) == 1:
            x = self.coords["wavelength"]
            ax.stackplot(x, *[v for _, v in flat], labels=[n for n, _ in flat], alpha=0.85)
            ax.set_xlabel("wavelength [nm]")
            ax.set_xlim(x[0], x[-1] if len(x) > 1 else x[0] + 1)
        else:
            count = flat[0][1].size
            labels = self.coords.get(self.axes[0]) if len(self.axes) == 1 else None
            at = np.arange(count)
            bottom = np.zeros(count)
            for label, value in flat:
                ax.bar(at, value, bottom=bottom, label=label, width=0.8)
                bottom = bottom + value
            ax.set_xticks(at, labels if labels is not None else [str(i) for i in at])
        ax.set_ylim(0.0, 1.0)
        ax.set_ylabel("fraction of the light")
        ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)


def slab(
    material: MaterialLike,
    *,
    wavelengths: ArrayLike | None = None,
    method: str = "radiative_transfer",
    incidence: Incidence = "normal",
    accuracy: float | None = None,
    derivatives: bool = False,
    interreflections: str | None = None,
    photons: float | None = None,
    relative_error: float | None = None,
    seconds: float | None = None,
    seed: int = 0,
    independent_bands: bool = False,
    progress: Progress = None,
) -> SlabTotals:
    """Totals of layers: reflected, transmitted, absorbed by each layer.

    Fractions are of the light that arrives. The first reflection at the surface is specular; all
    other light that leaves at the top is diffuse. All stacks are solved on all cores.

    :param material: a built-in name, a path, a dict, a `Material`, or `Layers` of any shape.
    :param wavelengths: [nm], in place of the material's own bands.
    :param method: "radiative_transfer" by adding-doubling, "diffusion" by layered multipoles, or
        "monte_carlo" by photons.
    :param incidence: "normal", "diffuse", or an angle [degrees] in [0, 90).
    :param accuracy: of radiative transfer: absolute, of each total, in [1e-10, 0.1]; 1e-5.
    :param derivatives: of radiative transfer: of the totals by what layers are made of.
    :param interreflections: of diffusion, between layers: "all", or "none" as in Eqs. 17 and 18 of
        Donner & Jensen 2005.
    :param photons: of monte_carlo, per band; 1e6.
    :param relative_error: of monte_carlo: stop when totals are known to this fraction.
    :param seconds: of monte_carlo: stop after so many.
    :param seed: of photons, in [0, 2^64).
    :param independent_bands: give each band random numbers of its own.
    :param progress: None, True for a bar, or a function of the finished fraction.
    :raises InvalidInput: naming what is wrong.
    :raises Interrupted: after Ctrl-C; `result` has the totals so far: of monte_carlo of the photons
        by then, else NaN for stacks that are not solved yet; None if none is.

    Source: Plass et al. 1973; docs/adding_doubling.md.

    >>> import lamina
    >>> skin = lamina.slab("donner_jensen_skin", incidence="diffuse")
    >>> skin.diffuse_reflectance.round(3)
    array([0.392, 0.388, 0.306])
    >>> round(float(skin.specular_reflectance[0] + skin.diffuse_reflectance[0]
    ...             + skin.transmittance[0] + skin.absorptance[0].sum()), 4)
    1.0
    """
    one_of("method", method, METHODS)
    layers = layers_of(material, wavelengths)
    is_diffuse, theta = check_incidence(incidence)
    require_unused(method, {
        "accuracy": (accuracy is not None, "radiative_transfer"),
        "derivatives": (flag("derivatives", derivatives), "radiative_transfer"),
        "interreflections": (interreflections is not None, "diffusion"),
        "photons": (photons is not None, "monte_carlo"),
        "relative_error": (relative_error is not None, "monte_carlo"),
        "seconds": (seconds is not None, "monte_carlo"),
        "independent_bands": (flag("independent_bands", independent_bands), "monte_carlo"),
    })
    effort = effort_of(photons, relative_error, seconds, seed, independent_bands)
    stacks = layers._stacks
    with progress_of(progress, "slab") as callback:
        if method == "diffusion":
            kind = one_of("interreflections", interreflections or "all", ("all", "none"))
            found = _lamina.slab_by_diffusion(stacks, is_diffuse, theta, kind, callback)
        elif method == "monte_carlo":
            found = _lamina.slab_by_monte_carlo(stacks, is_diffuse, theta, effort, callback)
        else:
            solve = _lamina.slab_with_derivatives if derivatives else _lamina.slab_by_radiative_transfer
            asked = 1e-5 if accuracy is None else number("accuracy", accuracy, 1e-10, 0.1)
            found = solve(stacks, is_diffuse, theta, asked, callback)
    interrupted = found.pop("was_interrupted", False)
    if derivatives:
        found["derivatives"] = {
            name: found.pop(f"d_{name}")
            for name in ("diffuse_reflectance", "transmittance", "unscattered_transmittance")
        }
    coords: dict[str, Any] = {**layers.coords, "layer": np.array(layers.names)}
    result = SlabTotals(axes=layers.axes, coords=coords, method=method, **found)
    if interrupted:
        raise interrupted_with(result)
    return result
