# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Phase functions, media by their look, short pulses, integrating spheres."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _lamina
from ._input import Doubles, Incidence, broadcast, doubles, flag, number, one_of, refuse, whole
from ._input import incidence as check_incidence
from ._lamina import InvalidInput
from ._layers import Layers
from ._materials import MaterialLike, layers_of
from ._optics import complexes
from ._progress import Progress, progress_of
from ._result import Array, Result, band_labels, quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_KINDS = ("henyey_greenstein", "rayleigh")


def phase_function(cos_theta: ArrayLike, g: ArrayLike = 0.0, *, kind: str = "henyey_greenstein") -> Doubles:
    """Density of scattered directions over the sphere [1/sr]; it integrates to 1.

    :param cos_theta: of the scattering angle, in [-1, 1]; 1 is straight on.
    :param g: mean cosine, in (-1, 1), of "henyey_greenstein".
    :param kind: "henyey_greenstein" or "rayleigh".
    :raises InvalidInput: naming what is out of its range.

    Source: Henyey & Greenstein 1941, Eq. 2; Chandrasekhar 1960, §3, Eq. 29.

    >>> import lamina
    >>> lamina.phase_function([1.0, -1.0], 0.5).round(4)
    array([0.4775, 0.0177])
    """
    one_of("kind", kind, _KINDS)
    arrays, _ = broadcast({
        "cos_theta": doubles("cos_theta", cos_theta, -1.0, 1.0), "g": doubles("g", g, -1.0, 1.0, closed="()")})
    return _lamina.phase_function(kind, arrays["cos_theta"], arrays["g"])[..., 0]


def phase_moments(g: ArrayLike = 0.0, count: int = 32, *, kind: str = "henyey_greenstein") -> Doubles:
    """Means of the Legendre polynomials over the scattering angle, axes (..., moment): 1, g, g² …

    :param g: mean cosine, in (-1, 1), of "henyey_greenstein".
    :param count: of moments from the 0th, in [1, 10000].
    :param kind: "henyey_greenstein" or "rayleigh".
    :raises InvalidInput: naming what is out of its range.

    >>> import lamina
    >>> lamina.phase_moments(0.5, 4)
    array([1.   , 0.5  , 0.25 , 0.125])
    """
    one_of("kind", kind, _KINDS)
    return _lamina.phase_moments(kind, doubles("g", g, -1.0, 1.0, closed="()"), whole("count", count, 1, 10000))


def mie_phase(cos_theta: ArrayLike, size_parameter: float, relative_ior: complex) -> Doubles:
    """Phase function of a sphere in unpolarized light [1/sr]; it integrates to 1.

    :param cos_theta: of the scattering angle, in [-1, 1].
    :param size_parameter: circumference over the wavelength in the medium, in (0, 1e5].
    :param relative_ior: index of the sphere over that of the medium; an imaginary part absorbs.
    :raises InvalidInput: naming what is out of its range.

    Source: Bohren & Huffman 1983, Eqs. 4.74, 4.77.

    >>> import lamina
    >>> lamina.mie_phase([1.0, -1.0], 3.0, 1.33).round(4)
    array([0.8411, 0.0041])
    """
    cosines = doubles("cos_theta", cos_theta, -1.0, 1.0)
    size = number("size_parameter", size_parameter, 0.0, 1e5, closed="(]")
    ior = complexes("relative_ior", relative_ior)
    if ior.ndim:
        raise refuse("relative_ior", "be one number", relative_ior)
    return _lamina.mie_phase(size, complex(ior), cosines.ravel().tolist()).reshape(cosines.shape)


class AlbedoInversion(NamedTuple):
    """A reduced albedo, and how far its reflectance is from what was asked."""

    albedo_prime: Doubles  #: in [0, 1]
    residual: Doubles  #: beyond 1e-12 no albedo gives so much, or so little


def invert_dipole_albedo(reflectance: ArrayLike, ior: ArrayLike = 1.0, *, ior_outside: ArrayLike = 1.0) -> AlbedoInversion:
    """The reduced albedo at which a half-space reflects so much by the dipole.

    :param reflectance: total diffuse reflectance of light that has entered, in [0, 1].
    :param ior: of the medium, in [0.1, 10].
    :param ior_outside: in [0.1, 10].
    :raises InvalidInput: naming what is out of its range.

    Source: the inverse of Jensen et al. 2001, Eq. 15. Exact inversions are `fit`'s.

    >>> import lamina
    >>> lamina.invert_dipole_albedo([0.2, 0.8], 1.4).albedo_prime.round(4)
    array([0.8134, 0.9982])
    """
    arrays, _ = broadcast({
        "reflectance": doubles("reflectance", reflectance, 0.0, 1.0), "ior": doubles("ior", ior, 0.1, 10.0),
        "ior_outside": doubles("ior_outside", ior_outside, 0.1, 10.0)})
    found = _lamina.invert_dipole_albedo(arrays["reflectance"], arrays["ior"], arrays["ior_outside"])
    return AlbedoInversion(found[..., 0], found[..., 1])


def medium_from_look(
    reflectance: ArrayLike,
    diffuse_mfp: ArrayLike,
    *,
    g: ArrayLike = 0.0,
    ior: ArrayLike = 1.4,
    ior_outside: ArrayLike = 1.0,
) -> Layers:
    """Half-spaces as artists ask for them, by their look, with the dipole.

    :param reflectance: total diffuse reflectance of light that has entered, in [0, 1).
    :param diffuse_mfp: how far diffused light spreads [mm], > 0.
    :param g: mean cosine that the medium shall have, in (-1, 1).
    :param ior: of the medium, in [0.1, 10].
    :param ior_outside: in [0.1, 10].
    :raises InvalidInput: naming what cannot be.

    Source: Jensen & Buhler 2002, §5; Hery 2003, §2.

    >>> import lamina
    >>> wax = lamina.medium_from_look([0.8, 0.6, 0.3], [2.0, 1.0, 0.5], ior=1.4)
    >>> wax.sigma_a[:, 0].round(3)
    array([0.012, 0.061, 0.345])
    """
    given = {
        "reflectance": doubles("reflectance", reflectance, 0.0, 1.0, closed="[)"),
        "diffuse_mfp": doubles("diffuse_mfp", diffuse_mfp, 0.0, 1e9, closed="(]", unit="mm"),
        "g": doubles("g", g, -1.0, 1.0, closed="()"),
        "ior": doubles("ior", ior, 0.1, 10.0),
        "ior_outside": doubles("ior_outside", ior_outside, 0.1, 10.0),
    }
    arrays, shape = broadcast(given)
    stacks = _lamina.medium_from_look(*(arrays[name] for name in given))
    return Layers(stacks, tuple(f"axis_{i}" for i in range(len(shape))), {}, ["medium"])


def equivalent_half_space(
    material: MaterialLike, *, wavelengths: ArrayLike | None = None, progress: Progress = None
) -> Layers:
    """The half-spaces that look most like layers if one layer must do: of the same reflectance, and
    falling to half of it at the same spatial frequency, by layered diffusion.

    :param material: a built-in name, a path, a dict, a `Material`, or `Layers` of any shape.
    :param wavelengths: [nm], in place of the material's own bands.
    :raises InvalidInput: naming what is wrong; Interrupted after Ctrl-C.

    >>> import lamina
    >>> lamina.equivalent_half_space("donner_jensen_skin").shape
    (3,)
    """
    layers = layers_of(material, wavelengths)
    with progress_of(progress, "half-spaces") as callback:
        stacks = _lamina.equivalent_half_space(layers._stacks, callback)
    return Layers(stacks, layers.axes, layers.coords, ["equivalent"])


@dataclass(frozen=True, eq=False, repr=False)
class PulsedReflectance(Result):
    """Light that leaves layers around a short pulse in a pencil beam, by diffusion."""

    r: Array = quantity("distances from the beam", unit="mm", axes=("r",), shared=True)
    t: Array = quantity("times of flight", unit="ps", axes=("t",), shared=True)
    reflectance: Array = quantity("that leaves per area and time, per arriving light", unit="1/(mm² ps)", axes=("r", "t"))

    def _draw(self, ax: Axes) -> None:
        flat = self.reflectance.reshape(-1, len(self.r), len(self.t))
        labels = band_labels(self.axes, self.coords) or [("", None)] * len(flat)
        for (label, color), values in zip(labels, flat):
            for i, r in enumerate(self.r):
                ax.semilogy(self.t, values[i], color=color, label=f"{label} {r:g} mm".strip())
        ax.set(xlabel="time of flight [ps]", ylabel="light [1/(mm² ps)]")
        if len(flat) * len(self.r) <= 12:
            ax.legend(frameon=False)


def pulsed(
    material: MaterialLike,
    r: ArrayLike,
    t: ArrayLike,
    *,
    wavelengths: ArrayLike | None = None,
    progress: Progress = None,
) -> PulsedReflectance:
    """Reflectance of a short pulse over distance and time of flight, by diffusion.

    :param material: a built-in name, a path, a dict, a `Material`, or `Layers` of any shape; every
        layer must scatter.
    :param r: distances [mm], in (0, 1e6].
    :param t: times of flight [ps], in (0, 1e9].
    :param wavelengths: [nm], in place of the material's own bands.
    :raises InvalidInput: naming what is wrong; Interrupted after Ctrl-C.

    Source: Contini et al. 1997, Eqs. 33 and 36; of layers Kienle et al. 1998, §2.

    >>> import lamina
    >>> tissue = lamina.layers(sigma_a=0.01, sigma_s=10.0, g=0.9, ior=1.4)
    >>> lamina.pulsed(tissue, [10.0, 20.0], [500.0, 1000.0]).reflectance.shape
    (2, 2)
    """
    layers = layers_of(material, wavelengths)
    distances = np.atleast_1d(doubles("r", r, 0.0, 1e6, closed="(]", unit="mm"))
    times = np.atleast_1d(doubles("t", t, 0.0, 1e9, closed="(]", unit="ps"))
    for name, values in (("r", distances), ("t", times)):
        if values.ndim != 1:
            raise InvalidInput(f"{name}: must be numbers in one row, but has the shape {values.shape}")
    with progress_of(progress, "pulses") as callback:
        found = _lamina.pulsed_diffusion(layers._stacks, distances.tolist(), times.tolist(), callback)
    return PulsedReflectance(
        axes=layers.axes, coords={**layers.coords, "r": distances, "t": times}, r=distances, t=times, reflectance=found)


class SphereReading(NamedTuple):
    """What a sphere reads, as a fraction: 1 if the sample sends all light into it; and derivatives."""

    value: Doubles
    by_scattered: Doubles
    by_straight: Doubles
    by_diffuse_reflectance: Doubles


def sphere_reading(
    scattered: ArrayLike,
    *,
    straight: ArrayLike = 0.0,
    diffuse_reflectance: ArrayLike,
    of: str = "reflectance",
    diameter: float = 150.0,
    sample_port: float = 20.0,
    detector_port: float = 10.0,
    entrance_port: float = 0.0,
    open_port: float = 0.0,
    wall_reflectance: float = 0.98,
    detector_reflectance: float = 0.0,
    standard_reflectance: float = 0.99,
    baffle: bool = True,
    method: str = "substitution",
) -> SphereReading:
    """What an integrating sphere reads of a sample.

    :param scattered: light that the sample sends into the sphere to all sides, in [0, 1].
    :param straight: the same as a beam: mirrored, or let through unscattered, in [0, 1].
    :param diffuse_reflectance: of the sample for diffuse light of the sphere, in [0, 1].
    :param of: "reflectance", a sphere over the lit side, or "transmittance", one behind the sample.
    :param diameter: of the sphere inside [mm]; that of ports the same.
    :param sample_port: [mm].
    :param detector_port: [mm].
    :param entrance_port: of the beam, open [mm]; 0 if it enters by the sample port.
    :param open_port: another open one [mm].
    :param wall_reflectance: in (0, 1).
    :param detector_reflectance: of what fills its port, in [0, 1).
    :param standard_reflectance: of the reference, in (0, 1].
    :param baffle: whether sample and detector do not see each other.
    :param method: "substitution", or "comparison" by a second beam.
    :raises InvalidInput: naming what cannot be.

    Source: Goebel 1967; Pickering et al. 1993; docs/fit_method.md.

    >>> import lamina
    >>> read = lamina.sphere_reading(0.5, diffuse_reflectance=0.5)
    >>> bool(0.4 < read.value < 0.5)  # less light in the sphere than with the white standard
    True
    """
    one_of("of", of, ("reflectance", "transmittance"))
    sizes = {"diameter": diameter, "sample_port": sample_port, "detector_port": detector_port,
             "entrance_port": entrance_port, "open_port": open_port}
    sphere: dict[str, object] = {name: number(name, value, 0.0, 1e6, unit="mm") for name, value in sizes.items()}
    shares = {"wall_reflectance": wall_reflectance, "detector_reflectance": detector_reflectance,
              "standard_reflectance": standard_reflectance}
    sphere.update({name: number(name, value, 0.0, 1.0) for name, value in shares.items()})
    sphere["has_baffle"] = flag("baffle", baffle)
    sphere["method"] = one_of("method", method, ("substitution", "comparison"))
    arrays, _ = broadcast({
        "scattered": doubles("scattered", scattered, 0.0, 1.0), "straight": doubles("straight", straight, 0.0, 1.0),
        "diffuse_reflectance": doubles("diffuse_reflectance", diffuse_reflectance, 0.0, 1.0)})
    found = _lamina.sphere_reading(of, sphere, arrays["scattered"], arrays["straight"], arrays["diffuse_reflectance"])
    return SphereReading(*np.moveaxis(found, -1, 0))


class LostLight(NamedTuple):
    """Light that leaves a sample beside the ports that should collect it, with standard errors."""

    reflected: Doubles
    reflected_error: Doubles
    transmitted: Doubles
    transmitted_error: Doubles


def lost_light(
    material: MaterialLike,
    *,
    port_diameter: float,
    beam_diameter: float = 0.0,
    incidence: Incidence = "normal",
    wavelengths: ArrayLike | None = None,
    photons: float = 1e6,
    seed: int = 1,
    progress: Progress = None,
) -> LostLight:
    """Light that spreads in a sample beyond round ports above and below, by photons.

    :param material: a built-in name, a path, a dict, a `Material`, or `Layers` of any shape.
    :param port_diameter: [mm], in (0, 1e6], at least that of the beam.
    :param beam_diameter: of an even beam [mm], in [0, 1e6]; 0: a narrow one.
    :param incidence: "normal", "diffuse", or an angle [degrees] in [0, 90).
    :param wavelengths: [nm], in place of the material's own bands.
    :param photons: for each band, in [1, 1e15].
    :param seed: in [0, 2^64).
    :raises InvalidInput: naming what is wrong; Interrupted after Ctrl-C.

    Source: Prahl 2011.

    >>> import lamina
    >>> milk = lamina.layers(sigma_a=0.01, sigma_s=5.0, g=0.8, ior=1.35, thickness=5.0)
    >>> lost = lamina.lost_light(milk, port_diameter=10.0, beam_diameter=2.0, photons=1e4)
    >>> bool(0.0 < lost.reflected < 0.5)
    True
    """
    layers = layers_of(material, wavelengths)
    is_diffuse, theta = check_incidence(incidence)
    port = number("port_diameter", port_diameter, 0.0, 1e6, closed="(]", unit="mm")
    beam = number("beam_diameter", beam_diameter, 0.0, 1e6, unit="mm")
    if beam > port:
        raise refuse("beam_diameter", f"be <= port_diameter, {port:g} mm", beam)
    with progress_of(progress, "lost light") as callback:
        found = _lamina.lost_light(
            layers._stacks, is_diffuse, theta, beam, port, whole("photons", photons, 1, 10**15),
            whole("seed", seed, 0, 2**64 - 1), callback)
    return LostLight(*np.moveaxis(found, -1, 0))
