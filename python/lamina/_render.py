# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Rendering: scenes to pictures, with everything that is known about them."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lamina
from ._input import PathLike, flag, json_text, number, one_of, whole
from ._lamina import InvalidInput
from ._progress import Progress, progress_of
from ._result import Result, quantity, setting
from ._slab import interrupted_with

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FloatImage = NDArray[np.float32]

VIEWS = ("standard", "filmic")


@dataclass(frozen=True, eq=False, repr=False)
class Picture(Result):
    """A rendered picture: linear light with its channels, and how it came about."""

    image: FloatImage = quantity("linear sRGB", axes=("y", "x", "channel"), shared=True)
    pixels: FloatImage = quantity("all channels", axes=("y", "x", "name"), shared=True)
    channels: tuple[str, ...] = setting("names of all channels")
    method: str = setting("of light below surfaces")
    method_chosen_because: str = setting("why, where the scene left it open")
    samples_per_pixel: float = quantity("the mean")
    cpu_seconds: float = quantity("of all threads while rendering", unit="s")
    wall_seconds: float = quantity("that went by", unit="s")
    expected_cpu_seconds: float = quantity("as it seemed before", unit="s")
    is_complete: bool = setting("False after Ctrl-C")
    light_samples: list[dict[str, Any]] = setting("of hierarchy: material, spacing_mm, count, change")
    corrections: list[dict[str, Any]] = setting("where light was corrected: material, walks, change, error_left")
    profiles: list[dict[str, str]] = setting("what profile each material has")
    warnings: list[str] = setting("a line each")
    exposure: float = setting("of the scene's film [stops]")
    view: str = setting("of the scene's film")
    noise: float | None = quantity("of pixels of translucent surfaces, relative", optional=True)

    def layer(self, name: str) -> FloatImage:
        """Channels by the name before their dot, as "albedo", "normal", "depth", "subsurface",
        "specular"; or one channel, as "variance". Axes (y, x, channel), of one channel (y, x).

        :raises InvalidInput: if there are none.
        """
        at = [i for i, c in enumerate(self.channels) if c == name or c.startswith(f"{name}.")]
        if not at:
            names = sorted({c.partition(".")[0] for c in self.channels if len(c) > 1})
            raise InvalidInput(f"name: must be one of {', '.join(names)}, but is {name!r}")
        return self.pixels[..., at[0]] if len(at) == 1 else self.pixels[..., at[0] : at[-1] + 1]

    def srgb(self, *, view: str | None = None, exposure: float | None = None) -> NDArray[np.uint8]:
        """For screens: 8 bit sRGB, axes (y, x, channel).

        :param view: "standard" or "filmic"; that of the scene.
        :param exposure: [stops]; that of the scene.
        """
        seen = self.view if view is None else one_of("view", view, VIEWS)
        stops = self.exposure if exposure is None else number("exposure", exposure, -50.0, 50.0)
        return _lamina.view(self.image, seen, stops)

    def save(self, path: PathLike) -> None:
        """Writes .exr, all channels and linear, or .png, as it looks. Whole or not at all.

        :raises InvalidInput: for another ending.
        :raises WriteError: if it cannot be written.
        """
        name = os.fspath(path)
        if name.endswith(".exr"):
            _lamina.save_image(self.pixels, list(self.channels), name, True)
        elif name.endswith(".png"):
            seen = self.srgb().astype(np.float32) / np.float32(255.0)
            linear = np.where(seen <= 0.04045, seen / 12.92, ((seen + 0.055) / 1.055) ** 2.4)
            _lamina.save_image(linear.astype(np.float32), ["R", "G", "B"], name, False)
        else:
            raise InvalidInput(f"path: must end in .exr or .png, but is {name!r}")

    def _draw(self, ax: Axes) -> None:
        ax.imshow(self.srgb())
        ax.set_ylabel(f"{self.method}, {self.samples_per_pixel:.3g} samples")
        ax.set_xticks([])
        ax.set_yticks([])

    def _repr_png_(self) -> bytes | None:
        import tempfile

        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "picture.png")
            self.save(path)
            with open(path, "rb") as file:
                return file.read()


#: A scene: the path of a file, or a dict with the keys of such a file.
SceneLike = Union[str, "os.PathLike[str]", Mapping[str, Any]]


def file_or_text(name: str, kind: str, what: object, folder: PathLike | None) -> tuple[str, str | None]:
    """A path, or where a dict would lie and its text."""
    if isinstance(what, Mapping):
        place = os.path.join(os.getcwd() if folder is None else os.fspath(folder), name)
        return place, json_text(name, {"lamina": kind, "version": 1, **what})
    if folder is not None:
        raise InvalidInput(f"folder: is for a {name} that is a dict")
    if isinstance(what, (str, os.PathLike)):
        path = os.fspath(what)
        if isinstance(path, str) and "\0" not in path:
            return path, None
    raise InvalidInput(f"{name}: must be a path or a dict, but is {type(what).__name__}")


def settings_of(changes: Mapping[str, Any] | None) -> list[str]:
    """Changes by paths, as `--set` of the command takes them."""
    if changes is None:
        return []
    if not isinstance(changes, Mapping):
        raise InvalidInput(f"changes: must be a dict, but is {type(changes).__name__}")
    return [f"{path}={json_text(str(path), value)}" for path, value in changes.items()]


def render(
    scene: SceneLike,
    *,
    folder: PathLike | None = None,
    changes: Mapping[str, Any] | None = None,
    width: int | None = None,
    height: int | None = None,
    samples: int | None = None,
    noise: float | None = None,
    method: str | None = None,
    correct: bool | None = None,
    profile: str | None = None,
    single_scattering: str | None = None,
    bounces: int | None = None,
    exposure: float | None = None,
    seed: int | None = None,
    denoise: bool = False,
    cache: PathLike | None = None,
    progress: Progress = None,
) -> Picture:
    """Renders a scene.

    What is None is as the scene says. The picture depends on the scene and the seed, not on threads.

    :param scene: the path of a scene file, or a dict with its keys; docs/scene.md.
    :param folder: where paths in a dict begin; the current folder.
    :param changes: values by their paths, as {"lights[0].scale": 2, "film.exposure": 1}.
    :param width: [pixels], in [1, 16384]; alone it keeps the proportions.
    :param height: [pixels], in [1, 16384].
    :param samples: per pixel, in [1, 2^24].
    :param noise: ends where the standard error is below this fraction of the brightness, in [0, 1].
    :param method: of light below surfaces: "auto", "probe", "hierarchy", "texture_space", "random_walk" …
    :param correct: corrects the light of hierarchy and texture_space by random walks.
    :param profile: "radiative_transfer", "diffusion" or "dipole".
    :param single_scattering: "none", "straight" or "refracted".
    :param bounces: of light between surfaces, in [0, 1000].
    :param exposure: [stops], in [-50, 50].
    :param seed: of everything random, in [0, 2^64).
    :param denoise: averages over what looks alike within the noise; for viewing.
    :param cache: a file that keeps light below surfaces for other cameras.
    :param progress: None, True for a bar, or a function of the finished fraction.
    :raises InvalidInput: naming the key of the scene that is wrong, with the command's message.
    :raises FileError: if a file cannot be read; WriteError if the cache cannot be written.
    :raises Interrupted: after Ctrl-C; `result` is the picture so far, once every pixel has a sample.

    >>> import lamina
    >>> ball = {
    ...     "camera": {"position": [0, 0, 40], "look_at": [0, 0, 0], "horizontal_fov": 35},
    ...     "film": {"width": 16, "height": 16},
    ...     "materials": {"jade": {"subsurface": "jade"}},
    ...     "meshes": [{"shape": "sphere", "material": "jade"}],
    ...     "lights": [{"type": "environment", "radiance": 1}], "mm_per_unit": 10}
    >>> lamina.render(ball, samples=1).image.shape
    (16, 16, 3)
    """
    path, text = file_or_text("scene", "scene", scene, folder)
    asked: dict[str, Any] = {}

    def ask(name: str, value: object) -> None:
        if value is not None:
            asked[name] = value

    ask("width", None if width is None else whole("width", width, 1, 16384))
    ask("height", None if height is None else whole("height", height, 1, 16384))
    ask("samples", None if samples is None else whole("samples", samples, 1, 1 << 24))
    ask("noise", None if noise is None else number("noise", noise, 0.0, 1.0))
    ask("method", None if method is None else one_of("method", method, ("auto", *_lamina.method_names())))
    ask("correct", None if correct is None else flag("correct", correct))
    ask("profile", None if profile is None else one_of(
        "profile", profile, ("radiative_transfer", "diffusion", "dipole")))
    ask("single_scattering", None if single_scattering is None else one_of(
        "single_scattering", single_scattering, ("none", "straight", "refracted")))
    ask("bounces", None if bounces is None else whole("bounces", bounces, 0, 1000))
    ask("exposure", None if exposure is None else number("exposure", exposure, -50.0, 50.0))
    ask("seed", None if seed is None else whole("seed", seed, 0, 2**64 - 1))
    file = "" if cache is None else os.fspath(cache)
    is_denoised = flag("denoise", denoise)
    with progress_of(progress, "rendering") as callback:
        found = _lamina.render(path, text, settings_of(changes), asked, file, is_denoised, callback)
    interrupted = found.pop("was_interrupted")
    pixels = found["pixels"]
    channels = found["channels"] = tuple(found["channels"])
    first = channels.index("R")
    result = Picture(
        axes=(),
        coords={"channel": np.array(["R", "G", "B"]), "name": np.array(channels)},
        image=pixels[..., first : first + 3],
        **found,
    )
    if interrupted:
        raise interrupted_with(result)
    return result


def load_image(path: PathLike, *, encoding: str = "srgb") -> tuple[FloatImage, tuple[str, ...]]:
    """Reads EXR, PNG, JPEG, TIFF, Radiance HDR, ENVI or camera raw: linear light, axes (y, x, channel), and its channels.

    :param encoding: of integers: "srgb", colors, which become linear; "linear", quantities.
    :raises FileError: if it cannot be read as an image.
    """
    of = one_of("encoding", encoding, ("srgb", "linear"))
    pixels, channels = _lamina.load_image(os.fspath(path), of)
    return pixels, tuple(channels)


def save_image(path: PathLike, image: ArrayLike, *, channels: Sequence[str] = ("R", "G", "B")) -> None:
    """Writes linear light, axes (y, x, channel), as .exr, all of it, or as .png, 8 bit sRGB.

    :raises InvalidInput: for another ending, or another number of channels than names.
    :raises WriteError: if it cannot be written.
    """
    name = os.fspath(path)
    if not name.endswith((".exr", ".png")):
        raise InvalidInput(f"path: must end in .exr or .png, but is {name!r}")
    pixels = np.asarray(image)
    if pixels.dtype.kind not in "fiu":
        raise InvalidInput(f"image: must be numbers, but is an array of {pixels.dtype}")
    _lamina.save_image(pixels.astype(np.float32, copy=False), list(channels), name, name.endswith(".exr"))
