# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Light in layered translucent materials: predict, render, acquire.

Start with `material`, `layers` or `skin`, and hand them to `slab` or `profile`. Lengths are in mm,
coefficients in 1/mm, wavelengths in nm, angles in degrees. Results are small frozen objects with
arrays; `help()` of each says shapes and units.

Calls run on all cores without Python's lock; they may be made from several threads at once. Ctrl-C
in the main thread ends them within a second.
"""

from __future__ import annotations

try:
    from ._lamina import Error, FileError, Interrupted, InvalidInput, WriteError, __version__
except ImportError as error:
    if "shared object" not in str(error):
        raise
    raise ImportError(
        f"{error}; lamina needs these Debian packages: libembree3-3 libfmt9 libhwy1 "
        "libopenexr-3-1-30 libpng16-16 libtbb12 libtiff6"
    ) from None
from ._tallies import McmlRun, Photons, mcml, photons
from ._threads import set_threads, threads
from ._bsdf import Bsdf, bsdf
from ._fit import Fit, FittedNumber, FittedSeries, fit
from ._layers import Layers, layers
from ._materials import Material, material, material_text, materials
from ._optics import (
    MieBulk,
    MieSphere,
    color_difference,
    fresnel,
    fresnel_diffuse,
    lab,
    mie_bulk,
    mie_sphere,
    spectrum_color,
)
from ._patch import PatchLight, SkinMaps, maps, patch
from ._profile import (
    FrequencyResponse,
    GaussianProfile,
    ObliqueProfile,
    Profile,
    gaussians,
    oblique_profile,
    profile,
    spatial_frequency,
)
from ._recipes import SPECTRAL_BANDS, SkinColors, leaf, skin, skin_colors, snow
from ._render import Picture, load_image, render, save_image
from ._slab import SlabTotals, slab

__all__ = [
    "Bsdf", "Error", "FileError", "Fit", "FittedNumber", "FittedSeries", "FrequencyResponse", "GaussianProfile", "Interrupted", "InvalidInput",
    "Layers", "Material", "McmlRun", "MieBulk", "MieSphere", "ObliqueProfile", "PatchLight", "Photons", "Picture", "Profile", "SPECTRAL_BANDS", "SkinColors", "SkinMaps", "SlabTotals",
    "WriteError", "__version__", "bsdf", "color_difference", "fit", "fresnel", "fresnel_diffuse", "gaussians", "lab", "layers", "leaf", "load_image", "maps", "material",
    "material_text", "materials", "mcml", "mie_bulk", "mie_sphere", "oblique_profile", "patch", "photons", "profile", "render", "save_image", "set_threads", "skin", "skin_colors", "slab", "snow",
    "spatial_frequency", "spectrum_color", "threads",
]

# What help() and pickles call them, wherever they are written.
for _name in __all__:
    if getattr(globals()[_name], "__module__", "").startswith("lamina._"):
        globals()[_name].__module__ = "lamina"
del _name
