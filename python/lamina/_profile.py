# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""How far light spreads: profiles R(r) and T(r), their spectra, and sums of Gaussians."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _lamina
from ._input import doubles, flag, number, one_of, shown, whole
from ._lamina import InvalidInput
from ._photons import effort_of, require_unused
from ._progress import Progress, interrupted_with, progress_of
from ._result import Array, Result, band_labels, quantity, setting
from ._layers import Layers
from ._materials import MaterialLike, layers_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

METHODS = ("radiative_transfer", "diffusion", "dipole", "monte_carlo")


@dataclass(frozen=True, eq=False, repr=False)
class Profile(Result):
    """Diffuse light around a point of light, over the distance r from it."""

    method: str = setting("how it was found")
    per: str = setting("the flux that it is a fraction of: arriving_flux or entered_flux")
    r: Array = quantity("distances", unit="mm", axes=("r",), shared=True)
    reflectance: Array = quantity("light that leaves at the top", unit="1/mm²", axes=("r",))
    transmittance: Array = quantity("light that leaves at the bottom", unit="1/mm²", axes=("r",))
    total_reflectance: Array = quantity("all of it, beyond the last r too")
    total_transmittance: Array = quantity("all of it, and unscattered light")
    relative_error: Array | None = quantity("estimated, of the reflectance", axes=("r",), optional=True)
    transmittance_error: Array | None = quantity("estimated, relative", axes=("r",), optional=True)
    estimated_error: Array | None = quantity("the largest, relative, where there is light", optional=True)
    mean_error: Array | None = quantity("relative, weighted by flux", optional=True)
    standard_error: dict[str, Array] | None = quantity("of each by photons", optional=True)
    unfinished: Array | None = quantity("light given up after very many events", optional=True)
    thin_layers: list[list[int]] | None = quantity(
        "layers of each stack that are too thin for diffusion", optional=True)
    clamped: Array | None = quantity("flux by which diffusion is negative, set to 0", optional=True)
    was_cached: bool | None = quantity("it came from disk", optional=True)

    def _draw(self, ax: Axes) -> None:
        shape = self.reflectance.shape[:-1]
        labels = band_labels(self.axes, self.coords)
        peak = float(self.reflectance.max())
        for i, at in enumerate(np.ndindex(shape)):
            label, color = labels[i] if labels else (str(list(at)) if at else "R(r)", None)
            (line,) = ax.plot(self.r, self.reflectance[at], color=color, label=label)
            if float(self.transmittance[at].max()) > 1e-8 * peak:
                ax.plot(self.r, self.transmittance[at], "--", color=line.get_color())
        ax.set_xscale("log")
        ax.set_yscale("log")
        # Down to 1e-8 of the peak, and as far as there is light then.
        seen = (self.reflectance > 1e-8 * peak).reshape(-1, self.r.size).any(axis=0)
        ax.set_ylim(1e-8 * peak, 2.0 * peak)
        ax.set_xlim(self.r[0], self.r[np.nonzero(seen)[0][-1]])
        ax.set_xlabel("distance r [mm]")
        ax.set_ylabel("R(r), dashed T(r) [1/mm²]")
        if len(labels) <= 12 and shape:
            ax.legend(frameon=False)


@dataclass(frozen=True, eq=False, repr=False)
class ObliqueProfile(Result):
    """Light around an oblique pencil beam: R(r, phi) = sum over m of moments[m] cos(m phi), phi from
    where the beam goes on."""

    r: Array = quantity("distances", unit="mm", axes=("r",), shared=True)
    reflectance_moments: Array = quantity("at the top", unit="1/mm²", axes=("r", "moment"))
    transmittance_moments: Array = quantity("at the bottom", unit="1/mm²", axes=("r", "moment"))
    total_reflectance: Array = quantity("all of it")
    total_transmittance: Array = quantity("all of it, and unscattered light")
    relative_error: Array = quantity("estimated, of moment 0 at the top", axes=("r",))
    transmittance_error: Array = quantity("the same at the bottom", axes=("r",))
    estimated_error: Array = quantity("the largest of both where there is light")
    mean_error: Array = quantity("weighted by flux, of the side where it is larger")

    def reflectance(self, phi: ArrayLike) -> Array:
        """R over azimuths [degrees], axes (..., r, phi) [1/mm²]."""
        angles = np.radians(doubles("phi", phi))
        m = np.arange(self.reflectance_moments.shape[-1])
        return np.tensordot(self.reflectance_moments, np.cos(np.multiply.outer(m, angles)), axes=1)

    def _draw(self, ax: Axes) -> None:
        labels = band_labels(self.axes, self.coords)
        for i, at in enumerate(np.ndindex(self.total_reflectance.shape)):
            label, color = labels[i] if labels else (str(list(at)), None)
            for phi, style in ((0.0, "-"), (180.0, ":")):
                values = np.maximum(self.reflectance(phi)[at], 0.0)
                ax.plot(self.r, values, style, color=color, label=label if phi == 0.0 else None)
        peak = float(self.reflectance_moments[..., 0].max())
        ax.set(xscale="log", yscale="log", ylim=(1e-8 * peak, 2.0 * peak), xlabel="distance r [mm]",
               ylabel="R(r) onward, dotted backward [1/mm²]")
        ax.legend(frameon=False)


@dataclass(frozen=True, eq=False, repr=False)
class FrequencyResponse(Result):
    """What leaves of light that arrives as a wave J0(k r), diffuse light only."""

    k: Array = quantity("spatial frequencies", unit="1/mm", axes=("k",), shared=True)
    reflectance: Array = quantity("at the top", axes=("k",))
    transmittance: Array = quantity("at the bottom", axes=("k",))
    reflectance_error: Array = quantity("estimated, absolute", axes=("k",))
    transmittance_error: Array = quantity("estimated, absolute", axes=("k",))
    estimated_error: Array = quantity("the largest, relative as the accuracy is asked")
    derivatives: dict[str, dict[str, Array]] | None = quantity(
        "of reflectance and transmittance by sigma_a [mm], sigma_s [mm], g, thickness [1/mm]",
        axes=("k", "layer"), optional=True)

    def _draw(self, ax: Axes) -> None:
        labels = band_labels(self.axes, self.coords)
        for i, at in enumerate(np.ndindex(self.reflectance.shape[:-1])):
            label, color = labels[i] if labels else (str(list(at)), None)
            ax.plot(self.k, self.reflectance[at], color=color, label=label)
        ax.set(xlabel="spatial frequency k [1/mm]", ylabel="reflectance", ylim=(0.0, None))
        ax.legend(frameon=False)


@dataclass(frozen=True, eq=False, repr=False)
class GaussianProfile(Result):
    """A profile as a sum of Gaussians of unit flux, exp(-r² / 2v) / (2 pi v), shared by all bands."""

    variances: Array = quantity(
        "v of each Gaussian; the first is 0: light that leaves where it entered",
        unit="mm²", axes=("gaussian",), shared=True)
    reflectance_weights: Array = quantity("flux of each, per arriving flux", axes=("gaussian",))
    reflectance_rms_error: Array = quantity("over spatial frequency, relative to that at k = 0")
    reflectance_largest_error: Array = quantity("the same, the largest")
    transmittance_weights: Array | None = quantity("flux of each", axes=("gaussian",), optional=True)
    transmittance_rms_error: Array | None = quantity("as above", optional=True)
    transmittance_largest_error: Array | None = quantity("as above", optional=True)

    def reflectance(self, r: ArrayLike) -> Array:
        """The sum at distances r > 0 [mm], axes (..., r) [1/mm²]."""
        squares = np.square(doubles("r", r, 0.0, closed="(]"))
        v = self.variances[1:]
        each = np.exp(-np.divide.outer(squares, 2.0 * v)) / (2.0 * math.pi * v)
        result: Array = np.tensordot(self.reflectance_weights[..., 1:], each, axes=(-1, -1))
        return result

    def _draw(self, ax: Axes) -> None:
        labels = band_labels(self.axes, self.coords)
        widths = np.sqrt(self.variances[1:])
        for i, at in enumerate(np.ndindex(self.reflectance_weights.shape[:-1])):
            label, color = labels[i] if labels else (str(list(at)), None)
            ax.plot(widths, self.reflectance_weights[at][1:], "o-", color=color, label=label)
        ax.set(xscale="log", xlabel="standard deviation [mm]", ylabel="flux of the Gaussian")
        ax.legend(frameon=False)


def _coords(layers: Layers, **more: Any) -> dict[str, Any]:
    return {**layers.coords, **more}


def _grid(r_min: float, r_max: float, radii: int) -> tuple[float, float, int]:
    first = number("r_min", r_min, 1e-9, 1e9, unit="mm")
    last = number("r_max", r_max, 1e-9, 1e9, unit="mm")
    if not last > first:
        raise InvalidInput(f"r_max: must be > r_min, {first:g} mm, but is {last:g}")
    return first, last, whole("radii", radii, 2, 100_000)


def _light(incidence: object, lit_from: str, accuracy: float | None) -> dict[str, Any]:
    if not isinstance(incidence, str) or incidence not in ("normal", "diffuse"):
        raise InvalidInput(
            f"incidence: must be normal or diffuse, but is {shown(incidence)}; oblique beams are for `oblique_profile`")
    return {
        "is_diffuse": incidence == "diffuse",
        "is_from_below": one_of("lit_from", lit_from, ("above", "below")) == "below",
        "accuracy": 0.005 if accuracy is None else number("accuracy", accuracy, 1e-4, 0.1),
    }


def profile(
    material: MaterialLike,
    *,
    wavelengths: ArrayLike | None = None,
    method: str = "radiative_transfer",
    incidence: str = "normal",
    lit_from: str = "above",
    r_min: float = 1e-3,
    r_max: float = 1e2,
    radii: int = 256,
    accuracy: float | None = None,
    cache: bool = True,
    interreflections: str | None = None,
    photons: float | None = None,
    relative_error: float | None = None,
    seconds: float | None = None,
    seed: int = 0,
    independent_bands: bool = False,
    progress: Progress = None,
) -> Profile:
    """Light around a pencil beam on layers, over the distance from it: R(r) and T(r).

    :param material: a built-in name, a path, a dict, a `Material`, or `Layers` of any shape.
    :param wavelengths: [nm], in place of the material's own bands.
    :param method: "radiative_transfer"; "diffusion", layered multipoles; "dipole", diffusion in one
        half-space like the layers; "monte_carlo", photons.
    :param incidence: "normal", a pencil beam; "diffuse", equal radiance from the hemisphere on a point.
    :param lit_from: "above" or "below": the side that is lit, and that R(r) then leaves on.
    :param r_min: first distance [mm]; the distances are a geometric series.
    :param r_max: last distance [mm].
    :param radii: how many, in [2, 100000].
    :param accuracy: of radiative transfer: relative, in [1e-4, 0.1]; 0.005.
    :param cache: of radiative transfer: look for the result on disk, and keep it there.
    :param interreflections: of diffusion, between layers: "all" or "none".
    :param photons, relative_error, seconds, seed, independent_bands: as in `slab`.
    :param progress: None, True for a bar, or a function of the finished fraction.
    :raises InvalidInput: naming what is wrong; also where the estimated error is above 20 %.
    :raises Interrupted: after Ctrl-C; of monte_carlo `result` has the profile so far.

    Source: docs/radiative_transfer_profiles.md; Donner & Jensen 2005 for diffusion.

    >>> import lamina
    >>> p = lamina.profile("marble", method="diffusion", radii=64)
    >>> p.reflectance.shape, p.per
    ((3, 64), 'entered_flux')
    """
    one_of("method", method, METHODS)
    layers = layers_of(material, wavelengths)
    light = _light(incidence, lit_from, accuracy)
    grid = _grid(r_min, r_max, radii)
    transfer = "radiative_transfer"
    require_unused(method, {
        "incidence": (incidence != "normal", transfer),
        "lit_from": (lit_from != "above", transfer),
        "accuracy": (accuracy is not None, transfer),
        "interreflections": (interreflections is not None, "diffusion"),
        "photons": (photons is not None, "monte_carlo"),
        "relative_error": (relative_error is not None, "monte_carlo"),
        "seconds": (seconds is not None, "monte_carlo"),
        "independent_bands": (flag("independent_bands", independent_bands), "monte_carlo"),
    })
    is_cached = flag("cache", cache)
    effort = effort_of(photons, relative_error, seconds, seed, independent_bands)
    stacks = layers._stacks
    with progress_of(progress, "profile") as callback:
        if method == "diffusion":
            kind = one_of("interreflections", interreflections or "all", ("all", "none"))
            found = _lamina.profile_by_diffusion(stacks, grid, kind)
        elif method == "dipole":
            found = _lamina.profile_by_dipole(stacks, grid)
        elif method == "monte_carlo":
            found = _lamina.profile_by_monte_carlo(stacks, grid, effort, callback)
        else:
            found = _lamina.profile_by_radiative_transfer(stacks, grid, light, is_cached, callback)
    interrupted = found.pop("was_interrupted", False)
    if "standard_error" in found:
        for name in ("per", "r"):
            found["standard_error"].pop(name)
    result = Profile(axes=layers.axes, coords=_coords(layers, r=found["r"]), method=method, **found)
    if interrupted:
        raise interrupted_with(result)
    return result


def oblique_profile(
    material: MaterialLike,
    angle: float,
    *,
    wavelengths: ArrayLike | None = None,
    r_min: float = 1e-3,
    r_max: float = 1e2,
    radii: int = 256,
    moments: int = 8,
    progress: Progress = None,
) -> ObliqueProfile:
    """Light around a pencil beam that falls on obliquely, by radiative transfer, over the plane.

    :param angle: of the beam from the normal [degrees], in [0, 90).
    :param moments: in azimuth, in [1, 32]; beyond 8 only light scattered once has them.
    :param wavelengths, r_min, r_max, radii, progress: as in `profile`.
    :raises InvalidInput: naming what is wrong; boundaries must be smooth.
    :raises Interrupted: after Ctrl-C.
    """
    layers = layers_of(material, wavelengths)
    theta = math.radians(number("angle", angle, 0.0, 90.0, closed="[)", unit="degrees"))
    grid = _grid(r_min, r_max, radii)
    count = whole("moments", moments, 1, 32)
    with progress_of(progress, "oblique profile") as callback:
        found = _lamina.oblique_profile(layers._stacks, theta, grid, count, callback)
    coords = _coords(layers, r=found["r"], moment=np.arange(count))
    return ObliqueProfile(axes=layers.axes, coords=coords, **found)


def spatial_frequency(
    material: MaterialLike,
    k: ArrayLike,
    *,
    wavelengths: ArrayLike | None = None,
    incidence: str = "normal",
    lit_from: str = "above",
    accuracy: float | None = None,
    derivatives: bool = False,
    progress: Progress = None,
) -> FrequencyResponse:
    """What spatial-frequency domain imaging sees of layers: light that arrives as a wave J0(k r).

    :param k: spatial frequencies [1/mm], >= 0, ascending; at 0 what `slab` finds.
    :param derivatives: by what layers are made of, too; boundaries must be smooth.
    :param wavelengths, incidence, lit_from, accuracy, progress: as in `profile`.
    :raises InvalidInput: naming what is wrong; Interrupted.
    """
    layers = layers_of(material, wavelengths)
    frequencies = doubles("k", k, 0.0, 1e9, unit="1/mm")
    if frequencies.ndim != 1 or not (np.diff(frequencies) > 0.0).all():
        raise InvalidInput("k: must be ascending frequencies >= 0 [1/mm] in one row, but are not")
    light = _light(incidence, lit_from, accuracy)
    has_derivatives = flag("derivatives", derivatives)
    with progress_of(progress, "spatial frequencies") as callback:
        found = _lamina.spatial_frequency_response(
            layers._stacks, frequencies.tolist(), light, has_derivatives, callback)
    if has_derivatives:
        found["derivatives"] = {n: found.pop(f"d_{n}") for n in ("reflectance", "transmittance")}
    coords = _coords(layers, k=frequencies, layer=np.array(layers.names))
    return FrequencyResponse(axes=layers.axes, coords=coords, k=frequencies, **found)


def gaussians(
    material: MaterialLike,
    count: int,
    *,
    wavelengths: ArrayLike | None = None,
    incidence: str = "normal",
    lit_from: str = "above",
    accuracy: float | None = None,
    progress: Progress = None,
) -> GaussianProfile:
    """A profile by radiative transfer as a sum of Gaussians, fitted over spatial frequency.

    :param count: of Gaussians, in [1, 40], the same for all bands but for their weights.
    :param wavelengths, incidence, lit_from, accuracy, progress: as in `profile`.
    :raises InvalidInput: naming what is wrong; Interrupted.
    """
    layers = layers_of(material, wavelengths)
    light = _light(incidence, lit_from, accuracy)
    number_of = whole("count", count, 1, 40)
    with progress_of(progress, "Gaussians") as callback:
        found = _lamina.gaussian_profile(layers._stacks, number_of, light, callback)
    return GaussianProfile(axes=layers.axes, coords=_coords(layers), **found)
