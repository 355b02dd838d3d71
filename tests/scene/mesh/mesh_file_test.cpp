// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/files/mesh_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "lamina/scene/mesh/mesh_shapes.h"
#include "scene/mesh/mesh_samples.h"

namespace lamina {
namespace {

std::string obj_refusal(const std::string& text) {
  return message_of([&] { (void)parse_obj(text, "f.obj"); });
}
std::string ply_refusal(const std::string& text) {
  return message_of([&] { (void)parse_ply(text, "f.ply"); });
}
std::string gltf_refusal(const std::string& bytes) {
  return message_of([&] { (void)parse_gltf(bytes, "f.glb"); });
}

void expect_same_surface(const PolygonMesh& a, const PolygonMesh& b) {
  ASSERT_EQ(face_count(a), face_count(b));
  for (std::size_t f = 0; f < face_count(a); ++f) {
    ASSERT_EQ(face(a, f).size(), face(b, f).size());
    for (std::size_t c = 0; c < face(a, f).size(); ++c)
      EXPECT_EQ(a.positions[face(a, f)[c].position], b.positions[face(b, f)[c].position]);
  }
}

TEST(Obj, KeepsPolygonsAndTheirCorners) {
  const PolygonMesh box = make_box({1, 2, 3}, 2);
  const PolygonMesh read = parse_obj(obj_text(box), "box.obj");
  expect_same_surface(box, read);
  EXPECT_EQ(read.uvs.size(), box.uvs.size());
  EXPECT_EQ(face(read, 5)[2].normal, face(box, 5)[2].normal);
  EXPECT_EQ(face(read, 5)[2].uv, face(box, 5)[2].uv);
}

TEST(Obj, CountsNegativeIndicesBackFromTheLatest) {
  const PolygonMesh mesh =
      parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 1\nf -3/-1 -2/-1 -1/-1\nv 5 5 5\n", "f.obj");
  EXPECT_EQ(face(mesh, 0)[0].position, 0U);
  EXPECT_EQ(face(mesh, 0)[2].position, 2U);
  EXPECT_EQ(face(mesh, 0)[2].uv, 0U);
}

TEST(Obj, MakesPartsOfMaterialsGroupsAndObjects) {
  const PolygonMesh mesh = parse_obj(
      "o man\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl skin\ng body\nf 1 2 3\ng left eye\nusemtl eye\n"
      "f 1 2 3\r\ng body # back again\nusemtl skin\nf 1 2 3\n",
      "f.obj");
  ASSERT_EQ(mesh.parts.size(), 2U);
  EXPECT_EQ(mesh.parts[0].labels, (std::vector<std::string>{"skin", "body", "man"}));
  EXPECT_EQ(mesh.parts[1].labels, (std::vector<std::string>{"eye", "left eye", "man"}));
  EXPECT_EQ(mesh.part, (std::vector<std::uint32_t>{0, 1, 0}));
}

TEST(Obj, ReadsLinesThatGoOnAndOddSpelling) {
  const PolygonMesh mesh = parse_obj(
      "\xEF\xBB\xBF# byte order mark\n v\t+1.0e0 0 -0.0 1.0\nv 1 1e-400 0 # tail\nv 0 1 0 0.5 0.5 "
      "0.5\nvt 0.5\nf 1/1 \\\n 2/1 3/1\ns off\nl 1 2",
      "f.obj");
  EXPECT_EQ(face_count(mesh), 1U);
  EXPECT_EQ(mesh.positions[1].y, 0.0F);
  EXPECT_EQ(mesh.uvs[0], (Vec2f{0.5F, 0.0F}));
}

TEST(Obj, NamesTheLineOfWhatIsWrong) {
  EXPECT_EQ(obj_refusal("v 0 0 0\nv 1 nan 0\n"),
            "f.obj:2: vertex 2: every number must be finite, but one is \"nan\"");
  EXPECT_EQ(obj_refusal("v 0 0 1e999\n"),
            "f.obj:1: vertex 1: every number must be finite, but one is \"1e999\"");
  EXPECT_EQ(obj_refusal("v 0 0\n"), "f.obj:1: vertex 1 is cut off: a number is missing");
  EXPECT_EQ(
      obj_refusal("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
      "f.obj:4: an index of v must lie in [1, 3] or count back from the latest, but is \"4\"");
  EXPECT_EQ(
      obj_refusal("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/1 3/1\n"),
      "f.obj:4: an index of vt must lie in [1, 0] or count back from the latest, but is \"1\"");
  EXPECT_EQ(obj_refusal("v 0 0 0\nf 1 1\n"),
            "f.obj:2: a face must have at least 3 corners, but has 2");
  EXPECT_EQ(obj_refusal("v 0 0 0\n"), "f.obj: holds no faces");
  EXPECT_EQ(obj_refusal(""), "f.obj: holds no faces");
}

TEST(Ply, IsTheSameInEveryFormat) {
  const PolygonMesh sphere = make_sphere(2.0, 6);
  for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"})
    for (const bool with_confidence : {false, true}) {
      SCOPED_TRACE(format);
      expect_same_surface(sphere, parse_ply(ply_bytes(sphere, format, with_confidence), "f.ply"));
    }
}

TEST(Ply, ReadsNormalsAndTextureCoordinatesUnderTheirManyNames) {
  for (const auto& [u, v] : {std::pair{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}}) {
    const PolygonMesh mesh = parse_ply(
        std::string("ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty float x\r\n"
                    "property uchar red\r\nproperty float y\r\nproperty float z\r\nproperty float "
                    "nx\r\nproperty float ny\r\nproperty float nz\r\nproperty float ") +
            u + "\r\nproperty float " + v +
            "\r\nelement face 1\r\nproperty uchar flags\r\nproperty list int int vertex_index\r\n"
            "element edge 1\r\nproperty int a\r\nend_header\r\n0 9 0 0 0 0 1 .1 .2\r\n"
            "1 9 0 0 0 0 1 .3 .4\r\n0 9 1 0 0 0 1 .5 .6\r\n8 3 0 1 2\r\n4\r\n",
        "f.ply");
    EXPECT_EQ(mesh.positions[2], (Vec3f{0, 1, 0}));
    EXPECT_EQ(mesh.normals[face(mesh, 0)[1].normal], (Vec3f{0, 0, 1}));
    EXPECT_EQ(mesh.uvs[face(mesh, 0)[1].uv], (Vec2f{0.3F, 0.4F}));
  }
}

TEST(Ply, ReadsTextureCoordinatesOfCorners) {
  const PolygonMesh mesh = parse_ply(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 1\nproperty list uchar int vertex_indices\nproperty list uchar float "
      "texcoord\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 0 1\n",
      "f.ply");
  EXPECT_EQ(mesh.uvs[face(mesh, 0)[1].uv], (Vec2f{1, 0}));
}

TEST(Ply, SaysWhatIsWrong) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty "
      "float y\nproperty float z\nelement face 1\nproperty list uchar int "
      "vertex_indices\nend_header\n";
  EXPECT_EQ(ply_refusal(head + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"),
            "f.ply: vertex 1 of 3: y must be finite, but is nan");
  EXPECT_EQ(ply_refusal(head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
            "f.ply: face 0: a vertex index must be < 3, but is 3");
  EXPECT_EQ(ply_refusal(head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"),
            "f.ply: face 0 of 1: a vertex index must be a whole number >= 0, but is -1");
  EXPECT_EQ(ply_refusal(head + "0 0 0\n1 0 0\n0 1"), "f.ply: is cut off within vertex 2 of 3");
  EXPECT_EQ(ply_refusal(head + "0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n"),
            "f.ply: vertex 1 of 3 must hold numbers, but has \"x\"");
  EXPECT_EQ(ply_refusal(head + "0 0 0\n1 0 0\n0 1 0\n2 0 1\n"),
            "f.ply: face 0 of 1 must have at least 3 corners, but has 2");
  EXPECT_EQ(ply_refusal("solid\n"),
            "f.ply: must begin with \"ply\", but does not: it is no PLY file");
  EXPECT_EQ(ply_refusal("ply\nformat ascii 1.0\n"),
            "f.ply: the header is cut off: \"end_header\" is missing");
}

TEST(Ply, RefusesACountThatTheFileCannotHoldBeforeAllocatingForIt) {
  const std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty "
      "float y\nproperty float z\nelement face 0\nproperty list uchar int "
      "vertex_indices\nend_header\n";
  EXPECT_EQ(
      ply_refusal(bytes),
      "f.ply: is cut off: the header promises 4000000000 of vertex, which do not fit into the "
      "file");
}

TEST(Gltf, ReadsInterleavedAttributesAndTurnsVUpward) {
  const PolygonMesh mesh = parse_gltf(SquareGltf{}.glb(), "f.glb");
  ASSERT_EQ(face_count(mesh), 2U);
  for (std::size_t f = 0; f < 2; ++f)
    for (const MeshCorner& corner : face(mesh, f)) {
      const Vec3f& p = mesh.positions[corner.position];
      EXPECT_EQ(mesh.uvs[corner.uv], (Vec2f{p.x, p.y}));
    }
  EXPECT_EQ(mesh.parts[0].labels, (std::vector<std::string>{"paper", "sheet", "square"}));
}

TEST(Gltf, AppliesTheTransformsOfNodesFromTheInnermostOutward) {
  SquareGltf gltf;
  gltf.replace(R"("nodes": [{"name": "square", "mesh": 0}])",
               R"("nodes": [{"translation": [0, 0, 5], "children": [1]},
      {"rotation": [0, 0, 0.7071067811865476, 0.7071067811865476], "scale": [2, 1, 1], "mesh": 0}])");
  const PolygonMesh mesh = parse_gltf(gltf.glb(), "f.glb");
  const Vec3f corner = mesh.positions[1];  // (1, 0, 0): scaled to 2, turned from x to y, lifted
  EXPECT_NEAR(corner.x, 0.0F, 1e-6F);
  EXPECT_NEAR(corner.y, 2.0F, 1e-6F);
  EXPECT_EQ(corner.z, 5.0F);
}

TEST(Gltf, MatricesAreColumnByColumn) {
  SquareGltf gltf;
  gltf.replace(R"("nodes": [{)", R"("nodes": [{"matrix": [0,1,0,0, -1,0,0,0, 0,0,1,0, 7,8,9,1], )");
  EXPECT_EQ(parse_gltf(gltf.glb(), "f.glb").positions[1], (Vec3f{7, 9, 9}));
}

TEST(Gltf, ReadsStripsAndFansAndMeshesWithoutIndices) {
  SquareGltf strip, fan, plain;
  strip.replace(R"("indices": 2,)", R"("mode": 5,)");
  const PolygonMesh as_strip = parse_gltf(strip.glb(), "f.glb");
  ASSERT_EQ(face_count(as_strip), 2U);
  for (std::size_t f = 0; f < 2; ++f) EXPECT_EQ(doubled_area(as_strip, f), (Vec3{0, 0, 1}));
  fan.replace(R"("indices": 2,)", R"("mode": 6,)");
  EXPECT_EQ(face_count(parse_gltf(fan.glb(), "f.glb")), 2U);
  plain.replace(R"("indices": 2,)", "");
  EXPECT_NE(gltf_refusal(plain.glb()).find("triangles must have 3 indices each, but there are 4"),
            std::string::npos);
}

TEST(Gltf, ReadsBuffersFromTextAndFromFiles) {
  // 92 bytes of the square in base64, by an encoder of its own.
  const std::string binary = SquareGltf{}.binary;
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < binary.size(); i += 3) {
    const auto at = [&](std::size_t k) {
      return k < binary.size() ? static_cast<unsigned char>(binary[k]) : 0U;
    };
    const unsigned bits = at(i) << 16 | at(i + 1) << 8 | at(i + 2);
    for (unsigned k = 0; k < 4; ++k)
      text += i + k <= binary.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
  }
  SquareGltf embedded;
  embedded.replace(
      R"({"byteLength": 92})",
      R"({"byteLength": 92, "uri": "data:application/octet-stream;base64,)" + text + "\"}");
  EXPECT_EQ(face_count(parse_gltf(embedded.json, "f.gltf")), 2U);

  const std::filesystem::path folder = testing::TempDir();
  std::ofstream(folder / "two words.bin", std::ios::binary) << binary;
  SquareGltf external;
  external.replace(R"({"byteLength": 92})", R"({"byteLength": 92, "uri": "two%20words.bin"})");
  EXPECT_EQ(face_count(parse_gltf(external.json, folder / "f.gltf")), 2U);
  external.replace("two%20words", "none");
  EXPECT_EQ(message_of([&] { (void)parse_gltf(external.json, folder / "f.gltf"); }),
            (folder / "none.bin").string() + ": there is no such file");
}

TEST(Gltf, SparseAccessorsReplaceValues) {
  SquareGltf gltf;
  gltf.replace(R"("count": 4, "type": "VEC3"})",
               R"("count": 4, "type": "VEC3", "sparse": {"count": 1,
      "indices": {"bufferView": 1, "byteOffset": 4, "componentType": 5123},
      "values": {"bufferView": 0, "byteOffset": 60}}})");
  // Index 3, the corner (1, 1, 0), gets the first three floats at 60: (1, 1, 0) again; then
  // index 1.
  EXPECT_EQ(parse_gltf(gltf.glb(), "f.glb").positions[3], (Vec3f{1, 1, 0}));
  gltf.replace(R"("byteOffset": 4, "componentType")", R"("byteOffset": 2, "componentType")");
  EXPECT_EQ(parse_gltf(gltf.glb(), "f.glb").positions[1], (Vec3f{1, 1, 0}));
}

TEST(Gltf, NormalizedIntegersAreFractions) {
  SquareGltf gltf;
  gltf.replace(R"("byteOffset": 12, "componentType": 5126, "count": 4)",
               R"("byteOffset": 12, "componentType": 5121, "normalized": true, "count": 4)");
  for (std::size_t i = 0; i < 4; ++i) gltf.binary[20 * i + 12] = static_cast<char>(51 * i);
  const PolygonMesh mesh = parse_gltf(gltf.glb(), "f.glb");
  for (std::size_t i = 0; i < 4; ++i) EXPECT_FLOAT_EQ(mesh.uvs[i].x, 0.2F * static_cast<float>(i));
}

TEST(Gltf, RefusesCompressionByName) {
  SquareGltf draco;
  draco.replace(R"("scene": 0,)",
                R"("scene": 0, "extensionsRequired": ["KHR_draco_mesh_compression"],)");
  EXPECT_EQ(
      gltf_refusal(draco.glb()),
      "f.glb:1: extensionsRequired[0]: the mesh is Draco compressed "
      "(KHR_draco_mesh_compression), which lamina does not read; save it without compression");
  SquareGltf meshopt;
  meshopt.replace(R"({"buffer": 0, "byteOffset": 80,)",
                  R"({"extensions": {"EXT_meshopt_compression": {}}, "buffer": 0, )");
  EXPECT_NE(gltf_refusal(meshopt.glb()).find("EXT_meshopt_compression"), std::string::npos);
}

TEST(Gltf, SaysWhatIsWrong) {
  const auto refusal_with = [](std::string_view from, const std::string& to) {
    return gltf_refusal(SquareGltf{}.replace(from, to).glb());
  };
  EXPECT_EQ(refusal_with(R"("byteLength": 12)", R"("byteLength": 10)"),
            "f.glb:9: accessors[2]: its 6 elements reach beyond the end of their buffer view of 10 "
            "bytes");
  EXPECT_EQ(refusal_with(R"("byteLength": 12)", R"("byteLength": 13)"),
            "f.glb:12: bufferViews[1]: reaches beyond the end of its buffer of 92 bytes");
  EXPECT_EQ(refusal_with(R"("count": 4)", R"("count": 4000000000)").find("f.glb:7: accessors[0]"),
            0U);
  EXPECT_EQ(refusal_with(R"("byteLength": 92)", R"("byteLength": 96)"),
            "f.glb:13: buffers[0] is cut off: it must have 96 bytes, but has 92");
  EXPECT_EQ(
      refusal_with(R"("POSITION": 0)", R"("POSITION": 3)"),
      "f.glb:5: meshes[0].primitives[0].attributes.POSITION must be a whole number in [0, 2], "
      "but is 3");
  EXPECT_EQ(refusal_with(R"("mesh": 0)", R"("mesh": 0, "children": [0])"),
            "f.glb:2: nodes[0].children[0]: a node must have one parent, but node 0 has several");
  SquareGltf out_of_range;
  out_of_range.binary[80] = 4;
  EXPECT_EQ(gltf_refusal(out_of_range.glb()),
            "f.glb:5: meshes[0].primitives[0].indices: index 0 must be < 4, but is 4");
  SquareGltf not_a_number;
  ByteWriter nan;
  nan.put(std::nanf(""));
  not_a_number.binary.replace(24, 4, nan.bytes);
  EXPECT_EQ(gltf_refusal(not_a_number.glb()),
            "f.glb:5: meshes[0].primitives[0].attributes.POSITION: vertex 1 of 4: every coordinate "
            "must be finite, but one is nan");
  const std::string glb = SquareGltf{}.glb();
  EXPECT_EQ(gltf_refusal(glb.substr(0, glb.size() - 10)).find("f.glb: is cut off: the header"), 0U);
}

TEST(MeshFile, RefusesWhatItCannotRead) {
  const auto refusal = [](const std::string& file) {
    return message_of([&] { (void)load_polygon_mesh(file); });
  };
  EXPECT_EQ(refusal("none.obj"), "none.obj: there is no such file");
  EXPECT_EQ(refusal("head.max"),
            "head.max: a mesh must be .obj, .ply, .gltf or .glb, but is \".max\"");
  const std::string folder = testing::TempDir() + "folder.ply";
  std::filesystem::create_directory(folder);
  EXPECT_EQ(refusal(folder), folder + ": is a folder, but must be a file");
}

TEST(MeshFile, ReadsMeshesOfTheWorld) {
  const std::filesystem::path meshes = std::filesystem::path(LAMINA_SHARED_DATA) / "meshes";
  if (!std::filesystem::exists(meshes)) GTEST_SKIP() << "no reference data at " << meshes;
  const PolygonMesh spot = load_polygon_mesh(meshes / "spot.obj");
  EXPECT_EQ(face_count(spot), 5856U);
  EXPECT_EQ(spot.positions.size(), 2930U);
  const PolygonMesh human = load_polygon_mesh(meshes / "makehuman_base_hm08.obj");
  EXPECT_EQ(human.positions.size(), 19158U);
  EXPECT_EQ(human.uvs.size(), 21334U);
  EXPECT_NE(message_of([&] {
              (void)load_polygon_mesh(meshes / "LeePerrySmith/LeePerrySmith_draco.glb");
            }).find("Draco compressed"),
            std::string::npos);
}

}  // namespace
}  // namespace lamina
