# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Scenes that stay, and are rendered again as they change."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _lamina
from ._files import FileLike, opened, settings_of
from ._input import PathLike, one_of, refuse, whole
from ._progress import Progress, progress_of


class Session:
    """A scene that stays, and is rendered again as it changes, keeping what a change leaves valid.

    It renders in the background, first small, then as the scene asks. Final pictures are those of render().

    :param scene: the path of a scene file, or a dict with its keys, as render() takes them.
    :param folder: where paths in a dict begin; the current folder.
    :param changes: values by their paths, as {"lights[0].scale": 2}.
    :raises InvalidInput: naming the key of the scene that is wrong.
    :raises FileError: if a file cannot be read.

    >>> import lamina
    >>> ball = {
    ...     "camera": {"position": [0, 0, 40], "look_at": [0, 0, 0], "horizontal_fov": 35},
    ...     "film": {"width": 16, "height": 16}, "render": {"samples_per_pixel": 1},
    ...     "materials": {"wall": {"diffuse": 0.5}},
    ...     "meshes": [{"shape": "sphere", "material": "wall"}],
    ...     "lights": [{"type": "environment", "radiance": 1}], "mm_per_unit": 10}
    >>> with lamina.Session(ball) as session:
    ...     session.set("materials.wall.diffuse", 0.2)
    ...     session.image().shape
    (16, 16, 3)
    """

    def __init__(
        self, scene: FileLike, *, folder: PathLike | None = None, changes: Mapping[str, Any] | None = None
    ) -> None:
        self._files = ExitStack()
        try:
            path, text = self._files.enter_context(opened("scene", "scene", scene, folder))
            self._session = _lamina.open_session(path, text, settings_of(changes))
        except BaseException:
            self._files.close()
            raise

    def set(self, path: str | Mapping[str, Any], value: Any = None) -> None:
        """Changes a value by its path, as "materials.skin.coat.roughness", or several of a dict at once. Files
        that have changed are read again.

        :param value: None removes the key.
        :raises InvalidInput: naming what is wrong; the scene is then as before.
        """
        self._session.set(settings_of(path if isinstance(path, Mapping) else {path: value}))

    def reload(self) -> None:
        """Reads files again that have changed.

        :raises InvalidInput: naming what is wrong; the scene is then as before.
        """
        self._session.set([])

    def region(self, region: Sequence[int] | None) -> None:
        """Renders x, y, width, height [pixels] alone; None: all of the film.

        :raises InvalidInput: if it does not lie on the film.
        """
        if region is None:
            self._session.set_region(None)
            return
        if not isinstance(region, (list, tuple)) or len(region) != 4:
            raise refuse("region", "be x, y, width, height", region)
        x, y, width, height = (whole(f"region[{i}]", value, 0, 16384) for i, value in enumerate(region))
        self._session.set_region((x, y, width, height))

    def image(self, wait: str = "final", *, progress: Progress = None) -> NDArray[np.float32]:
        """Colors of the scene as it is, linear sRGB, axes (y, x, channel).

        :param wait: "final", with all samples; "any", the first picture, which may be smaller.
        :raises InvalidInput: why the scene cannot be rendered.
        :raises Interrupted: after Ctrl-C.
        """
        found = self.picture(wait, progress=progress)
        first = found["channels"].index("R")
        pixels: NDArray[np.float32] = found["pixels"][..., first : first + 3]
        return pixels

    def picture(self, wait: str = "final", *, progress: Progress = None) -> dict[str, Any]:
        """The same with all that is known of it: pixels, channels, change, fraction, samples_per_pixel,
        seconds since the change, is_first_look, is_final.

        :param wait: as of image().
        :raises InvalidInput: why the scene cannot be rendered.
        :raises Interrupted: after Ctrl-C.
        """
        of = one_of("wait", wait, ("final", "any"))
        with progress_of(progress, "rendering") as callback:
            return self._session.picture(of == "final", callback)

    def close(self) -> None:
        """Ends the work, and forgets the scene."""
        self._session.close()
        self._files.close()

    def __enter__(self) -> Session:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
