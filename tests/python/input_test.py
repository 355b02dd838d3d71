# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Wrong input: an exception with place, expectation and value, whatever it is; never a crash."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any, Callable

import lamina
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

WAX: dict[str, Any] = {
    "length_unit": "mm",
    "bands": "rgb",
    "layers": [{"sigma_a": 0.1, "sigma_s": 5.0, "g": 0.5, "ior": 1.4, "thickness": "infinite"}],
}


def layer(**changes: Any) -> dict[str, Any]:
    return {**WAX, "layers": [{**WAX["layers"][0], **changes}]}


HIDDEN = np.ma.masked_greater(np.array([0.1, 5.0]), 1.0)

REFUSED: list[tuple[Callable[[], Any], str]] = [
    (lambda: lamina.layers(sigma_a=HIDDEN, sigma_s=1, thickness=1), "sigma_a: must have no masked elements"),
    (lambda: lamina.skin_colors(melanin=HIDDEN), "melanin: must have no masked elements"),
    (lambda: lamina.fresnel(HIDDEN, 1.4), "must have no masked elements"),
    (lambda: lamina.mie_sphere(1.0, [HIDDEN, HIDDEN]), "relative_ior: must have no masked elements"),
    (lambda: lamina.material(layer(sigma_a=HIDDEN)), "sigma_a: must have no masked elements"),
    (lambda: lamina.patch(melanin=np.ma.masked_less(np.full((2, 2), 0.1), 0.2)), "must have no masked elements"),
    (lambda: lamina.acquire({"images": [
        {"image": np.ma.masked_less(np.full((4, 4, 3), 0.3), 0.5), "encoding": "linear", "sensor": "srgb"}]}),
     "image: must have no masked elements"),
    (lambda: lamina.slab("jadx"), 'no file "jadx"; did you mean "jade"'),
    (lambda: lamina.slab(3), "material: must be a name, path, dict or Material, but is int"),
    (lambda: lamina.slab("jade", method="difusion"), 'did you mean "diffusion"'),
    (lambda: lamina.slab("jade", method=None), "method: must be one of"),
    (lambda: lamina.slab("jade", accuracy=3), "accuracy: must be in [1e-10, 0.1], but is 3"),
    (lambda: lamina.slab("jade", accuracy="fine"), "accuracy: must be in"),
    (lambda: lamina.slab("jade", accuracy=math.nan), "but is nan"),
    (lambda: lamina.slab("jade", accuracy=True), "accuracy: must be in"),
    (lambda: lamina.slab("jade", incidence=90), "incidence: must be normal, diffuse or an angle"),
    (lambda: lamina.slab("jade", incidence="difuse"), "but is 'difuse'"),
    (lambda: lamina.slab("jade", derivatives=1), "derivatives: must be True or False, but is 1"),
    (lambda: lamina.slab("jade", photons=10), 'photons: is for method="monte_carlo"'),
    (lambda: lamina.slab("jade", method="monte_carlo", photons=0.5), "must be a whole number"),
    (lambda: lamina.slab("jade", method="monte_carlo", photons=math.inf), "but is inf"),
    (lambda: lamina.slab("jade", method="monte_carlo", seed=-1), "seed: must be a whole number"),
    (lambda: lamina.slab("jade", method="monte_carlo", seed=2**64), "seed: must be a whole"),
    (lambda: lamina.slab("jade", progress=3), "progress: must be None, True, False or a function"),
    (lambda: lamina.slab("jade", wavelengths=[500]), "cannot be had at other wavelengths"),
    (lambda: lamina.slab(lamina.skin(), wavelengths=[500]), "wavelengths: must be left out"),
    (lambda: lamina.profile("jade", r_min=2, r_max=1), "r_max: must be > r_min"),
    (lambda: lamina.profile("jade", radii=1), "radii: must be a whole number in [2, 100000]"),
    (lambda: lamina.profile("jade", incidence=30), "`oblique_profile`"),
    (lambda: lamina.profile("jade", lit_from="left"), "lit_from: must be one of above, below"),
    (lambda: lamina.profile("jade", lit_from="below"), "light from below needs a finite last layer"),
    (lambda: lamina.profile("jade", method="dipole", accuracy=0.01), "accuracy: is for method"),
    (lambda: lamina.spatial_frequency("jade", [1.0, 0.5]), "k: must be ascending"),
    (lambda: lamina.spatial_frequency("jade", [-1.0]), "k[0]: must be in [0, 1000000000] 1/mm"),
    (lambda: lamina.gaussians("jade", 0), "count: must be a whole number in [1, 40]"),
    (lambda: lamina.oblique_profile("jade", 90), "angle: must be in [0, 90) degrees"),
    (lambda: lamina.material({"nam": 1}), 'unknown key "nam"; did you mean "name"?'),
    (lambda: lamina.material(layer(sigma_a=-1)), "layers[0].sigma_a must be >= 0 [1/mm], but is -1"),
    (lambda: lamina.material(layer(sigma_a=math.nan)), "sigma_a: must be a finite number, but is nan"),
    (lambda: lamina.material(layer(sigma_a=-math.inf)), "must be a finite number, but is -inf"),
    (lambda: lamina.material(layer(sigma_a={1: 2})), "keys must be text, but one is 1"),
    (lambda: lamina.material(layer(sigma_a=1j)), "but is complex"),
    (lambda: lamina.material(layer(sigma_a=[1, 2])), "must"),
    (lambda: lamina.material(layer(thickness=-math.inf)), "must be a finite number"),
    (lambda: lamina.material([WAX]), "but is list"),
    (lambda: lamina.material("a\0b"), "material: must be"),
    (lambda: lamina.material(b"jade"), "but is bytes"),
    (lambda: lamina.material_text("jadx"), "jade"),
    (lambda: lamina.skin(melanin=[0.1, 3]), "melanin[1]: must be in [0, 0.5], but is 3"),
    (lambda: lamina.skin(melanin=math.nan), "melanin: must be in [0, 0.5], but is nan"),
    (lambda: lamina.skin(constants="papr"), 'did you mean "paper"'),
    (lambda: lamina.skin(melanin="dark"), "melanin: must be numbers, but is 'dark'"),
    (lambda: lamina.skin(melanin=np.array(["a"])), "melanin: must be numbers, but is an array of"),
    (lambda: lamina.skin(melanin=np.array([1j])), "but is an array of complex128"),
    (lambda: lamina.skin(melanin=[]), "must hold numbers, but has the shape (0,)"),
    (lambda: lamina.skin(melanin=[[0.1], [0.1, 0.2]]), "melanin: must be numbers"),
    (lambda: lamina.skin(melanin=[0.1] * 2, carotene=[0.0] * 3), "melanin (2,), carotene (3,)"),
    (lambda: lamina.skin(wavelengths=[300]), "wavelengths[0]: must be in [350, 1000] nm"),
    (lambda: lamina.skin(wavelengths=[500, 400]), "must be ascending"),
    (lambda: lamina.leaf(wavelengths=300), "must be in [400, 1000] nm, but is 300"),
    (lambda: lamina.skin_colors(junction_absorption=-1.0), "junction_absorption: must be in"),
    (lambda: lamina.layers(sigma_a=-1, sigma_s=1), "sigma_a: must be in [0, 1000000000] 1/mm"),
    (lambda: lamina.layers(sigma_a=[1, 2], sigma_s=[1, 2, 3]), "sigma_a (2,), sigma_s (3,)"),
    (lambda: lamina.layers(sigma_a=1, sigma_s=1, g=1), "g: must be in (-1, 1), but is 1"),
    (lambda: lamina.layers(sigma_a=1, sigma_s=1, thickness=0), "thickness: must be in (0, "),
    (lambda: lamina.layers(sigma_a=[1, 1], sigma_s=1), "layer 0: thickness must be finite"),
    (lambda: lamina.layers(sigma_a=1, sigma_s=1, ior_below=1.3, ior=1.5), "ior_below: must be left out under an infinite layer"),
    (lambda: lamina.layers(sigma_a=1, sigma_s=1, phase="mie"), "phase: must be one of"),
    (lambda: lamina.layers(sigma_a=1, sigma_s=1, phase=["rayleigh"] * 2), "must be one or 1"),
    (lambda: lamina.layers(sigma_a=1, sigma_s=1, names=["a", "b"]), "names: must be 1 texts"),
    (lambda: lamina.layers(sigma_a=1, sigma_s=1, wavelengths=[500]), "wavelengths: must be as many"),
    (lambda: lamina.set_threads(-1), "count: must be a whole number in [0, 4096]"),
]


@pytest.mark.parametrize(("call", "message"), REFUSED)
def test_is_refused_in_words(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(lamina.InvalidInput) as refused:
        call()
    text = str(refused.value)
    assert message in text
    assert "\n" not in text
    assert isinstance(refused.value, ValueError) and isinstance(refused.value, lamina.Error)


def test_names_the_stack_that_is_wrong() -> None:
    with pytest.raises(lamina.InvalidInput, match=r"^\[1\]: layer 0: diffusion requires sigma_s > 0"):
        lamina.slab(lamina.layers(sigma_a=0.1, sigma_s=[[1.0], [0.0]]), method="diffusion")


def test_a_missing_file_is_an_os_error() -> None:
    with pytest.raises(OSError, match="there is no such file") as missing:
        lamina.material("nowhere/skin.json")
    assert isinstance(missing.value, lamina.FileError)


def test_arrays_of_any_kind_are_taken() -> None:
    """Integers, floats of half size, backwards, read-only, Fortran's order: the same numbers."""
    scatter = np.broadcast_to(np.array([3.0, 4.0])[:, None], (2, 1))
    plain = lamina.slab(lamina.layers(sigma_a=[[1.0], [2.0]], sigma_s=scatter)).diffuse_reflectance
    frozen = np.array([[1], [2]])
    frozen.setflags(write=False)
    kinds = (
        frozen,
        np.array([[2], [1]])[::-1],
        np.array([[1, 2]], dtype=np.float16).T,
        np.asfortranarray(np.array([[1.0], [2.0]])),
    )
    for sigma_a in kinds:
        found = lamina.slab(lamina.layers(sigma_a=sigma_a, sigma_s=scatter)).diffuse_reflectance
        assert (found == plain).all()


ANYTHING = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=5),
    st.binary(max_size=3),
    st.lists(st.floats(), max_size=3),
    st.dictionaries(st.text(max_size=3), st.floats(), max_size=2),
    st.complex_numbers(),
)
OF_LAYERS = (
    "sigma_a", "sigma_s", "g", "ior", "thickness", "roughness", "phase", "distribution", "ior_above",
    "ior_below", "ground_reflectance", "names", "axes", "wavelengths",
)  # fmt: skip


@settings(max_examples=300, deadline=None, database=None)
@given(st.fixed_dictionaries({}, optional={name: ANYTHING for name in OF_LAYERS}))
def test_anything_makes_layers_or_is_refused(arguments: dict[str, Any]) -> None:
    arguments = {"sigma_a": 0.1, "sigma_s": 1.0, **arguments}
    try:
        made = lamina.layers(**arguments)
    except lamina.InvalidInput:
        return
    assert np.isfinite(made.sigma_a).all() and (made.thickness > 0).all()


@settings(max_examples=300, deadline=None, database=None)
@given(ANYTHING, st.sampled_from(("sigma_a", "sigma_s", "g", "ior", "thickness", "name", "mixture")))
def test_anything_makes_a_material_or_is_refused(value: Any, key: str) -> None:
    try:
        made = lamina.material(layer(**{key: value}))
    except lamina.InvalidInput:
        return
    assert np.isfinite(made.layers.sigma_a).all()


MAPS = {"melanin": np.full((4, 6), 0.02), "mm_per_pixel": 0.1}
SURROGATE = "half_\ud800"
NO_TEXT: dict[str, Callable[[Any], object]] = {
    "material": lambda text: lamina.material(text),
    "path": lambda text: lamina.load_image(text),
    "capture": lambda text: lamina.acquire(text),
    "scene": lambda text: lamina.render(text),
    "folder": lambda text: lamina.maps({"width": 8}, folder=text),
    "number": lambda text: lamina.edit(MAPS, "scale", 1.2, number=text),
    "population": lambda text: lamina.persons(MAPS, 2, population=text),
    "numbers[0]": lambda text: lamina.filters(numbers=[text]),
    "names[0]": lambda text: lamina.layers(sigma_a=0.1, sigma_s=1.0, names=[text]),
    "channels[0]": lambda text: lamina.save_image("saved.exr", np.ones((2, 2, 1)), channels=[text]),
}


@pytest.mark.parametrize("name", NO_TEXT)
@pytest.mark.parametrize("text", [SURROGATE, "a\0b", "x" * 10000], ids=["surrogate", "zero", "long"])
def test_names_and_paths_are_text(name: str, text: str) -> None:
    with pytest.raises(lamina.InvalidInput, match=f"^{re.escape(name)}: must be") as refused:
        NO_TEXT[name](text)
    assert "\n" not in str(refused.value) and len(str(refused.value)) < 300


def test_the_module_of_another_python_is_named(tmp_path: Path) -> None:
    from lamina import _built_for

    (tmp_path / "_lamina.cpython-399-x86_64-linux-gnu.so").touch()
    found = str(_built_for.refusal(tmp_path))
    assert found.startswith("lamina: is built for Python 3.99, but this is cpython 3.") and "\n" not in found
    (tmp_path / "_lamina.cpython-399-x86_64-linux-gnu.so").unlink()
    assert "is not here" in str(_built_for.refusal(tmp_path))


def test_masks_that_hide_nothing_do_not_count() -> None:
    open_mask = np.ma.masked_array([0.1, 0.2], mask=[False, False])
    assert lamina.skin_colors(melanin=open_mask).reflectance.shape[0] == 2


def test_unknown_arguments_say_what_may_be_meant() -> None:
    with pytest.raises(TypeError, match="unexpected keyword argument 'incidense'; did you mean \"incidence\""):
        lamina.slab("jade", incidense="diffuse")  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="unexpected keyword argument 'zzz'$"):
        lamina.profile("jade", zzz=1)  # type: ignore[call-arg]


def test_natives_are_not_made_by_hand() -> None:
    """Without a value they would crash whatever reads them."""
    natives = [each for each in vars(lamina._lamina).values() if isinstance(each, type)
               and type(each).__name__ == "pybind11_type"]
    assert len(natives) >= 7
    for native in natives:
        for make in (native, lambda native=native: native.__new__(native), lambda native=native: object.__new__(native)):
            with pytest.raises(TypeError):
                make()
