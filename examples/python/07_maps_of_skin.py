# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # Maps of skin, and the light that leaves them
#
# Freckles and a vein as maps of melanin and blood; light that travels sideways between texels; and a tan, as arithmetic on an array.

# %%
import os
from pathlib import Path

import lamina
import matplotlib.pyplot as plt
import numpy as np

draft = "LAMINA_DRAFT" in os.environ
here = Path(globals().get("__file__", "./notebook")).resolve().parent
size = 96 if draft else 384
maps = lamina.maps(here.parent / "skin/freckles.json", changes={"width": size, "height": size})
nm = [550] if draft else lamina.SPECTRAL_BANDS
light = lamina.patch(**maps.arguments(), wavelengths=nm)
tanned = maps.arguments()
tanned["melanin"] = np.minimum(2.5 * tanned["melanin"] + 0.02, 0.5)
after = lamina.patch(**tanned, wavelengths=nm)

# %%
figure, axes = plt.subplots(1, 3, figsize=(12, 4), layout="constrained")
width = size * light.mm_per_pixel
shown = axes[0].imshow(100 * maps.maps["melanin"], cmap="copper_r", extent=(0, width, width, 0))
axes[0].set(title="melanin [% of the epidermis]", xlabel="mm", ylabel="mm")
figure.colorbar(shown, ax=axes[0], shrink=0.8)
light.plot(axes[1]).set_title("its light")
after.plot(axes[2]).set_title("tanned")
figure.savefig("maps_of_skin.png", dpi=110)

# %% [markdown]
# The same texels, each by itself: without light from its neighbours a freckle has hard edges.

# %%
alone = {k: v for k, v in maps.arguments().items() if k not in ("mm_per_pixel", "constants")}
by_itself = lamina.skin_colors(
    **{k: v for k, v in alone.items() if k not in ("dermis_thickness", "junction_absorption")}, incidence="normal",
    wavelengths=nm)
row = size // 2
across = (np.arange(size) + 0.5) * light.mm_per_pixel
figure, ax = plt.subplots(figsize=(8, 3.2), layout="constrained")
ax.plot(across, light.srgb_linear[row, :, 0], label="with light that travels sideways")
ax.plot(across, by_itself.srgb_linear[row, :, 0], lw=1, label="each texel by itself")
ax.set(xlabel="mm", ylabel="red, linear")
ax.legend(frameon=False)
figure.savefig("sideways_light.png", dpi=110)
assert np.diff(light.srgb_linear[row, :, 0]).std() < np.diff(by_itself.srgb_linear[row, :, 0]).std()
