# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Rendering: scenes to pictures, with everything that is known about them."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lamina
from ._files import FileLike, opened, settings_of
from ._input import (
    PathLike, doubles, flag, name_list, name_text, number, one_of, path_text, real_array, refuse, shown, whole,
)
from ._lamina import InvalidInput, __version__
from ._progress import Progress, interrupted_with, progress_of
from ._result import Result, quantity, setting

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FloatImage = NDArray[np.float32]

VIEWS = ("standard", "filmic", "agx")
COLOR_SPACES = ("rec709", "acescg")


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
    corrections: list[dict[str, Any]] = setting("where light was corrected: material, walks, change, error_left, share of the walks that were wanted")
    profiles: list[dict[str, str]] = setting("what profile each material has")
    warnings: list[str] = setting("a line each")
    exposure: float = setting("of the scene's film [stops]")
    view: str = setting("of the scene's film")
    frame: tuple[int, int, int, int] | None = setting("x, y of a region, and width, height of all the picture")
    notes: dict[str, str] = setting("what an EXR of it says of itself, as attributes")
    noise: float | None = quantity("of pixels of translucent surfaces, relative: the median", optional=True)
    noise_rms: float | None = quantity("of the same: root mean square, outliers included", optional=True)

    def layer(self, name: str) -> FloatImage:
        """Channels by the name before their dot, as "albedo", "normal", "depth", "subsurface",
        "specular"; or one channel, as "variance". Axes (y, x, channel), of one channel (y, x).

        :raises InvalidInput: if there are none.
        """
        at = [i for i, c in enumerate(self.channels) if c == name or c.startswith(f"{name}.")]
        if not at:
            names = sorted({c.partition(".")[0] for c in self.channels if len(c) > 1})
            raise InvalidInput(f"name: must be one of {', '.join(names)}, but is {shown(name)}")
        return self.pixels[..., at[0]] if len(at) == 1 else self.pixels[..., at[0] : at[-1] + 1]

    def srgb(
        self,
        *,
        view: str | None = None,
        exposure: float | None = None,
        ocio: PathLike | None = None,
        display: str | None = None,
    ) -> NDArray[np.uint8]:
        """For screens: 8 bit sRGB, or the code values of another display; axes (y, x, channel).

        :param view: "standard", "filmic" or "agx", or a view of the config; that of the scene.
        :param exposure: [stops]; that of the scene.
        :param ocio: config of OpenColorIO; where lamina does not have the view, or with a display,
            that of the environment variable OCIO.
        :param display: of the config; the one that it names first.
        :raises InvalidInput: naming the views or displays that there are.
        :raises FileError: if the config cannot be read.
        """
        stops = self.exposure if exposure is None else number("exposure", exposure, -50.0, 50.0)
        config = None if ocio is None else path_text("ocio", ocio)
        if config is None and (display is not None or (view is not None and view not in VIEWS)):
            config = os.environ.get("OCIO") or None
        if config is None:
            if display is not None:
                raise InvalidInput("display: goes with a config, by ocio or the environment variable OCIO")
            return _lamina.view(self.image, self.view if view is None else one_of("view", view, VIEWS), stops)
        shown_on = "" if display is None else name_text("display", display)
        seen = "" if view is None else name_text("view", view)
        return _lamina.ocio_view(self.image, config, shown_on, seen, stops)

    def save(
        self,
        path: PathLike,
        *,
        color_space: str = "rec709",
        view: str | None = None,
        exposure: float | None = None,
        ocio: PathLike | None = None,
        display: str | None = None,
    ) -> None:
        """Writes .exr, all channels and linear, or .png, as it looks. Whole or not at all.

        :param color_space: of the EXR: "rec709", or "acescg", the primaries AP1 of ACES.
        :param view: of the PNG, as of `srgb`; so are exposure, ocio and display.
        :raises InvalidInput: for another ending, or as `srgb`.
        :raises WriteError: if it cannot be written.
        """
        name = path_text("path", path)
        space = one_of("color_space", color_space, COLOR_SPACES)
        if name.endswith(".exr"):
            _lamina.save_exr(self.pixels, list(self.channels), name, self.notes, space, self.frame)
        elif name.endswith(".png"):
            codes = self.srgb(view=view, exposure=exposure, ocio=ocio, display=display)
            seen = codes.astype(np.float32) / np.float32(255.0)
            linear = np.where(seen <= 0.04045, seen / 12.92, ((seen + 0.055) / 1.055) ** 2.4)
            _lamina.save_png(linear.astype(np.float32), ["R", "G", "B"], name)
        else:
            raise InvalidInput(f"path: must end in .exr or .png, but is {shown(name)}")

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


def render(
    scene: FileLike,
    *,
    folder: PathLike | None = None,
    changes: Mapping[str, Any] | None = None,
    width: int | None = None,
    height: int | None = None,
    samples: int | None = None,
    noise: float | None = None,
    clamp: float | None = None,
    region: Sequence[int] | None = None,
    quality: str | None = None,
    method: str | None = None,
    correct: bool | None = None,
    profile: str | None = None,
    single_scattering: str | None = None,
    bounces: int | None = None,
    exposure: float | None = None,
    seed: int | None = None,
    denoise: bool = False,
    alpha: bool | None = None,
    cryptomatte: bool = False,
    light_layers: bool = False,
    cache: PathLike | None = None,
    foreign_light: bool = False,
    progress: Progress = None,
) -> Picture:
    """Renders a scene.

    What is None is as the scene says. The picture depends on the scene and the seed, not on threads.

    :param scene: the path of a scene file, or a dict with its keys; docs/scene.md. In a dict a mesh
        may be arrays: {"vertices": (n, 3), "faces": (m, 3 or more), "uvs": (n, 2), "normals": (n, 3)};
        and arrays (y, x) or (y, x, channel) may stand where maps and images have a path.
    :param folder: where paths in a dict begin; the current folder.
    :param changes: values by their paths, as {"lights[0].scale": 2, "film.exposure": 1}.
    :param width: [pixels], in [1, 16384]; alone it keeps the proportions.
    :param height: [pixels], in [1, 16384].
    :param samples: per pixel, in [1, 2^24].
    :param noise: ends where the standard error is below this fraction of the brightness, in [0, 1].
    :param clamp: cuts the light of single samples to so much per channel, against fireflies, in
        [0, 10^6]; 0: not at all. The picture lacks what is cut.
    :param region: x, y, width, height [pixels] of what is rendered alone, as in the whole picture.
    :param quality: "preview", a first look; "final", with little error and no noise below surfaces;
        "reference", with no error but noise. Chooses method, correct and samples in place of the scene's;
        those that are given stand in place of its choice.
    :param method: of light below surfaces: "auto", "probe", "hierarchy", "texture_space", "random_walk" …
    :param correct: corrects the light of hierarchy and texture_space by random walks.
    :param profile: "radiative_transfer", "diffusion" or "dipole".
    :param single_scattering: "none", "straight" or "refracted".
    :param bounces: of light between surfaces, in [0, 1000].
    :param exposure: [stops], in [-50, 50].
    :param seed: of everything random, in [0, 2^64).
    :param denoise: averages over what looks alike within the noise; for viewing.
    :param alpha: channel "A": how much of a pixel surfaces cover; the sky lights but is not seen.
    :param cryptomatte: mattes of objects and materials, as channels and notes of Cryptomatte.
    :param light_layers: layers "light.NAME" of each light, whose sum is the picture. Not with noise,
        denoise or cache.
    :param cache: a file that keeps light below surfaces for other cameras.
    :param foreign_light: takes the light of the cache as it is, whoever made it, and leaves the file alone.
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
    >>> lamina.render(ball, samples=1, method="random_walk").image.shape
    (16, 16, 3)
    """
    asked: dict[str, Any] = {}

    def ask(name: str, value: object) -> None:
        if value is not None:
            asked[name] = value

    ask("width", None if width is None else whole("width", width, 1, 16384))
    ask("height", None if height is None else whole("height", height, 1, 16384))
    ask("samples", None if samples is None else whole("samples", samples, 1, 1 << 24))
    ask("noise", None if noise is None else number("noise", noise, 0.0, 1.0))
    ask("clamp", None if clamp is None else number("clamp", clamp, 0.0, 1e6))
    if region is not None:
        if not isinstance(region, (list, tuple)) or len(region) != 4:
            raise refuse("region", "be x, y, width, height", region)
        ask("region", [whole(f"region[{i}]", value, 0, 16384) for i, value in enumerate(region)])
    ask("quality", None if quality is None else one_of("quality", quality, ("preview", "final", "reference")))
    ask("method", None if method is None else one_of("method", method, ("auto", *_lamina.method_names())))
    ask("correct", None if correct is None else flag("correct", correct))
    ask("profile", None if profile is None else one_of(
        "profile", profile, ("radiative_transfer", "diffusion", "dipole")))
    ask("single_scattering", None if single_scattering is None else one_of(
        "single_scattering", single_scattering, ("none", "straight", "refracted")))
    ask("bounces", None if bounces is None else whole("bounces", bounces, 0, 1000))
    ask("exposure", None if exposure is None else number("exposure", exposure, -50.0, 50.0))
    ask("seed", None if seed is None else whole("seed", seed, 0, 2**64 - 1))
    ask("alpha", None if alpha is None else flag("alpha", alpha))
    file = "" if cache is None else path_text("cache", cache)
    is_foreign = flag("foreign_light", foreign_light)
    if is_foreign and not file:
        raise InvalidInput("foreign_light: goes with cache, which is not given")
    is_denoised = flag("denoise", denoise)
    has_mattes, has_light_layers = flag("cryptomatte", cryptomatte), flag("light_layers", light_layers)
    if is_denoised and has_light_layers:
        raise InvalidInput("denoise: does not go with light_layers")
    with opened("scene", "scene", scene, folder) as (path, text), progress_of(progress, "rendering") as callback:
        found = _lamina.render(path, text, settings_of(changes), asked, file, is_foreign, is_denoised, has_mattes, has_light_layers, callback)
    interrupted = found.pop("was_interrupted")
    pixels = found["pixels"]
    channels = found["channels"] = tuple(found["channels"])
    found["notes"]["lamina/version"] = __version__
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


def load_image(
    path: PathLike,
    *,
    encoding: str = "srgb",
    bands: ArrayLike | None = None,
    widths: ArrayLike = 0.0,
    shape: str | None = None,
    rectangle: Sequence[int] | None = None,
) -> tuple[FloatImage, tuple[str, ...]]:
    """Reads EXR, PNG, JPEG, TIFF, Radiance HDR, ENVI or camera raw: linear light, and its channels.

    :param encoding: "srgb", colors as the file says (ICC profile, chunks of PNG, Exif, chromaticities of
        EXR), of integers sRGB where it says nothing; "linear", quantities, as they are; or an encoding of
        colors by name, whatever the file says: "srgb_texture", "lin_rec709", "g22_rec709", "g18_rec709",
        "rec709_display", "acescg", "g22_ap1", "adobergb", "lin_adobergb", "srgb_displayp3",
        "lin_displayp3". Colors become linear Rec.709. A picture that notes another orientation is turned.
    :param bands: of ENVI files: wavelengths [nm] to read in place of all bands.
    :param widths: of these, full [nm], one or one for each.
    :param shape: how bands of the file make one: "nearest"; with widths "box" or "gaussian".
    :param rectangle: of ENVI files: x, y, width, height, in place of the whole image.
    :raises InvalidInput: naming what is wrong.
    :raises FileError: if it cannot be read as an image.
    """
    of = one_of("encoding", encoding, (
        "srgb", "linear", "srgb_texture", "lin_rec709", "g22_rec709", "g18_rec709", "rec709_display", "acescg",
        "g22_ap1", "adobergb", "lin_adobergb", "srgb_displayp3", "lin_displayp3"))
    if bands is None and rectangle is None:
        pixels, channels = _lamina.load_image(path_text("path", path), of)
        return pixels, tuple(channels)
    nm = np.zeros(0) if bands is None else np.atleast_1d(doubles("bands", bands, 100.0, 1e5, unit="nm"))
    wide = doubles("widths", widths, 0.0, 1e5, unit="nm")
    if nm.ndim != 1 or wide.shape not in ((), nm.shape):
        raise InvalidInput(f"widths: must be one or {nm.size}, but have the shape {wide.shape}")
    kind = one_of("shape", shape or ("box" if wide.any() else "nearest"), ("nearest", "box", "gaussian"))
    if (kind == "nearest") == bool(wide.any()) or (kind != "nearest" and not wide.all()):
        raise InvalidInput(f"widths: must be > 0 of box and gaussian, and 0 of nearest, but the shape is {kind}")
    corners = None
    if rectangle is not None:
        if not isinstance(rectangle, (list, tuple)) or len(rectangle) != 4:
            raise refuse("rectangle", "be x, y, width, height", rectangle)
        corners = [whole(f"rectangle[{i}]", value, 0, 2**31 - 1) for i, value in enumerate(rectangle)]
    pixels, channels = _lamina.load_envi(
        path_text("path", path), nm.tolist(), np.broadcast_to(wide, nm.shape).tolist(), kind, corners)
    return pixels, tuple(channels)


def save_image(
    path: PathLike,
    image: ArrayLike,
    *,
    channels: Sequence[str] = ("R", "G", "B"),
    color_space: str = "rec709",
) -> None:
    """Writes linear light, axes (y, x, channel), as .exr, all of it, or as .png, 8 bit sRGB.

    :param color_space: that colors, linear Rec.709, are turned into in an EXR: "rec709", or "acescg".
    :raises InvalidInput: for another ending, or another number of channels than names.
    :raises WriteError: if it cannot be written.
    """
    name = path_text("path", path)
    if not name.endswith((".exr", ".png")):
        raise InvalidInput(f"path: must end in .exr or .png, but is {shown(name)}")
    pixels = real_array("image", image)
    names = name_list("channels", channels)
    numbers = np.require(pixels, np.float32, "C")
    space = one_of("color_space", color_space, COLOR_SPACES)
    if name.endswith(".exr"):
        _lamina.save_exr(numbers, names, name, {}, space, None)
    else:
        _lamina.save_png(numbers, names, name)


@dataclass(frozen=True, eq=False, repr=False)
class ImageComparison(Result):
    """Whether two pictures show the same scene, within their noise."""

    agrees: bool = setting("neither a pixel nor the mean of the picture differs")
    report: str = setting("one line: what agrees or differs, and by how much")
    smallest_p_value: float = quantity("of any pixel and channel")
    threshold: float = quantity("below it some pixel differs")
    differing: int = quantity("pixels and channels below the threshold")
    bias_z: float = quantity("difference of the means over its standard error")
    mean_square_z: float = quantity("1 if the variances are right and nothing differs")
    rmse: float = quantity("root mean square difference")
    p_values: FloatImage = quantity("the smallest of a pixel's channels", axes=("y", "x"), shared=True)

    def _draw(self, ax: Axes) -> None:
        shown = ax.imshow(np.log10(np.maximum(self.p_values, 1e-12)), cmap="magma", vmax=0.0)
        ax.figure.colorbar(shown, ax=ax, label="lg p")
        ax.set_xlabel(self.report, wrap=True)


def compare_pictures(
    first: Picture | tuple[ArrayLike, ArrayLike],
    second: Picture | tuple[ArrayLike, ArrayLike],
    *,
    significance: float = 1e-3,
) -> ImageComparison:
    """Whether two pictures show the same scene: a z-test for each pixel, and one for the mean.

    :param first: a `Picture`, or its mean and the variance of that, arrays (y, x) or (y, x, channel).
    :param second: the same.
    :param significance: probability to tell apart what is the same, in (0, 1).
    :raises InvalidInput: if sizes differ, or a variance is negative.

    >>> import lamina
    >>> import numpy as np
    >>> noise = np.random.default_rng(1).normal(0.5, 0.1, (2, 32, 32, 3))
    >>> lamina.compare_pictures((noise[0], np.full((32, 32, 3), 0.01)), (noise[1], np.full((32, 32, 3), 0.01))).agrees
    True
    """
    a, a_variance = _mean_and_variance("first", first)
    b, b_variance = _mean_and_variance("second", second)
    if a.shape != b.shape:
        raise InvalidInput(f"first, second: must be of one size, but are {a.shape} and {b.shape}")
    found = _lamina.compare_images(a, a_variance, b, b_variance, number("significance", significance, 0.0, 1.0, closed="()"))
    return ImageComparison(axes=(), coords={}, **found)


def _mean_and_variance(name: str, picture: object) -> tuple[FloatImage, FloatImage]:
    if isinstance(picture, Picture):  # its variance is that of luminance
        weights = np.array([0.2126, 0.7152, 0.0722], np.float32)
        return (picture.image @ weights)[..., None], picture.layer("variance")[..., None]
    if not isinstance(picture, (list, tuple)) or len(picture) != 2:
        raise refuse(name, "be a Picture, or a mean and its variance", type(picture).__name__)
    mean, variance = doubles(f"{name} mean", picture[0]), doubles(f"{name} variance", picture[1], 0.0, 1e30)
    if mean.ndim not in (2, 3) or mean.shape != variance.shape:
        raise InvalidInput(
            f"{name}: mean and variance must be of one size (y, x, channel), but are {mean.shape} and {variance.shape}")
    if mean.ndim == 2:
        mean, variance = mean[..., None], variance[..., None]
    return mean.astype(np.float32), variance.astype(np.float32)
