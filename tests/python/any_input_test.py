# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Whatever is given in place of one argument, or of one key of a dict: a result, or a refusal in one line."""

from __future__ import annotations

import copy
import fractions
import inspect
import os
import re
import time
from pathlib import Path
from typing import Any, Callable

import lamina
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

SOURCE = Path(os.environ.get("LAMINA_SOURCE", Path(__file__).parents[2]))
PLATE = lamina.layers(sigma_a=0.1, sigma_s=5.0, g=0.5, ior=1.4, thickness=0.5)
ABSORBER = {"sigma_a": 0.1, "sigma_s": 5.0, "g": 0.5, "ior": 1.4, "thickness": 0.5}
PLATE_FILE = {"lamina": "material", "version": 1, "length_unit": "mm", "bands": [600], "ior_below": 1, "layers": [ABSORBER]}
FLAT = np.full((4, 6), 0.02)
CAPTURE = {"mm_per_pixel": 0.2, "population": "none", "numbers": ["melanin", "hemoglobin_dermis"],
           "images": [{"image": np.full((4, 6, 3), 0.4), "encoding": "linear", "sensor": "srgb"}]}  # fmt: skip
MEASUREMENT = {
    "material": PLATE_FILE, "free": [{"parameter": "layers[0].sigma_a", "per_band": True, "low": 1e-4, "high": 10.0}],
    "measured": [{"kind": "totals", "wavelength_nm": [600], "reflectance": [0.3], "unit": "fraction",
                  "specular": "included", "sd": 0.005}]}  # fmt: skip
SCENE = {
    "mm_per_unit": 10, "camera": {"position": [0, 0, 6], "look_at": [0, 0, 0], "horizontal_fov": 30},
    "film": {"width": 4, "height": 4},
    "materials": {"cloth": {"diffuse": {"map": np.full((2, 2, 3), 0.5), "encoding": "linear"}}},
    "meshes": [{"vertices": np.eye(3), "faces": np.array([[0, 1, 2]]), "uvs": np.eye(3)[:, :2], "material": "cloth"}],
    "lights": [{"type": "environment", "radiance": 1}]}  # fmt: skip
SPOTTED = {"width": 8, "height": 6, "mm_per_pixel": 0.2, "seed": 3, "skin": {"melanin": 0.01}, "features": [{"unevenness": {}}]}
PATCH = {"bands": [550], "skin": {"melanin": {"map": FLAT, "encoding": "linear"}}, "mm_per_pixel": 0.2}
SPECTRUM = np.linspace(400.0, 700.0, 5)

# Of each function arguments with which it takes milliseconds.
CALLS: dict[str, dict[str, Any]] = {
    "acquire": dict(capture=CAPTURE, lateral="none"),
    "bsdf": dict(material=PLATE, theta_i=30.0, theta_o=[0.0, 40.0], phi=[0.0, 180.0], method="first_order"),
    "color_difference": dict(first=[0.5, 0.4, 0.3], second=[[0.5, 0.4, 0.2]]),
    "compare_pictures": dict(first=(FLAT, 1e-4 + 0 * FLAT), second=(FLAT, 1e-4 + 0 * FLAT), significance=0.01),
    "cylinder_photons": dict(material=PLATE, cylinders=[{"x": 0.5, "depth": 0.2, "radius": 0.1, "sigma_a": 5.0, "sigma_s": 1.0,
                                                        "g": 0.5}], width=1.0, length=1.0, columns=2, photons=100.0),
    "edit": dict(maps={"melanin": FLAT, "mm_per_pixel": 0.1}, kind="scale", amount=1.2, number="melanin",
                 mask=np.ones((4, 6)), strength=0.5),
    "equivalent_half_space": dict(material=PLATE),
    "export": dict(material=PLATE_FILE, formats=["mcml"]),
    "filters": dict(count=5, candidates=[420.0, 450.0, 500.0, 550.0, 600.0, 650.0], widths=10.0, noise=0.01),
    "fit": dict(measurement=MEASUREMENT),
    "fresnel": dict(cosine=[0.5, 1.0], eta=1.4),
    "fresnel_diffuse": dict(eta=[1.3, 1.4]),
    "gaussians": dict(material=PLATE, count=2),
    "half_space_color": dict(albedo=[0.2, 0.9], ior=1.4, g=0.5, roughness=0.2),
    "import_material": dict(source="openpbr", color=[0.5, 0.4, 0.3], radius=1.0, scale=2.0, g=0.5, ior=1.4, roughness=0.2,
                            blender="4", mm_per_unit=10.0),
    "invert": dict(color=[0.2, 0.5, 0.6], ior=1.4, g=0.0, roughness=0.1, radius=1.0),
    "invert_dipole_albedo": dict(reflectance=[0.2, 0.5], ior=1.3, ior_outside=1.0),
    "lab": dict(srgb_linear=[0.2, 0.3, 0.4]),
    "layers": dict(sigma_a=[0.1, 0.2], sigma_s=1.0, g=0.0, ior=1.4, thickness=[1.0, 2.0], roughness=0.1, ior_above=1.0,
                   ground_reflectance=0.5, ground_roughness=0.1, names=["a", "b"], phase="rayleigh"),
    "leaf": dict(chlorophyll=[30.0, 40.0], water=0.01, thickness=0.2, structure=1.5, wavelengths=[550.0]),
    "load_image": dict(path=SOURCE / "docs/images/arm.png"),
    "lost_light": dict(material=PLATE, port_diameter=10.0, beam_diameter=1.0, photons=100.0),
    "maps": dict(source=SPOTTED),
    "material": dict(what=PLATE_FILE),
    "mcml": dict(path="nowhere.mci"),
    "medium_from_look": dict(reflectance=[0.2, 0.5], diffuse_mfp=1.0, g=0.5, ior=1.4),
    "mie_bulk": dict(volume_fraction=[0.01, 0.02], median_radius=3e-4, ior=1.5, wavelength=550.0, sigma_log_radius=0.1),
    "mie_phase": dict(cos_theta=[-1.0, 0.5], size_parameter=2.0, relative_ior=1.4 + 0.01j),
    "mie_sphere": dict(size_parameter=[1.0, 2.0], relative_ior=1.4),
    "oblique_profile": dict(material=PLATE, angle=30.0, radii=4, moments=2),
    "patch": dict(melanin=FLAT, hemoglobin_dermis=0.01, light=1.0, mm_per_pixel=0.2, wavelengths=[550.0]),
    "patch_photons": dict(layers=lamina.layers(sigma_a=np.full((2, 3, 1), 0.1), sigma_s=5.0, thickness=1.0), mm_per_pixel=0.5,
                          light=np.ones((2, 3)), photons=100.0),
    "persons": dict(maps={"melanin": FLAT, "mm_per_pixel": 0.1}, count=2),
    "phase_function": dict(cos_theta=[-1.0, 0.5], g=0.5),
    "phase_moments": dict(g=[0.5, 0.6], count=3),
    "photons": dict(material=PLATE, photons=100.0, r=(4, 0.1), angles=3, log_r=(4, 0.01, 1.0), depth=(3, 0.1), bsdf=(2, 3),
                    path_length=(3, 1.0), time=(3, 1.0), frequencies=[0.0, 10.0], detectors=[0.5], detector_width=0.1,
                    directions=[(30.0, 0.0)]),
    "profile": dict(material=PLATE, method="dipole", r_min=0.1, r_max=2.0, radii=4),
    "pulsed": dict(material=PLATE, r=[1.0], t=[10.0, 20.0]),
    "render": dict(scene=SCENE, samples=1),
    "rough_interface": dict(roughness=0.3, eta=1.4, cosine=[0.5, 1.0]),
    "rough_surface": dict(smoothness=2.0, eta=1.4, theta_i=20.0),
    "save_image": dict(path="saved.exr", image=np.ones((3, 4, 3)), channels=["R", "G", "B"]),
    "skin": dict(melanin=[0.1, 0.2], hemoglobin_dermis=0.01, saturation_dermis=0.6, epidermis_thickness=0.1,
                 dermis_thickness=2.0, wavelengths=[550.0]),
    "skin_colors": dict(melanin=[0.1, 0.2], hemoglobin_dermis=0.01, saturation_dermis=0.6, wavelengths=[500.0, 600.0]),
    "slab": dict(material=PLATE, accuracy=1e-3),
    "snow": dict(grain_radius=[0.1, 0.2], density=300.0, thickness=50.0, soot=0.0, wavelengths=[550.0]),
    "spatial_frequency": dict(material=PLATE, k=[0.0, 1.0]),
    "spectrum_color": dict(wavelengths=SPECTRUM, spectrum=np.ones(5)),
    "sphere_reading": dict(scattered=[0.2, 0.5], straight=0.1, diffuse_reflectance=0.5, diameter=150.0, sample_port=20.0),
}  # fmt: skip
# Names and files only: tests of their own hold these to their messages.
WITHOUT = {"export_formats", "load_maps", "material_text", "materials", "reproduce", "reproductions", "set_threads", "threads"}


def _cycle() -> list[Any]:
    endless: list[Any] = []
    endless.append(endless)
    return endless


def _deep() -> list[Any]:
    deep: list[Any] = []
    for _ in range(3000):
        deep = [deep]
    return deep


def _read_only() -> np.ndarray[Any, Any]:
    array = np.array([0.1, 0.2])
    array.setflags(write=False)
    return array


ODD: list[Callable[[], Any]] = [
    lambda: None, lambda: True, lambda: 0, lambda: -1, lambda: 10**400, lambda: -(2**63), lambda: 1e300, lambda: 5e-324,
    lambda: float("nan"), lambda: float("inf"), lambda: -float("inf"), lambda: 1j, lambda: fractions.Fraction(1, 3),
    lambda: "", lambda: "infinite", lambda: "a\0b", lambda: "\ud800", lambda: "x" * 10000, lambda: b"\xff", lambda: object(),
    lambda: {}, lambda: {1: 2}, lambda: {"": 0.5}, lambda: {"map": None}, lambda: {0.1, 0.2}, lambda: range(3), lambda: (),
    lambda: [], lambda: [None], lambda: [[0.1], [0.1, 0.2]], lambda: ["0.1"], _cycle, _deep, lambda: iter([0.1]), lambda: len,
    lambda: np.float32(0.5), lambda: np.array(0.5), lambda: np.array([]), lambda: np.empty((0, 3)), lambda: np.array([np.nan, 0.1]),
    lambda: np.array([np.inf]), lambda: np.array([-0.1, 0.1]), lambda: np.array([1e308, 1e308]), lambda: np.array([2**63], np.uint64),
    lambda: np.array([True]), lambda: np.array(["a"]), lambda: np.array([1j]), lambda: np.array([None, 0.1]),
    lambda: np.array(["2020"], "M8[D]"), lambda: np.zeros(2, [("a", float)]), lambda: np.array([0.5, 0.25], ">f8"),
    lambda: np.array([0.5, 0.25], np.float16), lambda: np.array([1], np.int8), lambda: np.arange(20.0)[::-7] / 40,
    lambda: np.arange(12.0).reshape(3, 4)[::2, ::3] / 40, lambda: np.asfortranarray(np.full((4, 6), 0.1)), _read_only,
    lambda: np.ma.masked_array([0.1, 0.2], [True, False]), lambda: np.full((1,) * 20, 0.1), lambda: np.full((2, 3, 4, 5), 0.1),
    lambda: np.broadcast_to(0.1, (10**7, 10**7)), lambda: np.broadcast_to(np.float32(0.1), (10**9, 10**9)),
]  # fmt: skip
# By number, since Hypothesis cannot print all of them.
SOME = st.one_of(st.sampled_from(range(len(ODD))).map(lambda i: ODD[i]), st.one_of(
    st.floats(), st.integers(), st.text(max_size=5), st.lists(st.floats(-1.0, 2.0), max_size=4)).map(lambda v: lambda: v))


def call(name: str, arguments: dict[str, Any]) -> None:
    """Half a second of it at most, where there is something to stop."""
    function = getattr(lamina, name)
    begin = time.monotonic()
    if "progress" in inspect.signature(function).parameters:
        arguments = {"progress": lambda finished: time.monotonic() - begin < 0.2, **arguments}
    try:
        function(**arguments)
    except (lamina.Error, lamina.Interrupted) as refused:
        text = str(refused)
        assert text and "\n" not in text and len(text) < 1000, text
    except MemoryError as missing:
        assert "allocate" in str(missing)  # by NumPy, of arrays with 10^14 elements and more


@pytest.fixture(scope="module", autouse=True)
def elsewhere(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """save_image writes to any name."""
    before = os.getcwd()
    os.chdir(tmp_path_factory.mktemp("any"))
    yield
    os.chdir(before)


def test_every_function_is_here() -> None:
    functions = {name for name in lamina.__all__ if inspect.isfunction(getattr(lamina, name))}
    assert functions == CALLS.keys() | WITHOUT
    for name, arguments in CALLS.items():
        if name != "mcml":
            getattr(lamina, name)(**copy.deepcopy(arguments))


def known(name: str) -> list[str]:
    return [p for p in inspect.signature(getattr(lamina, name)).parameters if p not in ("progress", "seconds")]


SETTINGS = dict(deadline=None, database=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])


@pytest.mark.parametrize("name", CALLS)
@settings(max_examples=40, **SETTINGS)  # type: ignore[arg-type]
@given(st.data())
def test_any_argument_is_taken_or_refused(name: str, data: st.DataObject) -> None:
    which = data.draw(st.sampled_from(known(name)))
    call(name, {**CALLS[name], which: data.draw(SOME)()})


def places(value: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The paths of all values of a dict."""
    found = [at] if at else []
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        found += places(item, (*at, key))
    return found


FILES = {"material": "what", "render": "scene", "maps": "source", "acquire": "capture", "fit": "measurement"}


@pytest.mark.parametrize("name", [*FILES, "patch"])
@settings(max_examples=25, **SETTINGS)  # type: ignore[arg-type]
@given(st.data())
def test_any_value_in_a_dict_is_taken_or_refused(name: str, data: st.DataObject) -> None:
    source = copy.deepcopy(PATCH if name == "patch" else CALLS[name][FILES[name]])
    path = data.draw(st.sampled_from(places(source)))
    inside: Any = source
    for key in path[:-1]:
        inside = inside[key]
    if data.draw(st.booleans()):
        inside[path[-1]] = data.draw(SOME)()
    else:
        del inside[path[-1]]
    others = {k: v for k, v in CALLS[name].items() if k in ("samples", "lateral")}
    call(name, {**others, FILES.get(name, "source"): source})


BEYOND_JSON = [_cycle, _deep, lambda: "\ud800", lambda: float("nan"), lambda: 1j, lambda: {1: 2}, object, lambda: b"x", lambda: 10**400]


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("make", BEYOND_JSON)
def test_a_file_as_a_dict_holds_what_json_can(name: str, make: Callable[[], Any]) -> None:
    arguments = copy.deepcopy(CALLS[name])
    arguments[FILES[name]]["name"] = make()
    with pytest.raises(lamina.InvalidInput) as refused:
        getattr(lamina, name)(**arguments)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("name", FILES)
def test_an_unknown_key_is_named(name: str) -> None:
    arguments = copy.deepcopy(CALLS[name])
    arguments[FILES[name]]["colour_of_the_cat"] = 1
    with pytest.raises(lamina.InvalidInput, match="colour_of_the_cat"):
        getattr(lamina, name)(**arguments)


@pytest.mark.parametrize("value", [10**400, np.full((2, 3, 4, 5), 0.1), _cycle(), "x" * 10000], ids=lambda v: type(v).__name__)
def test_numbers_and_names_are_refused_in_one_short_line(value: Any) -> None:
    for function, arguments, name in (
            (lamina.bsdf, CALLS["bsdf"], "theta_i"), (lamina.slab, {"material": PLATE, "method": "monte_carlo"}, "seed"),
            (lamina.slab, CALLS["slab"], "method"), (lamina.export, CALLS["export"], "ior")):  # fmt: skip
        with pytest.raises(lamina.InvalidInput, match=f"^{name}: must be") as refused:
            function(**{**arguments, name: value})  # type: ignore[operator]
        assert "\n" not in str(refused.value) and len(str(refused.value)) < 300


@pytest.mark.parametrize("name", CALLS)
def test_an_unknown_argument_is_named(name: str) -> None:
    with pytest.raises(TypeError, match=re.escape("colour_of_the_cat")):
        getattr(lamina, name)(**CALLS[name], colour_of_the_cat=1)


def test_series_and_walks_without_end_are_refused() -> None:
    """They took all memory, or went on without hearing Ctrl-C."""
    with pytest.raises(lamina.InvalidInput, match="size parameter of at most 1e5"):
        lamina.mie_bulk(volume_fraction=0.1, median_radius=10.0, ior=1.5, wavelength=550.0, sigma_log_radius=1.5)
    with pytest.raises(lamina.InvalidInput, match="relative_ior: must have .* a magnitude <= 100"):
        lamina.mie_sphere(1.0, 1e9)
    with pytest.raises(lamina.InvalidInput, match=r"length: must be in \[0.001, 1000000\] mm, but is"):
        lamina.cylinder_photons(**{**CALLS["cylinder_photons"], "length": 5e-324})
