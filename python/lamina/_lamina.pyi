# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#
# The library as the modules here see it; see python/bindings/.
from typing import Any, Callable, Optional

import numpy as np
from numpy.typing import NDArray

_Doubles = NDArray[np.float64]
_Callback = Optional[Callable[[float], Optional[bool]]]
_Grid = tuple[float, float, int]

__version__: str

class Error(Exception): ...
class InvalidInput(Error, ValueError): ...
class FileError(Error, OSError): ...
class WriteError(Error, OSError): ...

class Interrupted(KeyboardInterrupt):
    result: Any

def set_thread_count(threads: int) -> None: ...
def thread_count() -> int: ...

class LayerStacks:
    @staticmethod
    def from_state(state: tuple[Any, ...]) -> LayerStacks: ...
    @staticmethod
    def made(
        sigma_a: _Doubles,
        sigma_s: _Doubles,
        g: _Doubles,
        ior: _Doubles,
        thickness: _Doubles,
        roughness: _Doubles,
        phase: list[str],
        distribution: list[str],
        ior_above: _Doubles,
        ior_below: _Doubles,
        ground_reflectance: _Doubles,
        ground_roughness: _Doubles,
    ) -> LayerStacks: ...
    shape: tuple[int, ...]
    layer_count: int
    sigma_a: _Doubles
    sigma_s: _Doubles
    g: _Doubles
    ior: _Doubles
    thickness: _Doubles
    roughness: _Doubles
    ior_above: _Doubles
    ior_below: _Doubles
    ground_reflectance: _Doubles
    def flipped(self) -> LayerStacks: ...
    def __getstate__(self) -> Any: ...

class Material:
    name: str
    source: str
    oiliness: float
    specular_roughness: Optional[float]
    band_names: list[str]
    wavelengths: Optional[_Doubles]
    layer_names: list[str]
    def text(self) -> str: ...
    def layer_stacks(self) -> LayerStacks: ...

def swatch_scene(material: Material, side: int) -> str: ...
def decode_material(text: str, name: str, wavelengths: list[float]) -> Material: ...
def find_material(name_or_path: str, wavelengths: list[float]) -> Material: ...
def builtin_material_names() -> list[str]: ...
def builtin_material_text(name: str) -> str: ...

_Arrays = dict[str, _Doubles]
_Range = tuple[str, float, float, bool]

def skin_parameter_ranges() -> list[_Range]: ...
def leaf_parameter_ranges() -> list[_Range]: ...
def snow_parameter_ranges() -> list[_Range]: ...
def skin_constants(constants: str) -> dict[str, float]: ...
def skin_stacks(
    arrays: _Arrays, shape: list[int], constants: str, wavelengths: list[float]
) -> LayerStacks: ...
def leaf_stacks(arrays: _Arrays, shape: list[int], wavelengths: list[float]) -> LayerStacks: ...
def snow_stacks(arrays: _Arrays, shape: list[int], wavelengths: list[float]) -> LayerStacks: ...

class SkinTable:
    @staticmethod
    def made(
        wavelengths: list[float],
        is_diffuse: bool,
        theta: float,
        fixed: _Arrays,
        constants: str,
        callback: _Callback,
    ) -> SkinTable: ...
    specular_reflectance: float
    color_weights: _Doubles
    def reflectance(self, arrays: _Arrays, shape: list[int], constants: str) -> _Doubles: ...

def slab_by_radiative_transfer(
    stacks: LayerStacks, is_diffuse: bool, theta: float, accuracy: float, callback: _Callback
) -> dict[str, Any]: ...
def slab_with_derivatives(
    stacks: LayerStacks, is_diffuse: bool, theta: float, accuracy: float, callback: _Callback
) -> dict[str, Any]: ...
def slab_by_diffusion(
    stacks: LayerStacks, is_diffuse: bool, theta: float, interreflections: str, callback: _Callback
) -> dict[str, Any]: ...
def slab_by_monte_carlo(
    stacks: LayerStacks, is_diffuse: bool, theta: float, effort: dict[str, Any], callback: _Callback
) -> dict[str, Any]: ...
def profile_by_radiative_transfer(
    stacks: LayerStacks, grid: _Grid, options: dict[str, Any], is_cached: bool, callback: _Callback
) -> dict[str, Any]: ...
def profile_by_diffusion(
    stacks: LayerStacks, grid: _Grid, interreflections: str
) -> dict[str, Any]: ...
def profile_by_dipole(stacks: LayerStacks, grid: _Grid) -> dict[str, Any]: ...
def profile_by_monte_carlo(
    stacks: LayerStacks, grid: _Grid, effort: dict[str, Any], callback: _Callback
) -> dict[str, Any]: ...
def oblique_profile(
    stacks: LayerStacks, theta: float, grid: _Grid, moments: int, callback: _Callback
) -> dict[str, Any]: ...
def spatial_frequency_response(
    stacks: LayerStacks,
    k: list[float],
    options: dict[str, Any],
    has_derivatives: bool,
    callback: _Callback,
) -> dict[str, Any]: ...
def gaussian_profile(
    stacks: LayerStacks, count: int, options: dict[str, Any], callback: _Callback
) -> dict[str, Any]: ...

_Floats = NDArray[np.float32]

def render(
    path: str,
    text: Optional[str],
    settings: list[str],
    changes: dict[str, Any],
    cache: str,
    takes_foreign_light: bool,
    denoises: bool,
    has_mattes: bool,
    has_light_layers: bool,
    callback: _Callback,
) -> dict[str, Any]: ...

class Session:
    def set(self, settings: list[str]) -> int: ...
    def set_region(self, region: Optional[tuple[int, int, int, int]]) -> int: ...
    def picture(self, is_final: bool, callback: _Callback) -> dict[str, Any]: ...
    def close(self) -> None: ...

def open_session(path: str, text: Optional[str], settings: list[str]) -> Session: ...
def view(rgb: _Floats, name: str, exposure: float) -> NDArray[np.uint8]: ...
def ocio_view(
    rgb: _Floats, config: str, display: str, name: str, exposure: float
) -> NDArray[np.uint8]: ...
def load_image(file: str, encoding: str) -> tuple[_Floats, list[str]]: ...
def save_png(pixels: _Floats, channels: list[str], file: str) -> None: ...
def save_exr(
    pixels: _Floats,
    channels: list[str],
    file: str,
    notes: dict[str, str],
    space: str,
    frame: Optional[tuple[int, int, int, int]],
) -> None: ...
def method_names() -> list[str]: ...
def photons(
    stacks: LayerStacks,
    is_diffuse: bool,
    theta: float,
    beam: str,
    beam_radius: float,
    tallies: dict[str, Any],
    effort: dict[str, Any],
    max_events: int,
    callback: _Callback,
) -> dict[str, Any]: ...

class SkinPatch:
    @staticmethod
    def made(
        maps: _Arrays,
        numbers: dict[str, float],
        light: _Doubles,
        mm_per_pixel: float,
        wavelengths: list[float],
        theta: float,
        constants: str,
    ) -> SkinPatch: ...

def load_patch(path: str, text: Optional[str], settings: list[str]) -> SkinPatch: ...
def solve_patch(patch: SkinPatch, callback: _Callback) -> dict[str, Any]: ...
def patch_color_weights(patch: SkinPatch) -> _Doubles: ...

class DifferentiablePatch:
    @staticmethod
    def made(patch: SkinPatch, callback: _Callback) -> DifferentiablePatch: ...
    light: _Floats
    def gradient(self, by_light: _Floats, callback: _Callback) -> dict[str, _Floats]: ...

class EditableSkin:
    @staticmethod
    def made(
        maps: Any, numbers: dict[str, float], constants: str, mm_per_pixel: float
    ) -> EditableSkin: ...
    @staticmethod
    def load(path: str) -> EditableSkin: ...
    @staticmethod
    def from_recipe(
        path: str,
        text: Optional[str],
        settings: list[str],
        seed: Optional[int],
        callback: _Callback,
    ) -> EditableSkin: ...
    maps: dict[str, _Floats]
    deviations: dict[str, _Floats]
    mask: Optional[_Floats]
    numbers: dict[str, float]
    constants: str
    mm_per_pixel: Optional[float]
    warnings: list[str]
    def edited(self, kind: str, what: dict[str, Any]) -> tuple[EditableSkin, dict[str, int]]: ...
    def persons(self, population: str, count: int, seed: int) -> list[EditableSkin]: ...
    def patch(
        self, light: _Doubles, wavelengths: list[float], theta: float
    ) -> SkinPatch: ...
    def preview(self, longest_side: int, callback: _Callback) -> _Floats: ...
    def save(self, folder: str, edited_from: str) -> None: ...

def edit_kinds() -> dict[str, tuple[float, float, float, bool, bool]]: ...

class Acquisition:
    def save(self, folder: str) -> None: ...

def acquire(
    path: str,
    text: Optional[str],
    settings: list[str],
    options: dict[str, Any],
    start: dict[str, _Floats],
    smoothness: list[float],
    callback: _Callback,
) -> tuple[dict[str, Any], Acquisition]: ...
def choose_bands(
    wavelengths: list[float],
    widths: list[float],
    count: int,
    noise: float,
    numbers: list[str],
    population: str,
    skins_drawn: int,
    seed: int,
    compared: Optional[list[int]],
    callback: _Callback,
) -> dict[str, Any]: ...
def fit(
    sources: list[tuple[str, Optional[str]]], settings: list[str], seed: int, callback: _Callback
) -> tuple[list[Optional[dict[str, Any]]], bool]: ...
def bsdf(
    stacks: LayerStacks,
    theta_i: float,
    theta_o: list[float],
    phi_o: list[float],
    method: str,
    accuracy: float,
    callback: _Callback,
) -> dict[str, Any]: ...
def load_mcml(file: str) -> list[dict[str, Any]]: ...

_Complexes = NDArray[np.complex128]

def fresnel(cosine: _Doubles, eta: _Doubles) -> _Doubles: ...
def fresnel_diffuse(eta: _Doubles) -> _Doubles: ...
def mie_sphere(size: _Doubles, ior: _Complexes) -> _Doubles: ...
def mie_bulk(
    fraction: _Doubles,
    radius: _Doubles,
    spread: _Doubles,
    ior: _Complexes,
    ior_medium: _Doubles,
    wavelength: _Doubles,
) -> _Doubles: ...
def band_weights(wavelengths: list[float], illuminant: str) -> _Doubles: ...
def lab(rgb: _Doubles, shape: list[int]) -> _Doubles: ...
def color_difference(first: _Doubles, second: _Doubles, shape: list[int]) -> _Doubles: ...

def color_range(
    ior: _Doubles, g: _Doubles, roughness: _Doubles, distribution: str, definition: str
) -> _Doubles: ...
def half_space_color(
    albedo: _Doubles,
    ior: _Doubles,
    g: _Doubles,
    roughness: _Doubles,
    distribution: str,
    definition: str,
    solves: bool,
) -> _Doubles: ...
def invert(
    color: _Doubles,
    radius: _Doubles,
    ior: _Doubles,
    g: _Doubles,
    roughness: _Doubles,
    distribution: str,
    definition: str,
    meaning: str,
) -> _Doubles: ...
def phase_function(kind: str, cos_theta: _Doubles, g: _Doubles) -> _Doubles: ...
def phase_moments(kind: str, g: _Doubles, count: int) -> _Doubles: ...
def mie_phase(size: float, ior: complex, cosines: list[float]) -> _Doubles: ...
def invert_dipole_albedo(
    reflectance: _Doubles, ior: _Doubles, ior_outside: _Doubles
) -> _Doubles: ...
def medium_from_look(*numbers: _Doubles) -> LayerStacks: ...
def equivalent_half_space(stacks: LayerStacks, callback: _Callback) -> LayerStacks: ...
def pulsed_diffusion(
    stacks: LayerStacks, r: list[float], t: list[float], callback: _Callback
) -> _Doubles: ...
def sphere_reading(
    side: str,
    sphere: dict[str, Any],
    scattered: _Doubles,
    straight: _Doubles,
    diffuse_reflectance: _Doubles,
) -> _Doubles: ...
def lost_light(
    stacks: LayerStacks,
    is_diffuse: bool,
    theta: float,
    beam_diameter: float,
    port_diameter: float,
    photons: int,
    seed: int,
    callback: _Callback,
) -> _Doubles: ...
def rough_interface(
    roughness: float, eta: float, distribution: str, masking: str, cosines: list[float]
) -> dict[str, Any]: ...
def rough_surface(
    smoothness: float,
    eta: float,
    theta_i: float,
    method: str,
    rays: int,
    seed: int,
    visibility: str,
    realizations: int,
    callback: _Callback,
) -> dict[str, Any]: ...
def patch_photons(
    stacks: LayerStacks,
    shape: list[int],
    irradiance: _Doubles,
    texel: float,
    photons: int,
    seed: int,
    is_diffuse: bool,
    theta: float,
    callback: _Callback,
) -> dict[str, Any]: ...
def cylinder_photons(
    stacks: LayerStacks,
    cylinders: list[dict[str, float]],
    width: float,
    length: float,
    repeats: bool,
    beam_radius: Optional[float],
    columns: int,
    photons: int,
    seed: int,
    callback: _Callback,
) -> dict[str, Any]: ...
def load_envi(
    file: str,
    wavelengths: list[float],
    widths: list[float],
    shape: str,
    rectangle: Optional[list[int]],
) -> tuple[_Floats, list[str]]: ...
def compare_images(
    a: _Floats, a_variance: _Floats, b: _Floats, b_variance: _Floats, significance: float
) -> dict[str, Any]: ...
def reproduction_items() -> list[tuple[str, str, str, str]]: ...
def reproduce(
    id: str,
    path: Optional[str],
    text: Optional[str],
    quality: str,
    folder: str,
    sources: str,
    run: Callable[[list[str], str], str],
) -> dict[str, Any]: ...

def export_formats() -> list[tuple[str, str]]: ...
def export_files(
    material: Material,
    formats: list[str],
    mm_per_unit: float,
    goal: str,
    gaussians: int,
    channels: Optional[str],
    g: Optional[float],
    ior: Optional[float],
    glb: bytes,
    scatter: bool,
    callback: _Callback,
) -> list[tuple[dict[str, bytes], list[str], dict[str, Any]]]: ...
def import_text(
    source: str,
    blender: str,
    color: list[float],
    radius: list[float],
    scale: float,
    g: float,
    ior: float,
    roughness: float,
    mm_per_unit: float,
    callback: _Callback,
) -> str: ...
