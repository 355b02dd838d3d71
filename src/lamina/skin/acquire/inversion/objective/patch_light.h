// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "lamina/skin/acquire/inversion/objective/patch_maps.h"
#include "lamina/skin/acquire/inversion/texels/inversion_tables.h"
#include "lamina/skin/acquire/inversion/texels/skin_at_texel.h"

namespace lamina::detail {

/// Images of a capture by skin of given coordinates, with light that travels
/// sideways; and derivatives of it. Counts what it costs.
class PatchLight {
 public:
  /// @param capture, tables  must outlive this
  /// @param cost             of one forward equivalent, in those that are counted
  /// @param spent            before
  PatchLight(const PatchCapture& capture, const InversionTables& tables, double cost = 1.0,
             double spent = 0.0);

  /// The images, [image]. @param coordinates  [number]
  [[nodiscard]] TexelMaps images(const TexelMaps& coordinates);
  /// Tangent product: change of the last `images` by a change of the coordinates.
  [[nodiscard]] TexelMaps change(const TexelMaps& coordinate_change);
  /// From derivatives of a number by the images to those by the coordinates.
  [[nodiscard]] TexelMaps gradient(const TexelMaps& by_images);

  /// Forward equivalents so far: each of the above counts one.
  [[nodiscard]] double forwards() const { return forwards_; }
  [[nodiscard]] double cost() const { return cost_; }

 private:
  /// Absorption of one layer at one wavelength, and its derivatives, of which some are none.
  struct LayerMaps {
    Plane sigma_a;
    TexelMaps by_number;
  };
  /// A wavelength of a light that some image sees.
  struct Field {
    std::size_t wavelength, light;
    std::array<AbsorptionRange, skin_layer_count> ranges = {};
    std::unique_ptr<DifferentiableTransport<float>> transport = nullptr;
    Plane reflected = {};  ///< of what was asked for last
  };
  void set_absorption(const TexelMaps& coordinates);
  void make_transport(Field& field) const;
  [[nodiscard]] TexelMaps sums_over_sensors() const;

  const PatchCapture& capture_;
  const InversionTables& tables_;
  std::size_t texels_;
  std::vector<std::array<LayerMaps, skin_layer_count>> layers_;  ///< [wavelength]
  std::vector<Field> fields_;
  double cost_, forwards_;
};

}  // namespace lamina::detail
