// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Meshes as the programs of other people write them: colors of vertices in every encoding, surveyed
// coordinates, paths of other computers.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "lamina/base/core/vec.h"
#include "lamina/scene/mesh/files/mesh_file.h"
#include "lamina/scene/mesh/mesh.h"
#include "lamina/scene/mesh/mesh_orientation.h"
#include "lamina/scene/mesh/mesh_report.h"
#include "lamina/scene/mesh/mesh_shapes.h"
#include "scene/mesh/mesh_samples.h"

namespace lamina {
namespace {

float from_srgb(float srgb) { return std::pow((srgb + 0.055F) / 1.055F, 2.4F); }

/// The square with a color at each vertex, the same at all.
/// @param accessor  what the accessor says beside its view, count and byte offset
SquareGltf colored_square(const std::string& accessor, const std::string& color,
                          std::size_t stride) {
  SquareGltf gltf;
  for (int i = 0; i < 4; ++i) gltf.binary += color + std::string(stride - color.size(), '\0');
  gltf.replace(R"("TEXCOORD_0": 1})", R"("TEXCOORD_0": 1, "COLOR_0": 3})");
  gltf.replace(R"("count": 6, "type": "SCALAR"})",
               R"("count": 6, "type": "SCALAR"}, {"bufferView": 2, "count": 4, )" + accessor + "}");
  gltf.replace(R"("byteLength": 12}])", R"("byteLength": 12}, {"buffer": 0, "byteOffset": 92,
    "byteLength": )" + std::to_string(4 * stride) +
                                            R"(, "byteStride": )" + std::to_string(stride) + "}]");
  gltf.replace(R"({"byteLength": 92})",
               R"({"byteLength": )" + std::to_string(92 + 4 * stride) + "}");
  return gltf;
}

void expect_color(const PolygonMesh& mesh, const Vec3f& wanted) {
  ASSERT_EQ(mesh.colors.size(), 4U);
  for (const Vec3f& color : mesh.colors)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(color[c], wanted[c], 2e-5F);
}

constexpr Vec3f painted{182.0F / 255.0F, 178.0F / 255.0F, 25.0F / 255.0F};

TEST(VertexColors, OfGltfAreLinearFractionsAndAFactorOfTheBaseColor) {
  const std::string bytes = ByteWriter()
                                .put(std::uint8_t{182})
                                .put(std::uint8_t{178})
                                .put(std::uint8_t{25})
                                .put(std::uint8_t{255})
                                .bytes;
  const std::string shorts = ByteWriter()
                                 .put(static_cast<std::uint16_t>(182 * 257))
                                 .put(static_cast<std::uint16_t>(178 * 257))
                                 .put(static_cast<std::uint16_t>(25 * 257))
                                 .put(std::uint16_t{65535})
                                 .bytes;
  const std::string floats =
      ByteWriter().put(painted.x).put(painted.y).put(painted.z).put(1.0F).bytes;
  struct Case {
    const char* accessor;
    std::string color;
    std::size_t stride;
    bool is_noted;
  };
  for (const auto& [accessor, color, stride, is_noted] : {
           Case{R"("componentType": 5121, "normalized": true, "type": "VEC4")", bytes, 4, false},
           {R"("componentType": 5121, "normalized": true, "type": "VEC3")", bytes, 4, false},
           {R"("componentType": 5121, "type": "VEC3")", bytes, 8, true},
           {R"("componentType": 5123, "normalized": true, "type": "VEC4")", shorts, 8, false},
           {R"("componentType": 5123, "normalized": false, "type": "VEC4")", shorts, 8, true},
           {R"("componentType": 5126, "type": "VEC3")", floats.substr(0, 12), 12, false},
           {R"("componentType": 5126, "type": "VEC4")", floats, 16, false},
       }) {
    const PolygonMesh mesh = parse_gltf(colored_square(accessor, color, stride).glb(), "f.glb");
    expect_color(mesh, painted);
    EXPECT_TRUE(mesh.file_materials.at(0).has_vertex_colors) << accessor;
    EXPECT_EQ(says(mesh.notes, "must be \"normalized\""), is_noted) << accessor;
  }
  EXPECT_NE(message_of([&] {
              (void)parse_gltf(
                  colored_square(R"("componentType": 5120, "type": "VEC3")", bytes, 4).glb(),
                  "f.glb");
            }).find("COLOR_0: colors of vertices must be floats, unsigned bytes"),
            std::string::npos)
      << message_of([&] {
           (void)parse_gltf(
               colored_square(R"("componentType": 5120, "type": "VEC3")", bytes, 4).glb(), "f.glb");
         });
  const std::string bright = ByteWriter().put(1.5F).put(-0.5F).put(0.25F).bytes;
  expect_color(
      parse_gltf(colored_square(R"("componentType": 5126, "type": "VEC3")", bright, 12).glb(),
                 "f.glb"),
      {1.0F, 0.0F, 0.25F});
  const std::string white = ByteWriter().put(1.0F).put(1.0F).put(1.0F).bytes;
  EXPECT_FALSE(
      parse_gltf(colored_square(R"("componentType": 5126, "type": "VEC3")", white, 12).glb(),
                 "f.glb")
          .file_materials.at(0)
          .has_vertex_colors);
}

TEST(VertexColors, OfASparseAccessorWithoutAViewAreThoseItReplaces) {
  SquareGltf gltf;
  gltf.binary += ByteWriter()
                     .put(std::uint8_t{1})
                     .put(std::uint8_t{2})
                     .put(std::uint8_t{51})
                     .put(std::uint8_t{102})
                     .put(std::uint8_t{153})
                     .put(std::uint8_t{255})
                     .put(std::uint8_t{0})
                     .put(std::uint8_t{0})
                     .bytes;
  gltf.replace(R"("TEXCOORD_0": 1})", R"("TEXCOORD_0": 1, "COLOR_0": 3})");
  gltf.replace(R"("count": 6, "type": "SCALAR"})",
               R"("count": 6, "type": "SCALAR"},
    {"count": 4, "componentType": 5121, "normalized": true, "type": "VEC3", "sparse": {"count": 2,
      "indices": {"bufferView": 2, "componentType": 5121},
      "values": {"bufferView": 2, "byteOffset": 2}}})");
  gltf.replace(R"("byteLength": 12}])",
               R"("byteLength": 12}, {"buffer": 0, "byteOffset": 92, "byteLength": 8}])");
  gltf.replace(R"({"byteLength": 92})", R"({"byteLength": 100})");
  const PolygonMesh mesh = parse_gltf(gltf.glb(), "f.glb");
  ASSERT_EQ(mesh.colors.size(), 4U);
  EXPECT_EQ(mesh.colors[0], (Vec3f{0, 0, 0}));
  EXPECT_FLOAT_EQ(mesh.colors[1].y, 0.4F);
  EXPECT_EQ(mesh.colors[2].x, 1.0F);
}

TEST(VertexColors, OfObjAreFractionsOrBytes) {
  const auto with = [](const std::string& color) {
    return parse_obj("v 0 0 0 " + color + "\nv 1 0 0\nv 0 1 0 0 0 0\nf 1 2 3\n", "t.obj");
  };
  const PolygonMesh bytes = with("182 178 25");
  EXPECT_NEAR(bytes.colors[0].x, from_srgb(182.0F / 255.0F), 1e-6F);
  EXPECT_NEAR(bytes.colors[0].y, from_srgb(178.0F / 255.0F), 1e-6F);
  EXPECT_EQ(bytes.colors[1], (Vec3f{1, 1, 1}));
  EXPECT_EQ(bytes.colors[2], (Vec3f{0, 0, 0}));
  EXPECT_TRUE(says(bytes.notes, "t.obj:1: colors of vertices reach beyond 1"));
  const PolygonMesh fractions = with("1 .5 0");
  EXPECT_NEAR(fractions.colors[0].y, from_srgb(0.5F), 1e-6F);
  EXPECT_TRUE(fractions.notes.empty());
  for (const char* color : {"1.5 .2 .3", "182.5 178 25", "256 0 0"}) {
    const PolygonMesh mesh = with(color);
    EXPECT_TRUE(mesh.colors.empty()) << color;
    EXPECT_TRUE(says(mesh.notes, "t.obj:1: colors of vertices are left out")) << color;
  }
}

TEST(VertexColors, OfPlyAreBytesWhateverTheirType) {
  const auto with = [](const std::string& type, const std::string& color,
                       const std::string& prefix = "") {
    std::string header = "ply\nformat ascii 1.0\nelement vertex 3\n";
    for (const char* axis : {"x", "y", "z"}) header += "property float " + std::string(axis) + "\n";
    for (const char* name : {"red", "green", "blue"})
      header += "property " + type + " " + prefix + name + "\n";
    header += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    return parse_ply(
        header + "0 0 0 " + color + "\n1 0 0 " + color + "\n0 1 0 " + color + "\n3 0 1 2\n",
        "t.ply");
  };
  const Vec3f srgb{from_srgb(painted.x), from_srgb(painted.y), from_srgb(painted.z)};
  const auto expect = [&](const PolygonMesh& mesh, const Vec3f& wanted) {
    ASSERT_EQ(mesh.colors.size(), 3U);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mesh.colors[1][c], wanted[c], 1e-5F);
  };
  for (const char* type : {"uchar", "int", "uint", "short", "float", "double"})
    expect(with(type, "182 178 25"), srgb);
  expect(with("ushort", "46774 45746 6425"), srgb);
  expect(with("uchar", "182 178 25", "diffuse_"), srgb);
  expect(with("float", ".71 .5 .1"), {.71F, .5F, .1F});
  const PolygonMesh bright = with("float", "3.5 1 0");
  EXPECT_TRUE(bright.colors.empty());
  EXPECT_TRUE(
      says(bright.notes, "must lie in [0, 1] or be whole numbers in [0, 255], but one is 3.5"));
}

// --- Coordinates of surveyors: 1 m of a statue 332 km from the origin.

constexpr Vec3 surveyed{332499.642, 5621873.207, 87.415};

/// Edges of the unit box that come out wrong, in its size.
double worst_edge(const Mesh& mesh) {
  double worst = 0.0;
  Vec3f low = mesh.positions[0], high = low;
  for (const Vec3f& p : mesh.positions)
    for (int a = 0; a < 3; ++a) low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
  const Vec3 wanted{1.037, 2.011, 3.003};
  for (int a = 0; a < 3; ++a)
    worst = std::max(worst, std::abs(static_cast<double>(high[a] - low[a]) - wanted[a]));
  return worst;
}

const MeshOptions brought_back{.to_world = {.translation = -1.0 * surveyed}};

void expect_kept(const PolygonMesh& mesh) {
  EXPECT_LT(worst_edge(prepared(mesh, brought_back).mesh), 1e-6);
  const std::string refusal = message_of([&] { (void)prepared(mesh); });
  EXPECT_NE(refusal.find("brings it near the origin"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("apart"), std::string::npos) << refusal;
  const FaceCounts counts = report_mesh(mesh).counts;
  EXPECT_NEAR(counts.high.x - counts.low.x, 1.037F, 1e-5F);
}

TEST(FarMeshes, OfObjAndPlyKeepTheirShapeIfBroughtBackAndAreRefusedElse) {
  const PolygonMesh box = make_box({1.037, 2.011, 3.003}, 1);
  std::string obj = "v 0 0 0\n";  // of no face, as cut scans have them
  char line[200];
  for (const Vec3f& p : box.positions) {
    const Vec3 far = surveyed + to_double(p);
    std::snprintf(line, sizeof line, "v %.6f %.6f %.6f\n", far.x, far.y, far.z);
    obj += line;
  }
  std::string ply = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                    std::to_string(box.positions.size()) +
                    "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                    std::to_string(face_count(box)) +
                    "\nproperty list uchar uint vertex_indices\nend_header\n";
  ByteWriter binary;
  for (const Vec3f& p : box.positions)
    for (int a = 0; a < 3; ++a) binary.put(surveyed[a] + static_cast<double>(p[a]));
  for (std::size_t f = 0; f < face_count(box); ++f) {
    obj += "f";
    binary.put(static_cast<std::uint8_t>(face(box, f).size()));
    for (const MeshCorner& corner : face(box, f)) {
      obj += " " + std::to_string(corner.position + 2);
      binary.put(corner.position);
    }
    obj += "\n";
  }
  expect_kept(parse_obj(obj, "survey.obj"));
  expect_kept(parse_ply(ply + binary.bytes, "survey.ply"));
}

TEST(FarMeshes, OfNodesAreMovedInDouble) {
  SquareGltf gltf;
  gltf.replace(R"("mesh": 0})", R"("mesh": 0, "translation": [332499.642, 5621873.207, 87.415]})");
  const PolygonMesh mesh = parse_gltf(gltf.glb(), "survey.glb");
  const Mesh back = prepared(mesh, brought_back).mesh;
  for (const Vec3f& p : back.positions)
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(p[a], std::round(p[a]), 1e-6F);
  EXPECT_NE(message_of([&] { (void)prepared(mesh); }), "");
  // Near enough: floats are fine, and nothing changes.
  SquareGltf near;
  near.replace(R"("mesh": 0})", R"("mesh": 0, "translation": [8, 0, 0]})");
  EXPECT_EQ(parse_gltf(near.glb(), "f.glb").origin, Vec3{});
}

// --- Materials.

TEST(GltfMaterials, PrimitivesWithoutOneHaveThatOfTheStandard) {
  SquareGltf gltf;
  gltf.replace(R"(, "material": 0)", "");
  const PolygonMesh mesh = parse_gltf(gltf.glb(), "f.glb");
  ASSERT_EQ(mesh.file_materials.size(), 2U);
  EXPECT_EQ(mesh.parts.at(0).material, 1U);
  EXPECT_EQ(mesh.parts[0].labels, (std::vector<std::string>{"sheet", "square"}));
  EXPECT_EQ(mesh.file_materials[1].base_color, (std::array{1.0, 1.0, 1.0}));
  EXPECT_EQ(mesh.file_materials[1].metallic, 1.0);
  EXPECT_EQ(mesh.file_materials[1].roughness, 1.0);
}

/// Where a texture transform takes a place of the texture, both counted as glTF does, v downward.
Vec2 placed(const FileTexture& texture, double u, double v) {
  const double x = texture.repeat_u * u, y = texture.repeat_v * (1.0 - v);
  const double c = std::cos(texture.rotate), s = std::sin(texture.rotate);
  return {texture.shift_u + c * x - s * y, 1.0 - (texture.shift_v + s * x + c * y)};
}

TEST(GltfMaterials, TextureTransformsAreThoseOfTheExtension) {
  const auto with = [](const std::string& transform) {
    SquareGltf gltf;
    gltf.replace(R"([{"name": "paper"}])",
                 R"([{"name": "paper", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0,
      "extensions": {"KHR_texture_transform": )" +
                     transform + R"(}}}}],
      "textures": [{"source": 0}], "images": [{"uri": "a.png"}])");
    return *parse_gltf(gltf.glb(), "f.glb").file_materials.at(0).base_color_texture;
  };
  const auto expect = [](const FileTexture& texture, double u, double v, Vec2 wanted) {
    const Vec2 found = placed(texture, u, v);
    EXPECT_NEAR(found.x, wanted.x, 1e-9);
    EXPECT_NEAR(found.y, wanted.y, 1e-9);
  };
  // The example of the extension: "only the lower left quadrant of the source image, rotated
  // clockwise 90 degrees". Its corner at the bottom left comes to the top left.
  const FileTexture quadrant =
      with(R"({"offset": [0, 1], "rotation": 1.57079632679489662, "scale": [0.5, 0.5]})");
  expect(quadrant, 0, 0, {0, 1});
  expect(quadrant, 1, 0, {0, 0.5});
  expect(quadrant, 0, 1, {0.5, 1});
  expect(quadrant, 1, 1, {0.5, 0.5});
  // Its other example "inverts the T axis".
  const FileTexture inverted = with(R"({"offset": [0, 1], "scale": [1, -1]})");
  expect(inverted, 0.25, 0.125, {0.25, 0.875});
  // Offset and unequal scales, by hand.
  const FileTexture moved = with(R"({"offset": [0.25, 0.5], "scale": [2, 3], "texCoord": 1})");
  EXPECT_EQ(moved.uv_set, 1);
  expect(moved, 0.5, 0.25, {1.25, 1.25});
}

class ObjLibraries : public testing::Test {
 protected:
  ObjLibraries() { std::filesystem::create_directories(folder_ / "sub"); }
  ~ObjLibraries() override { std::filesystem::remove_all(folder_); }
  PolygonMesh load(const std::string& line) const {
    std::ofstream(folder_ / "a.obj")
        << line << "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl one\nf 1 2 3\nusemtl two\nf 1 2 3\n";
    return load_polygon_mesh(folder_ / "a.obj");
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "lamina_libraries";
};

TEST_F(ObjLibraries, AreSeveralOnALineAndHaveBlanksInTheirNames) {
  write("a.mtl", "newmtl one\n");
  write("b.MTL", "newmtl two\n");
  write("my two.mtl", "newmtl two\n");
  for (const char* line : {"mtllib a.mtl b.MTL", "mtllib a.mtl\nmtllib my two.mtl",
                           "mtllib a.mtl my two.mtl", "mtllib a.mtl \t b.MTL a.mtl\r"}) {
    const PolygonMesh mesh = load(line);
    EXPECT_EQ(mesh.file_materials.size(), 2U) << line;
    EXPECT_EQ(mesh.parts[1].material, 1U) << line;
    EXPECT_TRUE(mesh.notes.empty()) << line << mesh.notes.front();
  }
}

TEST_F(ObjLibraries, AndTexturesOfOtherComputersAreTakenFromTheFolder) {
  write("skin one.png", "");
  write("a.mtl",
        "newmtl one\nmap_Kd C:\\Users\\me\\tex\\skin one.png\nnewmtl two\nmap_Kd -o .5 .25 "
        "//server/x/none.png\n");
  const PolygonMesh mesh = load("mtllib D:\\work\\a.mtl");
  ASSERT_EQ(mesh.file_materials.size(), 2U);
  ASSERT_TRUE(mesh.file_materials[0].base_color_texture);
  EXPECT_EQ(mesh.file_materials[0].base_color_texture->map, "skin one.png");
  EXPECT_TRUE(mesh.file_materials[0].base_color_texture->place.ends_with("a.mtl:2"));
  EXPECT_FALSE(mesh.file_materials[1].base_color_texture);
  EXPECT_TRUE(says(mesh.notes, "a.mtl beside the OBJ file is taken"));
  EXPECT_TRUE(says(mesh.notes, "a.mtl:2: the texture C:/Users/me/tex/skin one.png lies elsewhere"));
  EXPECT_TRUE(says(mesh.notes, "a.mtl:4: the texture //server/x/none.png is left out"));
}

TEST_F(ObjLibraries, InAFolderBelowHaveTheirTexturesThere) {
  write("sub/a.mtl", "newmtl one\nmap_Kd -o .5 .25 -s 2 tex.png\n");
  const PolygonMesh mesh = load("mtllib sub/a.mtl");
  const FileTexture& texture = mesh.file_materials.at(0).base_color_texture.value();
  EXPECT_EQ(texture.map, "sub/tex.png");
  EXPECT_EQ(texture.shift_u, 0.5);
  EXPECT_EQ(texture.shift_v, 0.25);
  EXPECT_EQ(texture.repeat_v, 2.0);
}

// --- Texts of other editors, and what glTF has beyond one mesh at rest.

TEST(ForeignTexts, OfOldMacsAndWithAByteOrderMarkAreRead) {
  const std::string obj = "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 \\\r 3\r";
  EXPECT_EQ(face_count(parse_obj(obj, "t.obj")), 1U);
  EXPECT_EQ(parse_obj("\xEF\xBB\xBFv 5 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "t.obj").positions[0],
            (Vec3f{5, 0, 0}));
  const std::string ply =
      "ply\rformat ascii 1.0\rcomment \\ odd\relement vertex 3\rproperty double x\rproperty "
      "float y\rproperty float z\relement face 1\rproperty list uchar int "
      "vertex_index\rend_header\r0 0 0\r1 0 0\r0 1 0\r3 0 1 2\r";
  EXPECT_EQ(face_count(parse_ply(ply, "t.ply")), 1U);
  const PolygonMesh free_form = parse_obj(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\ncstype bezier\ndeg 1 1\nsurf 0 1 0 1 1 2 3 1\nend\nf 1 2 3\n",
      "t.obj");
  EXPECT_TRUE(says(free_form.notes, "t.obj:6: free-form curves and surfaces are left out"));
}

TEST(ForeignGltf, WarnsOfOtherScenesMorphTargetsAndInstances) {
  SquareGltf gltf;
  gltf.replace(R"("scenes": [{"nodes": [0]}])", R"("scenes": [{"nodes": [0]}, {"nodes": [0]}])");
  gltf.replace(R"({"name": "sheet", )", R"({"name": "sheet", "weights": [0, 0.5], )");
  gltf.replace(R"("mesh": 0}])",
               R"("mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {}}}}])");
  const PolygonMesh mesh = parse_gltf(gltf.glb(), "f.glb");
  EXPECT_TRUE(says(mesh.notes, "scenes[0]: of 2 scenes this one is read"));
  EXPECT_TRUE(says(mesh.notes, "meshes[0].weights: morph targets are left out"));
  EXPECT_TRUE(says(mesh.notes, "nodes[0]: its instances (EXT_mesh_gpu_instancing)"));
}

TEST(ForeignGltf, MirroringAndSkewingNodesKeepTheOutsideOutside) {
  for (const char* node :
       {R"("scale": [-1, 2, 3])", R"("matrix": [-1,0,0,0, 0.5,1,0,0, 0,0.25,2,0, 0,0,0,1])"}) {
    SquareGltf gltf;  // seen from +z, below a parent that turns and stretches
    gltf.replace(R"("nodes": [{"name": "square", "mesh": 0}])",
                 R"("nodes": [{"scale": [1, 4, 1], "children": [1]}, {"mesh": 0, )" +
                     std::string(node) + "}]");
    const PolygonMesh mesh = parse_gltf(gltf.glb(), "f.glb");
    for (std::size_t f = 0; f < 2; ++f) EXPECT_GT(doubled_area(mesh, f).z, 0.0) << node;
  }
}

// --- Files that are copied.

TEST(CheckGltf, RefusesWhatParsingWouldNotReachAndPassesOverCompression) {
  const auto refusal = [](const SquareGltf& gltf) {
    return message_of([&] { (void)check_gltf(gltf.glb(), "f.glb"); });
  };
  EXPECT_EQ(refusal(SquareGltf{}), "");
  SquareGltf unused;
  unused.replace(R"("meshes": [)", R"("meshes": [{"primitives": [7]}, )");
  unused.replace(R"("mesh": 0)", R"("mesh": 1)");
  EXPECT_EQ(message_of([&] { (void)parse_gltf(unused.glb(), "f.glb"); }), "");
  EXPECT_NE(refusal(unused).find("meshes[0].primitives[0]"), std::string::npos) << refusal(unused);
  for (const auto& [from, to] :
       {std::pair<const char*, const char*>{R"("bufferViews": [)",
                                            R"("bufferViews": null, "x": [)"},
        {R"("nodes": [{)", R"("nodes": [{"matrix": 3, )"},
        {R"("materials": [{"name": "paper"}])", R"("materials": {"name": "paper"})"},
        {R"("scenes": [{"nodes": [0]}])", R"("scenes": 4)"},
        {R"("version": "2.0")", R"("version": 2)"},
        {R"("meshes": [{"name")", R"("meshes": [5, {"name")"}}) {
    SquareGltf gltf;
    gltf.replace(from, to);
    const std::string said = refusal(gltf);
    EXPECT_TRUE(said.starts_with("f.glb:")) << to << ": " << said;
  }
  SquareGltf draco;
  draco.replace(R"("scene": 0,)",
                R"("scene": 0, "extensionsRequired": ["KHR_draco_mesh_compression"],)");
  draco.replace(R"("indices": 2,)", R"("extensions": {"KHR_draco_mesh_compression": {}},)");
  EXPECT_EQ(refusal(draco), "");
}

}  // namespace
}  // namespace lamina
