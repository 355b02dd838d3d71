# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""From photographs to maps, each with its error; and which bands to photograph in."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lamina
from ._files import FileLike, SavedFolder, folder_of, opened, settings_of
from ._input import PathLike, doubles, name_list, number, one_of, path_text, refuse, whole
from ._lamina import InvalidInput
from ._maps import Map, SkinMaps, maps_of_skin
from ._progress import Progress, interrupted_with, progress_of
from ._result import Array, Result, quantity, setting

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False, repr=False)
class AcquiredMaps(Result):
    """Maps of what skin, or leaves, are made of, each with its standard deviation."""

    name: str = setting("of the capture")
    maps: dict[str, Map] = setting("by number, axes (y, x)")
    deviations: dict[str, Map] = setting(
        "standard deviation of each, of its coordinate: relative of a logarithm, absolute of a logit")
    coordinates: dict[str, str] = setting("of each number: logarithm, logit or value")
    prior_share: dict[str, float] = setting(
        "median error of each number over what people, or leaves, differ by: beyond 0.8 it is not told")
    mask: Mask = quantity("where there is skin, or leaf", axes=("y", "x"), shared=True)
    residual: Array = quantity("of what the maps reflect, root mean square", axes=("band",), shared=True)
    chi_squared: Array = quantity(
        "reduced, of what the maps leave by the stated errors: where it is above 1 errors have grown by its root",
        axes=("band",), shared=True)
    error_growth: Array = quantity("factors of the stated errors that were used", axes=("band",), shared=True)
    correlation: Array = quantity("of the numbers' coordinates", axes=("number", "other"), shared=True)
    predicted: Map | None = quantity(
        "what the maps reflect, at every few pixels of large captures", axes=("row", "column", "band"), shared=True)
    mm_per_pixel: float | None = quantity("if it is known", unit="mm")
    notes: tuple[str, ...] = setting("what was done to the photographs")
    _found: Any = None

    def save(self, folder: PathLike) -> None:
        """Writes the maps, their standard deviations and the files that load them, as the command.

        :raises WriteError: if they cannot be written.
        """
        self._found.save(path_text("folder", folder))

    def __reduce__(self) -> Any:
        return _restored, (type(self), self.to_dict(), folder_of(self.save))

    def _draw(self, ax: Axes) -> None:
        name = min(self.prior_share, key=lambda n: self.prior_share[n])
        values = np.where(self.mask, self.maps[name], np.nan)
        scale = self.mm_per_pixel or 1.0
        shown = ax.imshow(
            values, extent=(0.0, values.shape[1] * scale, values.shape[0] * scale, 0.0), cmap="copper_r",
            vmin=np.nanpercentile(values, 1), vmax=np.nanpercentile(values, 99))
        ax.set(title=name, xlabel="mm" if self.mm_per_pixel else "pixel", ylabel="mm" if self.mm_per_pixel else "pixel")
        ax.figure.colorbar(shown, ax=ax)


def _restored(kind: type[AcquiredMaps], fields: dict[str, Any], files: dict[str, bytes]) -> AcquiredMaps:
    return kind(**fields, _found=SavedFolder(files))


@dataclass(frozen=True, eq=False, repr=False)
class AcquiredSkin(AcquiredMaps):
    """Maps of what skin is made of, from photographs, each with its standard deviation."""

    within_share: dict[str, float] = quantity(
        "as prior_share, of differences within the image", optional=True)
    number_units: dict[str, str] = quantity("what the values of each number are", optional=True)
    recipe_names: dict[str, list[str]] = quantity("arguments of `patch` that a number gives", optional=True)
    fixed: dict[str, float] = quantity("numbers of skin that were not acquired", optional=True)
    constants: str = quantity("of skin", optional=True)
    measured: Map | None = quantity(
        "the reflectances that were photographed", axes=("row", "column", "band"), shared=True, optional=True)
    mean_ciede2000: float | None = quantity("between what was measured and predicted", optional=True)
    by_calibration: Array | None = quantity(
        "change of each number where a band is 2 % brighter", axes=("band", "number"), shared=True, optional=True)
    lateral: str = quantity("transport, or none: each pixel by itself", optional=True)
    stop: str = quantity("why the steps ended", optional=True)
    history: tuple[tuple[float, float, float], ...] = quantity(
        "of the steps: forward models, residual, residual in standard deviations", optional=True)
    smoothness: Array | None = quantity("of each number that was used, twice", optional=True)
    has_errors: bool = quantity("False after Ctrl-C: deviations are those of the prior", optional=True)

    def skin_maps(self) -> SkinMaps:
        """The same for `patch` and `edit`."""
        known = {other: self.maps[n] for n, others in self.recipe_names.items() for other in others}
        rest = {n: v for n, v in self.fixed.items() if n not in known}
        return maps_of_skin(_lamina.EditableSkin.made(known, rest, self.constants, self.mm_per_pixel or 0.0))


@dataclass(frozen=True, eq=False, repr=False)
class AcquiredLeaf(AcquiredMaps):
    """Maps of what leaves are made of, from photographs in many bands."""

    misfit: Map | None = quantity("root mean square over bands", axes=("y", "x"), shared=True, optional=True)
    bias: Array | None = quantity("measured less predicted, mean", axes=("band",), shared=True, optional=True)
    noise: Array | None = quantity("that was used", axes=("band",), shared=True, optional=True)


def acquire(
    capture: FileLike,
    *,
    folder: PathLike | None = None,
    changes: Mapping[str, Any] | None = None,
    lateral: str = "auto",
    most_forwards: float | None = None,
    model_error: float | None = None,
    robust: float | None = None,
    start: AcquiredSkin | None = None,
    seed: int = 0,
    progress: Progress = None,
) -> AcquiredSkin | AcquiredLeaf:
    """Maps of melanin, blood and other numbers of skin from photographs, each with its error; of
    leaves where the capture says "leaf".

    :param capture: the path of a capture file, or a dict with its keys; docs/acquire.md. In a dict
        arrays (y, x) or (y, x, channel) may stand for images, dark and white ones, masks and lights.
    :param folder: where paths in a dict begin; the current folder.
    :param changes: values of the file by their paths.
    :param lateral: "transport": light travels sideways; "none": each pixel by itself; "auto":
        transport where mm_per_pixel is known and the capture is no texture.
    :param most_forwards: ends after so many forward models, in [1, 1e6]; 120.
    :param model_error: of the forward model, relative, in [0, 0.5]; 0.
    :param robust: residuals beyond so many standard deviations count less, in [0, 1e6]; 0: all alike.
    :param start: an earlier result to go on from, as of Ctrl-C.
    :param seed: of draws for standard deviations, in [0, 2^64).
    :param progress: None, True for a bar, or a function of the finished fraction.
    :raises InvalidInput: naming the key that is wrong.
    :raises FileError: if a file cannot be read.
    :raises Interrupted: after Ctrl-C; of pixels that are solved together `result` has the maps so far.

    Source: Donner et al. 2008, §6; docs/acquire.md.

    >>> import lamina
    >>> import numpy as np
    >>> freckle = np.full((8, 8), 0.02)
    >>> freckle[3:5, 3:5] = 0.06
    >>> photograph = lamina.skin_colors(melanin=freckle).srgb_linear
    >>> found = lamina.acquire({"images": [{"image": photograph, "encoding": "linear", "sensor": "srgb"}]})
    >>> bool(found.maps["melanin"][3, 3] > 2 * found.maps["melanin"][0, 0])
    True
    """
    of_transport = [most_forwards, model_error, robust, start]
    options = {
        "lateral": one_of("lateral", lateral, ("auto", "none", "transport")),
        "most_forwards": number("most_forwards", 120.0 if most_forwards is None else most_forwards, 1.0, 1e6),
        "model_error": number("model_error", 0.0 if model_error is None else model_error, 0.0, 0.5),
        "robust": number("robust", 0.0 if robust is None else robust, 0.0, 1e6),
        "seed": whole("seed", seed, 0, 2**64 - 1),
        "is_of_transport": any(given is not None for given in of_transport),
    }
    if start is not None and not isinstance(start, AcquiredSkin):
        raise refuse("start", "be an AcquiredSkin", type(start).__name__)
    maps = {} if start is None else start.maps
    smoothness = [] if start is None or start.smoothness is None else start.smoothness.tolist()
    with opened("capture", "capture", capture, folder) as (path, text), progress_of(progress, "acquiring") as callback:
        found, handle = _lamina.acquire(path, text, settings_of(changes), options, maps, smoothness, callback)
    interrupted = found.pop("was_interrupted")
    kind = AcquiredSkin if "fixed" in found else AcquiredLeaf
    coords = {"band": np.array(found.pop("bands"))}
    for name in ("notes", "history"):
        if name in found:
            found[name] = tuple(found[name])
    result: AcquiredSkin | AcquiredLeaf = kind(axes=(), coords=coords, _found=handle, **found)
    if interrupted:
        raise interrupted_with(result)
    return result


@dataclass(frozen=True, eq=False, repr=False)
class BandChoice(Result):
    """Bands to photograph skin in, and how well they tell its numbers."""

    wavelengths: Array = quantity("of the best bands", unit="nm", axes=("best",), shared=True)
    score: float = quantity("root mean square of the standard deviations that they leave")
    standard_deviation: dict[str, float] = setting("by number: relative of amounts, of the logit of shares")
    sets: dict[str, dict[str, Any]] = setting("the same of the best, evenly spaced, compared and all bands")
    candidates: Array = quantity("that there were", unit="nm", axes=("candidate",), shared=True)
    reflectance: Array = quantity("of the skins they were chosen for", axes=("skin", "candidate"), shared=True)
    changes: Array = quantity("of it by each number's coordinate, relative", axes=("skin", "candidate", "number"),
                              shared=True)

    def _draw(self, ax: Axes) -> None:
        for i, name in enumerate(self.coords["number"]):
            ax.plot(self.candidates, self.changes[0, :, i], label=str(name))
        for nm in self.wavelengths:
            ax.axvline(float(nm), color="0.8", zorder=0)
        ax.set(xlabel="wavelength [nm], gray: the best bands", ylabel="relative change of the light")
        ax.legend(frameon=False)


def filters(
    count: int = 5,
    *,
    noise: float = 0.005,
    candidates: ArrayLike | None = None,
    widths: ArrayLike = 0.0,
    numbers: Sequence[str] = (
        "melanin", "melanin_blend", "hemoglobin_epidermis", "hemoglobin_dermis", "carotene"),
    population: str | os.PathLike[str] | None = None,
    compare: ArrayLike | None = None,
    seed: int = 0,
    progress: Progress = None,
) -> BandChoice:
    """The bands in which photographs tell most of skin's pigments.

    :param count: how many, in [1, 100].
    :param noise: error of each band, of the light that it reflects, in [1e-6, 1].
    :param candidates: [nm], ascending, in [350, 1000]; 400 to 700 nm by 10 nm.
    :param widths: of bands, full at half of the height [nm], in [0, 200]; a number or one for each.
    :param numbers: of skin that are to be told.
    :param population: "forearms" or a file: what is known before, and 30 skins drawn from it in place
        of five kinds.
    :param compare: bands of the candidates to rate beside the best [nm].
    :param seed: of skins that are drawn, in [0, 2^64).
    :raises InvalidInput: naming what is wrong; FileError; Interrupted.

    Source: Fisher information, Donner et al. 2008, §6.1; docs/acquire.md.

    >>> import lamina
    >>> best = lamina.filters(3, numbers=["melanin", "hemoglobin_dermis"], candidates=range(400, 700, 50))
    >>> best.wavelengths.shape
    (3,)
    """
    nm = doubles("candidates", np.arange(400.0, 701.0, 10.0) if candidates is None else candidates,
                 350.0, 1000.0, unit="nm")
    if nm.ndim != 1 or not (np.diff(nm) > 0.0).all():
        raise InvalidInput("candidates: must be ascending wavelengths in one row [nm]")
    wide = doubles("widths", widths, 0.0, 200.0, unit="nm")
    if wide.shape not in ((), nm.shape):
        raise InvalidInput(f"widths: must be one or {nm.size}, but have the shape {wide.shape}")
    names = name_list("numbers", numbers)
    places = None
    if compare is not None:
        wanted = np.atleast_1d(doubles("compare", compare, 350.0, 1000.0, unit="nm"))
        missing = [w for w in wanted if w not in nm]
        if missing:
            raise InvalidInput(f"compare: must be of the candidates, but one is {missing[0]:g} nm")
        places = [int(np.flatnonzero(nm == w)[0]) for w in wanted]
    with progress_of(progress, "filters") as callback:
        found = _lamina.choose_bands(
            nm.tolist(), np.broadcast_to(wide, nm.shape).tolist(), whole("count", count, 1, 100),
            number("noise", noise, 1e-6, 1.0), names, "" if population is None else path_text("population", population),
            30, whole("seed", seed, 0, 2**64 - 1), places, callback)
    reflectance, by = found.pop("reflectance"), found.pop("changes")
    best = found["best"]
    return BandChoice(
        axes=(), coords={"candidate": nm, "number": np.array(list(numbers))}, wavelengths=best["wavelengths"],
        score=best["score"], standard_deviation=best["standard_deviation"], sets=found, candidates=nm,
        reflectance=reflectance, changes=by)
