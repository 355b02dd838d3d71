// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/files/leaf_files.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "lamina/base/core/number_text.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/json_output.h"
#include "lamina/base/io/write_places.h"
#include "lamina/skin/fit/least_squares/nonlinear_fit.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

/// The map without holes.
Image filled(const Image& map) {
  std::vector<float> known;
  for (const float value : map.pixels)
    if (std::isfinite(value)) known.push_back(value);
  Image whole = map;
  if (known.empty()) return whole;
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
  std::ranges::nth_element(known, middle);
  for (float& value : whole.pixels)
    if (!std::isfinite(value)) value = *middle;
  return whole;
}

bool is_of_the_leaf(const LeafMap& map) {
  const auto numbers = leaf_numbers();
  return std::ranges::any_of(numbers, [&](const LeafNumber& number) {
    return number.parameter.name == map.parameter.name;
  });
}

void write_json_file(const fs::path& file, const JsonOutput& json) {
  const std::string text = json.text(1) + "\n";
  write_file_bytes(file, std::as_bytes(std::span(text)));
}

}  // namespace

LeafFiles save_leaf(const LeafMaps& leaf, const Capture& capture, const fs::path& folder,
                    const std::string& version) {
  make_folder(folder);
  LeafFiles files;
  JsonOutput recipe = JsonOutput::object();
  for (const LeafMap& map : leaf.maps) {
    const std::string& name = map.parameter.name;
    const std::vector<ImageNote> notes = {
        {"lamina.version", version},
        {"lamina.number", name},
        {"lamina.capture", capture.name},
        {"lamina.prior_share", number_text(map.prior_share)},
        {"lamina.told",
         map.prior_share <= prior_share_of_note ? "by the capture" : "from the prior"}};
    files.maps.push_back(folder / (name + ".exr"));
    save_exr(filled(map.values), files.maps.back(), ExrPrecision::single_float, notes);
    files.deviations.push_back(folder / (name + ".sd.exr"));
    save_exr(filled(map.deviations), files.deviations.back(), ExrPrecision::half, notes);
    if (is_of_the_leaf(map)) recipe[name] = {{"map", name + ".exr"}};
  }
  Image mask = make_image(leaf.width, leaf.height, {"Y"});
  for (std::size_t i = 0; i < leaf.kinds.size(); ++i)
    mask.pixels[i] = leaf.kinds[i] == LeafPixelKind::leaf ? 1.0f : 0.0f;
  files.mask = folder / "mask.exr";
  save_exr(mask, files.mask);
  const JsonOutput material = {{"lamina", "material"}, {"version", 1},     {"name", capture.name},
                               {"length_unit", "mm"},  {"ior_below", 1.0}, {"leaf", recipe}};
  files.material = folder / "material.json";
  write_json_file(files.material, material);
  if (capture.mm_per_pixel) {
    files.patch = folder / "patch.json";
    write_json_file(files.patch, {{"lamina", "patch"},
                                  {"version", 1},
                                  {"mm_per_pixel", *capture.mm_per_pixel},
                                  {"width", leaf.width},
                                  {"height", leaf.height},
                                  {"material", material}});
  }
  return files;
}

}  // namespace lamina
