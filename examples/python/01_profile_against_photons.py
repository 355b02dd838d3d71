# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # How far light spreads in skin, and who says so
#
# Three layers of skin after Donner & Jensen 2005, under a pencil beam. Radiative transfer gives R(r) without noise; photons are an
# independent witness; diffusion is the model of the paper.

# %%
import os

import lamina
import matplotlib.pyplot as plt
import numpy as np

draft = "LAMINA_DRAFT" in os.environ
skin = lamina.material("donner_jensen_skin")
skin

# %%
exact = lamina.profile(skin, r_min=0.02, r_max=8.0, radii=96)
counted = lamina.profile(skin, method="monte_carlo", r_min=0.02, r_max=8.0, radii=24,
                         photons=2e5 if draft else 5e6, seed=1)
diffusion = lamina.profile(skin, method="diffusion", r_min=0.02, r_max=8.0, radii=96)
assert counted.standard_error  # photons have one

# %%
figure, (above, below) = plt.subplots(2, 1, figsize=(7, 7), sharex=True, height_ratios=[3, 1.4], layout="constrained")
for band, color in enumerate(("#c0392b", "#27853f", "#2a5db0")):
    name = skin.bands[band]
    above.plot(exact.r, exact.reflectance[band], color=color, label=f"{name}, radiative transfer")
    # Diffusion is per light that entered: 7.7 % are mirrored first.
    entered = 1.0 - lamina.slab(skin).specular_reflectance[band]
    above.plot(diffusion.r, entered * diffusion.reflectance[band], "--", color=color, lw=1)
    error = counted.standard_error["reflectance"][band]
    seen = counted.reflectance[band] > 2 * error
    r, value, error = counted.r[seen], counted.reflectance[band][seen], error[seen]
    above.errorbar(r, value, error, fmt=".", color=color, ms=4)
    at = np.exp(np.interp(np.log(r), np.log(exact.r), np.log(np.maximum(exact.reflectance[band], 1e-12))))
    below.errorbar(r, 100 * (value / at - 1), 100 * error / at, fmt=".", color=color, ms=4)
above.set(xscale="log", yscale="log", ylim=(1e-6, 20), ylabel="R(r) [1/mm²]",
          title="Lines: radiative transfer. Points: photons. Dashed: diffusion")
above.legend(frameon=False)
below.axhline(0, color="gray", lw=0.8)
below.set(ylim=(-12, 12), xlabel="distance r [mm]", ylabel="photons over\nthe line - 1 [%]")
figure.savefig("profile_against_photons.png", dpi=110)

# %%
off = (counted.total_reflectance - exact.total_reflectance) / counted.standard_error["total_reflectance"]
print("totals of photons, in standard errors from radiative transfer:", off.round(1))
assert (np.abs(off) < 5).all()
