#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""What Python costs over C++: the table "Time" of docs/python.md.

usage: PYTHONPATH=BUILD/python python3 benchmarks/python_benchmark.py [--small]

Seconds are of the processor, all threads, medians. The time of C++ is that of the function of lamina._lamina
that does the work, taken in the same run.
"""

import gc
import os
import resource
import statistics
import subprocess
import sys
import time

import lamina
import numpy as np
from lamina import _lamina


def median(work, repeats=5):
    def once():
        begun = time.process_time()
        work()
        return time.process_time() - begun

    once()
    return statistics.median(once() for _ in range(repeats))


def per_call(work, calls):
    return median(lambda: [work() for _ in range(calls)]) / calls


def of_process(code):
    def once():
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-c", code], check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    once()
    return statistics.median(once() for _ in range(7))


class timed:
    """A function or class whose own time is added up: the part of a call that is C++."""

    def __init__(self, thing):
        self.thing, self.seconds = thing, 0.0

    def __call__(self, *arguments):
        begun = time.process_time()
        result = self.thing(*arguments)
        self.seconds += time.process_time() - begun
        return result


def inside(name, work, repeats=3):
    """Time of a call, and of a function of C++ within it: medians."""
    kept, whole, within = getattr(_lamina, name), [], []
    for _ in range(repeats):
        watched = timed(kept)
        setattr(_lamina, name, watched)
        begun = time.process_time()
        work()
        whole.append(time.process_time() - begun)
        within.append(watched.seconds)
    setattr(_lamina, name, kept)
    return statistics.median(whole), statistics.median(within)


def resident():
    gc.collect()
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize() / 2**20


def row(what, asked, measured):
    print(f"| {what} | {asked} | {measured} |", flush=True)


def main():
    small = "--small" in sys.argv
    print("| what | asked | measured |\n|---|---|---|")
    nothing, numpy = of_process("pass"), of_process("import numpy")
    row("`import lamina`", "≤ .2 s", f"{of_process('import lamina') - nothing:.3f} s, of which NumPy {numpy - nothing:.3f} s")

    calls = 200 if small else 5000
    row("`fresnel` of one angle, all of the call", "≤ 20 µs", f"{1e6 * per_call(lambda: lamina.fresnel(0.5, 1.5), calls):.1f} µs")
    plate = lamina.layers(sigma_a=0.1, sigma_s=1.0, thickness=0.1)
    calls = 50 if small else 500
    whole, within = inside("slab_by_radiative_transfer", lambda: [lamina.slab(plate) for _ in range(calls)])
    row("`slab` of one layer, over C++", "≤ 20 µs", f"{1e6 * (whole - within) / calls:.1f} µs, of {1e6 * whole / calls:.0f} µs")

    million = np.linspace(0.0, 1.0, 10**6)
    from lamina._input import doubles

    row("10⁶ numbers pass without a copy", "yes", "yes" if np.shares_memory(doubles("x", million), million) else "no")
    row("`fresnel` of 10⁶ angles", "", f"{median(lambda: lamina.fresnel(million, 1.5)):.3f} s")

    melanin = np.linspace(0.01, 0.4, 100)[:, None]
    blood = np.linspace(0.002, 0.05, 100)
    colors = lambda: lamina.skin_colors(melanin=melanin, hemoglobin_dermis=blood)
    begun = time.process_time()
    colors()
    first = time.process_time() - begun
    row("10 000 colors of skin, from the exact table", "≤ 1 s on 2 cores", f"{first:.2f} s the first time, {median(colors):.3f} s later")

    side = 64 if small else 512
    y, x = np.mgrid[0:side, 0:side]
    maps = {"melanin": 0.05 + 0.04 * np.sin(x / 9.0) * np.cos(y / 7.0), "hemoglobin_dermis": 0.01 + 0.005 * np.cos(x / 20.0)}
    nm = [550.0] if small else [450.0, 550.0, 650.0]
    weights = np.ones((side, side, len(nm)), np.float32)

    def with_gradient():
        light = lamina.patch(**maps, wavelengths=nm, mm_per_pixel=0.1, derivatives=True)
        kept = light._solver.gradient
        begun = time.process_time()
        kept(np.ascontiguousarray(np.moveaxis(weights, -1, 0)), None)
        with_gradient.within = time.process_time() - begun
        begun = time.process_time()
        light.gradient(weights)
        with_gradient.whole = time.process_time() - begun

    with_gradient()  # its tables are on disk from here on
    light, within = inside("DifferentiablePatch", with_gradient, 3)
    whole = light - with_gradient.within  # the gradient ran twice, once bare
    cpp = within + with_gradient.within
    row(f"{side}² patch with gradient", "≤ 5 % over C++", f"{whole:.2f} s, {100 * (whole / cpp - 1):.1f} % over C++")

    plate_file = {"length_unit": "mm", "bands": "rgb", "ior_below": 1.0,
                  "layers": [{"sigma_a": 0.1, "sigma_s": 1.0, "g": 0.0, "ior": 1.3, "thickness": 1.0}]}

    def round_of_calls():
        lamina.slab(plate)
        lamina.skin_colors(melanin=np.full(1000, 0.1))
        lamina.profile("marble", method="diffusion", radii=32)
        lamina.material(plate_file)

    for _ in range(100):
        round_of_calls()
    before = resident()
    for _ in range(100 if small else 1000):
        round_of_calls()
    row("memory after 1000 rounds of four calls", "returns", f"{resident() - before:+.2f} MiB")
    print(f"\n{os.cpu_count()} processors, NumPy {np.__version__}, lamina {lamina.__version__}")


if __name__ == "__main__":
    main()
