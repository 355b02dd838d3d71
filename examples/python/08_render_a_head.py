# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # A head from a notebook
#
# A scene is a dict: here a bust in marble, in skin and in jade, lit from the side and from behind.

# %%
import os

import lamina
import matplotlib.pyplot as plt
import numpy as np

draft = "LAMINA_DRAFT" in os.environ
size, samples = (48, 2) if draft else (320, 32)
profile = "diffusion" if draft else "radiative_transfer"


def bust(material):
    return {
        "mm_per_unit": 60,
        "camera": {"position": [2.2, 1.2, 12.5], "look_at": [0, 0, 0], "horizontal_fov": 4.7},
        "film": {"width": size, "height": int(size * 1.2), "view": "filmic", "exposure": 1.0},
        "materials": {"bust": {"subsurface": material, "coat": {"ior": 1.44, "roughness": 0.3}}},
        "meshes": [{"shape": "bust", "material": "bust"}],
        "lights": [
            {"type": "rectangle", "position": [-6, 6, 5], "look_at": [0, 0, 0], "size": [3, 3], "radiance": [18, 17, 15.5]},
            {"type": "rectangle", "position": [5, 3, -6], "look_at": [0, 0, 0], "size": [2, 4], "radiance": [16, 16, 18]},
            {"type": "environment", "radiance": [0.05, 0.055, 0.065], "visible": False}],
    }


# %%
pictures = {
    "marble": lamina.render(bust("marble"), samples=samples, method="hierarchy", profile=profile),
    "skin": lamina.render(bust("skin_type_2"), samples=samples, method="hierarchy", profile=profile),
    "jade": lamina.render(bust("jade"), samples=samples, method="hierarchy", profile=profile),
}
figure, axes = plt.subplots(1, 3, figsize=(11, 4.9), layout="constrained")
for ax, (name, picture) in zip(axes, pictures.items()):
    ax.imshow(picture.srgb())
    ax.set_title(f"{name}, {picture.cpu_seconds:.1f} CPU-s")
    ax.axis("off")
figure.savefig("busts.png", dpi=110)

# %% [markdown]
# Every channel is an array: what left from below the surface, what the coat mirrors, depth.

# %%
marble = pictures["marble"]
figure, axes = plt.subplots(1, 3, figsize=(11, 4.9), layout="constrained")
depth = np.where(np.isfinite(marble.layer("depth")), marble.layer("depth"), np.nan)
for ax, (title, image) in zip(axes, (
        ("from below the surface", np.clip(2 * marble.layer("subsurface"), 0, 1) ** 0.45),
        ("mirrored", np.clip(2 * marble.layer("specular"), 0, 1) ** 0.45), ("depth [mm]", depth))):
    shown = ax.imshow(image, cmap="viridis_r")
    ax.set_title(title)
    ax.axis("off")
figure.colorbar(shown, ax=axes, shrink=0.8, pad=0.02)
figure.savefig("channels.png", dpi=110)
assert np.isfinite(marble.image).all() and marble.layer("subsurface").mean() > 0
