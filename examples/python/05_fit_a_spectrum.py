# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # Skin by its spectrum, with error bars
#
# The reflectance of a forearm from 400 to 700 nm, eight numbers of skin, and what is known of 100 people's forearms.

# %%
from pathlib import Path

import lamina
import matplotlib.pyplot as plt
import numpy as np

here = Path(globals().get("__file__", "./notebook")).resolve().parent
found = lamina.fit(here.parent / "measurements/forearm.json")
print(found)

# %%
(series,) = found.series
nm = np.array([float(band) for band in series.band])
figure, (above, below) = plt.subplots(2, 1, figsize=(7, 6), sharex=True, height_ratios=[3, 1], layout="constrained")
above.errorbar(nm, series.measured, series.sd, fmt=".", color="#333333", label="measured")
above.plot(nm, series.predicted, color="#b5533c", label="skin as it was found")
above.set(ylabel="reflectance", ylim=(0, None))
above.legend(frameon=False)
below.axhline(0, color="gray", lw=0.8)
below.plot(nm, series.residual, ".", color="#b5533c")
below.set(xlabel="wavelength [nm]", ylabel="residual [σ]", ylim=(-3, 3))
figure.savefig("fitted_forearm.png", dpi=110)

# %% [markdown]
# How the errors go together: what one number has more of, another may have less of.

# %%
places, matrix = found.correlations[0]
names = [found.numbers[i].parameter.split(".")[-1] for i in places]
figure, ax = plt.subplots(figsize=(6, 5), layout="constrained")
image = ax.imshow(matrix, vmin=-1, vmax=1, cmap="RdBu_r")
ax.set_xticks(range(len(names)), names, rotation=60, ha="right")
ax.set_yticks(range(len(names)), names)
figure.colorbar(image, label="correlation of errors")
figure.savefig("fitted_correlations.png", dpi=110)
assert found.has_converged
