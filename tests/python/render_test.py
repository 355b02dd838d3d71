# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Rendering from Python: the command's pictures, partial ones, and wrong scenes."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path
from typing import Any

import lamina
import numpy as np
import pytest

SOURCE = Path(os.environ.get("LAMINA_SOURCE", Path(__file__).parents[2]))
COMMAND = Path(lamina.__file__).resolve().parents[2] / "lamina"
SCENE = SOURCE / "scenes/bumpy.json"

BALL: dict[str, Any] = {
    "mm_per_unit": 10,
    "camera": {"position": [0, 0, 40], "look_at": [0, 0, 0], "horizontal_fov": 35},
    "film": {"width": 24, "height": 16},
    "materials": {"jade": {"subsurface": "jade"}},
    "meshes": [{"shape": "sphere", "material": "jade"}],
    "lights": [{"type": "environment", "radiance": 1}],
}


def test_the_picture_is_that_of_the_command(tmp_path: Path) -> None:
    if not COMMAND.exists():
        pytest.skip(f"there is no command at {COMMAND}")
    options = ["--width", "24", "--samples", "2", "--method", "probe", "--seed", "5"]
    file = tmp_path / "p.exr"
    subprocess.run([str(COMMAND), "render", str(SCENE), *options, "-o", str(file)], check=True, capture_output=True)
    printed, channels = lamina.load_image(file)
    found = lamina.render(SCENE, width=24, samples=2, method="probe", seed=5)
    found.save(tmp_path / "ours.exr")
    ours, names = lamina.load_image(tmp_path / "ours.exr")
    for name in found.channels:
        assert (ours[..., names.index(name)] == found.pixels[..., found.channels.index(name)]).all()
    assert sorted(names) == sorted(channels)
    for i, name in enumerate(channels):
        if name != "depth.Z":  # beyond half precision where nothing is
            half = found.pixels[..., found.channels.index(name)].astype(np.float16)
            assert (half == printed[..., i].astype(np.float16)).all(), name


def test_quality_chooses_and_yields() -> None:
    preview = lamina.render(BALL, quality="preview")
    assert (preview.method, preview.samples_per_pixel, preview.corrections) == ("probe", 8.0, [])
    assert (preview.image == lamina.render(BALL, method="probe", samples=8).image).all()
    final = lamina.render(BALL, quality="final", samples=1)
    assert final.method == "hierarchy" and len(final.corrections) == 1
    assert lamina.render(BALL, quality="final", samples=1, correct=False).corrections == []
    in_scene = lamina.render({**BALL, "render": {"quality": "reference", "samples_per_pixel": 2}})
    assert (in_scene.method, in_scene.samples_per_pixel) == ("random_walk", 2.0)


def test_a_dict_is_a_scene() -> None:
    picture = lamina.render(BALL, samples=4, seed=2)
    assert picture.image.shape == (16, 24, 3) and picture.is_complete
    assert np.shares_memory(picture.image, picture.pixels)
    assert picture.layer("depth").shape == (16, 24) and picture.layer("normal").shape == (16, 24, 3)
    assert picture.srgb().dtype == np.uint8 and picture.srgb(exposure=1).mean() > picture.srgb().mean()
    again = lamina.render(BALL, samples=4, seed=2, changes={"lights[0].radiance": 2})
    lit = picture.image[8, 12].astype(float)
    assert again.image[8, 12].astype(float) == pytest.approx(2.0 * lit, rel=1e-5)
    assert picture.to_xarray()["image"].dims == ("y", "x", "channel")


def test_no_hang_on_threads() -> None:
    lamina.set_threads(1)
    one = lamina.render(BALL, samples=2)
    lamina.set_threads(0)
    assert (lamina.render(BALL, samples=2).pixels == one.pixels).all()


def test_png_is_the_view(tmp_path: Path) -> None:
    picture = lamina.render(BALL, samples=2)
    picture.save(tmp_path / "p.png")
    read, _ = lamina.load_image(tmp_path / "p.png", encoding="linear")
    assert (np.rint(255 * read[..., :3]).astype(np.uint8) == picture.srgb()).all()
    png = picture._repr_png_()
    assert png is not None and png.startswith(b"\x89PNG")


def test_alpha_mattes_and_light_layers(tmp_path: Path) -> None:
    picture = lamina.render(BALL, samples=2, alpha=True, cryptomatte=True)
    assert 0.0 < picture.layer("A").mean() < 1.0
    assert {"CryptoObject00.R", "CryptoMaterial02.A"} <= set(picture.channels)
    picture.save(tmp_path / "p.exr")
    said = (tmp_path / "p.exr").read_bytes()
    assert b"cryptomatte/" in said and b"lamina/version" in said and b'"jade"' in said
    assert picture.notes["lamina/version"] == lamina.__version__
    two = {**BALL, "lights": [*BALL["lights"], {"type": "directional", "towards": [0, -1, 0], "irradiance": 1, "name": "sun"}]}
    layers = lamina.render(two, samples=2, light_layers=True)
    parts = layers.layer("light")
    assert parts.shape[-1] == 6
    assert parts[..., :3] + parts[..., 3:] == pytest.approx(layers.image, abs=1e-5)
    with pytest.raises(lamina.InvalidInput, match="^denoise: does not go with light_layers$"):
        lamina.render(two, samples=2, light_layers=True, denoise=True)


def test_color_spaces(tmp_path: Path) -> None:
    red = np.zeros((1, 1, 3), np.float32)
    red[..., 0] = 1.0
    lamina.save_image(tmp_path / "aces.exr", red, color_space="acescg")
    raw, names = lamina.load_image(tmp_path / "aces.exr", encoding="linear")
    assert [raw[0, 0, names.index(c)] for c in "RGB"] == pytest.approx([0.613097, 0.070194, 0.020616], abs=2e-5)
    back, names = lamina.load_image(tmp_path / "aces.exr")
    assert [back[0, 0, names.index(c)] for c in "RGB"] == pytest.approx([1, 0, 0], abs=1e-6)
    with pytest.raises(lamina.InvalidInput, match="^color_space: must be one of rec709, acescg"):
        lamina.save_image(tmp_path / "x.exr", red, color_space="aces")


def test_views_of_a_config(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    config = tmp_path / "studio.ocio"
    config.write_text("""ocio_profile_version: 2
search_path: ""
roles: {default: lin_rec709}
displays:
  Monitor:
    - !<View> {name: Linear, colorspace: lin_rec709}
    - !<View> {name: Root, colorspace: root}
colorspaces:
  - !<ColorSpace> {name: lin_rec709}
  - !<ColorSpace>
    name: root
    from_scene_reference: !<ExponentTransform> {value: [2, 2, 2, 1], direction: inverse}
""")
    picture = lamina.render(BALL, samples=2)
    monkeypatch.delenv("OCIO", raising=False)
    with pytest.raises(lamina.InvalidInput, match="^display: goes with a config"):
        picture.srgb(display="Monitor")
    try:
        seen = picture.srgb(ocio=config, view="Root")
    except lamina.InvalidInput as error:
        pytest.skip(str(error))
    expected = 255.0 * np.sqrt(np.clip(picture.image, 0.0, 1.0))
    assert np.abs(seen - expected).max() <= 0.51
    assert (picture.srgb(ocio=config) == np.rint(255.0 * np.clip(picture.image, 0, 1))).mean() > 0.99
    monkeypatch.setenv("OCIO", str(config))
    assert (picture.srgb(view="Root") == seen).all()
    picture.save(tmp_path / "root.png", view="Root")
    read, _ = lamina.load_image(tmp_path / "root.png", encoding="linear")
    assert (np.rint(255 * read[..., :3]) == seen).all()
    with pytest.raises(lamina.InvalidInput, match='must be one of Linear, Root, but is Rot; did you mean "Root"'):
        picture.srgb(ocio=config, view="Rot")


def test_ctrl_c_hands_over_the_picture_so_far() -> None:
    calls = 0

    def press(finished: float) -> None:  # well within the picture, however busy the machine is
        nonlocal calls
        calls += finished > 0.0
        if calls == 8:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(lamina.Interrupted) as stopped:
        lamina.render(BALL, samples=1 << 22, progress=press)
    partial: Any = stopped.value.result
    assert not partial.is_complete and 0 < partial.samples_per_pixel < 1 << 22
    assert partial.image.mean() > 0


WRONG: list[tuple[dict[str, Any], dict[str, Any], str]] = [
    ({**BALL, "materals": {}}, {}, 'scene: unknown key "materals"'),
    ({**BALL, "meshes": [{"shape": "sphere", "material": "jad"}]}, {}, "jad"),
    ({**BALL, "film": {"width": -1, "height": 4}}, {}, "film.width"),
    ({**BALL, "lights": [{"type": "environment", "radiance": float("nan")}]}, {}, "must be a finite number"),
    (BALL, {"samples": 0}, "samples: must be a whole number in [1, 2^24], but is 0"),
    (BALL, {"width": 1.5}, "width: must be a whole number"),
    (BALL, {"method": "prob"}, 'did you mean "probe"'),
    (BALL, {"quality": "fnal"}, 'quality: must be one of preview, final, reference, but is \'fnal\'; did you mean "final"?'),
    (BALL, {"changes": {"film.widht": 3}}, "widht"),
    (BALL, {"changes": [1]}, "changes: must be a dict"),
    (BALL, {"correct": 1}, "correct: must be True or False"),
    (BALL, {"exposure": float("inf")}, "exposure: must be in"),
]


@pytest.mark.parametrize(("scene", "arguments", "message"), WRONG)
def test_wrong_scenes_are_refused(scene: Any, arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(lamina.InvalidInput) as refused:
        lamina.render(scene, **arguments)
    assert message in str(refused.value) and "\n" not in str(refused.value)


def test_files_that_are_not_there(tmp_path: Path) -> None:
    with pytest.raises(lamina.FileError):
        lamina.render(tmp_path / "none.json")
    with pytest.raises(lamina.FileError):
        lamina.load_image(tmp_path / "none.png")
    with pytest.raises(lamina.WriteError):
        lamina.save_image(tmp_path / "no/folder.exr", np.zeros((2, 2, 3)))
    ragged = [[1.0], [1.0, 2.0]]
    for image, message in ((np.zeros((2, 2)), "axes"), (np.array([["a"]]), "numbers"), (ragged, "numbers")):
        with pytest.raises(lamina.InvalidInput, match=message):
            lamina.save_image(tmp_path / "x.exr", image)
    with pytest.raises(MemoryError):  # and not TypeError
        lamina.save_image(tmp_path / "x.exr", np.broadcast_to(np.float32(0.1), (10**9, 10**9)))
    with pytest.raises(lamina.InvalidInput, match="must be a path or a dict, but is int"):
        lamina.render(3)  # type: ignore[arg-type]
