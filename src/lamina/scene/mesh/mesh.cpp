// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/mesh.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <set>
#include <utility>

#include "lamina/base/core/checked_size.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/vec.h"
#include "lamina/scene/mesh/mesh_holes.h"
#include "lamina/scene/mesh/mesh_orientation.h"
#include "lamina/scene/mesh/mesh_subdivision.h"
#include "lamina/scene/mesh/mesh_triangulation.h"

namespace lamina {
namespace {

Vec3f to_unit_float(const Vec3& v) {
  const Vec3 n = normalize(v);
  return {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)};
}

std::string counted(std::size_t count, const std::string& noun, const std::string& nouns) {
  return std::to_string(count) + " " + (count == 1 ? noun : nouns);
}

std::string counted(std::size_t count, const std::string& noun) {
  return counted(count, noun, noun + "s");
}

/// "is" or "are".
std::string be(std::size_t count) { return count == 1 ? "is" : "are"; }

void move_to_world(PolygonMesh& mesh, const Transform& to_world) {
  const double det = determinant(to_world);
  if (!std::isfinite(det) || det == 0.0)
    throw InvalidInput(mesh.name + ": its transform must not flatten it");
  transform_mesh(to_world, mesh);
  settle_in_world(mesh);
  constexpr float most = 1e9F;  // [mm]; beyond, squares of lengths in float lose all meaning
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    for (const float x : {mesh.positions[i].x, mesh.positions[i].y, mesh.positions[i].z})
      if (!(std::abs(x) <= most))
        throw InvalidInput(mesh.name + ": vertex " + std::to_string(i) +
                           " must lie within 1e9 mm of the origin, but has a coordinate " +
                           number_text(x) + " mm");
}

/// Gives white to the corners without a color if others have one.
void complete_colors(PolygonMesh& mesh) {
  const auto lacks_color = [](const MeshCorner& corner) { return corner.color == no_index; };
  if (std::ranges::all_of(mesh.corners, lacks_color)) {
    mesh.colors.clear();
    return;
  }
  if (std::ranges::none_of(mesh.corners, lacks_color)) return;
  const auto white = static_cast<std::uint32_t>(mesh.colors.size());
  mesh.colors.push_back({1, 1, 1});
  for (MeshCorner& corner : mesh.corners)
    if (lacks_color(corner)) corner.color = white;
}

/// Gives (0, 0) to the corners without texture coordinates if others have them.
/// @return how many faces have such corners.
std::size_t complete_uvs(PolygonMesh& mesh) {
  const auto lacks_uv = [](const MeshCorner& corner) { return corner.uv == no_index; };
  if (std::ranges::all_of(mesh.corners, lacks_uv)) {
    mesh.uvs.clear();
    return 0;
  }
  std::size_t faces = 0;
  for (std::size_t f = 0; f < face_count(mesh); ++f)
    if (std::ranges::any_of(face(mesh, f), lacks_uv)) ++faces;
  if (faces == 0) return 0;
  const auto zero = static_cast<std::uint32_t>(mesh.uvs.size());
  mesh.uvs.push_back({});
  for (MeshCorner& corner : mesh.corners)
    if (lacks_uv(corner)) corner.uv = zero;
  return faces;
}

/// Forgets normals that have no direction. @return how many of those that are used.
std::size_t drop_bad_normals(PolygonMesh& mesh) {
  std::vector<bool> is_bad(mesh.normals.size());
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    const double norm = length(to_double(mesh.normals[i]));
    is_bad[i] = !std::isfinite(norm) || !(norm > 0.0);
    if (!is_bad[i]) mesh.normals[i] = to_unit_float(to_double(mesh.normals[i]));
  }
  std::vector<bool> is_counted(mesh.normals.size());
  std::size_t count = 0;
  for (MeshCorner& corner : mesh.corners) {
    if (corner.normal == no_index || !is_bad[corner.normal]) continue;
    if (!is_counted[corner.normal]) ++count;
    is_counted[corner.normal] = true;
    corner.normal = no_index;
  }
  return count;
}

/// [position], the sum of the unit normals of the faces there, each times its angle there; zero
/// where there are none. Source: [ThurmerWuthrich1998].
std::vector<Vec3> smooth_normals(const PolygonMesh& mesh) {
  std::vector<Vec3> sums(mesh.positions.size());
  for (std::size_t f = 0; f < face_count(mesh); ++f) {
    const auto corners = face(mesh, f);
    const Vec3 area = doubled_area(mesh, f);
    if (!(length(area) > 0.0)) continue;
    const auto point = [&](std::size_t i) {
      return to_double(mesh.positions[corners[i % corners.size()].position]);
    };
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec3 here = point(i), to_next = point(i + 1) - here,
                 to_last = point(i + corners.size() - 1) - here;
      const Vec3 normal = cross(to_next, to_last);
      const double angle = std::atan2(length(normal), dot(to_next, to_last));
      // A bent quadrilateral has a normal at each corner; at a hollow corner that one is upside
      // down.
      const bool is_usable = dot(normal, area) > 0.0;
      sums[corners[i].position] += angle * normalize(is_usable ? normal : area);
    }
  }
  return sums;
}

/// Moves vertices along the smooth normal by the heights that a displacement has there: where
/// texture coordinates part, by their mean, so that no crack opens. Normals are forgotten.
void displace(PolygonMesh& mesh, const Displacement& displacement) {
  if (mesh.uvs.empty())
    throw InvalidInput(mesh.name +
                       ": must have texture coordinates, because it is displaced, but has none");
  const std::vector<Vec3> normals = smooth_normals(mesh);
  std::vector<double> heights(mesh.positions.size());
  std::vector<std::uint32_t> counts(mesh.positions.size());
  for (std::size_t f = 0; f < face_count(mesh); ++f) {
    Vec2f middle{};
    const auto corners = face(mesh, f);
    for (const MeshCorner& corner : corners)
      middle = middle + (1.0F / static_cast<float>(corners.size())) * mesh.uvs[corner.uv];
    for (const MeshCorner& corner : corners) {
      heights[corner.position] += static_cast<double>(displacement(mesh.uvs[corner.uv], middle));
      ++counts[corner.position];
    }
  }
  for (std::size_t p = 0; p < mesh.positions.size(); ++p) {
    const double norm = length(normals[p]);
    if (counts[p] > 0 && norm > 0.0)
      mesh.positions[p] += to_float((heights[p] / counts[p] / norm) * normals[p]);
  }
  mesh.normals.clear();
  for (MeshCorner& corner : mesh.corners) corner.normal = no_index;
}

/// Cuts polygons into triangles with one vertex per distinct position, normal and texture
/// coordinate.
class TriangleBuilder {
 public:
  TriangleBuilder(const PolygonMesh& polygons, NormalSource normals,
                  std::span<const std::uint32_t> material_of_part)
      : polygons_(polygons),
        source_(normals),
        material_of_part_(material_of_part),
        latest_(polygons.positions.size(), no_index) {
    if (normals != NormalSource::flat) smooth_ = smooth_normals(polygons);
  }

  Mesh run() {
    mesh_.name = polygons_.name;
    std::vector<Vec3> points;
    for (std::size_t f = 0; f < face_count(polygons_); ++f) {
      const auto corners = face(polygons_, f);
      points.clear();
      for (const MeshCorner& corner : corners)
        points.push_back(to_double(polygons_.positions[corner.position]));
      const Vec3 face_area = doubled_area(polygons_, f);
      for (const auto& [a, b, c] : triangulate(points)) {
        const Vec3 area = cross(points[b] - points[a], points[c] - points[a]);
        const double longest =
            std::max({length(points[b] - points[a]), length(points[c] - points[b]),
                      length(points[a] - points[c])});
        // Flatter than the rounding of its corners: the normal would be noise.
        if (!(length(area) > 1e-7 * longest * longest)) {
          ++dropped_;
          continue;
        }
        const Vec3 flat = dot(area, face_area) > 0.0 ? face_area : area;
        mesh_.triangles.push_back(
            {vertex(corners[a], flat), vertex(corners[b], flat), vertex(corners[c], flat)});
        mesh_.material.push_back(material_of_part_[polygons_.part[f]]);
      }
    }
    return std::move(mesh_);
  }

  [[nodiscard]] std::size_t dropped() const { return dropped_; }

 private:
  [[nodiscard]] Vec3f normal(const MeshCorner& corner, const Vec3& flat) const {
    if (source_ == NormalSource::flat) return to_unit_float(flat);
    if (source_ == NormalSource::file && corner.normal != no_index)
      return polygons_.normals[corner.normal];
    const Vec3& sum = smooth_[corner.position];
    return to_unit_float(length(sum) > 1e-6 ? sum : flat);
  }

  std::uint32_t vertex(const MeshCorner& corner, const Vec3& flat) {
    const Vec3f n = normal(corner, flat);
    const bool has_uv = !polygons_.uvs.empty();
    const Vec2f uv = has_uv ? polygons_.uvs[corner.uv] : Vec2f{};
    const bool has_color = !polygons_.colors.empty();
    const Vec3f color = has_color ? polygons_.colors[corner.color] : Vec3f{};
    std::uint32_t found = latest_[corner.position];
    int steps = 64;  // a position with more vertices is made of needles; do not spend their square
    for (; found != no_index && steps > 0; found = earlier_[found], --steps)
      if (mesh_.normals[found] == n && (!has_uv || mesh_.uvs[found] == uv) &&
          (!has_color || mesh_.colors[found] == color))
        return found;
    found = static_cast<std::uint32_t>(mesh_.positions.size());
    mesh_.positions.push_back(polygons_.positions[corner.position]);
    mesh_.normals.push_back(n);
    if (has_uv) mesh_.uvs.push_back(uv);
    if (has_color) mesh_.colors.push_back(color);
    earlier_.push_back(std::exchange(latest_[corner.position], found));
    return found;
  }

  const PolygonMesh& polygons_;
  NormalSource source_;
  std::span<const std::uint32_t> material_of_part_;
  std::vector<Vec3> smooth_;  // [position]
  Mesh mesh_;
  std::vector<std::uint32_t> latest_;   // [position], the last vertex made there
  std::vector<std::uint32_t> earlier_;  // [vertex], another at the same position
  std::size_t dropped_ = 0;
};

/// Sees whether there is memory for what a mesh becomes and for all on the way to it.
void take_memory(const PolygonMesh& polygons, const MeshOptions& options) {
  // Measured, of faces that share no vertices and have flat normals: 210 and 89 bytes; of smooth
  // ones that share them 69 and 56.
  constexpr std::size_t per_corner = 212, per_subdivided_corner = 92;
  const std::size_t growth = std::size_t{1} << (2 * options.subdivision);
  const std::size_t corners = checked_product(polygons.name, {polygons.corners.size(), growth});
  MemoryBudget memory = options.memory;
  take_memory(memory, corners, options.subdivision > 0 ? per_subdivided_corner : per_corner,
              polygons.name + ": " + std::to_string(corners) + " corners of faces");
}

OpenPart open_part(const OpenEdges& open, const MeshPart& part,
                   std::span<const std::uint32_t> material_of_part) {
  OpenPart result{.name = {}, .edges = open.count, .place = open.place, .materials = {}};
  for (const std::string& label : part.labels)
    result.name += (result.name.empty() ? "" : ", ") + label;
  std::set<std::uint32_t> materials;
  for (const std::uint32_t opened : open.opened) materials.insert(material_of_part[opened]);
  result.materials.assign(materials.begin(), materials.end());
  return result;
}

}  // namespace

PreparedMesh make_mesh(PolygonMesh polygons, const MeshOptions& options,
                       std::span<const std::uint32_t> material_of_part) {
  assert(material_of_part.size() == polygons.parts.size());
  PreparedMesh result;
  const std::string name = polygons.name;
  take_memory(polygons, options);
  const auto warn = [&](std::size_t count, const std::string& text) {
    if (count > 0) result.warnings.push_back(name + ": " + text);
  };
  for (const std::string& note : polygons.notes) result.warnings.push_back(note);
  move_to_world(polygons, options.to_world);
  const std::size_t joined = unify_indices(polygons);
  const std::size_t collapsed = drop_collapsed_faces(polygons);
  const std::size_t without_uvs = complete_uvs(polygons);
  complete_colors(polygons);
  const std::size_t bad_normals = drop_bad_normals(polygons);

  if (!options.closes.empty()) close_holes(polygons, options.closes);
  OrientedMesh oriented = orient_mesh(std::move(polygons));
  polygons =
      subdivide_catmull_clark(std::move(oriented.mesh), options.subdivision, options.creases);
  if (options.displacement) displace(polygons, options.displacement);
  TriangleBuilder builder(polygons,
                          options.subdivision > 0 && options.normals == NormalSource::file
                              ? NormalSource::smooth
                              : options.normals,
                          material_of_part);
  result.mesh = builder.run();
  result.mesh.is_closed = oriented.is_closed;
  for (const OpenEdges& open : oriented.open)
    result.mesh.open_parts.push_back(open_part(open, polygons.parts[open.part], material_of_part));
  const std::size_t dropped = collapsed + builder.dropped();
  if (result.mesh.triangles.empty())
    throw InvalidInput(name + ": must have a surface, but all its faces (" +
                       std::to_string(dropped) + ") have zero area");
  warn(joined, counted(joined, "vertex", "vertices") +
                   " along open edges joined to another that differs by rounding");
  warn(dropped, counted(dropped, "face") + " of zero area " + be(dropped) + " dropped");
  warn(without_uvs, counted(without_uvs, "face") + " without texture coordinates " +
                        (without_uvs == 1 ? "has" : "have") +
                        " (0, 0) among others that have them");
  warn(bad_normals, counted(bad_normals, "normal") + " without a direction " + be(bad_normals) +
                        " replaced by the mean of the faces around");
  warn(oriented.turned_faces, counted(oriented.turned_faces, "face") + " wound the wrong way " +
                                  be(oriented.turned_faces) + " turned");
  warn(oriented.inside_out, counted(oriented.inside_out, "closed surface") + " inside out " +
                                be(oriented.inside_out) + " turned");
  warn(oriented.open_inside_out, counted(oriented.open_inside_out, "surface") +
                                     " inside out, open by little, " +
                                     be(oriented.open_inside_out) + " turned");
  warn(oriented.turned_normals, "normals of " + counted(oriented.turned_normals, "face") +
                                    " pointed to the back and are turned");
  return result;
}

}  // namespace lamina
