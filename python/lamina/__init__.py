# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Light in layered translucent materials: predict, render, acquire.

Start with `material`, `layers` or `skin`, and hand them to `slab` or `profile`. Lengths are in mm,
coefficients in 1/mm, wavelengths in nm, angles in degrees. Results are small frozen objects with
arrays; `help()` of each says shapes and units.

Calls run on all cores without Python's lock; they may be made from several threads at once. Ctrl-C
in the main thread ends them within a second.
"""

from __future__ import annotations

from types import FunctionType as _FunctionType

try:
    from ._lamina import Error, FileError, Interrupted, InvalidInput, WriteError, __version__
except ModuleNotFoundError:
    from ._built_for import refusal

    raise refusal() from None
except ImportError as error:
    if "shared object" not in str(error):
        raise
    raise ImportError(
        f"{error}; lamina needs these Debian packages: libembree3-3 libfmt9 libhwy1 "
        "libopenexr-3-1-30 libpng16-16 libtbb12 libtiff6"
    ) from None
from ._tallies import McmlRun, Photons, mcml, photons
from ._threads import set_threads, threads
from ._acquire import AcquiredLeaf, AcquiredSkin, BandChoice, acquire, filters
from ._bsdf import Bsdf, bsdf
from ._exchange import ExportFormat, Exported, export, export_formats, import_material
from ._fit import Fit, FittedNumber, FittedSeries, fit
from ._input import suggests as _suggests
from ._half_spaces import InvertedColor, half_space_color, invert
from ._layers import Layers, layers
from ._map_photons import CylinderPhotons, PatchPhotons, cylinder_photons, patch_photons
from ._maps import SkinMaps, edit, load_maps, maps, persons
from ._materials import Material, material, material_text, materials
from ._media import (
    AlbedoInversion,
    LostLight,
    PulsedReflectance,
    SphereReading,
    equivalent_half_space,
    invert_dipole_albedo,
    lost_light,
    medium_from_look,
    mie_phase,
    phase_function,
    phase_moments,
    pulsed,
    sphere_reading,
)
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
from ._patch import PatchLight, patch
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
from ._render import ImageComparison, Picture, compare_pictures, load_image, render, save_image
from ._reproduce import (
    CheckedFeature,
    CheckedNumber,
    Reproduction,
    ReproductionItem,
    reproduce,
    reproductions,
)
from ._session import Session
from ._slab import SlabTotals, slab
from ._surfaces import RoughInterface, RoughSurface, rough_interface, rough_surface

__all__ = [
    "AcquiredLeaf", "AcquiredSkin", "AlbedoInversion", "BandChoice", "Bsdf", "CheckedFeature",
    "CheckedNumber", "CylinderPhotons", "Error", "ExportFormat", "Exported", "FileError", "Fit",
    "FittedNumber", "FittedSeries", "FrequencyResponse", "GaussianProfile", "ImageComparison",
    "Interrupted", "InvalidInput", "InvertedColor", "Layers", "LostLight", "Material", "McmlRun",
    "MieBulk", "MieSphere", "ObliqueProfile", "PatchLight", "PatchPhotons", "Photons", "Picture",
    "Profile", "PulsedReflectance", "Reproduction", "ReproductionItem", "RoughInterface",
    "RoughSurface", "SPECTRAL_BANDS", "Session", "SkinColors", "SkinMaps", "SlabTotals",
    "SphereReading", "WriteError", "__version__", "acquire", "bsdf", "color_difference", "compare_pictures",
    "cylinder_photons", "edit", "equivalent_half_space", "export", "export_formats", "filters",
    "fit", "fresnel", "fresnel_diffuse", "gaussians", "half_space_color", "import_material", "invert",
    "invert_dipole_albedo", "lab", "layers", "leaf", "load_image", "load_maps", "lost_light",
    "maps", "material", "material_text", "materials", "mcml", "medium_from_look", "mie_bulk",
    "mie_phase", "mie_sphere", "oblique_profile", "patch", "patch_photons", "persons",
    "phase_function", "phase_moments", "photons", "profile", "pulsed", "render", "reproduce",
    "reproductions", "rough_interface", "rough_surface", "save_image", "set_threads", "skin",
    "skin_colors", "slab", "snow", "spatial_frequency", "spectrum_color", "sphere_reading",
    "threads",
]

# Names of help() and pickles, wherever functions are written; functions say which argument may be meant.
for _name in __all__:
    if isinstance(globals()[_name], _FunctionType):
        globals()[_name] = _suggests(globals()[_name])
    if getattr(globals()[_name], "__module__", "").startswith("lamina._"):
        globals()[_name].__module__ = "lamina"
del _name
