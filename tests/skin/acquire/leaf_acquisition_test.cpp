// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/leaf_acquisition.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/json_input.h"
#include "lamina/skin/acquire/files/capture_file.h"
#include "lamina/skin/acquire/files/leaf_files.h"
#include "lamina/skin/maps/files/material_map_file.h"
#include "lamina/solve/reflectance/leaf_totals_table.h"

namespace lamina {
namespace {

/// A leaf whose chlorophyll rises from left to right, over a ground of .1, in ten bands.
Capture made_leaf() {
  Capture capture =
      develop_capture(load_capture(LAMINA_SOURCE_DIR "/tests/inputs/capture/good/leaf.json"));
  LeafRange range;
  range.low.chlorophyll = 10.0;
  range.high.chlorophyll = 60.0;
  const LeafTotalsTable table(capture.wavelengths, capture.incidence, range);
  for (int y = 0; y < capture.reflectance.height; ++y)
    for (int x = 0; x < capture.reflectance.width; ++x) {
      LeafParameters leaf;
      leaf.chlorophyll = 20.0 + 5.0 * x;
      for (std::size_t b = 0; b < capture.wavelengths.size(); ++b) {
        const LeafTotalsTable::Totals totals = table.totals(leaf, b);
        const double ground = *capture.leaf->ground;
        const double seen = totals.reflectance + totals.transmittance * totals.transmittance *
                                                     ground / (1.0 - totals.reflectance * ground);
        capture.reflectance.at(x, y)[b] = static_cast<float>(seen);
      }
    }
  return capture;
}

TEST(LeafAcquisition, FindsAndWritesWhatALeafHolds) {
  const Capture capture = made_leaf();
  const LeafMaps leaf = acquire_leaf(capture);
  EXPECT_EQ(leaf.maps[0].parameter.name, "chlorophyll");
  for (int x = 0; x < 6; ++x)
    EXPECT_NEAR(static_cast<double>(leaf.maps[0].values.at(x, 1)[0]) / (20.0 + 5.0 * x), 1.0, 0.15);
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / "lamina_acquired_leaf";
  const LeafFiles files = save_leaf(leaf, capture, folder, "1.0");
  const JsonDocument document = load_json(files.patch);
  const JsonObject object =
      document.root().file_object("patch", 1, {"mm_per_pixel", "width", "height", "material"});
  const MappedMaterial material = decode_mapped_material(object.required("material"));
  EXPECT_EQ(material.maps.size(),
            leaf_numbers().size());  // illumination and gloss are not the leaf's
  EXPECT_TRUE(material.warnings.empty());
  for (const float value : load_image(files.maps[0], ColorEncoding::linear).pixels)
    EXPECT_TRUE(std::isfinite(value));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace lamina
