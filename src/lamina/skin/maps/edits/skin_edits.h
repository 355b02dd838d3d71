// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/image/image.h"
#include "lamina/skin/maps/edits/editable_skin.h"

// Edits of the maps of skin: they change what skin is made of, so that a tan looks like one in any
// light and at any angle. Each takes a skin and gives another one, in the same units.

namespace lamina {

/// Kind of an edit. A is its amount, σ its size: the spread of a Gaussian blur.
enum class SkinEditKind {
  tan,         ///< (1 + A) times the melanin; what is added has tanned_blend of eumelanin
  flush,       ///< (1 + A) times the blood; what is added is arterial, of flush_saturation
  pale,        ///< (1 - A) times the blood
  saturation,  ///< the oxygenated share of the blood becomes A, in the middle: its detail stays
  cyanosis,    ///< (1 - A) times the oxygenated share of the blood
  /// (1 + A) times what of ln(melanin) lies above its surroundings within σ; of dark ones, as
  /// moles, the melanin times exp(A) at most. Where they fade, so does the composition of theirs
  freckles,
  even,        ///< (1 - A) times what of each pigment differs from its surroundings within σ
  foundation,  ///< the same over more skin, and (1 - A) times the oil: what it looks like; no layer
  blush,       ///< the look of rouge: a little red in the epidermis
  lipstick,  ///< the look of lipstick: much of it, less melanin, and a red dye below the epidermis
  homogenize,  ///< mean and covariance of the pigments become those of the reference
  scale,       ///< A times the number
  add,         ///< the number and A, in its unit
  set,         ///< the number is A
  gamma,       ///< A times the contrast of the number about its mean, in its coordinate
  blur,        ///< the number blurred by a Gaussian; σ is A [mm]
  transfer,    ///< the number is the image
};

template <>
inline constexpr auto enum_names<SkinEditKind> =
    std::to_array<EnumName<SkinEditKind>>({{"tan", SkinEditKind::tan},
                                           {"flush", SkinEditKind::flush},
                                           {"pale", SkinEditKind::pale},
                                           {"saturation", SkinEditKind::saturation},
                                           {"cyanosis", SkinEditKind::cyanosis},
                                           {"freckles", SkinEditKind::freckles},
                                           {"even", SkinEditKind::even},
                                           {"foundation", SkinEditKind::foundation},
                                           {"blush", SkinEditKind::blush},
                                           {"lipstick", SkinEditKind::lipstick},
                                           {"homogenize", SkinEditKind::homogenize},
                                           {"scale", SkinEditKind::scale},
                                           {"add", SkinEditKind::add},
                                           {"set", SkinEditKind::set},
                                           {"gamma", SkinEditKind::gamma},
                                           {"blur", SkinEditKind::blur},
                                           {"transfer", SkinEditKind::transfer}});

/// Share of eumelanin in the melanin of human epidermis, however dark it is [DelBino2015]; under
/// light of the sun both kinds grow [Wolber2008].
inline constexpr double tanned_blend = 0.74;
inline constexpr double flush_saturation = 0.97;  ///< of arterial blood

struct SkinEdit {
  SkinEditKind kind = SkinEditKind::tan;
  double amount = 0.0;      ///< A, in the range of skin_edit_range
  std::string number = {};  ///< of scale, add, set, gamma, blur, transfer: as "melanin", "ink_red"
  double size = 0.0;        ///< σ [mm]; 0: that of skin_edit_range
  /// How far the edit goes at a place: 0 leaves it as it is, bit for bit; 1 is the whole edit;
  /// between, the way is shared in the number's coordinate, a logarithm or a logit.
  double strength = 1.0;
  Image mask = {};  ///< [0, 1], a factor on that; one channel, the proportions of the maps
  EditableSkin reference = {};  ///< of homogenize
  Image image = {};             ///< of transfer: one channel, in the number's unit
};

/// Range of amounts that an edit takes, and the size over which it looks for detail.
struct SkinEditRange {
  double low = 0.0, high = 0.0;
  double size = 0.0;        ///< [mm] unless given; 0: it has none
  bool has_number = false;  ///< of skin: scale, add, ...
  bool needs_mask = false;
};
[[nodiscard]] SkinEditRange skin_edit_range(SkinEditKind kind);

/// Texels that an edit would have taken out of the range of their number: they are at its end.
struct ClampedTexels {
  std::string name;  ///< of the number
  std::size_t count = 0;
};

struct EditedSkin {
  EditableSkin skin;
  std::vector<ClampedTexels> clamped;
};

/// The skin after an edit. Numbers that no map gives are edited as numbers; with a mask they become
/// maps. Standard deviations are carried on to first order; those of maps whose texels were mixed
/// or replaced are dropped, with a warning.
///
/// @throws InvalidInput for an amount, a name, a size or a mask that cannot be, and for edits that
///         need a size in mm of maps whose width is not known.
[[nodiscard]] EditedSkin edited_skin(EditableSkin skin, const SkinEdit& edit);

}  // namespace lamina
