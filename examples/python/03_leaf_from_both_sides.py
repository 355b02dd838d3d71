# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # A leaf from both sides
#
# A leaf's upper side holds most of the pigment. So its two sides look different, and light that comes through has another color than both.

# %%
import lamina
import matplotlib.pyplot as plt
import numpy as np

nm = np.arange(400.0, 1001.0, 10.0)
green = lamina.leaf(wavelengths=nm)
autumn = lamina.leaf(chlorophyll=8.0, anthocyanins=3.0, brown_pigments=0.3, wavelengths=nm)

# %%
figure, axes = plt.subplots(1, 2, figsize=(10, 4), sharey=True, layout="constrained")
for ax, leaf, title, fill, line in zip(axes, (green, autumn), ("green oak", "in autumn"), ("#4a7c2f", "#a3632a"),
                                       ("#7d9f5c", "#c98f4e")):
    top, bottom = (lamina.slab(side, incidence="diffuse") for side in (leaf, leaf.flipped()))
    ax.fill_between(nm, 0, top.diffuse_reflectance, color=fill, alpha=0.35, label="reflected, upper side")
    ax.plot(nm, bottom.diffuse_reflectance, color=line, label="reflected, lower side")
    ax.plot(nm, 1 - top.transmittance, color="#444444", label="1 - transmitted")
    ax.set(title=title, xlabel="wavelength [nm]", xlim=(400, 1000), ylim=(0, 1))
    # What passes does so either way: reciprocity.
    np.testing.assert_allclose(top.transmittance, bottom.transmittance, rtol=1e-3, atol=1e-4)
    ax.text(560, 0.45, "absorbed", color="#444444", ha="center")
    ax.legend(loc="upper right", framealpha=0.9, edgecolor="none")
axes[0].set_ylabel("fraction of the light")
figure.savefig("leaf_from_both_sides.png", dpi=110)

# %%
lobes = lamina.bsdf("leaf", 45.0)
axes = lobes.plot()
axes.set_title("a leaf lit at 45°: where light leaves above, and below")
axes.figure.savefig("leaf_lobes.png", dpi=110)
lobes
