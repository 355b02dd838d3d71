# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""In which directions layers send light: BRDF and BTDF."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from . import _lamina
from ._input import doubles, number, one_of
from ._lamina import InvalidInput
from ._materials import MaterialLike, layers_of
from ._photons import require_unused
from ._progress import Progress, progress_of
from ._result import Array, Result, band_labels, quantity, setting

if TYPE_CHECKING:
    from matplotlib.axes import Axes

METHODS = ("radiative_transfer", "first_order", "layered_bsdf")


@dataclass(frozen=True, eq=False, repr=False)
class Bsdf(Result):
    """How layers scatter a beam from one angle: radiance per irradiance. What leaves unscattered, in
    the mirror direction and straight through, has no finite radiance, and stands beside it."""

    method: str = setting("how it was found")
    theta_i: float = quantity("angle of incidence", unit="degrees")
    theta_o: Array = quantity("angles from the normal of the side that light leaves on", unit="degrees",
                              axes=("theta_o",), shared=True)
    phi: Array = quantity("azimuths of leaving light: 0 goes on, 180 turns back", unit="degrees",
                          axes=("phi",), shared=True)
    brdf: Array = quantity("of light that leaves at the top", unit="1/sr", axes=("theta_o", "phi"))
    btdf: Array = quantity("of light that leaves at the bottom", unit="1/sr", axes=("theta_o", "phi"))
    unscattered_reflectance: Array = quantity("fraction of the light that comes back unscattered")
    unscattered_transmittance: Array = quantity("fraction of the light that passes unscattered")
    estimated_error: Array | None = quantity("of each value, relative to it or the mean", optional=True)

    def _draw(self, ax: Axes) -> None:
        on, back = int(np.argmin(self.phi)), int(np.argmax(self.phi))
        angle = np.concatenate([-self.theta_o[:0:-1], self.theta_o])
        labels = band_labels(self.axes, self.coords)
        for i, at in enumerate(np.ndindex(self.unscattered_reflectance.shape)):
            label, color = labels[i] if labels else (str(list(at)), None)
            for values, style in ((self.brdf, "-"), (self.btdf, "--")):
                plane = np.concatenate([values[at][:0:-1, back], values[at][:, on]])
                if plane.max() > 0.0:
                    ax.plot(angle, plane, style, color=color, label=label if style == "-" else None)
        ax.set(xlabel="angle of leaving light [degrees], < 0 on the side of the light",
               ylabel="BRDF, dashed BTDF [1/sr]", ylim=(0.0, None))
        if labels and len(labels) <= 12:
            ax.legend(frameon=False)


def bsdf(
    material: MaterialLike,
    theta_i: float,
    *,
    theta_o: ArrayLike | None = None,
    phi: ArrayLike | None = None,
    wavelengths: ArrayLike | None = None,
    method: str = "radiative_transfer",
    accuracy: float | None = None,
    progress: Progress = None,
) -> Bsdf:
    """BRDF and BTDF of layers for one angle of incidence.

    :param material: a built-in name, a path, a dict, a `Material`, or `Layers` of any shape.
    :param theta_i: angle of incidence [degrees], in [0, 90).
    :param theta_o: angles of leaving light [degrees], in [0, 90); every 5.
    :param phi: azimuths [degrees], 0 onward, 180 back, in [-360, 360]; every 5 from 0 to 180.
    :param wavelengths: [nm], in place of the material's own bands.
    :param method: "radiative_transfer" by adding-doubling; "first_order", in closed form, smooth
        boundaries; "layered_bsdf", the same with higher orders. By photons: `photons(bsdf=...)`.
    :param accuracy: of radiative transfer, of each value, in [1e-6, 0.1]; 1e-3.
    :raises InvalidInput: naming what is wrong; Interrupted after Ctrl-C.

    Source: docs/layered_bsdf.md; Hanrahan & Krueger 1993 for the first order.

    >>> import lamina
    >>> leaf = lamina.bsdf("leaf", 45, theta_o=[0, 30, 60], phi=[0, 180])
    >>> leaf.brdf.shape
    (3, 3, 2)
    """
    one_of("method", method, METHODS)
    layers = layers_of(material, wavelengths)
    angle = number("theta_i", theta_i, 0.0, 90.0, closed="[)", unit="degrees")
    thetas = np.arange(0.0, 90.0, 5.0) if theta_o is None else doubles(
        "theta_o", theta_o, 0.0, 90.0, closed="[)", unit="degrees")
    phis = np.arange(0.0, 181.0, 5.0) if phi is None else doubles("phi", phi, -360.0, 360.0, unit="degrees")
    for name, values in (("theta_o", thetas), ("phi", phis)):
        if values.ndim != 1:
            raise InvalidInput(f"{name}: must be angles in one row, but has the shape {values.shape}")
    require_unused(method, {"accuracy": (accuracy is not None, "radiative_transfer")})
    asked = 1e-3 if accuracy is None else number("accuracy", accuracy, 1e-6, 0.1)
    with progress_of(progress, "BSDF") as callback:
        found = _lamina.bsdf(layers._stacks, float(np.radians(angle)), np.radians(thetas).tolist(),
                             np.radians(phis).tolist(), method, asked, callback)
    coords = {**layers.coords, "theta_o": thetas, "phi": phis}
    return Bsdf(axes=layers.axes, coords=coords, method=method, theta_i=angle, theta_o=thetas, phi=phis, **found)
