# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Photon Monte Carlo with all that photons can be counted by."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _lamina
from ._input import Incidence, PathLike, doubles, flag, number, one_of, path_text, refuse, shown, whole
from ._input import incidence as check_incidence
from ._lamina import InvalidInput
from ._layers import Layers
from ._materials import MaterialLike, layers_of
from ._photons import effort_of
from ._progress import Progress, interrupted_with, progress_of
from ._result import Array, Result, band_labels, quantity, setting

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Axes and unit of what photons are counted by; NAME_reflected and NAME_transmitted where there are sides.
TALLIES: dict[str, tuple[tuple[str, ...], str]] = {
    "absorptance": (("layer",), "1"),
    "r": (("r",), "1/mm²"),
    "angle": (("angle",), "1/sr"),
    "r_angle": (("r", "angle"), "1/(mm² sr)"),
    "log_r": (("log_r",), "1/mm²"),
    "bsdf": (("cosine", "azimuth"), "1/sr"),
    "bsdf_by_order": (("order", "cosine", "azimuth"), "1/sr"),
    "order": (("order",), "1"),
    "angle_by_order": (("order", "angle"), "1/sr"),
    "path_length": (("path_length",), "1/mm"),
    "mean_path": ((), "mm"),
    "mean_time": ((), "ps"),
    "mean_layer_path": (("layer",), "mm"),
    "time": (("time",), "1/ps"),
    "r_time": (("r", "time"), "1/(mm² ps)"),
    "modulation": (("frequency",), "1"),
    "r_modulation": (("r", "frequency"), "1/mm²"),
    "detector": (("distance",), "1/mm²"),
    "detector_time": (("distance", "time"), "1/(mm² ps)"),
    "detector_modulation": (("distance", "frequency"), "1/mm²"),
    "direction": (("exit",), "1/sr"),
    "absorption": (("r", "depth"), "1/mm³"),
    "fluence": (("r", "depth"), "1/mm²"),
}


@dataclass(frozen=True, eq=False, repr=False)
class Photons(Result):
    """What photons were counted by: `p["r_reflected"]`, and its standard error `p.error("r_reflected")`."""

    values: dict[str, Array] = setting("all tallies by name; `axes_of` and `unit_of` say what they are")
    errors: dict[str, Array] = setting("their standard errors")
    photons: Array = quantity("that were followed")

    def __getitem__(self, name: str) -> Array:
        return self._of(name, self.values)

    def error(self, name: str) -> Array:
        """The standard error of a tally, of its shape."""
        return self._of(name, self.errors)

    def _of(self, name: str, table: dict[str, Array]) -> Array:
        if name not in table:
            raise InvalidInput(f"name: must be one of {', '.join(table)}, but is {shown(name)}")
        return table[name]

    @staticmethod
    def _tally(name: str) -> tuple[tuple[str, ...], str]:
        for end in ("_amplitude", "_phase"):
            if name.endswith(end):
                axes, unit = Photons._tally(name[: -len(end)])
                return axes, "rad" if end == "_phase" else unit
        return TALLIES.get(name.replace("_reflected", "").replace("_transmitted", ""), ((), "1"))

    def axes_of(self, name: str) -> tuple[str, ...]:
        """Names of all axes of a tally."""
        self[name]
        return self.axes + self._tally(name)[0]

    def unit_of(self, name: str) -> str:
        """The unit of a tally, "1" without one."""
        self[name]
        return self._tally(name)[1]

    def to_xarray(self) -> Any:
        """All tallies as an xarray.Dataset; NAME_error beside each."""
        import xarray

        variables = {}
        for name, value in self.values.items():
            attributes = {"units": self.unit_of(name)}
            variables[name] = (self.axes_of(name), value, attributes)
            variables[f"{name}_error"] = (self.axes_of(name), self.errors[name], attributes)
        return xarray.Dataset(variables, coords=self.coords)

    def _draw(self, ax: Axes) -> None:
        one = next((n for n in ("log_r_reflected", "r_reflected", "angle_reflected", "time_reflected",
                                "path_length_reflected", "detector") if n in self.values), None)
        if one is None:
            names = ("specular_reflectance", "diffuse_reflectance", "transmittance")
            for i, name in enumerate(names):
                ax.errorbar([i] * self[name].size, self[name].ravel(), self.error(name).ravel(), fmt="o")
            ax.set_xticks(range(len(names)), [n.replace("_", "\n") for n in names])
            ax.set_ylabel("fraction of the light")
            return
        axis = self._tally(one)[0][0]
        labels = band_labels(self.axes, self.coords)
        for i, at in enumerate(np.ndindex(self[one].shape[:-1])):
            label, color = labels[i] if labels else (str(list(at)), None)
            seen = self[one][at] > 0.0
            ax.errorbar(self.coords[axis][seen], self[one][at][seen], self.error(one)[at][seen],
                        color=color, label=label, lw=1.2)
        is_log = axis in ("r", "log_r", "distance")
        ax.set(xlabel=f"{axis.replace('_', ' ')}", ylabel=f"{one.replace('_', ' ')} [{self.unit_of(one)}]",
               yscale="log" if is_log else "linear", xscale="log" if axis == "log_r" else "linear")
        if labels and len(labels) <= 12:
            ax.legend(frameon=False)


def _bins(name: str, value: object, unit: str) -> tuple[int, float] | None:
    if value is None:
        return None
    if not isinstance(value, (tuple, list)) or len(value) != 2:
        raise InvalidInput(f"{name}: must be (count, width), but is {shown(value)}")
    return whole(f"{name}[0]", value[0], 1, 10**7), number(
        f"{name}[1]", value[1], 0.0, 1e9, closed="(]", unit=unit)


def photons(
    material: MaterialLike,
    *,
    wavelengths: ArrayLike | None = None,
    photons: float | None = None,
    relative_error: float | None = None,
    seconds: float | None = None,
    seed: int = 0,
    independent_bands: bool = False,
    incidence: Incidence = "normal",
    beam: str = "pencil",
    beam_radius: float | None = None,
    r: tuple[int, float] | None = None,
    angles: int | None = None,
    log_r: tuple[int, float, float] | None = None,
    depth: tuple[int, float] | None = None,
    fluence: bool = False,
    bsdf: tuple[int, int] | None = None,
    orders: bool = False,
    path_length: tuple[int, float] | None = None,
    time: tuple[int, float] | None = None,
    frequencies: ArrayLike | None = None,
    detectors: ArrayLike | None = None,
    detector_width: float | None = None,
    directions: Sequence[tuple[float, float]] | None = None,
    max_events: int = 500_000,
    progress: Progress = None,
) -> Photons:
    """Photon Monte Carlo in layers: totals, and what else is asked for, each with its standard error.

    Bins are (count, width); what lies beyond the last counts in the last.

    :param material: a built-in name, a path, a dict, a `Material`, or `Layers` of any shape.
    :param wavelengths, photons, relative_error, seconds, seed, independent_bands: as in `slab`.
    :param incidence: "normal", "diffuse", or an angle [degrees] in [0, 90).
    :param beam: "pencil", "gaussian" or "flat".
    :param beam_radius: of a Gaussian (1/e²) or flat beam [mm].
    :param r: bins of exit radius [mm].
    :param angles: bins of exit angle over 0 to 90 degrees.
    :param log_r: (count, low, high): bins of the logarithm of the exit radius [mm].
    :param depth: bins of depth [mm]: with `r` absorbed density over (r, depth).
    :param fluence: with `r` and `depth` the fluence, too.
    :param bsdf: (cosines, azimuths): cells of equal solid angle.
    :param orders: totals, angles and BSDF by scattering order: 0, 1 to 10, and the rest.
    :param path_length: bins of path length inside [mm], and its mean.
    :param time: bins of time of flight [ps], and its mean.
    :param frequencies: of modulated light [MHz]: amplitudes and phases.
    :param detectors: distances of ring detectors [mm]; `detector_width` is that of each ring [mm].
    :param directions: (theta, phi) [degrees] where next-event estimation looks: theta < 90 above,
        > 90 below; phi from the plane of incidence.
    :param max_events: after which a photon is given up.
    :raises InvalidInput: naming what is wrong.
    :raises Interrupted: after Ctrl-C; `result` has the counts so far.

    Source: Hanrahan & Krueger 1993, Figure 7; Wang et al. 1995; docs/photons.md.

    >>> import lamina
    >>> p = lamina.photons("jade", photons=2e4, r=(50, 0.1), seed=1)
    >>> p["r_reflected"].shape, p.unit_of("r_reflected"), p.axes_of("r_reflected")
    ((3, 50), '1/mm²', ('band', 'r'))
    """
    layers = layers_of(material, wavelengths)
    is_diffuse, theta = check_incidence(incidence)
    one_of("beam", beam, ("pencil", "gaussian", "flat"))
    if (beam == "pencil") != (beam_radius is None):
        raise InvalidInput(f"beam_radius: must {'be left out' if beam == 'pencil' else 'be given'} for a {beam} beam")
    radius = 0.0 if beam_radius is None else number("beam_radius", beam_radius, 0.0, 1e9, closed="(]", unit="mm")
    asked: dict[str, Any] = {}
    coords: dict[str, Any] = {**layers.coords, "layer": np.array(layers.names)}
    for name, value, unit in (("r", r, "mm"), ("depth", depth, "mm"),
                              ("path_length", path_length, "mm"), ("time", time, "ps")):
        bins = _bins(name, value, unit)
        if bins is not None:
            asked[name] = bins
            coords[name] = (np.arange(bins[0]) + 0.5) * bins[1]
    if angles is not None:
        asked["angles"] = whole("angles", angles, 1, 10**6)
        coords["angle"] = (np.arange(asked["angles"]) + 0.5) * 90.0 / asked["angles"]
    if log_r is not None:
        if not isinstance(log_r, (tuple, list)) or len(log_r) != 3:
            raise InvalidInput(f"log_r: must be (count, low, high), but is {shown(log_r)}")
        low, high = (number(f"log_r[{i}]", log_r[i], 0.0, 1e9, closed="(]", unit="mm") for i in (1, 2))
        count = whole("log_r[0]", log_r[0], 1, 10**6)
        if not low < high:
            raise InvalidInput(f"log_r: low must be < high, but they are {low:g} and {high:g}")
        asked["log_r"] = (count, low, high)
        coords["log_r"] = low * (high / low) ** ((np.arange(count) + 0.5) / count)
    if depth is not None and r is None:
        raise InvalidInput("depth: goes with r, which is not given")
    if flag("fluence", fluence):
        if r is None or depth is None:
            raise InvalidInput("fluence: goes with r and depth, which are not both given")
        asked["fluence"] = True
    if bsdf is not None:
        if not isinstance(bsdf, (tuple, list)) or len(bsdf) != 2:
            raise InvalidInput(f"bsdf: must be (cosines, azimuths), but is {shown(bsdf)}")
        asked["bsdf"] = (whole("bsdf[0]", bsdf[0], 1, 10**4), whole("bsdf[1]", bsdf[1], 1, 10**4))
        coords["cosine"] = (np.arange(asked["bsdf"][0]) + 0.5) / asked["bsdf"][0]
        coords["azimuth"] = (np.arange(asked["bsdf"][1]) + 0.5) * 360.0 / asked["bsdf"][1]
    if flag("orders", orders):
        asked["orders"] = True
        coords["order"] = np.array([*(str(i) for i in range(11)), "more"])
    if frequencies is not None:
        coords["frequency"] = np.atleast_1d(doubles("frequencies", frequencies, 0.0, 1e9, unit="MHz"))
        asked["frequencies"] = coords["frequency"].ravel().tolist()
    if (detectors is None) != (detector_width is None):
        raise InvalidInput("detectors and detector_width: must be given together")
    if detectors is not None:
        coords["distance"] = np.atleast_1d(doubles("detectors", detectors, 0.0, 1e9, unit="mm"))
        asked["detectors"] = coords["distance"].ravel().tolist()
        asked["detector_width"] = number("detector_width", detector_width, 0.0, 1e9, closed="(]", unit="mm")
    if directions is not None:
        if not isinstance(directions, (tuple, list)):
            raise refuse("directions", "be pairs (theta, phi) in a list", directions)
        asked["directions"] = [_direction(i, d) for i, d in enumerate(directions)]
        coords["exit"] = np.arange(len(asked["directions"]))
    effort = effort_of(photons, relative_error, seconds, seed, independent_bands)
    events = whole("max_events", max_events, 1, 2**32 - 1)
    with progress_of(progress, "photons") as callback:
        found = _lamina.photons(
            layers._stacks, is_diffuse, theta, beam, radius, asked, effort, events, callback)
    interrupted = found.pop("was_interrupted")
    result = Photons(axes=layers.axes, coords=coords, **found)
    if interrupted:
        raise interrupted_with(result)
    return result


@dataclass(frozen=True)
class McmlRun:
    """A run of an MCML file, in mm: `run.photons()` follows its photons."""

    name: str  #: of its output file
    layers: Layers
    photon_count: int
    r: tuple[int, float]  #: bins of exit radius: count and width [mm]
    depth: tuple[int, float]  #: bins of depth
    angles: int  #: bins of exit angle

    def photons(
        self, photons: float | None = None, *, seed: int = 0, fluence: bool = False, progress: Progress = None
    ) -> Photons:
        """What MCML would count, by lamina's photons.

        :param photons: in place of the file's.
        :raises InvalidInput, Interrupted: as `photons`.
        """
        count = self.photon_count if photons is None else photons
        return _follow(self.layers, photons=count, seed=seed, r=self.r, depth=self.depth,
                       angles=self.angles or None, fluence=fluence, progress=progress)


def mcml(path: PathLike) -> list[McmlRun]:
    """Reads an MCML 1.x input file (.mci): layers and what to count, run by run, in mm.

    :raises InvalidInput: naming line and field; FileError if it cannot be read.

    Source: Wang et al. 1995, §5.1.
    """
    return [
        McmlRun(
            name=run["name"],
            layers=Layers(run["stacks"], (), {}, [f"layer {i}" for i in range(run["stacks"].layer_count)]),
            photon_count=run["photons"],
            r=run["r"],
            depth=run["depth"],
            angles=run["angles"],
        )
        for run in _lamina.load_mcml(path_text("path", path))
    ]


def _direction(i: int, direction: object) -> tuple[float, float, bool]:
    if not isinstance(direction, (tuple, list)) or len(direction) != 2:
        raise InvalidInput(f"directions[{i}]: must be (theta, phi), but is {shown(direction)}")
    theta = number(f"directions[{i}][0]", direction[0], 0.0, 180.0, closed="[)", unit="degrees")
    phi = number(f"directions[{i}][1]", direction[1], -360.0, 360.0, unit="degrees")
    if theta == 90.0:
        raise InvalidInput(f"directions[{i}][0]: must not be 90 degrees")
    is_below = theta > 90.0
    return math.radians(180.0 - theta if is_below else theta), math.radians(phi), is_below


_follow = photons  # where an argument has that name
