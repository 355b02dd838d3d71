// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/base/image/image.h"
#include "lamina/skin/maps/map_example.h"
#include "lamina/skin/maps/skin_maps.h"

namespace lamina {

// What grows, flows or is drawn in skin, as changes to the maps of its parameters. All lengths are
// in mm; places are measured from the upper left corner.

/// Two numbers between which things vary.
using Span2 = std::array<double, 2>;

/// Spots of melanin with ragged rims: freckles, or moles. Where spots overlap the darker one
/// counts.
struct MelaninSpots {
  double density = 8.0;          ///< [1/cm²]
  Span2 diameter = {0.4, 2.0};   ///< small ones are more frequent: even in the logarithm
  Span2 melanin = {0.01, 0.04};  ///< added at the middle
  double melanin_blend = 0.35;   ///< of the melanin that is added
  double rim = 0.25;             ///< over which a spot fades, at most a third of its diameter
};

/// Vessels of venous blood: tubes that wander, and branch (split_vessel). A tube at a depth is seen
/// as wide as diameter and depth together, so its share of blood is spread over that width.
struct Veins {
  int count = 2;
  int levels = 3;  ///< of branches: 0 for none, 1 for branches without branches, ...
  Span2 diameter = {0.5, 1.2};
  Span2 depth = {0.3, 1.0};
  double hemoglobin = 0.06;  ///< of the dermis at the middle of a tube of no depth
  double saturation = 0.4;   ///< of that blood
  double absorbance = 0.0;   ///< of the junction above it, added: a dark bluish shade, as of blood
                             ///< so deep that little but red light gets there
};

/// Patches in which there is more of something, with soft rims: a flush, a rash, a tan.
struct Blotches {
  double size = 4.0;                               ///< typical distance between them
  double coverage = 0.4;                           ///< share of the area
  double hemoglobin_dermis = 0.01, melanin = 0.0;  ///< added at the middle
};

/// Ink at the junction of epidermis and dermis, as dark as an image is.
struct Tattoo {
  Image image;              ///< "Y": share of the ink
  Span2 at = {0.0, 0.0};    ///< its middle
  double width = 10.0;      ///< its height follows
  double absorbance = 1.5;  ///< of the darkest ink, per crossing
  std::string ink = {};  ///< one of the skin's, by name; empty: that of the junction's own spectrum
};

/// Where a tattoo's ink goes. @throws InvalidInput if the skin has no ink of that name.
[[nodiscard]] double& absorbance_of(const Tattoo& tattoo, SkinParameters& skin);

/// A finger has just been there: blood is pressed out of a disc.
struct PressedDisc {
  Span2 at = {0.0, 0.0};
  double diameter = 8.0;
  double share = 0.8;      ///< of the blood that is gone in the middle
  double refill = 0.0;     ///< from the rim inward, in patches; 0: the finger has just left
  double hyperemia = 0.0;  ///< share of more blood in a ring around it, where vessels have opened
};

/// Natural unevenness: melanin and blood times exp(amount * noise).
struct Unevenness {
  double melanin = 0.12, melanin_size = 0.8;
  double hemoglobin = 0.2, hemoglobin_size = 2.5;
};

/// The maps of a small piece of skin, captured or made, spread over all of it.
struct Synthesis {
  MapExample example;
  bool are_factors = false;                ///< the maps over their means multiply what is there
  std::vector<std::string> warnings = {};  ///< what was clamped, and which maps hold one value only
};

using SkinFeature =
    std::variant<MelaninSpots, Veins, Blotches, Tattoo, PressedDisc, Unevenness, Synthesis>;

/// Recipe of the maps that `lamina maps` makes.
struct SkinMapRecipe {
  int width = 512, height = 512;
  double mm_per_texel = 0.05;
  std::uint64_t seed = 0;
  SkinMaps base;                      ///< numbers only
  std::vector<SkinFeature> features;  ///< one after the other
};

/// Sets the parameters that the example's maps are of. @param share  of the change, in [0, 1]
void change_by_synthesis(SkinParameters& skin, const Synthesis& synthesis,
                         std::span<const double> values, double share);

/// Adds blood or melanin of another composition: shares mix by amount.
void mix_in(double& amount, double& composition, double added, double composition_of_it);

/// Ink of an image at a place in it, both from 0 to 1, v downward; 0 outside.
[[nodiscard]] double ink_at(const Image& image, double u, double v);

/// Share of the blood that a finger leaves at a distance from its middle [mm].
/// @param raggedness  of its rim: noise of mean 0 and variance 1
[[nodiscard]] double share_left(const PressedDisc& disc, double distance, double raggedness);

/// Numbers that are not the same everywhere, as maps without images.
[[nodiscard]] std::vector<SkinMap> varying_numbers(std::span<SkinParameters> skin);

/// Value of a map at a place, brought into its range.
[[nodiscard]] float clamped_number(SkinParameters& skin, const SkinMap& map);

/// The maps of those parameters that vary, every value in its range. Equal recipes give equal maps;
/// a feature does not depend on those after it.
/// @throws Interrupted if progress asks to stop.
[[nodiscard]] std::vector<SkinMap> make_skin_maps(const SkinMapRecipe& recipe,
                                                  const Progress& progress = {});

}  // namespace lamina
