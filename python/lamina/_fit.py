# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""The way back: numbers of a material from measurements, with error bars."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from . import _lamina
from ._files import FileLike, opened, settings_of
from ._input import PathLike, shown, whole
from ._lamina import InvalidInput
from ._materials import Material
from ._progress import Progress, interrupted_with, progress_of
from ._result import Array, Result, quantity, setting

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class FittedNumber:
    """A number of the material that was free, once or in one band."""

    parameter: str  #: its path in the material
    band: str | None  #: None: the same in all
    value: float
    low_error: float  #: from the value down to one standard deviation
    high_error: float  #: and up
    standard_deviation: float  #: of its coordinate; inf where the data do not tell
    prior_share: float  #: that over the prior's; 0 without a prior
    is_at_bound: bool  #: it ended at its range; its errors are inf: unknown


@dataclass(frozen=True)
class FittedSeries:
    """What one instrument measured, and what the fit makes of it; arrays over its points."""

    kind: str
    band: tuple[str, ...]
    quantity: tuple[str, ...]
    at: Array  #: spatial frequency [1/mm], radius [mm], time [ps] or frequency [MHz]; 0 of totals
    r: Array  #: radius of what is over time or frequency [mm]
    measured: Array
    sd: Array  #: standard deviation of what was measured
    predicted: Array
    residual: Array  #: measured - predicted, in standard deviations


@dataclass(frozen=True, eq=False, repr=False)
class Fit(Result):
    """What a measurement says of a material: `fit["sigma_a"]` is an array over bands, or one number."""

    name: str = setting("of the measurement")
    numbers: tuple[FittedNumber, ...] = setting("what was free, as it was found")
    series: tuple[FittedSeries, ...] = setting("what was measured, beside what the fit predicts")
    correlations: tuple[tuple[tuple[int, ...], Array], ...] = setting(
        "places in `numbers` that were fitted together, and how their errors go together")
    material: Material = setting("as it was found")
    notes: tuple[str, ...] = setting("what the data cannot tell")
    has_converged: bool = setting("whether the steps ended")
    chi_squared: float = quantity("sum of the squares of the residuals, without priors")
    prior_squares: float = quantity("what priors add to it")
    degrees_of_freedom: float = quantity("measured numbers less free ones")

    def _of(self, parameter: str) -> list[FittedNumber]:
        found = [n for n in self.numbers if n.parameter == parameter]
        if not found:  # by the end of its path, where that is unique
            ends = sorted({n.parameter for n in self.numbers if n.parameter.endswith("." + parameter)})
            found = [n for n in self.numbers if len(ends) == 1 and n.parameter == ends[0]]
        if not found:
            names = ", ".join(dict.fromkeys(n.parameter for n in self.numbers))
            raise InvalidInput(f"parameter: must be one of {names}, but is {shown(parameter)}")
        return found

    def __getitem__(self, parameter: str) -> Array:
        return np.array([n.value for n in self._of(parameter)]).squeeze()

    def error(self, parameter: str) -> Array:
        """One standard deviation of a number: the mean of that down and that up; inf where it is unknown."""
        return np.array([(n.low_error + n.high_error) / 2.0 for n in self._of(parameter)]).squeeze()

    def _draw(self, ax: Axes) -> None:
        first = 0
        for series in self.series:
            at = np.arange(first, first + series.measured.size)
            first += series.measured.size
            ax.errorbar(at, series.measured, series.sd, fmt=".", label=f"measured, {series.kind}")
            ax.plot(at, series.predicted, "k_", ms=9)
        ax.set(xlabel="point", ylabel="measured, lines: the fit")
        ax.legend(frameon=False)

    def __repr__(self) -> str:
        lines = [f"Fit of {self.name!r}: chi² {self.chi_squared:.4g} for {self.degrees_of_freedom:.0f} degrees of freedom"]
        for n in self.numbers:
            where = f" at {n.band}" if n.band else ""
            bound = ", at its range" if n.is_at_bound else ""
            is_known = np.isfinite(n.standard_deviation)
            error = f"-{n.low_error:.2g} +{n.high_error:.2g}" if is_known else f"unknown{bound}"
            lines.append(f"  {n.parameter}{where}: {n.value:.5g} {error}")
        return "\n".join(lines + [f"  note: {note}" for note in self.notes])


@overload
def fit(
    measurement: FileLike,
    *,
    folder: PathLike | None = None,
    changes: Mapping[str, Any] | None = None,
    seed: int = 0,
    progress: Progress = None,
) -> Fit: ...
@overload
def fit(
    measurement: list[FileLike] | tuple[FileLike, ...],
    *,
    folder: PathLike | None = None,
    changes: Mapping[str, Any] | None = None,
    seed: int = 0,
    progress: Progress = None,
) -> list[Fit]: ...
def fit(
    measurement: FileLike | Sequence[FileLike],
    *,
    folder: PathLike | None = None,
    changes: Mapping[str, Any] | None = None,
    seed: int = 0,
    progress: Progress = None,
) -> Fit | list[Fit]:
    """Finds numbers of a material from measurements, with error bars.

    :param measurement: the path of a measurement file, a dict with its keys (arrays may stand for
        lists), or a list of these, which are fitted on all cores; docs/fit.md.
    :param folder: where paths in a dict begin; the current folder.
    :param changes: values by their paths.
    :param seed: of further starts.
    :raises InvalidInput: naming the key that is wrong, or if a solver refuses the material.
    :raises FileError: if a file cannot be read.
    :raises Interrupted: after Ctrl-C; of a list `result` has the fits that had ended, None for others.

    >>> import lamina
    >>> found = lamina.fit({
    ...     "name": "plate",
    ...     "material": {"lamina": "material", "version": 1, "length_unit": "mm", "bands": [600], "ior_below": 1,
    ...                  "layers": [{"sigma_a": 0.1, "sigma_s": 5, "g": 0.8, "ior": 1.4, "thickness": 1}]},
    ...     "free": [{"parameter": "layers[0].sigma_a", "per_band": True, "low": 1e-4, "high": 10, "scale": "logarithmic"},
    ...              {"parameter": "layers[0].sigma_s", "per_band": True, "low": 0.1, "high": 100, "scale": "logarithmic"}],
    ...     "measured": [{"kind": "totals", "wavelength_nm": [600], "reflectance": [0.3], "transmittance": [0.2], "unit": "fraction",
    ...                   "specular": "included", "sd": 0.005}]})
    >>> found.has_converged
    True
    """
    many = isinstance(measurement, (list, tuple))
    each: list[Any] = list(measurement) if isinstance(measurement, (list, tuple)) else [measurement]
    if not each:
        raise InvalidInput("measurement: must be a path, a dict or a list of these, but is empty")
    with ExitStack() as files:
        sources = [files.enter_context(opened("measurement", "measurement", one, folder)) for one in each]
        callback = files.enter_context(progress_of(progress, "fit"))
        found, interrupted = _lamina.fit(sources, settings_of(changes), whole("seed", seed, 0, 2**64 - 1), callback)
    if interrupted:
        ended = [None if one is None else _fit_of(one) for one in found]
        raise interrupted_with(ended if many else ended[0])
    fits = [_fit_of(one) for one in found if one is not None]
    return fits if many else fits[0]


def _fit_of(found: dict[str, Any]) -> Fit:
    text = found.pop("material_text")
    return Fit(
        axes=(),
        coords={},
        numbers=tuple(FittedNumber(**n) for n in found.pop("numbers")),
        series=tuple(
            FittedSeries(
                band=tuple(s.pop("band")), quantity=tuple(s.pop("quantity")), kind=s.pop("kind"), **s
            )
            for s in found.pop("series")
        ),
        correlations=tuple((tuple(places), matrix) for places, matrix in found.pop("groups")),
        material=Material(_lamina.decode_material(text, "material", []), text=text),
        notes=tuple(found.pop("notes")),
        **found,
    )
