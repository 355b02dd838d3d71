#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""A plate's absorption and scattering from its totals, by SciPy with lamina's derivatives.

usage: PYTHONPATH=build/release/python python3 examples/python/fit_scipy.py
"""

import sys

import lamina
import numpy as np

try:
    from scipy.optimize import least_squares
except ImportError:
    print("skipped: SciPy is not installed (python3-scipy)")
    sys.exit(0)

NAMES = ("diffuse_reflectance", "transmittance")


def totals(logarithms):
    sigma_a, sigma_s = np.exp(logarithms)
    return lamina.slab(
        lamina.layers(sigma_a=sigma_a, sigma_s=sigma_s, g=0.8, ior=1.4, thickness=1.0), derivatives=True, accuracy=1e-7)


def main():
    wanted = np.array([0.15, 12.0])
    measured = totals(np.log(wanted))
    calls = 0

    def misfit(logarithms):
        nonlocal calls
        calls += 1
        found = totals(logarithms)
        return np.array([getattr(found, name) - getattr(measured, name) for name in NAMES])

    def jacobian(logarithms):
        derivatives = totals(logarithms).derivatives
        by_logarithm = np.exp(logarithms)
        return np.array([[derivatives[name][of][0] * by_logarithm[i]
                          for i, of in enumerate(("sigma_a", "sigma_s"))] for name in NAMES])

    fit = least_squares(misfit, np.log([1.0, 3.0]), jac=jacobian, xtol=1e-12, ftol=1e-14, gtol=1e-14)
    found = np.exp(fit.x)
    print(f"sigma_a {found[0]:.6f} /mm (is {wanted[0]}), sigma_s {found[1]:.5f} /mm (is {wanted[1]}), "
          f"{calls} solutions")
    if not np.allclose(found, wanted, rtol=1e-4):
        sys.exit("the fit is wrong")


if __name__ == "__main__":
    main()
