#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""All built-in materials as balls on one sheet: docs/images/materials.png.

usage: PYTHONPATH=BUILD/python python3 tools/docs/material_sheet.py OUT.png [--exact]

Profiles are those of layered diffusion, which take no time; --exact takes those of radiative transfer, minutes
of them. `lamina materials NAME --swatch FILE.png` is the exact one.
"""

import json
import sys

import lamina
from lamina import _lamina
from matplotlib.figure import Figure

SIDE, COLUMNS = 104, 7


def swatch(name, profile):
    material = lamina.material(name)
    scene = json.loads(_lamina.swatch_scene(material._material, SIDE))
    try:
        return lamina.render(scene, samples=24, denoise=True, profile=profile).srgb()
    except lamina.InvalidInput:  # of methods that need no profile
        return lamina.render(scene, samples=24, denoise=True).srgb()


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    profile = None if "--exact" in sys.argv else "diffusion"
    names = lamina.materials()
    rows = -(-len(names) // COLUMNS)
    inch = SIDE / 100
    figure = Figure(figsize=(COLUMNS * inch * 1.06, rows * (inch + 0.24)), dpi=100)
    figure.patch.set_facecolor("#767676")
    for i, name in enumerate(names):
        ax = figure.add_subplot(rows, COLUMNS, i + 1)
        ax.imshow(swatch(name, profile), interpolation="nearest")
        ax.set_title(name, fontsize=7, color="white", pad=2)
        ax.axis("off")
        print(name, flush=True)
    figure.subplots_adjust(0.0, 0.0, 1.0, 0.97, 0.0, 0.16)
    figure.savefig(sys.argv[1], facecolor=figure.get_facecolor())
    pixels, _ = lamina.load_image(sys.argv[1])
    lamina.save_image(sys.argv[1], pixels[..., :3])  # without alpha, and smaller


if __name__ == "__main__":
    main()
