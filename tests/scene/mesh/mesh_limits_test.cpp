// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
//
// Small files that claim much: they are refused before memory is taken, or read in a time that
// grows with the size of the file. Times are of the processor, with room for slow ones: what they
// forbid takes a hundred times as long.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "base/image/peak_memory.h"
#include "lamina/scene/mesh/files/mesh_file.h"
#include "lamina/scene/mesh/mesh.h"
#include "lamina/scene/mesh/mesh_shapes.h"
#include "lamina/scene/mesh/mesh_triangulation.h"
#include "scene/mesh/mesh_samples.h"

namespace lamina {
namespace {

constexpr std::size_t mebi = std::size_t{1} << 20;

template <class Work>
double cpu_seconds(const Work& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

bool speaks_of_memory(const std::string& message) {
  return message.find("left of the budget") != std::string::npos;
}

std::string repeated(int times, const std::function<std::string(int)>& text) {
  std::string all;
  for (int i = 0; i < times; ++i) all += (i > 0 ? ", " : "") + text(i);
  return all;
}

/// glTF with these nodes, meshes and accessors, beside the square's views and buffer.
std::string gltf_with(const std::string& roots, const std::string& nodes, const std::string& meshes,
                      const std::string& accessors) {
  return glb_bytes(R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [)" + roots +
                       R"(]}], "nodes": [)" + nodes + R"(], "meshes": [)" + meshes +
                       R"(], "accessors": [)" + accessors +
                       R"(], "bufferViews": [{"buffer": 0, "byteLength": 12}],
                         "buffers": [{"byteLength": 12}]})",
                   std::string(12, '\0'));
}

constexpr const char* many_zeros = R"({"componentType": 5126, "count": 10000000, "type": "VEC3"})";
constexpr const char* six_indices =
    R"({"bufferView": 0, "componentType": 5123, "count": 6, "type": "SCALAR"})";
const std::string two_accessors = std::string(many_zeros) + ", " + six_indices;
constexpr const char* two_triangles =
    R"({"attributes": {"POSITION": 0, "NORMAL": 0}, "indices": 1})";

TEST(GltfLimits, NodesShareWhatTheirMeshIs) {
  const auto number = [](int i) { return std::to_string(i); };
  const std::string bytes =
      gltf_with(repeated(1000, number), repeated(1000, [](int) { return R"({"mesh": 0})"; }),
                R"({"primitives": [)" + std::string(two_triangles) + "]}", two_accessors);
  EXPECT_LT(cpu_seconds([&] {
              const PolygonMesh mesh = parse_gltf(bytes, "f.glb", {32 * mebi});
              EXPECT_EQ(face_count(mesh), 2000U);
              EXPECT_EQ(mesh.positions.size(), 1000U);  // of 10 million, those that faces use
            }),
            2.0);
}

TEST(GltfLimits, PrimitivesShareTheirAccessor) {
  const std::string bytes = gltf_with(
      "0", R"({"mesh": 0})",
      R"({"primitives": [)" + repeated(1000, [](int) { return std::string(two_triangles); }) + "]}",
      two_accessors);
  EXPECT_LT(
      cpu_seconds([&] { EXPECT_EQ(face_count(parse_gltf(bytes, "f.glb", {32 * mebi})), 2000U); }),
      2.0);
}

TEST(GltfLimits, ViewsShareTheirBuffer) {
  constexpr int count = 4000;
  const std::string text = std::string(4 * mebi, 'A');  // 3 MiB of zeros
  const auto numbered = [](const std::string& before, const std::string& after) {
    return [=](int i) { return before + std::to_string(i) + after; };
  };
  const std::string json =
      R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
          "meshes": [{"primitives": [)" +
      repeated(count, numbered(R"({"attributes": {"POSITION": )", "}}")) + R"(]}],
          "accessors": [)" +
      repeated(count, numbered(R"({"bufferView": )",
                               R"(, "componentType": 5126, "count": 3, "type": "VEC3"})")) +
      R"(], "bufferViews": [)" +
      repeated(count, [](int) { return R"({"buffer": 0, "byteLength": 36})"; }) +
      R"(], "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,)" + text +
      "\"}]}";
  EXPECT_LT(cpu_seconds([&] {
              EXPECT_EQ(face_count(parse_gltf(json, "f.gltf", {64 * mebi})),
                        static_cast<std::size_t>(count));
            }),
            2.0);
}

TEST(GltfLimits, WhatNodesRepeatIsTakenFromTheBudget) {
  const std::string bytes = gltf_with(
      "0, 1", R"({"mesh": 0}, {"mesh": 0})", R"({"primitives": [{"attributes": {"POSITION": 0}}]})",
      R"({"componentType": 5126, "count": 300000, "type": "VEC3"})");
  EXPECT_EQ(message_of([&] { (void)parse_gltf(bytes, "f.glb"); }), "");
  const std::string message = message_of([&] { (void)parse_gltf(bytes, "f.glb", {20 * mebi}); });
  EXPECT_EQ(message.find("f.glb:1: meshes[0].primitives[0] would take "), 0U) << message;
  EXPECT_TRUE(speaks_of_memory(message)) << message;
}

TEST(GltfLimits, ElementsWithoutDataAreRefusedBeforeTheyAreMade) {
  const std::string bytes =
      gltf_with("0", R"({"mesh": 0})", R"({"primitives": [{"attributes": {"POSITION": 0}}]})",
                R"({"componentType": 5126, "count": 3000000000, "type": "VEC3"})");
  const std::string message = message_of([&] { (void)parse_gltf(bytes, "f.glb"); });
  EXPECT_TRUE(speaks_of_memory(message)) << message;
}

TEST(GltfLimits, SparseIndicesMustRise) {
  SquareGltf gltf;
  gltf.replace(R"("count": 4, "type": "VEC3"})",
               R"("count": 4, "type": "VEC3", "sparse": {"count": 2,
      "indices": {"bufferView": 1, "byteOffset": 4, "componentType": 5123},
      "values": {"bufferView": 0}}})");  // 3, 0
  EXPECT_EQ(message_of([&] { (void)parse_gltf(gltf.glb(), "f.glb"); }),
            "f.glb:7: accessors[0].sparse: its indices must rise, but index 1 does not");
}

// A glTF file comes from strangers; it has no business elsewhere on the disk.
TEST(GltfLimits, BuffersLieBesideTheFile) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("gltf." + std::to_string(getpid()));
  std::filesystem::create_directories(folder / "inner");
  std::ofstream(folder / "outer.bin", std::ios::binary) << SquareGltf{}.binary;
  std::ofstream(folder / "inner/buffer.bin", std::ios::binary) << SquareGltf{}.binary;
  const auto refusal = [&](const std::string& uri, const std::string& file = "f.gltf") {
    SquareGltf gltf;
    gltf.replace(R"({"byteLength": 92})", R"({"byteLength": 92, "uri": ")" + uri + "\"}");
    return message_of([&] { (void)parse_gltf(gltf.json, folder / file); });
  };
  EXPECT_EQ(refusal("inner/buffer.bin"), "");
  for (const std::string& uri :
       {(folder / "outer.bin").string(), std::string("../outer.bin"), std::string("%2e./outer.bin"),
        std::string("inner/../../outer.bin"), std::string("outer.bin%00.png"), std::string()}) {
    const std::string message = refusal(uri, "inner/f.gltf");
    EXPECT_NE(message.find("must be data or the path of a file in the folder"), std::string::npos)
        << uri << ": " << message;
  }
  ASSERT_EQ(mkfifo((folder / "pipe.bin").c_str(), 0600), 0);  // nobody writes into it
  EXPECT_EQ(refusal("pipe.bin"),
            (folder / "pipe.bin").string() + ": is a pipe, but must be a file");
  std::filesystem::remove_all(folder);
}

TEST(PlyLimits, HeadersAreReadInLinearTime) {
  std::string bytes = "ply\nformat ascii 1.0\n";
  for (int i = 0; i < 200'000; ++i) bytes += "element e" + std::to_string(i) + " 0\n";
  bytes +=
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_LT(cpu_seconds([&] { EXPECT_EQ(face_count(parse_ply(bytes, "f.ply")), 1U); }), 2.0);
  EXPECT_TRUE(speaks_of_memory(message_of([&] { (void)parse_ply(bytes, "f.ply", {mebi}); })));
}

TEST(PlyLimits, OnlyVerticesThatTheFileCanHoldGetMemory) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex 1000000\n";
  bytes += "property uchar quality\nproperty double x\nproperty double y\nproperty double z\n";
  bytes += "end_header\n" + std::string(1'000'000, '\0');  // enough for as many qualities
  EXPECT_EQ(message_of([&] { (void)parse_ply(bytes, "f.ply", {3 * mebi}); }),
            "f.ply: is cut off within vertex 40000 of 1000000");
}

TEST(MeshLimits, FacesAndVerticesAreTakenFromTheBudget) {
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 40000\nproperty char x\n"
      "property char y\nproperty char z\nelement face 20000\n"
      "property list uchar uchar vertex_indices\nend_header\n" +
      std::string(120'000, '\0');
  std::string obj = "v 0 0 0\n";
  for (int i = 0; i < 20'000; ++i) {
    ply += std::string("\3\0\1\2", 4);
    obj += "f 1 1 1\n";
  }
  EXPECT_EQ(message_of([&] { (void)parse_ply(ply, "f.ply"); }), "");
  EXPECT_EQ(message_of([&] {
              (void)parse_ply(ply, "f.ply", {mebi});
            }).find("f.ply: its vertices would take 2.1 MiB of memory, but only 102"),
            0U);
  EXPECT_TRUE(speaks_of_memory(message_of([&] { (void)parse_ply(ply, "f.ply", {2 * mebi}); })));
  EXPECT_EQ(message_of([&] { (void)parse_obj(obj, "f.obj"); }), "");
  EXPECT_TRUE(speaks_of_memory(message_of([&] { (void)parse_obj(obj, "f.obj", {mebi}); })));
}

TEST(ObjLimits, NamesAreShort) {
  const std::string obj = "v 0 0 0\no " + std::string(1001, 'x') + "\nf 1 1 1\n";
  EXPECT_EQ(message_of([&] { (void)parse_obj(obj, "f.obj"); }),
            "f.obj:2: a name must not have more than 1000 bytes");
}

// Subdivision makes much of little; all that it takes on the way counts.
TEST(MeshLimits, OfWhatAMeshBecomesAreCountedInFull) {
  for (const int subdivision : {0, 2}) {
    const PolygonMesh sphere = make_sphere(1.0, subdivision > 0 ? 60 : 240);
    const std::vector<std::uint32_t> materials(sphere.parts.size());
    const auto refusal = [&](std::size_t budget) {
      return message_of([&] {
        (void)make_mesh(
            sphere, {.subdivision = subdivision, .normals = NormalSource::flat, .memory = {budget}},
            materials);
      });
    };
    std::size_t low = 0, high = 512 * mebi;  // refused with, made with
    EXPECT_TRUE(speaks_of_memory(refusal(mebi))) << refusal(mebi);
    ASSERT_EQ(refusal(high), "");
    while (high - low > mebi) {
      const std::size_t middle = low + (high - low) / 2;
      (refusal(middle).empty() ? high : low) = middle;
    }
    const auto peak = peak_memory([&] { (void)refusal(high); });
    if (!peak) GTEST_SKIP() << "the system does not tell how much memory is in use";
    EXPECT_LT(*peak, high + 2 * mebi) << subdivision;
    EXPECT_GT(*peak, high / 3) << subdivision;
  }
}

// A comb: hardly any corner of it is a good ear, and each must be tested against all others.
TEST(MeshLimits, PolygonsAreCutInSquareTime) {
  std::vector<Vec3> comb;
  constexpr int teeth = 990;
  for (int i = 0; i < teeth; ++i) {
    comb.push_back({i + 0.0, 0.0, 0.0});
    comb.push_back({i + 0.5, 1000.0, 0.0});
  }
  comb.push_back({teeth + 0.0, 0.0, 0.0});
  comb.push_back({teeth / 2.0, -1.0, 0.0});
  EXPECT_LT(cpu_seconds([&] { EXPECT_EQ(triangulate(comb).size(), comb.size() - 2); }), 1.0);
}

}  // namespace
}  // namespace lamina
