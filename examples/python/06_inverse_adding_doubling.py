# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # Inverse adding-doubling
#
# A liquid in a cuvette between slides: reflectance, transmittance and unscattered transmittance give absorption, reduced scattering and g,
# band by band. Then twenty cuvettes at once.

# %%
from pathlib import Path

import lamina
import matplotlib.pyplot as plt
import numpy as np

here = Path(globals().get("__file__", "./notebook")).resolve().parent
found = lamina.fit(here.parent / "measurements/liquid.json")
nm = found.material.wavelengths
figure, axes = plt.subplots(1, 3, figsize=(11, 3.4), layout="constrained")
for ax, name, label in zip(axes, ("sigma_a", "sigma_s_prime", "g"), ("σa [1/mm]", "σs′ [1/mm]", "g")):
    ax.errorbar(nm, found[name], found.error(name), fmt="o-", ms=4, color="#2a5d8f")
    ax.set(xlabel="wavelength [nm]", title=label)
figure.savefig("inverse_adding_doubling.png", dpi=110)
print(found)

# %% [markdown]
# Many samples in one call, on all cores: made ones, so that the answers are known.

# %%
sigma_a, sigma_s = np.geomspace(0.01, 1.0, 20), 12.0
plates = lamina.layers(sigma_a=sigma_a[:, None], sigma_s=sigma_s, g=0.8, ior=1.4, thickness=1.0)
totals = lamina.slab(plates)
layer = {"sigma_a": 0.1, "sigma_s": 5.0, "g": 0.8, "ior": 1.4, "thickness": 1.0}
free = {"per_band": True, "scale": "logarithmic", "low": 1e-4, "high": 1e3}
samples = lamina.fit([
    {"name": f"plate {i}",
     "material": {"lamina": "material", "version": 1, "length_unit": "mm", "bands": [600], "ior_below": 1, "layers": [layer]},
     "free": [dict(free, parameter=f"layers[0].{name}") for name in ("sigma_a", "sigma_s")],
     "measured": [{"kind": "totals", "wavelength_nm": [600], "unit": "fraction", "specular": "excluded", "sd": 0.002,
                   "reflectance": [totals.diffuse_reflectance[i]], "transmittance": [totals.transmittance[i]]}]}
    for i in range(len(sigma_a))])
again = np.array([float(sample["sigma_a"]) for sample in samples])
error = np.array([float(sample.error("sigma_a")) for sample in samples])
print("absorption found again within", f"{100 * np.abs(again / sigma_a - 1).max():.2g} %;",
      "errors of", f"{100 * (error / sigma_a).min():.1g} to {100 * (error / sigma_a).max():.1g} %")
assert np.allclose(again, sigma_a, rtol=0.01)
