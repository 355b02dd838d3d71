# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # The color of skin over melanin and blood
#
# Every texel of this map is skin of its own, solved by radiative transfer and shown under D65. On top: the skins that lamina brings, and one
# measured forearm (person 12 of Cooksey, Allen and Tsai, NIST 2017), placed by a fit of its spectrum.

# %%
import json
import os
import re
from pathlib import Path

import lamina
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patheffects import withStroke

draft = "LAMINA_DRAFT" in os.environ
here = Path(globals().get("__file__", "./notebook")).resolve().parent
size = 64 if draft else 256
melanin = np.geomspace(0.002, 0.4, size)
blood = np.geomspace(0.0002, 0.08, size)
colors = lamina.skin_colors(melanin=melanin[:, None], hemoglobin_dermis=blood)
print(f"{colors.reflectance.shape[0] * colors.reflectance.shape[1]} skins")

# %%
forearm = lamina.fit(here.parent / "measurements/forearm.json")
print(forearm)

# %%
figure, axes = plt.subplots(figsize=(6.4, 5.6), layout="constrained")
edges = np.log10([blood[0], blood[-1], melanin[0], melanin[-1]])
axes.imshow(colors.srgb, origin="lower", extent=edges, aspect="auto")


def mark(share_of_blood, share_of_melanin, name, style):
    x, y = np.log10(share_of_blood), np.log10(share_of_melanin)
    axes.plot(x, y, style, mec="white", mfc="none", ms=8, mew=1.5)
    # On the right, but where another one is near: above or below.
    offset = {"skin_flushed": (0, 13), "skin_type_1": (0, -13)}.get(name, (8, 0))
    axes.annotate(name, (x, y), offset, textcoords="offset points", fontsize=8, color="white", va="center",
                  ha="left" if offset[0] else "center", path_effects=[withStroke(linewidth=2, foreground="#2a1a14")])


mark(float(forearm["skin.hemoglobin_dermis"]), float(forearm["skin.melanin"]), "measured forearm", "o")
for name in lamina.materials():
    stated = lamina.material_text(name)
    if '"skin"' not in stated:
        continue
    recipe = json.loads(re.sub(r"//[^\n]*", "", stated)).get("skin", {})
    if {"melanin", "hemoglobin_dermis"} <= recipe.keys():
        mark(recipe["hemoglobin_dermis"], recipe["melanin"], name, "D")
for set_ticks, shares in ((axes.set_xticks, (0.05, 0.2, 0.5, 1, 2, 5)), (axes.set_yticks, (0.3, 1, 3, 10, 30))):
    set_ticks(np.log10(np.array(shares) / 100), [f"{share:g}" for share in shares])
axes.set(xlabel="blood in the dermis [% of volume]", ylabel="melanin in the epidermis [% of volume]",
         title="Colors of skin under D65")
figure.savefig("colors_of_skin.png", dpi=110)

# %% [markdown]
# Brighter with less melanin, redder with more blood: the two directions that photographs tell apart.

# %%
luminance = colors.srgb_linear @ [0.2126, 0.7152, 0.0722]
assert (np.diff(luminance, axis=0) < 0).all() and (np.diff(luminance, axis=1) < 0).all()
