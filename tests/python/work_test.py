# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Long calls: progress, Ctrl-C, threads, memory."""

from __future__ import annotations

import gc
import os
import resource
import signal
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable

import lamina
import numpy as np
import pytest


def long_work(progress: Any = None) -> Any:
    """Of days, if nothing stopped it."""
    return lamina.slab("marble", method="monte_carlo", photons=1e12, progress=progress)


def test_progress_is_told_and_can_stop() -> None:
    told: list[float] = []

    def callback(finished: float) -> bool:
        told.append(finished)
        return len(told) < 3

    with pytest.raises(lamina.Interrupted) as stopped:
        long_work(callback)
    assert len(told) == 3 and all(0.0 <= f <= 1.0 for f in told)
    partial: Any = stopped.value.result
    assert 0.0 < partial.diffuse_reflectance[0] < 1.0


def test_what_a_callback_raises_comes_out() -> None:
    def callback(finished: float) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        long_work(callback)


def interrupted(work: Callable[[], object], within: float = 1.0) -> Any:
    """What Ctrl-C half a second after its begin makes of it: an end within a second, on machines
    that do nothing else. So seconds of the processor count, by which busy machines do not differ."""
    sent: list[float] = []

    def send() -> None:
        sent.append(time.process_time())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(0.5, send)
    timer.start()
    with pytest.raises(KeyboardInterrupt) as stopped:
        work()
    assert time.process_time() - sent[0] < within * lamina.threads()
    timer.join()
    assert isinstance(stopped.value, lamina.Interrupted)
    return stopped.value.result


def test_ctrl_c_hands_over_what_there_is() -> None:
    partial = interrupted(long_work)
    assert partial.photons.sum() > 0 and 0.0 < partial.diffuse_reflectance[0] < 1.0


STACKS = lamina.layers(sigma_a=np.geomspace(1e-4, 1, 200_000)[:, None], sigma_s=10.0, g=0.8, ior=1.4, thickness=5.0)


@pytest.mark.parametrize("how", [{"accuracy": 1e-6}, {"derivatives": True}], ids=str)
def test_ctrl_c_hands_over_the_stacks_that_are_solved(how: dict[str, Any]) -> None:
    partial = interrupted(lambda: lamina.slab(STACKS, **how))
    solved = np.flatnonzero(np.isfinite(partial.diffuse_reflectance))
    assert 0 < solved.size < STACKS.shape[0]
    every = solved[:: max(solved.size // 5, 1)]
    again = lamina.slab(lamina.layers(sigma_a=STACKS.sigma_a[every], sigma_s=10.0, g=0.8, ior=1.4, thickness=5.0), **how)
    assert (again.diffuse_reflectance == partial.diffuse_reflectance[every]).all()
    assert (again.absorptance == partial.absorptance[every]).all()
    assert (np.isnan(partial.transmittance) == np.isnan(partial.absorptance[:, 0])).all()


def test_a_stop_hands_over_the_fits_that_have_ended() -> None:
    layer = {"sigma_a": 0.1, "sigma_s": 5, "g": 0.8, "ior": 1.4, "thickness": 1}
    one = {
        "name": "plate",
        "material": {"lamina": "material", "version": 1, "length_unit": "mm", "bands": [600], "ior_below": 1, "layers": [layer]},
        "free": [{"parameter": "layers[0].sigma_a", "per_band": True, "low": 1e-4, "high": 10, "scale": "logarithmic"}],
        "measured": [{"kind": "totals", "wavelength_nm": [600], "reflectance": [0.3], "unit": "fraction",
                      "specular": "included", "sd": 0.005}]}  # fmt: skip
    alone = lamina.fit(one)
    with pytest.raises(lamina.Interrupted) as stopped:
        lamina.fit([one] * 3000, progress=lambda finished: finished == 0.0)
    ended = [fit for fit in stopped.value.result if fit is not None]
    assert 0 < len(ended) < 3000 == len(stopped.value.result)
    assert all(fit["sigma_a"] == alone["sigma_a"] for fit in ended[:20])


def test_ctrl_c_ends_what_has_nothing_yet() -> None:
    y, x = np.mgrid[0:200, 0:200]
    melanin = 0.05 + 0.04 * np.sin(x / 6) * np.cos(y / 7)
    assert interrupted(lambda: lamina.patch(melanin=melanin, wavelengths=np.arange(410.0, 700.0, 2.0))) is None
    # Calls that take no progress=.
    many = lamina.layers(sigma_a=np.geomspace(1e-4, 1, 30_000)[:, None], sigma_s=10.0, thickness=1.0)
    assert interrupted(lambda: lamina.profile(many, method="diffusion")) is None
    assert interrupted(lambda: lamina.mie_phase(np.linspace(-1, 1, 300_000), 20_000.0, 1.33)) is None
    assert interrupted(lambda: lamina.leaf(thickness=np.linspace(0.1, 1.0, 1_000_000), wavelengths=[500, 600, 700])) is None
    # Python has its own way with Ctrl-C back.
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)
        time.sleep(1.0)


def test_threads_may_call_at_once() -> None:
    expected = lamina.slab("donner_jensen_skin").diffuse_reflectance
    colors = lamina.skin_colors(melanin=0.1, wavelengths=[500, 600, 700]).reflectance

    def work(i: int) -> None:
        if i % 2:
            assert (lamina.slab("donner_jensen_skin").diffuse_reflectance == expected).all()
        else:
            found = lamina.skin_colors(melanin=0.1, wavelengths=[500, 600, 700]).reflectance
            assert (found == colors).all()

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(work, range(64)))


def test_python_goes_on_meanwhile() -> None:
    """The lock is free during a call: another thread counts."""
    counted = 0
    done = threading.Event()

    def count() -> None:
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.005)

    counter = threading.Thread(target=count)
    counter.start()
    before = counted
    lamina.slab("marble", method="monte_carlo", seconds=0.6)
    meanwhile = counted - before
    done.set()
    counter.join()
    assert meanwhile > 3  # of some hundred; with the lock held one at most


def test_results_do_not_hang_on_threads() -> None:
    before = lamina.threads()
    many = lamina.slab("marble", method="monte_carlo", photons=50_000).diffuse_reflectance
    try:
        lamina.set_threads(1)
        assert lamina.threads() == 1
        one = lamina.slab("marble", method="monte_carlo", photons=50_000).diffuse_reflectance
    finally:
        lamina.set_threads(0)
    assert (one == many).all() and lamina.threads() == before


def test_memory_comes_back() -> None:
    plate = {"sigma_a": 0.1, "sigma_s": 1.0, "g": 0.0, "ior": 1.3, "thickness": 1.0}

    def round_of_calls() -> None:
        lamina.slab("jade")
        lamina.skin_colors(melanin=np.full(1000, 0.1))
        lamina.profile("marble", method="diffusion", radii=32)
        lamina.material({"length_unit": "mm", "bands": "rgb", "ior_below": 1.0, "layers": [plate]})
        with pytest.raises(lamina.InvalidInput):
            lamina.slab("jade", accuracy=3)

    def resident() -> float:
        gc.collect()
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * resource.getpagesize() / 2**20

    for _ in range(100):
        round_of_calls()
    before = resident()
    for _ in range(1000):
        round_of_calls()
    assert resident() - before < 4.0  # MiB; colors alone, if they stayed, would be 84 KiB a round
