# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Files, and dicts that stand for them: with arrays where a file has the path of an image or mesh."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from . import _lamina
from ._input import PathLike, doubles, json_text, name_text, path_text, real_array, refuse_masked
from ._lamina import InvalidInput, WriteError

#: What functions take for a file: its path, or a dict with its keys.
FileLike = Union[str, "os.PathLike[str]", Mapping[str, Any]]

#: Keys whose value is the path of an image: an array (y, x) or (y, x, channel) may stand there.
_IMAGES = ("image", "map", "dark", "parallel", "mask", "light")


def folder_of(save: Callable[[str], object]) -> dict[str, bytes]:
    """The files that something is saved as, by name: what a pickle keeps of it."""
    with tempfile.TemporaryDirectory(prefix="lamina_") as folder:
        save(folder)
        return {path.name: path.read_bytes() for path in sorted(Path(folder).iterdir())}


@dataclass(frozen=True)
class SavedFolder:
    """A folder in memory, which can be saved again."""

    files: dict[str, bytes]

    def save(self, folder: str) -> None:
        """
        :raises WriteError: if it cannot be written; what is there stays.
        """
        place = Path(folder)
        try:
            place.mkdir(parents=True, exist_ok=True)
            for name, content in self.files.items():
                unfinished = place / f".{name}.{os.getpid()}"
                unfinished.write_bytes(content)
                unfinished.replace(place / name)
        except OSError as error:
            raise WriteError(str(error)) from None


class opened:
    """`with opened("scene", "scene", what, folder) as (path, text):` a path, or where a dict would
    lie and its text. Arrays in the dict are files in a folder of their own until the end."""

    def __init__(self, name: str, kind: str, what: object, folder: PathLike | None) -> None:
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._count = 0
        where = None if folder is None else path_text("folder", folder)
        if isinstance(what, Mapping):
            try:
                plain = self._without_arrays(name, {"lamina": kind, "version": 1, **what})
            except RecursionError:
                self.close()
                raise InvalidInput(f"{name}: must not hold lists or dicts in each other without end") from None
            except BaseException:
                self.close()
                raise
            place = os.path.join(where or os.getcwd(), name)
            self._opened: tuple[str, str | None] = place, json_text(name, plain)
            return
        if folder is not None:
            raise InvalidInput(f"folder: is for a {name} that is a dict")
        if isinstance(what, (str, os.PathLike)):
            self._opened = name_text(name, os.fspath(what), "be a path or a dict"), None
            return
        raise InvalidInput(f"{name}: must be a path or a dict, but is {type(what).__name__}")

    def __enter__(self) -> tuple[str, str | None]:
        return self._opened

    def __exit__(self, *exception: object) -> None:
        self.close()

    def close(self) -> None:
        if self._folder is not None:
            self._folder.cleanup()

    def _new_file(self, ending: str) -> str:
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="lamina_")
        self._count += 1
        return os.path.join(self._folder.name, f"array_{self._count}{ending}")

    def _without_arrays(self, where: str, value: object) -> object:
        if isinstance(value, Mapping):
            if "vertices" in value or "faces" in value:
                return self._mesh(where, value)
            result: dict[Any, object] = {}
            for key, item in value.items():
                if key in _IMAGES and isinstance(item, np.ndarray) and item.ndim >= 2:
                    result[key] = self._image(f"{where}.{key}", item, value)
                else:
                    result[key] = self._without_arrays(f"{where}.{key}", item)
            return result
        if isinstance(value, (list, tuple)):
            return [self._without_arrays(f"{where}[{i}]", item) for i, item in enumerate(value)]
        return value

    def _image(self, where: str, array: NDArray[Any], beside: Mapping[Any, Any]) -> str:
        refuse_masked(where, array)
        if array.ndim > 3 or array.dtype.kind not in "fiub" or array.size == 0:
            raise InvalidInput(
                f"{where}: must be an array of numbers (y, x) or (y, x, channel), "
                f"but is of {array.dtype} with the shape {array.shape}")
        pixels = array.astype(np.float32)
        pixels = pixels[..., None] if pixels.ndim == 2 else pixels
        path = self._new_file(".exr")
        _lamina.save_exr(pixels, _channels(pixels.shape[-1], beside), path, {}, "rec709", None)
        return path

    def _mesh(self, where: str, mesh: Mapping[Any, Any]) -> dict[Any, object]:
        """A binary PLY of vertices (n, 3), faces (m, 3 or more), uvs (n, 2), normals (n, 3)."""
        for name in ("vertices", "faces"):
            if name not in mesh:
                raise InvalidInput(f"{where}: must have vertices and faces, but has no {name}")
        columns = [_rows(f"{where}.vertices", mesh["vertices"], 3)]
        names = ["x", "y", "z"]
        count = len(columns[0])
        for name, width, properties in (("normals", 3, ["nx", "ny", "nz"]), ("uvs", 2, ["u", "v"])):
            if mesh.get(name) is not None:
                rows = _rows(f"{where}.{name}", mesh[name], width)
                if len(rows) != count:
                    raise InvalidInput(
                        f"{where}.{name}: must be as many as vertices, {count}, but are {len(rows)}")
                columns.append(rows)
                names += properties
        faces = real_array(f"{where}.faces", mesh["faces"])
        if faces.dtype.kind not in "iu" or faces.ndim != 2 or not 3 <= faces.shape[1] <= 255 or not len(faces):
            raise InvalidInput(
                f"{where}.faces: must be whole numbers (face, corner) with 3 corners or more, "
                f"but are of {faces.dtype} with the shape {faces.shape}")
        if faces.min() < 0 or faces.max() >= count:
            bad = faces[(faces < 0) | (faces >= count)][0]
            raise InvalidInput(f"{where}.faces: must be in [0, {count - 1}], but one is {bad}")
        records = np.empty(len(faces), np.dtype([("n", "u1"), ("v", "<u4", faces.shape[1])]))
        records["n"] = faces.shape[1]
        records["v"] = faces
        header = ["ply", "format binary_little_endian 1.0", f"element vertex {count}"]
        header += [f"property float {name}" for name in names]
        header += [f"element face {len(faces)}", "property list uchar uint vertex_indices", "end_header", ""]
        path = self._new_file(".ply")
        with open(path, "wb") as file:
            file.write("\n".join(header).encode())
            file.write(np.hstack(columns).astype("<f4").tobytes())
            file.write(records.tobytes())
        rest = {k: v for k, v in mesh.items() if k not in ("vertices", "faces", "uvs", "normals")}
        if "file" in rest or "shape" in rest:
            raise InvalidInput(f"{where}: must have vertices, file or shape, but has two of them")
        return {"file": path, **rest}


def _rows(where: str, value: object, width: int) -> NDArray[np.float64]:
    rows = doubles(where, value, -1e9, 1e9)  # type: ignore[arg-type]
    if rows.ndim != 2 or rows.shape[1] != width:
        raise InvalidInput(f"{where}: must have the shape (n, {width}), but has {rows.shape}")
    return rows


def _channels(count: int, beside: Mapping[Any, Any]) -> list[str]:
    """What channels of an array are called: by the wavelengths beside it, if there are any."""
    sensor = beside.get("sensor")
    nm = sensor.get("wavelength_nm") if isinstance(sensor, Mapping) else None
    if isinstance(nm, (list, tuple, np.ndarray)) and len(nm) == count:
        return [f"{float(w):g}nm" for w in nm]
    usual = {1: ["Y"], 3: ["R", "G", "B"], 4: ["R", "G", "B", "A"]}
    return usual.get(count, [f"band {i}" for i in range(count)])


def settings_of(changes: Mapping[str, Any] | None) -> list[str]:
    """Changes by paths, as `--set` of the command takes them."""
    if changes is None:
        return []
    if not isinstance(changes, Mapping):
        raise InvalidInput(f"changes: must be a dict, but is {type(changes).__name__}")
    return [f"{name_text('changes', path)}={json_text(path, value)}" for path, value in changes.items()]
