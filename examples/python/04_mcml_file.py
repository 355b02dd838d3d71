# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # An MCML file
#
# Files of MCML run as they are; what it counts comes as arrays in mm, each with a standard error, here beside the exact totals.

# %%
import os
from pathlib import Path

import lamina
import matplotlib.pyplot as plt
import numpy as np

draft = "LAMINA_DRAFT" in os.environ
Path("tissue.mci").write_text("""1.0                  # file version
1                    # number of runs
tissue.mco A         # output
1000000              # photons
0.005 0.01           # dz, dr [cm]
80 60 18             # bins
3                    # layers
1.0                  # n above
1.4 1.0 100 0.9 0.1  # n mua mus g d: epidermis
1.4 1.0 10 0.0 0.1   # dermis
1.4 2.0 10 0.7 0.2   # fat
1.0                  # n below
""")
(run,) = lamina.mcml("tissue.mci")
photons = run.photons(1e5 if draft else 2e6, seed=3, fluence=True)
exact = lamina.slab(run.layers)
for name in ("diffuse_reflectance", "transmittance"):
    print(f"{name}: {photons[name]:.5f} ± {photons.error(name):.5f}, exact {getattr(exact, name):.5f}")
    assert abs(photons[name] - getattr(exact, name)) < 5 * photons.error(name)

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4), layout="constrained")
# The last bins hold what lies beyond, as MCML's do: they are left out.
r, z = photons.coords["r"][:-1], photons.coords["depth"]
fluence = np.ma.masked_less_equal(photons["fluence"][:-1].T, 0)
image = left.pcolormesh(r, z, np.ma.log10(fluence), cmap="inferno", shading="nearest")
left.invert_yaxis()
left.set(xlabel="distance from the beam [mm]", ylabel="depth [mm]", title="fluence, log10 of 1/mm²")
figure.colorbar(image, ax=left)
right.errorbar(r, photons["r_reflected"][:-1], photons.error("r_reflected")[:-1], fmt=".", label="MCML's bins")
smooth = lamina.profile(run.layers, r_min=0.05, r_max=6.0, radii=64)
right.plot(smooth.r, smooth.reflectance, label="radiative transfer")
right.set(yscale="log", xlabel="distance r [mm]", ylabel="R(r) [1/mm²]")
right.legend(frameon=False)
figure.savefig("mcml_file.png", dpi=110)
