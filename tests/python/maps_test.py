# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Maps of skin from Python: made, edited, saved as the command does; arrays where files have paths."""

from __future__ import annotations

import os
import pickle
import subprocess
from pathlib import Path
from typing import Any

import lamina
import numpy as np
import pytest

SOURCE = Path(os.environ.get("LAMINA_SOURCE", Path(__file__).parents[2]))
COMMAND = Path(lamina.__file__).resolve().parents[2] / "lamina"

SPOTTED = {"width": 24, "height": 16, "mm_per_pixel": 0.2, "seed": 3, "skin": {"melanin": 0.01},
           "features": [{"freckles": {"density": 9}}, {"unevenness": {}}]}


@pytest.fixture(scope="module")
def spotted() -> lamina.SkinMaps:
    return lamina.maps(SPOTTED)


def test_edits_are_those_of_the_command(spotted: lamina.SkinMaps, tmp_path: Path) -> None:
    if not COMMAND.exists():
        pytest.skip(f"there is no command at {COMMAND}")
    mask = np.zeros((16, 24), np.float32)
    mask[4:12, 6:18] = 0.7
    lamina.save_image(tmp_path / "mask.exr", mask[..., None], channels=["Y"])
    spotted.save(tmp_path / "maps")
    steps = ["--tan", ".5", "--freckles", ".3", "--size", "2", "--blush", ".4", "--mask", str(tmp_path / "mask.exr"),
             "--scale", "hemoglobin_dermis=1.2", "--strength", ".5"]
    subprocess.run([str(COMMAND), "edit", str(tmp_path / "maps"), "-o", str(tmp_path / "edited"), "--no-preview", *steps],
                   check=True, capture_output=True)
    printed = lamina.load_maps(tmp_path / "edited")
    found = (lamina.load_maps(tmp_path / "maps").edit("tan", 0.5).edit("freckles", 0.3, size=2.0)
             .edit("blush", 0.4, mask=mask).edit("scale", 1.2, number="hemoglobin_dermis", strength=0.5))
    assert found.maps.keys() == printed.maps.keys()
    for name, values in found.maps.items():
        assert (values == printed.maps[name]).all(), name


def test_a_tan_is_more_melanin(spotted: lamina.SkinMaps) -> None:
    tanned = lamina.edit(spotted, "tan", 0.5)
    assert tanned.maps["melanin"] == pytest.approx(1.5 * spotted.maps["melanin"], rel=1e-5)
    assert tanned.preview(longest_side=16).mean() < spotted.preview(longest_side=16).mean()


def test_maps_come_from_arrays_and_files_alike(spotted: lamina.SkinMaps, tmp_path: Path) -> None:
    by_dict = lamina.edit(spotted.arguments(), "set", 0.03, number="carotene")
    by_maps = lamina.edit(spotted, "set", 0.03, number="carotene")
    assert by_dict.numbers["carotene"] == by_maps.numbers["carotene"] == 0.03
    by_dict.save(tmp_path)
    again = lamina.load_maps(tmp_path)
    assert again.maps.keys() == spotted.maps.keys() and again.mm_per_pixel == pytest.approx(0.2)
    assert (again.maps["melanin"] == spotted.maps["melanin"]).all()
    copied = pickle.loads(pickle.dumps(spotted))
    assert (copied.edit("tan", 0.5).maps["melanin"] == spotted.edit("tan", 0.5).maps["melanin"]).all()


def test_maps_are_lit_with_their_inks(spotted: lamina.SkinMaps) -> None:
    plain = lamina.patch(spotted, wavelengths=[550])
    by_arrays = lamina.patch(**spotted.arguments(), wavelengths=[550])
    assert (plain.light == by_arrays.light).all()
    lips = spotted.edit("lipstick", 0.6, mask=np.ones((16, 24)))
    assert any(name.startswith("ink_") for name in lips.maps)
    assert lamina.patch(lips, wavelengths=[550]).light.mean() < 0.9 * plain.light.mean()


def test_persons_have_means_of_their_own(spotted: lamina.SkinMaps) -> None:
    several = lamina.persons(spotted, 3, seed=4)
    means = [float(person.maps["melanin"].mean()) for person in several]
    assert len(set(means)) == 3
    # What differs from place to place stays: ratios of melanin, up to the offset of its logarithm.
    contrast = np.log(spotted.maps["melanin"].max() / spotted.maps["melanin"].min())
    for person in several:
        assert np.log(person.maps["melanin"].max() / person.maps["melanin"].min()) == pytest.approx(contrast, rel=0.25)


WRONG: list[tuple[tuple[Any, ...], dict[str, Any], str]] = [
    (("tan", "much"), {}, "amount: must be in"),
    (("tam", 0.3), {}, 'did you mean "tan"'),
    (("tan", 0.3), {"number": "melanin"}, "number: must be left out of tan"),
    (("scale", 0.3), {}, "number: must be given of scale"),
    (("scale", 0.3), {"number": "melanine"}, "melanin"),
    (("tan", 0.3), {"size": 2.0}, "size: is for freckles"),
    (("blush", 0.3), {}, "mask: must be given of blush"),
    (("tan", 0.3), {"mask": np.full((16, 24), 2.0)}, "mask[0, 0]: must be in [0, 1], but is 2"),
    (("tan", 0.3), {"mask": np.ones(3)}, "mask: must be an array (y, x)"),
    (("tan", 0.3), {"mask": np.ones((4, 100))}, "mask"),
    (("tan", 0.3), {"strength": -1}, "strength: must be in [0, 1], but is -1"),
    (("transfer", np.ones(3)), {"number": "melanin"}, "amount: must be an array (y, x)"),
    (("homogenize", 3), {}, "amount: must be maps"),
]


@pytest.mark.parametrize(("what", "where", "message"), WRONG)
def test_wrong_edits_are_refused(
    spotted: lamina.SkinMaps, what: tuple[Any, ...], where: dict[str, Any], message: str
) -> None:
    with pytest.raises(lamina.InvalidInput) as refused:
        lamina.edit(spotted, *what, **where)
    assert message in str(refused.value)


def test_wrong_maps_are_refused(tmp_path: Path) -> None:
    for source, message in (({"melanin": [0.1, 0.2]}, "must be a number or a map"), ({"melamin": 0.1}, "melanin"), (3, "maps")):
        with pytest.raises(lamina.InvalidInput, match=message):
            lamina.edit(source, "tan", 0.3)  # type: ignore[arg-type]
    with pytest.raises(lamina.FileError):
        lamina.load_maps(tmp_path)
    with pytest.raises(lamina.InvalidInput, match="fetures"):
        lamina.maps({**SPOTTED, "fetures": []})


# Meshes and images as arrays.

SQUARE = {"vertices": np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]),
          "uvs": np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]), "faces": np.array([[0, 1, 2, 3]])}


def scene_of(mesh: dict[str, Any], diffuse: Any) -> dict[str, Any]:
    return {
        "camera": {"position": [0, 0, 10], "look_at": [0, 0, 0], "horizontal_fov": 10}, "film": {"width": 12, "height": 12},
        "materials": {"wall": {"diffuse": diffuse}}, "meshes": [{**mesh, "material": "wall"}],
        "lights": [{"type": "environment", "radiance": 1}], "mm_per_unit": 10,
    }  # fmt: skip


def test_a_mesh_of_arrays_is_the_mesh_of_a_file(tmp_path: Path) -> None:
    (tmp_path / "square.obj").write_text("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n")
    by_file = lamina.render(scene_of({"file": "square.obj"}, [0.2, 0.4, 0.6]), folder=tmp_path, samples=2)
    by_arrays = lamina.render(scene_of(SQUARE, [0.2, 0.4, 0.6]), samples=2)
    assert (by_file.pixels == by_arrays.pixels).all()
    triangles = {**SQUARE, "faces": np.array([[0, 1, 2], [0, 2, 3]], np.uint8)}
    assert lamina.render(scene_of(triangles, [0.2, 0.4, 0.6]), samples=2).image == pytest.approx(by_file.image, rel=0.1)


def test_an_array_may_stand_for_a_texture() -> None:
    texture = np.zeros((2, 2, 3), np.float32)
    texture[0, 0] = [0.8, 0.1, 0.1]  # above on the left
    picture = lamina.render(scene_of(SQUARE, {"map": texture, "encoding": "linear"}), samples=8).image
    assert picture[1, 1, 0] > 0.5 and picture[-2, -2].max() < 0.05


@pytest.mark.parametrize(("change", "message"), [
    ({"faces": np.array([[0, 1, 9]])}, "faces: must be in [0, 3], but one is 9"),
    ({"faces": np.array([[0.0, 1, 2]])}, "faces: must be whole numbers"),
    ({"faces": np.array([0, 1, 2])}, "with the shape (3,)"),
    ({"faces": [[0, 1, 2], [0, 1]]}, "faces: must be numbers"),
    ({"vertices": np.zeros((4, 2))}, "vertices: must have the shape (n, 3)"),
    ({"vertices": np.full((4, 3), np.nan)}, "vertices[0, 0]: must be in"),
    ({"uvs": np.zeros((3, 2))}, "uvs: must be as many as vertices, 4, but are 3"),
    ({"normals": np.zeros((4, 2))}, "normals: must have the shape (n, 3)"),
    ({"file": "other.obj"}, "vertices, file or shape"),
])  # fmt: skip
def test_wrong_meshes_are_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(lamina.InvalidInput) as refused:
        lamina.render(scene_of({**SQUARE, **change}, 0.5))
    assert message in str(refused.value)


def test_wrong_images_are_refused() -> None:
    with pytest.raises(lamina.InvalidInput, match="diffuse.map: must be an array of numbers"):
        lamina.render(scene_of(SQUARE, {"map": np.zeros((2, 2), complex), "encoding": "linear"}))


def test_no_file_of_an_array_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import tempfile

    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    lamina.render(scene_of(SQUARE, [0.2, 0.4, 0.6]), samples=1)
    with pytest.raises(lamina.InvalidInput):
        lamina.render({**scene_of(SQUARE, 0.5), "lihgts": []})
    with pytest.raises(lamina.InvalidInput):
        lamina.render(scene_of({**SQUARE, "faces": np.array([[0, 1, 9]])}, 0.5))
    assert not list(tmp_path.iterdir())
