// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
//
// Meshes that were cut off or damaged on their way: each is read or refused with one line, and what
// is read can be made ready to be rendered. The sanitizers watch the same tests.
#include <gtest/gtest.h>

#include <cmath>

#include "lamina/base/core/random.h"
#include "lamina/scene/mesh/files/mesh_file.h"
#include "lamina/scene/mesh/mesh.h"
#include "lamina/scene/mesh/mesh_shapes.h"
#include "scene/mesh/mesh_samples.h"

namespace lamina {
namespace {

struct Sample {
  std::string name;
  std::string bytes;
};

std::vector<Sample> samples() {
  const PolygonMesh box = make_box({1, 2, 3}, 2), sphere = make_sphere(1.0, 3);
  SquareGltf square;
  return {{"box.obj", obj_text(box)},
          {"ascii.ply", ply_bytes(sphere, "ascii", true)},
          {"little.ply", ply_bytes(sphere, "binary_little_endian", true)},
          {"big.ply", ply_bytes(box, "binary_big_endian")},
          {"square.glb", square.glb()}};
}

PolygonMesh parse(const Sample& sample) {
  if (sample.name.ends_with(".obj")) return parse_obj(sample.bytes, sample.name);
  if (sample.name.ends_with(".ply")) return parse_ply(sample.bytes, sample.name);
  return parse_gltf(sample.bytes, sample.name);
}

/// Reads and prepares a mesh. True if that went well; the mesh is then whole, else the error is one
/// line that names the file.
bool survives(const Sample& sample) {
  try {
    PolygonMesh polygons = parse(sample);
    const std::vector<std::uint32_t> materials(polygons.parts.size());
    const Mesh mesh = make_mesh(std::move(polygons), {.subdivision = 1}, materials).mesh;
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t v : triangle)
        EXPECT_TRUE(v < mesh.positions.size() && std::isfinite(mesh.positions[v].x) &&
                    std::abs(length(mesh.normals[v]) - 1.0F) < 1e-5F)
            << sample.name;
    return true;
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find(sample.name), 0U) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return false;
  }
}

TEST(DamagedMesh, SamplesAreSoundToBeginWith) {
  for (const Sample& sample : samples()) EXPECT_TRUE(survives(sample)) << sample.name;
}

TEST(DamagedMesh, IsRefusedWhereverItIsCutOff) {
  for (const Sample& sample : samples()) {
    std::size_t read = 0;
    const std::size_t step = sample.bytes.size() / 400 + 1;
    const std::size_t last_word =
        sample.name == "ascii.ply" ? 4 : 0;  // "12" cut to "1" is a number
    for (std::size_t size = 0; size < sample.bytes.size() - last_word; size += step)
      if (survives({sample.name, sample.bytes.substr(0, size)})) ++read;
    // An OBJ has no end to miss: its first faces are a mesh.
    if (!sample.name.ends_with(".obj")) {
      EXPECT_EQ(read, 0U) << sample.name;
    }
  }
}

TEST(DamagedMesh, NeverHarmsTheReader) {
  for (const Sample& sample : samples()) {
    std::size_t read = 0;
    for (std::uint64_t trial = 0; trial < 3000; ++trial) {
      Random random = make_random(11, trial);
      Sample damaged = sample;
      for (std::uint64_t flips = 1 + random.bits() % 3; flips > 0; --flips)
        damaged.bytes[random.bits() % damaged.bytes.size()] =
            static_cast<char>(random.bits() & 0xff);
      if (survives(damaged)) ++read;
    }
    EXPECT_GT(read, 0U) << sample.name;  // else the trials test nothing but the first check
    EXPECT_LT(read, 3000U) << sample.name;
  }
}

}  // namespace
}  // namespace lamina
