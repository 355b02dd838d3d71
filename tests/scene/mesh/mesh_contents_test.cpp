// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// What mesh files hold beside their shape: colors, creases, several sets of texture coordinates,
// instances, materials.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "lamina/base/core/error.h"
#include "lamina/scene/mesh/files/gltf_image.h"
#include "lamina/scene/mesh/files/mesh_file.h"
#include "lamina/scene/mesh/mesh.h"
#include "lamina/scene/mesh/mesh_shapes.h"
#include "scene/mesh/mesh_samples.h"

namespace lamina {
namespace {

float linear(float srgb) { return std::pow((srgb + 0.055F) / 1.055F, 2.4F); }

TEST(MeshColors, OfObjAreSrgbAndOfWhiteWhereThereAreNone) {
  const PolygonMesh mesh = parse_obj("v 0 0 0\nv 1 0 0 .5 1 0\nv 0 1 0 1 1 1\nf 1 2 3\n", "t.obj");
  ASSERT_EQ(mesh.colors.size(), 3U);
  EXPECT_EQ(mesh.colors[0], (Vec3f{1, 1, 1}));
  EXPECT_NEAR(mesh.colors[1].x, linear(0.5F), 1e-6F);
  EXPECT_EQ(mesh.colors[1].y, 1.0F);
  EXPECT_EQ(mesh.corners[1].color, 1U);
  EXPECT_TRUE(parse_obj("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n", "w.obj").colors.empty());
  EXPECT_NE(message_of([] { (void)parse_obj("v 0 0 0 1 nan 0\n", "t.obj"); }).find("finite"),
            std::string::npos);
}

TEST(MeshColors, OfPlyFollowTheirType) {
  const std::string bytes =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty "
      "list uchar int vertex_indices\nend_header\n0 0 0 255 0 128\n1 0 0 0 0 0\n0 1 0 1 1 1\n3 0 1 "
      "2\n";
  const PolygonMesh mesh = parse_ply(bytes, "t.ply");
  ASSERT_EQ(mesh.colors.size(), 3U);
  EXPECT_EQ(mesh.colors[0].x, 1.0F);
  EXPECT_NEAR(mesh.colors[0].z, linear(128.0F / 255.0F), 1e-6F);
}

TEST(MeshColors, ReachTheTrianglesThroughSubdivision) {
  PolygonMesh mesh =
      parse_obj("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 1 0 0\nv 0 1 0 0 1 0\nf 1 2 3 4\n", "t.obj");
  const std::vector<std::uint32_t> material = {0};
  const Mesh made = make_mesh(std::move(mesh), {.subdivision = 1}, material).mesh;
  ASSERT_EQ(made.colors.size(), made.positions.size());
  for (std::size_t v = 0; v < made.positions.size(); ++v)
    if (made.positions[v] == Vec3f{0.5F, 0.5F, 0}) {
      EXPECT_NEAR(made.colors[v].x, 0.5F, 1e-6F);
      EXPECT_NEAR(made.colors[v].y, 0.5F, 1e-6F);
    }
}

TEST(MeshCreases, AreReadFromObjAndPlyAndSurviveUnifying) {
  PolygonMesh mesh = parse_obj(
      "v 0 0 0\nv 1 0 0\nv 0 0 0\nv 0 1 0\nf 1 2 4\nf 3 4 2\nt crease 2/1/0 2 3 1.5\n", "t.obj");
  ASSERT_EQ(mesh.creases.size(), 1U);
  (void)unify_indices(mesh);
  ASSERT_EQ(mesh.creases.size(), 1U);
  EXPECT_EQ(mesh.positions[mesh.creases[0].a], (Vec3f{0, 0, 0}));
  EXPECT_EQ(mesh.positions[mesh.creases[0].b], (Vec3f{0, 1, 0}));
  EXPECT_EQ(mesh.creases[0].sharpness, 1.5F);
  for (const char* line : {"t crease 2/1/0 0 3 1", "t crease 2/1/0 0 1", "t crease 1/1/0 0 1 1",
                           "t crease 2/1/0 0 1.5 1", "t crease 2/1/0 0 1 -1"})
    EXPECT_NE(message_of([&] {
                (void)parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + std::string(line) + "\nf 1 2 3\n",
                                "t.obj");
              }),
              "")
        << line;
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 1\nproperty list uchar int vertex_indices\nelement edge 2\nproperty int "
      "vertex1\nproperty int vertex2\nproperty float crease\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 "
      "1 "
      "2\n0 1 2.5\n1 2 0\n";
  const PolygonMesh from_ply = parse_ply(ply, "t.ply");
  ASSERT_EQ(from_ply.creases.size(), 1U);
  EXPECT_EQ(from_ply.creases[0].sharpness, 2.5F);
}

TEST(Displacement, MovesAPlaneByItsHeightsAndTiltsItsNormals) {
  const std::vector<std::uint32_t> material = {0};
  const MeshOptions options{.displacement = [](Vec2f uv, Vec2f) { return 0.5F * uv.x - 0.25F; }};
  const Mesh made = make_mesh(make_rectangle(2, 2, 8), options, material).mesh;
  for (std::size_t v = 0; v < made.positions.size(); ++v) {
    EXPECT_NEAR(made.positions[v].z, 0.25F * made.positions[v].x, 1e-6F);
    EXPECT_NEAR(made.normals[v].x, -0.25F / std::sqrt(1.0625F), 1e-5F);
  }
}

TEST(Displacement, OpensNoCrackAlongSeamsAndKeepsAClosedSurfaceClosed) {
  const std::vector<std::uint32_t> material = {0};
  const MeshOptions options{
      .displacement = [](Vec2f uv, Vec2f) { return 0.1F * std::sin(40.0F * uv.x + 7.0F * uv.y); }};
  const Mesh made = make_mesh(make_bumpy_sphere(1.0, 8), options, material).mesh;
  EXPECT_TRUE(made.is_closed);
  for (std::size_t a = 0; a < made.positions.size(); ++a)  // vertices that part only by texture
    for (std::size_t b = 0; b < a; ++b)
      if (made.positions[a] != made.positions[b]) {
        EXPECT_GT(length(made.positions[a] - made.positions[b]), 1e-3F);
      }
}

const std::filesystem::path inputs =
    std::filesystem::path(LAMINA_SOURCE_DIR) / "tests" / "inputs" / "scene" / "good";

TEST(GltfContents, InstancesColorsSetsAndMaterialsAreRead) {
  MemoryBudget memory;
  const PolygonMesh mesh = load_polygon_mesh(inputs / "triangle.gltf", memory, {.uv_set = 1});
  ASSERT_EQ(mesh.parts.size(), 2U);                  // two nodes with one mesh
  EXPECT_EQ(mesh.parts[0].labels.back(), "second");  // the last node first
  EXPECT_EQ(mesh.uv_sets, 2);
  ASSERT_EQ(mesh.uvs.size(), 6U);
  EXPECT_EQ(mesh.uvs[0], (Vec2f{0.5F, 0.5F}));  // v counts up
  EXPECT_EQ(mesh.uvs[2], (Vec2f{0.5F, 0.0F}));
  EXPECT_EQ(mesh.colors[1], (Vec3f{0, 1, 0}));
  EXPECT_EQ(std::abs(mesh.positions[0].z - mesh.positions[3].z), 1.0F);
  ASSERT_EQ(mesh.file_materials.size(), 1U);
  const FileMaterial& paint = mesh.file_materials[0];
  EXPECT_EQ(paint.name, "paint");
  EXPECT_EQ(paint.base_color[1], 0.4);
  EXPECT_EQ(paint.roughness, 0.5);
  EXPECT_EQ(mesh.parts[1].material, 0U);
}

TEST(GltfContents, ExtensionsOfMaterialsAreReadAndTheRestIsNamed) {
  const std::string text = R"({ "asset": { "version": "2.0" }, "scenes": [ { "nodes": [ 0 ] } ],
    "nodes": [ { "mesh": 0 } ],
    "meshes": [ { "primitives": [ { "attributes": { "POSITION": 0 }, "material": 0 } ] } ],
    "accessors": [ { "componentType": 5126, "count": 3, "type": "VEC3", "bufferView": 0 } ],
    "bufferViews": [ { "buffer": 0, "byteLength": 36 } ],
    "buffers": [ { "byteLength": 36, "uri":
      "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA" } ],
    "images": [ { "uri": "skin%20a.png" }, { "bufferView": 0, "mimeType": "image/png" } ],
    "textures": [ { "source": 0 }, { "source": 1 }, { "extensions": { "EXT_texture_webp": {} } } ],
    "materials": [ { "name": "leaf", "alphaMode": "MASK", "emissiveFactor": [ 0, 0.5, 0 ],
      "pbrMetallicRoughness": { "baseColorFactor": [ 2, 0.5, 0, 0.9 ], "roughnessFactor": 0.25,
        "metallicFactor": 0,
        "baseColorTexture": { "index": 0, "texCoord": 1,
          "extensions": { "KHR_texture_transform": { "scale": [ 3, 1 ] } } } },
      "normalTexture": { "index": 1, "scale": 0.5 }, "occlusionTexture": { "index": 2 },
      "extensions": {
        "KHR_materials_ior": { "ior": 1.33 }, "KHR_materials_clearcoat": {},
        "KHR_materials_volume": { "thicknessFactor": 0.002, "attenuationDistance": 0.001,
          "attenuationColor": [ 0.5, 0.6, 0.7 ] },
        "KHR_materials_emissive_strength": { "emissiveStrength": 10 },
        "KHR_materials_diffuse_transmission": { "diffuseTransmissionFactor": 0.4,
          "diffuseTransmissionColorFactor": [ 0.1, 0.2, 0.3 ] } } } ] })";
  const PolygonMesh mesh = parse_gltf(text, "folder/leaf.gltf");
  ASSERT_EQ(mesh.file_materials.size(), 1U);
  const FileMaterial& leaf = mesh.file_materials[0];
  EXPECT_EQ(leaf.base_color, (std::array{1.0, 0.5, 0.0}));  // no more than all
  ASSERT_TRUE(leaf.base_color_texture);
  EXPECT_EQ(leaf.base_color_texture->map, "leaf.gltf#0");
  EXPECT_EQ(leaf.base_color_texture->uv_set, 1);
  EXPECT_EQ(leaf.base_color_texture->repeat_u, 3.0);
  ASSERT_TRUE(leaf.normal_texture);
  EXPECT_EQ(leaf.normal_texture->map, "leaf.gltf#1");
  EXPECT_TRUE(leaf.has_cutouts);
  EXPECT_EQ(leaf.opacity, 0.9);
  EXPECT_EQ(leaf.ior, 1.33);
  EXPECT_EQ(leaf.attenuation_distance, 0.001);
  EXPECT_EQ(leaf.diffuse_transmission, 0.4);
  EXPECT_EQ(leaf.emission[1], 5.0);
  EXPECT_EQ(leaf.ignored, (std::vector<std::string>{"normalTexture.scale", "occlusionTexture",
                                                    "KHR_materials_clearcoat"}));
}

TEST(GltfContents, ImagesOutsideOfTheFolderAreRefused) {
  const auto text = [](const std::string& uri) {
    return R"({ "asset": { "version": "2.0" }, "scenes": [ {} ], "images": [ { "uri": ")" + uri +
           R"(" } ], "textures": [ { "source": 0 } ],
      "materials": [ { "normalTexture": { "index": 0 } } ] })";
  };
  for (const char* uri : {"../../etc/passwd", "/etc/passwd", "a/../../b.png"})
    EXPECT_NE(message_of([&] { (void)parse_gltf(text(uri), "a.gltf"); }).find("in the folder"),
              std::string::npos)
        << uri;
}

TEST(GltfImages, AreNamedByTheirFileAndNumber) {
  EXPECT_EQ(gltf_image_name("a/head.glb#12")->index, 12U);
  EXPECT_EQ(gltf_image_name("a/head.glb#12")->file, "a/head.glb");
  for (const char* path : {"head.glb", "head.png#1", "head.glb#", "head.glb#-1", "head.glb#1x"})
    EXPECT_FALSE(gltf_image_name(path)) << path;
  MemoryBudget memory;
  EXPECT_NE(message_of([&] {
              (void)load_gltf_image({inputs / "triangle.gltf", 0}, memory);
            }).find("has no image 0"),
            std::string::npos);
}

TEST(ObjMaterials, AreReadFromTheirLibrary) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "lamina_obj_materials";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "a.obj") << "mtllib a.mtl\nmtllib none.mtl\nmtllib ../b.mtl\nv 0 0 0\nv 1 "
                                     "0 0\nv 0 1 0\nusemtl red paint\nf 1 2 3\n";
  std::ofstream(folder / "a.mtl")
      << "newmtl red paint\r\nKd 0.8 0.1 0.1\nKs 1 1 1\nNs 198\nNi 1.4\nd 0.5\nKe 0 0 2\n"
         "map_Kd -s 2 3 1 -blendu off tex\\red one.png\nmap_bump -bm 0.3 b.png\nmap_Ks s.png\nKa 1 "
         "1 1\nillum 2\n";
  const PolygonMesh mesh = load_polygon_mesh(folder / "a.obj");
  ASSERT_EQ(mesh.file_materials.size(), 1U);
  ASSERT_EQ(mesh.parts[0].material, 0U);
  const FileMaterial& red = mesh.file_materials[0];
  EXPECT_EQ(red.base_color[0], 0.8);
  EXPECT_TRUE(red.has_specular);
  EXPECT_NEAR(red.roughness * red.roughness, 0.1, 1e-12);  // sqrt(2 / 200)
  EXPECT_EQ(red.ior, 1.4);
  EXPECT_EQ(red.opacity, 0.5);
  EXPECT_EQ(red.emission[2], 1.0);  // no more than all
  ASSERT_TRUE(red.base_color_texture);
  EXPECT_EQ(red.base_color_texture->map, "tex/red one.png");
  EXPECT_EQ(red.base_color_texture->repeat_v, 3.0);
  EXPECT_EQ(red.bump_scale, 0.3);
  EXPECT_EQ(red.ignored, (std::vector<std::string>{"-blendu", "map_Ks"}));
  ASSERT_EQ(mesh.notes.size(), 2U);
  EXPECT_NE(mesh.notes[0].find("none.mtl"), std::string::npos);
  EXPECT_NE(mesh.notes[1].find("must lie in the folder"), std::string::npos);
  EXPECT_EQ(red.base_color_texture->place, (folder / "a.mtl").string() + ":8");
  std::ofstream(folder / "a.mtl") << "newmtl x\nKd 1 2 three\n";
  EXPECT_NE(message_of([&] { (void)load_polygon_mesh(folder / "a.obj"); }).find("a.mtl:2: "),
            std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST(MeshFiles, OfOtherKindsSayHowToConvertThem) {
  for (const char* name : {"a.abc", "a.usd", "a.USDA", "a.usdc", "a.usdz", "a.fbx", "a.stl"})
    EXPECT_NE(message_of([&] { (void)load_polygon_mesh(name); }).find("export it as glTF (.glb)"),
              std::string::npos)
        << name;
}

}  // namespace
}  // namespace lamina
