// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/materials/chromophores.h"

#include "lamina/layers/materials/leaf.h"
#include "lamina/layers/materials/skin.h"

namespace lamina {
namespace {

/// That of PROSPECT [Feret2017], which is per cm.
double water_absorption(double wavelength) { return 0.1 * leaf_spectrum(wavelength).water; }

constexpr Chromophore all_chromophores[] = {
    {"eumelanin", eumelanin_absorption, 350.0, 1000.0},
    {"pheomelanin", pheomelanin_absorption, 350.0, 1000.0},
    {"oxyhemoglobin", oxyhemoglobin_absorption, 350.0, 1000.0},
    {"deoxyhemoglobin", deoxyhemoglobin_absorption, 350.0, 1000.0},
    {"carotene", carotene_absorption, 350.0, 1000.0},
    {"baseline", baseline_absorption, 350.0, 1000.0},
    {"water", water_absorption, shortest_leaf_wavelength, longest_leaf_wavelength},
};

}  // namespace

std::span<const Chromophore> chromophores() { return all_chromophores; }

}  // namespace lamina
