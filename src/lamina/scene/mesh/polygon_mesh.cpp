// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/polygon_mesh.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/vec.h"
#include "lamina/scene/mesh/internal/mesh_borders.h"

namespace lamina {
namespace {

struct Extent {
  Vec3 low, high;
  [[nodiscard]] Vec3 middle() const { return 0.5 * (low + high); }
  [[nodiscard]] double longest_side() const {
    const Vec3 d = high - low;
    return std::max({d.x, d.y, d.z});
  }
  /// The step between floats as large as the largest coordinate.
  [[nodiscard]] double float_step() const {
    double most = 0.0;
    for (int a = 0; a < 3; ++a) most = std::max({most, std::abs(low[a]), std::abs(high[a])});
    const auto rounded = static_cast<float>(most);
    return static_cast<double>(std::nextafter(rounded, std::numeric_limits<float>::max())) -
           static_cast<double>(rounded);
  }
};

/// Around the corners of all faces, or around all positions if there are no faces.
/// @param position  of an index
template <class Position>
Extent extent_of(const PolygonMesh& mesh, std::size_t count, const Position& position) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Extent box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  const auto add = [&](const Vec3& p) {
    for (int a = 0; a < 3; ++a) {
      box.low[a] = std::min(box.low[a], p[a]);
      box.high[a] = std::max(box.high[a], p[a]);
    }
  };
  for (const MeshCorner& corner : mesh.corners)
    if (corner.position < count) add(position(corner.position));
  for (std::size_t i = 0; mesh.corners.empty() && i < count; ++i) add(position(i));
  return box.low.x <= box.high.x ? box : Extent{};
}

/// For each position the index of the first one that equals it.
std::vector<std::uint32_t> first_equal_positions(std::span<const Vec3f> positions) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t i) {
    const Vec3f& p = positions[i];
    return std::tuple(p.x, p.y, p.z);
  };
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple_cat(key(a), std::tuple(a)) < std::tuple_cat(key(b), std::tuple(b));
  });
  std::vector<std::uint32_t> first(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  return first;
}

void unify_positions(PolygonMesh& mesh) {
  const std::vector<std::uint32_t> first = first_equal_positions(mesh.positions);
  std::vector<std::uint32_t> renamed(mesh.positions.size(), no_index);
  std::vector<Vec3f> kept;
  for (MeshCorner& corner : mesh.corners) {
    std::uint32_t& name = renamed[first[corner.position]];
    if (name == no_index) {
      name = static_cast<std::uint32_t>(kept.size());
      kept.push_back(mesh.positions[corner.position]);
    }
    corner.position = name;
  }
  for (MeshCrease& crease : mesh.creases)
    crease = {renamed[first[crease.a]], renamed[first[crease.b]], crease.sharpness};
  std::erase_if(mesh.creases, [](const MeshCrease& crease) {  // of no face
    return crease.a == no_index || crease.b == no_index || crease.a == crease.b;
  });
  mesh.positions = std::move(kept);
}

/// Texture coordinates or colors.
template <class T>
void unify_values(PolygonMesh& mesh, std::vector<T>& values, std::uint32_t MeshCorner::*index) {
  if (values.empty()) return;
  std::vector<T> kept;
  std::vector<std::uint32_t> latest(mesh.positions.size(), no_index);  // [position]
  std::vector<std::uint32_t> earlier;  // [value], another at the same position
  for (MeshCorner& corner : mesh.corners) {
    if (corner.*index == no_index) continue;
    const T value = values[corner.*index];
    std::uint32_t found = latest[corner.position];
    int steps =
        64;  // a position with more texture coordinates is a needle's; spend no square of them
    while (found != no_index && steps > 0 && kept[found] != value) found = earlier[found], --steps;
    if (found == no_index || steps == 0) {
      found = static_cast<std::uint32_t>(kept.size());
      kept.push_back(value);
      earlier.push_back(std::exchange(latest[corner.position], found));
    }
    corner.*index = found;
  }
  values = std::move(kept);
}

}  // namespace

void add_face(PolygonMesh& mesh, std::span<const MeshCorner> corners, std::uint32_t part) {
  mesh.corners.insert(mesh.corners.end(), corners.begin(), corners.end());
  mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  mesh.part.push_back(part);
}

Vec3 doubled_area(const PolygonMesh& mesh, std::size_t face_index) {
  const auto corners = face(mesh, face_index);
  const Vec3 origin = to_double(mesh.positions[corners[0].position]);
  Vec3 sum;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum += cross(to_double(mesh.positions[corners[i].position]) - origin,
                 to_double(mesh.positions[corners[i + 1].position]) - origin);
  return sum;
}

Vec3 transform_point(const Transform& transform, const Vec3& p) {
  return p.x * transform.x_axis + p.y * transform.y_axis + p.z * transform.z_axis +
         transform.translation;
}

Transform combine_transforms(const Transform& outer, const Transform& inner) {
  const auto turned = [&](const Vec3& v) { return transform_point(outer, v) - outer.translation; };
  return {.x_axis = turned(inner.x_axis),
          .y_axis = turned(inner.y_axis),
          .z_axis = turned(inner.z_axis),
          .translation = transform_point(outer, inner.translation)};
}

double determinant(const Transform& transform) {
  return dot(cross(transform.x_axis, transform.y_axis), transform.z_axis);
}

void set_positions(PolygonMesh& mesh, std::span<const Vec3> positions) {
  constexpr double finest = 1e-6;
  const Extent box = extent_of(mesh, positions.size(), [&](std::size_t i) { return positions[i]; });
  mesh.origin = box.float_step() > finest * box.longest_side() ? box.middle() : Vec3{};
  mesh.positions.clear();
  mesh.positions.reserve(positions.size());
  for (const Vec3& p : positions) mesh.positions.push_back(to_float(p - mesh.origin));
}

std::optional<std::string> too_far_from_origin(const PolygonMesh& mesh, std::string_view unit) {
  constexpr double coarsest = 1e-4;
  if (mesh.origin == Vec3{}) return std::nullopt;
  const Extent box = extent_of(mesh, mesh.positions.size(), [&](std::size_t i) {
    return mesh.origin + to_double(mesh.positions[i]);
  });
  const double size = box.longest_side(), step = box.float_step();
  if (!(size > 0.0) || step <= coarsest * size) return std::nullopt;
  const auto text = [](double value) { return number_text(static_cast<float>(value)); };
  const Vec3 middle = box.middle();
  std::string place;
  for (int a = 0; a < 3; ++a)
    place += (a == 0 ? "" : ", ") + number_text(std::round(middle[a] * 1e3) / 1e3);
  return "its middle lies at (" + place + ") " + std::string(unit) +
         ", where numbers of single precision are " + text(step) + " " + std::string(unit) +
         " apart, " + text(step / size) + " of its longest side of " + text(size) + " " +
         std::string(unit) + "; \"translate\" of its \"transform\" brings it near the origin";
}

void settle_in_world(PolygonMesh& mesh) {
  if (const auto why = too_far_from_origin(mesh, "mm")) throw InvalidInput(mesh.name + ": " + *why);
  for (Vec3f& p : mesh.positions) p = to_float(mesh.origin + to_double(p));
  mesh.origin = {};
}

std::size_t drop_collapsed_faces(PolygonMesh& mesh) {
  PolygonMesh kept = mesh;
  kept.corners.clear();
  kept.face_begin = {0};
  kept.part.clear();
  std::vector<MeshCorner> corners;
  for (std::size_t f = 0; f < face_count(mesh); ++f) {
    corners.clear();
    for (const MeshCorner& corner : face(mesh, f))
      if (corners.empty() || corners.back().position != corner.position) corners.push_back(corner);
    while (corners.size() > 1 && corners.front().position == corners.back().position)
      corners.pop_back();
    const bool is_spike = corners.size() == 3 && corners[0].position == corners[2].position;
    if (corners.size() >= 3 && !is_spike) add_face(kept, corners, mesh.part[f]);
  }
  const std::size_t dropped = face_count(mesh) - face_count(kept);
  mesh = std::move(kept);
  return dropped;
}

void transform_mesh(const Transform& transform, PolygonMesh& mesh) {
  const double det = determinant(transform);
  assert(det != 0.0);
  std::vector<Vec3> moved;
  moved.reserve(mesh.positions.size());
  for (const Vec3f& p : mesh.positions)
    moved.push_back(transform_point(transform, mesh.origin + to_double(p)));
  set_positions(mesh, moved);
  // Normals go with the cofactors of the axes, whose sign a mirror would turn.
  const double side = std::copysign(1.0, det);
  const Vec3 x_cofactor = side * cross(transform.y_axis, transform.z_axis);
  const Vec3 y_cofactor = side * cross(transform.z_axis, transform.x_axis);
  const Vec3 z_cofactor = side * cross(transform.x_axis, transform.y_axis);
  for (Vec3f& n : mesh.normals) {
    const Vec3 turned = static_cast<double>(n.x) * x_cofactor +
                        static_cast<double>(n.y) * y_cofactor +
                        static_cast<double>(n.z) * z_cofactor;
    const double norm = length(turned);
    n = norm > 0.0 ? to_float(turned / norm) : Vec3f{};
  }
  if (det < 0.0)
    for (std::size_t f = 0; f < face_count(mesh); ++f)
      std::reverse(mesh.corners.begin() + mesh.face_begin[f],
                   mesh.corners.begin() + mesh.face_begin[f + 1]);
}

std::size_t unify_indices(PolygonMesh& mesh) {
  unify_positions(mesh);
  const std::size_t joined = join_borders(mesh);
  unify_values(mesh, mesh.uvs, &MeshCorner::uv);
  unify_values(mesh, mesh.colors, &MeshCorner::color);
  return joined;
}

}  // namespace lamina
