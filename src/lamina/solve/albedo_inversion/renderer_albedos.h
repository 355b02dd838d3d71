// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The color of diffuse light that a half-space returns, as renderers have it in closed form.

namespace lamina {

/// van de Hulst's fit for a matched boundary, by similarity for all g.
///
/// @param albedo  of single scattering, in [0, 1]
/// @param g       in (-1, 1)
///
/// Source: [VanDeHulst1980] as [KullaConty2017] give it.
[[nodiscard]] double van_de_hulst_color(double albedo, double g);

/// Albedo of a color, the inverse: the formula that [OpenPBR] 1.1.1, section Subsurface,
/// KHR_materials_scatter and Blender 5.2 print.
[[nodiscard]] double van_de_hulst_albedo(double color, double g);

/// The albedo that Blender makes of a color from 3.0 to 5.1, and later where its method says so.
/// Nowhere above .999999.
/// Source: [Wrenninge2017], as Cycles has it.
[[nodiscard]] double wrenninge_albedo(double color, double g);

}  // namespace lamina
