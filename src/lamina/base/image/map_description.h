// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string_view>

#include "lamina/base/core/vec.h"
#include "lamina/base/image/color_encoding.h"
#include "lamina/base/image/image.h"
#include "lamina/base/image/uv_placement.h"
#include "lamina/base/io/json_input.h"

// Maps are said alike in all files, whatever they vary:
//
//   { "map": "skin.exr", "channel": "melanin", "encoding": "linear", "repeat": 2,
//     "rotate": 90, "shift": [0.5, 0], "value": 0.5, "scale": 0.3, "offset": 0.1, "clamp": [0, 1] }
//   { "noise": { "size": 3 }, "scale": 0.1, "offset": 0.5 }
//
// means value * (offset + scale * x), what stands in brackets kept within clamp, where x is the
// image or the noise.

namespace lamina {

/// Description of a map in a file. Features that a place cannot have are refused by reason by who
/// decodes it.
struct MapDescription {
  JsonInput self;                        ///< the whole, for messages
  std::optional<JsonInput> file, noise;  ///< one of the two
  std::optional<JsonInput> value;        ///< a factor, a number or a color
  std::optional<JsonInput> channel, encoding, repeat, rotate, shift;  ///< of a file
  bool has_vertex_colors = false;  ///< a factor: the colors of the mesh's vertices
  double scale = 1.0, offset = 0.0;
  double low = -std::numeric_limits<double>::infinity();  ///< of offset + scale * x
  double high = std::numeric_limits<double>::infinity();
};

/// @param may_have_vertex_colors  whether "vertex_colors" is a key; it can stand alone, without a
///                                file and noise.
/// @throws InvalidInput
[[nodiscard]] MapDescription decode_map_description(const JsonInput& value,
                                                    bool may_have_vertex_colors = false);

/// Texture coordinates times "repeat", turned by "rotate" [degrees], moved by "shift": as they are
/// unless given.
[[nodiscard]] UvPlacement placement_of(const MapDescription& map);

/// Refuses those three where the image covers a surface once. `why` says so.
void refuse_placement(const MapDescription& map, std::string_view why);

/// The encoding of a quantity is linear unless given, and is one of numbers, which are never
/// converted; that of a color must be given.
[[nodiscard]] ColorEncoding encoding_of(const MapDescription& map, bool is_color);

/// The index of the channel that a file names. @throws InvalidInput if the image has none such.
[[nodiscard]] std::size_t named_channel(const Image& image, const JsonInput& channel);

}  // namespace lamina
