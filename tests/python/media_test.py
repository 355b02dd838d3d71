# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Parts of the library by themselves: laws of each, and wrong input."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any, Callable

import lamina
import numpy as np
import pytest

COMMAND = Path(lamina.__file__).resolve().parents[2] / "lamina"

NODES, WEIGHTS = np.polynomial.legendre.leggauss(200)


@pytest.mark.parametrize(("kind", "g"), [("henyey_greenstein", 0.7), ("henyey_greenstein", -0.3), ("rayleigh", 0.0)])
def test_phase_functions_have_their_moments(kind: str, g: float) -> None:
    values = 2.0 * np.pi * WEIGHTS * lamina.phase_function(NODES, g, kind=kind)
    moments = lamina.phase_moments(g, 6, kind=kind)
    for i in range(6):
        legendre = np.polynomial.legendre.Legendre.basis(i)(NODES)
        assert float((values * legendre).sum()) == pytest.approx(moments[i], abs=1e-12)


def test_the_phase_function_of_a_sphere_has_its_mean_cosine() -> None:
    values = 2.0 * np.pi * WEIGHTS * lamina.mie_phase(NODES, 5.0, 1.4 + 0.01j)
    assert values.sum() == pytest.approx(1.0, abs=1e-9)
    assert (values * NODES).sum() == pytest.approx(float(lamina.mie_sphere(5.0, 1.4 + 0.01j).g), abs=1e-9)


def test_a_medium_has_the_look_that_was_asked_for() -> None:
    wanted, spread = np.array([0.1, 0.5, 0.9]), 2.0
    media = lamina.medium_from_look(wanted, spread, g=0.5, ior=1.3)
    reduced = media.sigma_s * 0.5
    total = media.sigma_a + reduced
    assert 1.0 / np.sqrt(3.0 * media.sigma_a * total)[:, 0] == pytest.approx([spread] * 3, rel=1e-9)
    albedo = lamina.invert_dipole_albedo(wanted, 1.3).albedo_prime
    assert (reduced / total)[:, 0] == pytest.approx(albedo, rel=1e-9)
    # And the profile has it, of light that enters.
    total_reflectance = lamina.profile(media, method="dipole").total_reflectance
    assert total_reflectance == pytest.approx(wanted, rel=0.05)


def test_a_half_space_is_its_own_equivalent() -> None:
    one = lamina.layers(sigma_a=0.1, sigma_s=3.0, ior=1.4)
    same = lamina.equivalent_half_space(one)
    assert same.sigma_a == pytest.approx(one.sigma_a, rel=1e-4)
    assert same.sigma_s * (1 - same.g) == pytest.approx(one.sigma_s, rel=1e-4)


def test_pulses_fall_as_absorption_has_it() -> None:
    """Absorption takes exp(-sigma_a c t / n) of what would arrive at t, whatever the way."""
    t = np.array([300.0, 600.0])
    clear = lamina.pulsed(lamina.layers(sigma_a=0.0, sigma_s=1.0, ior=1.4), [8.0], t).reflectance
    dark = lamina.pulsed(lamina.layers(sigma_a=0.01, sigma_s=1.0, ior=1.4), [8.0], t).reflectance
    assert dark / clear == pytest.approx(np.exp(-0.01 * 0.299792458 / 1.4 * t)[None], rel=1e-6)


def test_a_white_sample_reads_as_the_standard() -> None:
    white = lamina.sphere_reading(0.99, diffuse_reflectance=0.99, standard_reflectance=0.99)
    assert white.value == pytest.approx(0.99)
    steps = [float(lamina.sphere_reading(0.5 + h, diffuse_reflectance=0.4).value) for h in (-1e-4, 1e-4)]
    slope = (steps[1] - steps[0]) / 2e-4
    assert lamina.sphere_reading(0.5, diffuse_reflectance=0.4).by_scattered == pytest.approx(slope, rel=1e-6)


def test_less_light_is_lost_by_wide_ports() -> None:
    milk = lamina.layers(sigma_a=0.01, sigma_s=5.0, g=0.8, ior=1.35, thickness=2.0)
    lost = [lamina.lost_light(milk, port_diameter=d, photons=2e4) for d in (2.0, 20.0)]
    assert lost[0].reflected > lost[1].reflected + 5.0 * lost[0].reflected_error
    assert lost[0].transmitted > lost[1].transmitted


def test_a_smooth_boundary_reflects_by_fresnel() -> None:
    cosine = np.linspace(0.3, 1.0, 5)
    found = lamina.rough_interface(0.0, 1.5, cosine=cosine)
    assert found.reflectance == pytest.approx(lamina.fresnel(cosine, 1.5), abs=2e-3)
    whole = lamina.rough_interface(0.4, 1.5, masking="smith_multiple", cosine=cosine)
    assert whole.reflectance + whole.transmittance == pytest.approx(np.ones(5), abs=2e-3)
    assert found._repr_html_()


def test_rough_surfaces_are_those_of_the_command() -> None:
    if not COMMAND.exists():
        pytest.skip(f"there is no command at {COMMAND}")
    done = subprocess.run([str(COMMAND), "bsdf", "--model", "rough_transmission", "--eta", "1.5", "--smoothness", "4",
                           "--theta-i", "30", "--json", "-"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    printed = json.loads(done.stdout)
    found = lamina.rough_surface(4.0, 1.5, 30)
    btdf = np.array(printed["btdf"]).squeeze()
    assert found.btdf == pytest.approx(btdf if btdf.shape == (45, 18) else btdf.T, rel=1e-9)
    assert found.transmittance[0] == pytest.approx(printed["transmittance"][0], rel=1e-9)
    by_chance = lamina.rough_surface(4.0, 1.5, 30, method="height_field", rays=20000, realizations=2)
    assert by_chance.transmittance[0] + by_chance.reflectance[0] == pytest.approx(1.0, abs=0.01)


def test_photons_through_even_maps_are_photons() -> None:
    even = lamina.layers(sigma_a=np.full((3, 4, 1), 0.1), sigma_s=4.0, ior=1.3, thickness=2.0)
    found = lamina.patch_photons(even, 1.0, photons=4e4)
    exact = lamina.slab(even).diffuse_reflectance[0, 0]
    error = np.sqrt((found.light_error**2).sum()) / 12.0
    assert abs(found.light.mean() - exact) < 5.0 * error < 0.05


def test_the_patch_is_that_of_photons() -> None:
    """Skin with a dark stripe: sums over it, within noise and the patch's own error."""
    melanin = np.full((4, 16), 0.01)
    melanin[:, 6:10] = 0.15
    skin = lamina.skin(melanin=melanin, wavelengths=[600])
    truth = lamina.patch_photons(skin, 0.5, photons=2e5, incidence="normal")
    light = lamina.patch(melanin=melanin, mm_per_pixel=0.5, wavelengths=[600]).light[..., 0]
    dark, bright = slice(7, 9), [0, 1, 14, 15]
    assert light[:, dark].mean() / light[:, bright].mean() == pytest.approx(
        truth.light[:, dark].mean() / truth.light[:, bright].mean(), rel=0.08)


def test_vessels_take_light() -> None:
    dermis = lamina.layers(sigma_a=0.02, sigma_s=10.0, g=0.8, ior=1.4)
    vein = {"x": 2.0, "depth": 1.0, "radius": 0.4, "sigma_a": 2.0, "sigma_s": 20.0, "g": 0.95}
    found = lamina.cylinder_photons(dermis, [vein], width=4.0, length=1.0, columns=8, photons=2e4)
    total = (found.specular_reflectance + found.diffuse_reflectance + found.transmittance + found.through_sides
             + found.absorptance.sum() + found.absorptance_of_cylinders.sum())
    assert total == pytest.approx(1.0, abs=0.02)
    assert found.reflectance_by_column[3:5].mean() < found.reflectance_by_column[[0, 7]].mean()
    assert found.reflectance_by_column.sum() == pytest.approx(found.diffuse_reflectance, rel=1e-6)


def test_pictures_are_compared_with_their_noise() -> None:
    random = np.random.default_rng(1)
    mean, variance = np.full((24, 24, 3), 0.5), np.full((24, 24, 3), 1e-4)
    one, other = (mean + 0.01 * random.standard_normal(mean.shape) for _ in range(2))
    assert lamina.compare_pictures((one, variance), (other, variance)).agrees
    biased = lamina.compare_pictures((one, variance), (other + 0.002, variance))
    assert not biased.agrees and biased.bias_z < -4 or biased.bias_z > 4
    broken = other.copy()
    broken[5, 7] += 0.2
    found = lamina.compare_pictures((one, variance), (broken, variance))
    assert not found.agrees and found.differing == 3 and found.p_values.argmin() == 5 * 24 + 7


def test_parts_of_envi_files_are_read(tmp_path: Path) -> None:
    cube = np.arange(4 * 5 * 6, dtype="<f4").reshape(6, 4, 5)  # band, y, x
    (tmp_path / "cube.raw").write_bytes(cube.tobytes())
    nm = ", ".join(str(500 + 10 * i) for i in range(6))
    (tmp_path / "cube.hdr").write_text(
        "ENVI\nsamples = 5\nlines = 4\nbands = 6\nheader offset = 0\ndata type = 4\ninterleave = bsq\nbyte order = 0\n"
        f"wavelength units = nm\nwavelength = {{{nm}}}\n")
    whole, channels = lamina.load_image(tmp_path / "cube.hdr")
    assert whole.shape == (4, 5, 6) and (whole == np.moveaxis(cube, 0, -1)).all() and channels[0] == "500nm"
    part, names = lamina.load_image(tmp_path / "cube.hdr", bands=[520, 540], rectangle=[1, 2, 3, 1])
    assert (part == whole[2:3, 1:4, [2, 4]]).all() and names == ("520nm", "540nm")
    means, _ = lamina.load_image(tmp_path / "cube.hdr", bands=[520], widths=25)
    assert means[..., 0] == pytest.approx(whole[..., 1:4].mean(axis=-1))


def test_a_table_of_a_paper_is_made_again(tmp_path: Path) -> None:
    if not COMMAND.exists():
        pytest.skip(f"there is no command at {COMMAND}")
    assert {"dj05.table1", "hk93.fig2"} <= {item.id for item in lamina.reproductions()}
    item = {
        "paper": "hery_2003", "id": "hery03.mirror", "title": "A mirror", "shows": "What glass reflects.",
        "inputs": [{"what": "glass of index 1.5"}],
        "files": [{"name": "glass.json", "content": {
            "lamina": "material", "version": 1, "length_unit": "mm", "bands": [550], "ior_below": 1.5,
            "layers": [{"sigma_a": 0, "sigma_s": 0, "g": 0, "ior": 1.5, "thickness": 1}]}}],
        "runs": [{"name": "glass", "command": "slab glass.json"}],
        "numbers": [{"text": "reflectance", "value": "glass.specular_reflectance", "expected": 0.04, "from": "Fresnel",
                     "within": 1e-6}],
    }  # fmt: skip
    found = lamina.reproduce(item, folder=tmp_path)
    assert found.verdict == "agrees" and found.numbers[0].holds and found.numbers[0].value == pytest.approx(0.04)
    assert "A mirror" in found.html and "reflectance" in found._repr_html_()
    found.save(tmp_path / "page.html")
    wrong = {**item, "runs": [{"name": "glass", "command": "slab glas.json"}]}
    with pytest.raises(lamina.InvalidInput, match="glas.json"):
        lamina.reproduce(wrong)
    with pytest.raises(lamina.InvalidInput, match='did you mean "dj05.table1"'):
        lamina.reproduce("dj05.tabel1")


MILK = lamina.layers(sigma_a=0.01, sigma_s=5.0, g=0.8, ior=1.35, thickness=2.0)

WRONG: list[tuple[Callable[[], Any], str]] = [
    (lambda: lamina.phase_function(2.0), "cos_theta: must be in [-1, 1], but is 2"),
    (lambda: lamina.phase_function(0.0, 1.0), "g: must be in (-1, 1)"),
    (lambda: lamina.phase_function(0.0, kind="mie"), "kind: must be one of"),
    (lambda: lamina.phase_moments(0.0, 0), "count: must be a whole number in [1, 10000]"),
    (lambda: lamina.mie_phase([0.0], 3.0, [1.2, 1.3]), "relative_ior: must be one number"),  # type: ignore[arg-type]
    (lambda: lamina.medium_from_look(1.0, 1.0), "reflectance: must be in [0, 1)"),
    (lambda: lamina.medium_from_look(0.5, 0.0), "diffuse_mfp: must be in (0, 1000000000] mm"),
    (lambda: lamina.medium_from_look([0.5, 0.6], [1, 2, 3]), "shapes must broadcast together"),
    (lambda: lamina.pulsed("jade", -1, 1), "r: must be in (0, 1000000] mm"),
    (lambda: lamina.pulsed("jade", [[1.0]], 1), "r: must be numbers in one row"),
    (lambda: lamina.pulsed(lamina.layers(sigma_a=1, sigma_s=0), 1, 1), "requires sigma_s > 0"),
    (lambda: lamina.sphere_reading(2.0, diffuse_reflectance=0.5), "scattered: must be in [0, 1]"),
    (lambda: lamina.sphere_reading(0.5, diffuse_reflectance=0.5, sample_port=200), "port"),
    (lambda: lamina.sphere_reading(0.5, diffuse_reflectance=0.5, baffle=1), "baffle: must be True or False"),  # type: ignore[arg-type]
    (lambda: lamina.lost_light(MILK, port_diameter=1, beam_diameter=2), "beam_diameter: must be <= port_diameter"),
    (lambda: lamina.rough_interface(2.0, 1.5), "roughness: must be in [0, 1]"),
    (lambda: lamina.rough_surface(6.0, 1.0, 30), "eta: must not be 1"),
    (lambda: lamina.rough_surface(6.0, 1.5, 89.5, method="height_field"), "theta_i: must be in [0, 89]"),
    (lambda: lamina.rough_surface(6.0, 1.5, 30, visibility="smith"), "visibility: is for method"),
    (lambda: lamina.patch_photons(MILK, 1.0), "layers: must have the shape (y, x)"),
    (lambda: lamina.patch_photons(3, 1.0), "layers: must be Layers"),  # type: ignore[arg-type]
    (lambda: lamina.patch_photons(lamina.layers(sigma_a=0.1, sigma_s=np.arange(1.0, 5).reshape(2, 2, 1)), 1.0),
     "layers must differ in sigma_a only"),
    (lambda: lamina.patch_photons(lamina.layers(sigma_a=np.ones((2, 2, 1)), sigma_s=1), 1.0, light=0), "light: must not be 0"),
    (lambda: lamina.cylinder_photons(MILK, [{"x": 1.0}], width=2, length=2), "cylinders[0]: must have depth"),
    (lambda: lamina.cylinder_photons(MILK, [{"x": 1.0, "dept": 1.0}], width=2, length=2), 'did you mean "depth"'),
    (lambda: lamina.cylinder_photons(MILK, [{"x": 1.0, "depth": 0.1, "radius": 1.0}], width=2, length=2), "cylinder"),
    (lambda: lamina.cylinder_photons("jade", [], width=2, length=2), "material: must be one stack"),
    (lambda: lamina.compare_pictures(3, 4), "first: must be a Picture"),  # type: ignore[arg-type]
    (lambda: lamina.compare_pictures((np.ones((2, 2)), -np.ones((2, 2))), (np.ones((2, 2)), np.ones((2, 2)))), "variance[0, 0]"),
    (lambda: lamina.compare_pictures((np.ones((2, 2)), np.ones((2, 2))), (np.ones((2, 3)), np.ones((2, 3)))), "of one size"),
    (lambda: lamina.load_image("none.hdr", bands=[500], widths=10, shape="nearest"), "widths: must be > 0 of box"),
    (lambda: lamina.load_image("none.hdr", rectangle=[1, 2]), "rectangle: must be x, y, width, height"),
    (lambda: lamina.reproduce("x.json", quality="best"), "quality: must be one of"),
]


@pytest.mark.parametrize(("call", "message"), WRONG)
def test_wrong_input_is_refused(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(lamina.InvalidInput) as refused:
        call()
    assert message in str(refused.value)


def test_materials_are_exported_as_the_command_does(tmp_path: Path) -> None:
    if not COMMAND.exists():
        pytest.skip(f"there is no command at {COMMAND}")
    found = lamina.export("marble", "mcml")
    assert isinstance(found, lamina.Exported)
    paths = found.save(tmp_path / "ours")
    subprocess.run([str(COMMAND), "export", "marble", "--to", "mcml"], cwd=tmp_path, check=True, capture_output=True)
    for path in paths:
        assert Path(path).read_bytes() == (tmp_path / Path(path).name).read_bytes()
    with pytest.raises(lamina.InvalidInput, match='did you mean "mcml"'):
        lamina.export("marble", "mcmll")
