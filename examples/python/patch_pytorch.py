#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""lamina.patch as a function that PyTorch differentiates: melanin from the light of a patch.

usage: PYTHONPATH=build/release/python python3 examples/python/patch_pytorch.py [STEPS]
"""

import os
import sys

import lamina
import numpy as np

try:
    import torch
except ImportError:
    print("skipped: PyTorch is not installed (python3-torch)")
    sys.exit(0)

is_draft = "LAMINA_DRAFT" in os.environ
NM = [550.0] if is_draft else [450.0, 550.0, 650.0]
MM_PER_PIXEL = 0.2


class Patch(torch.autograd.Function):
    """The light of a patch of skin, (y, x, band), from its melanin, (y, x)."""

    @staticmethod
    def forward(context, melanin):
        context.patch = lamina.patch(
            melanin=melanin.detach().numpy(), wavelengths=NM, mm_per_pixel=MM_PER_PIXEL, derivatives=True)
        return torch.from_numpy(np.ascontiguousarray(context.patch.light)).to(melanin.dtype)

    @staticmethod
    def backward(context, by_light):
        gradient = context.patch.gradient(by_light.detach().numpy())["melanin"]
        return torch.from_numpy(gradient).to(by_light.dtype)


def main():
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 20 if is_draft else 60
    y, x = np.mgrid[0:48, 0:48]
    wanted = 0.03 + 0.15 * np.exp(-((x - 16) ** 2 + (y - 30) ** 2) / 40.0)
    seen = torch.from_numpy(np.ascontiguousarray(
        lamina.patch(melanin=wanted, wavelengths=NM, mm_per_pixel=MM_PER_PIXEL).light)).double()
    # Its logarithm is free, so that melanin stays positive; 0.5 is the most that skin may have.
    log_melanin = torch.full((48, 48), np.log(0.05), dtype=torch.float64, requires_grad=True)
    optimizer = torch.optim.Adam([log_melanin], lr=0.08)
    losses = []
    for step in range(steps):
        optimizer.zero_grad()
        light = Patch.apply(torch.exp(log_melanin).clamp(1e-4, 0.5))
        loss = ((light / seen - 1.0) ** 2).mean()
        loss.backward()
        optimizer.step()
        losses.append(loss.item())
        if step % 10 == 0 or step == steps - 1:
            found = torch.exp(log_melanin).detach().numpy()
            print(f"step {step:3d}: misfit {100 * loss.item() ** 0.5:6.2f} %, "
                  f"melanin off by {100 * np.abs(found / wanted - 1).mean():5.1f} %")
    if not losses[-1] < 0.5 * losses[0]:
        sys.exit("the misfit did not fall")


if __name__ == "__main__":
    main()
