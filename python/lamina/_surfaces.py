# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Rough surfaces by themselves: what they reflect and let through."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from . import _lamina
from ._input import doubles, number, one_of, refuse, whole
from ._lamina import InvalidInput
from ._photons import require_unused
from ._progress import Progress, progress_of
from ._result import Array, Result, quantity, setting

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False, repr=False)
class RoughInterface(Result):
    """Fractions of light that a boundary of small facets reflects and lets through."""

    cosine: Array = quantity("of the angle of incidence", axes=("cosine",), shared=True)
    reflectance: Array = quantity("of light from that angle", axes=("cosine",), shared=True)
    transmittance: Array = quantity("of light from that angle; the rest met more facets", axes=("cosine",), shared=True)
    diffuse_reflectance: float = quantity("of diffuse light")
    diffuse_transmittance: float = quantity("of diffuse light")

    def _draw(self, ax: Axes) -> None:
        angle = np.degrees(np.arccos(self.cosine))
        ax.plot(angle, self.reflectance, label="reflected")
        ax.plot(angle, self.transmittance, label="transmitted")
        ax.set(xlabel="angle of incidence [degrees]", ylabel="fraction of the light", ylim=(0.0, 1.0))
        ax.legend(frameon=False)


def rough_interface(
    roughness: float,
    eta: float,
    *,
    distribution: str = "beckmann",
    masking: str = "smith",
    cosine: ArrayLike | None = None,
) -> RoughInterface:
    """What a rough boundary between two dielectrics reflects and lets through, over the angle.

    :param roughness: microfacet alpha, in [0, 1].
    :param eta: refractive index beyond the boundary over that before it, in [0.01, 100].
    :param distribution: of facets, "beckmann" or "ggx".
    :param masking: "smith", light that meets one facet; "smith_multiple", all light; "v_cavity", as
        Torrance & Sparrow 1967.
    :param cosine: of the angle of incidence, in [0, 1]; 0, 0.05 … 1.
    :raises InvalidInput: naming what is out of its range.

    Source: Walter et al. 2007, Eqs. 20, 21; Heitz 2014; Heitz et al. 2016.

    >>> import lamina
    >>> frost = lamina.rough_interface(0.5, 1.5, cosine=[1.0])
    >>> bool(frost.reflectance[0] + frost.transmittance[0] < 1.0)
    True
    """
    cosines = np.atleast_1d(doubles("cosine", np.linspace(0.0, 1.0, 21) if cosine is None else cosine, 0.0, 1.0))
    if cosines.ndim != 1:
        raise InvalidInput(f"cosine: must be numbers in one row, but has the shape {cosines.shape}")
    found = _lamina.rough_interface(
        number("roughness", roughness, 0.0, 1.0), number("eta", eta, 0.01, 100.0),
        one_of("distribution", distribution, ("beckmann", "ggx")),
        one_of("masking", masking, ("smith", "smith_multiple", "v_cavity")), cosines.tolist())
    return RoughInterface(axes=(), coords={"cosine": cosines}, cosine=cosines, **found)


@dataclass(frozen=True, eq=False, repr=False)
class RoughSurface(Result):
    """Where light from one direction goes at a rough surface: means over cells of directions."""

    method: str = setting("how it was found")
    theta_o: Array = quantity("middles of cells, from the normal of the side", unit="degrees", axes=("theta_o",), shared=True)
    phi: Array = quantity("middles of cells: 0 goes on, 180 turns back", unit="degrees", axes=("phi",), shared=True)
    brdf: Array = quantity("light of all orders", unit="1/sr", axes=("theta_o", "phi"), shared=True)
    btdf: Array = quantity("light of all orders", unit="1/sr", axes=("theta_o", "phi"), shared=True)
    brdf_error: Array = quantity("standard error", unit="1/sr", axes=("theta_o", "phi"), shared=True)
    btdf_error: Array = quantity("standard error", unit="1/sr", axes=("theta_o", "phi"), shared=True)
    single_brdf: Array = quantity("light that met one facet", unit="1/sr", axes=("theta_o", "phi"), shared=True)
    single_btdf: Array = quantity("light that met one facet", unit="1/sr", axes=("theta_o", "phi"), shared=True)
    reflectance: tuple[float, float] = setting("of all orders, with its standard error")
    transmittance: tuple[float, float] = setting("of all orders, with its standard error")
    single_reflectance: tuple[float, float] = setting("by one facet, with its standard error")
    single_transmittance: tuple[float, float] = setting("by one facet, with its standard error")
    start_weight: tuple[float, float] = setting("mean weight that light starts with, with its standard error")
    given_up: float = quantity("light not followed to its end")

    def _draw(self, ax: Axes) -> None:
        angle = np.concatenate([-self.theta_o[::-1], self.theta_o])
        for values, label in ((self.brdf, "BRDF"), (self.btdf, "BTDF")):
            ax.plot(angle, np.concatenate([values[::-1, -1], values[:, 0]]), label=label)
        ax.set(xlabel="angle of leaving light [degrees], < 0 on the side of the light", ylabel="1/sr", ylim=(0.0, None))
        ax.legend(frameon=False)


def rough_surface(
    smoothness: float,
    eta: float,
    theta_i: float,
    *,
    method: str = "analytic",
    visibility: str | None = None,
    rays: float = 1e6,
    realizations: int = 8,
    seed: int = 0,
    progress: Progress = None,
) -> RoughSurface:
    """Where light goes at a surface of Gaussian heights, as Xu & Sun 2008 see it.

    :param smoothness: correlation length over RMS height, in [0.01, 10000].
    :param eta: refractive index beyond the surface over that before it, in [0.01, 100], not 1.
    :param theta_i: angle of incidence [degrees], in [0, 90); of height fields in [0, 89].
    :param method: "analytic", light that meets one facet; "monte_carlo", the paper's simulation;
        "height_field", rays through generated surfaces, the truth.
    :param visibility: of facets, of monte_carlo: "xu_sun" or "smith"; "xu_sun".
    :param rays: of the two methods by chance, in [1000, 1e12].
    :param realizations: of height fields, in [2, 1000].
    :param seed: in [0, 2^64).
    :raises InvalidInput: naming what is wrong; Interrupted after Ctrl-C.

    Source: Xu & Sun 2008, Eq. 25 and §4; docs/rough_surfaces.md.

    >>> import lamina
    >>> lamina.rough_surface(6.0, 1.5, 30).btdf.shape
    (45, 18)
    """
    one_of("method", method, ("analytic", "monte_carlo", "height_field"))
    require_unused(method, {"visibility": (visibility is not None, "monte_carlo")})
    ratio = number("eta", eta, 0.01, 100.0)
    if ratio == 1.0:
        raise refuse("eta", "not be 1", eta)
    most = 89.0 if method == "height_field" else 90.0
    angle = number("theta_i", theta_i, 0.0, most, closed="[]" if most == 89.0 else "[)", unit="degrees")
    with progress_of(progress, "rough surface") as callback:
        found = _lamina.rough_surface(
            number("smoothness", smoothness, 0.01, 10000.0), ratio, float(np.radians(angle)), method,
            whole("rays", rays, 1000, 10**12), whole("seed", seed, 0, 2**64 - 1),
            one_of("visibility", visibility or "xu_sun", ("xu_sun", "smith")),
            whole("realizations", realizations, 2, 1000), callback)
    thetas, phis = (np.arange(45) + 0.5) * 2.0, (np.arange(18) + 0.5) * 10.0
    return RoughSurface(
        axes=(), coords={"theta_o": thetas, "phi": phis}, method=method, theta_o=thetas, phi=phis, **found)
