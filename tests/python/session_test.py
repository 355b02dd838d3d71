# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Scenes that stay: the pictures of render(), refusals, and Ctrl-C."""

import os
import signal
import threading
import time

import lamina
import numpy as np
import pytest

BALL = {
    "camera": {"position": [0, 0, 40], "look_at": [0, 0, 0], "horizontal_fov": 35},
    "film": {"width": 24, "height": 16},
    "render": {"samples_per_pixel": 2},
    "materials": {"wall": {"diffuse": 0.5}},
    "meshes": [{"shape": "sphere", "material": "wall"}],
    "lights": [{"type": "environment", "radiance": 1}],
    "mm_per_unit": 10,
}


def test_images_are_those_of_render():
    with lamina.Session(BALL) as session:
        assert np.array_equal(session.image(), lamina.render(BALL).image)
        changes = {"materials.wall.diffuse": [0.2, 0.4, 0.6], "film.width": 20}
        session.set("materials.wall.diffuse", [0.2, 0.4, 0.6])
        session.set({"film.width": 20})
        found = session.picture()
        assert np.array_equal(session.image(), lamina.render(BALL, changes=changes).image)
        assert found["is_final"] and found["change"] == 3 and found["samples_per_pixel"] == 2
        session.region([2, 3, 5, 6])
        assert np.array_equal(session.image(), lamina.render(BALL, changes=changes, region=[2, 3, 5, 6]).image)
        session.region(None)
        assert session.image("any").shape[2] == 3


def test_what_is_wrong_is_named():
    with pytest.raises(lamina.InvalidInput, match="film.width"):
        lamina.Session({**BALL, "film": {"width": -1}})
    session = lamina.Session(BALL)
    with pytest.raises(lamina.InvalidInput, match="camera.position"):
        session.set("camera.position", 3)
    with pytest.raises(lamina.InvalidInput, match="region"):
        session.region([0, 0, 30, 30])
    with pytest.raises(lamina.InvalidInput, match="region: must be x, y, width, height"):
        session.region(3)
    with pytest.raises(lamina.InvalidInput, match="wait"):
        session.image("soon")
    assert np.array_equal(session.image(), lamina.render(BALL).image)
    session.close()
    with pytest.raises(lamina.InvalidInput, match="closed"):
        session.image()
    session.close()


def test_other_threads_go_on_and_ctrl_c_is_heard():
    slow = {**BALL, "film": {"width": 512, "height": 512}, "render": {"samples_per_pixel": 100000}}
    with lamina.Session(slow) as session:
        counted = []
        threading.Thread(target=lambda: [counted.append(time.sleep(0.01)) for _ in range(20)]).start()
        threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        start = time.monotonic()
        with pytest.raises((lamina.Interrupted, KeyboardInterrupt)):
            session.image()
        assert time.monotonic() - start < 20
        assert len(counted) >= 10
