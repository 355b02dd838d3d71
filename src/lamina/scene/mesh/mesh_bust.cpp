// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <span>
#include <unordered_map>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/scene/mesh/mesh_shapes.h"

namespace lamina {
namespace {

// Solids by the distance to their surface, negative inside; the head is about 1.5 high.

double ball(const Vec3& p, const Vec3& center, double radius) {
  return length(p - center) - radius;
}

double ellipsoid(const Vec3& p, const Vec3& center, const Vec3& radii) {
  const Vec3 q = p - center;
  const Vec3 a{q.x / radii.x, q.y / radii.y, q.z / radii.z};
  const double slope = length(Vec3{a.x / radii.x, a.y / radii.y, a.z / radii.z});
  const double norm = length(a);
  return slope > 0.0 ? norm * (norm - 1.0) / slope : -std::min({radii.x, radii.y, radii.z});
}

/// A rod with round ends whose radius goes from the first to the second.
double rod(const Vec3& p, const Vec3& from, const Vec3& to, double radius_from, double radius_to) {
  const Vec3 along = to - from;
  const double t = std::clamp(dot(p - from, along) / dot(along, along), 0.0, 1.0);
  return length(p - from - t * along) - (radius_from + t * (radius_to - radius_from));
}

/// The union, its seam rounded over a width.
double join(double a, double b, double width) {
  const double h = std::max(width - std::abs(a - b), 0.0) / width;
  return std::min(a, b) - 0.25 * width * h * h;
}

double carve(double solid, double tool, double width) { return -join(-solid, tool, width); }

double face(const Vec3& p) {
  double d = join(ellipsoid(p, {0, 1.78, -0.10}, {0.66, 0.74, 0.80}),  // skull
                  ellipsoid(p, {0, 1.42, 0.22}, {0.50, 0.66, 0.54}), 0.25);
  d = join(d, rod(p, {0, 0.93, 0.60}, {0.10, 0.93, 0.58}, 0.15, 0.15), 0.25);    // chin
  d = join(d, rod(p, {0.36, 1.05, 0.18}, {0.47, 1.45, 0.02}, 0.13, 0.12), 0.2);  // jaw
  d = join(d, ball(p, {0.30, 1.38, 0.55}, 0.16), 0.2);                           // cheek
  d = carve(d, ellipsoid(p, {0.23, 1.66, 0.80}, {0.17, 0.12, 0.17}), 0.14);      // eye socket
  d = join(d, rod(p, {0, 1.84, 0.70}, {0.36, 1.83, 0.58}, 0.07, 0.07), 0.10);    // brow
  d = join(d, ellipsoid(p, {0.225, 1.645, 0.60}, {0.125, 0.10, 0.12}), 0.03);    // eye
  d = join(d, rod(p, {0, 1.75, 0.76}, {0, 1.36, 0.95}, 0.06, 0.095), 0.08);      // nose
  d = join(d, ball(p, {0.075, 1.345, 0.86}, 0.07), 0.05);
  d = join(d, rod(p, {0, 1.175, 0.80}, {0.13, 1.15, 0.72}, 0.052, 0.03), 0.06);  // lips
  d = join(d, rod(p, {0, 1.085, 0.785}, {0.11, 1.10, 0.72}, 0.058, 0.03), 0.04);
  d = join(d, ellipsoid(p, {0.66, 1.52, -0.08}, {0.07, 0.22, 0.14}), 0.06);  // ear
  return carve(d, ellipsoid(p, {0.74, 1.55, -0.02}, {0.05, 0.13, 0.07}), 0.04);
}

/// Waves combed back from a parting, and a bun.
double hair(const Vec3& p) {
  const Vec3 q = p - Vec3{0, 1.78, -0.10};
  const double back = std::atan2(q.y, 0.2 - q.z), out = std::atan2(q.x, std::hypot(q.y, q.z));
  const double fade = std::clamp(1.2 - out, 0.0, 0.5) / 0.5;
  const double wave = 0.03 * fade * std::sin(14.0 * back + 3.0 * std::sin(5.0 * out));
  double d = ellipsoid(p, {0, 1.82, -0.14}, {0.73, 0.80, 0.82}) - wave;
  d = carve(d, rod(p, {0, 1.3, 0.9}, {0, 1.75, 0.9}, 0.62, 0.62), 0.10);  // the face stays free
  d = carve(d, p.y - (p.z < 0.0 ? 1.10 : 1.35), 0.05);
  return join(d, ball(p, {0, 1.75, -1.0}, 0.26) + 0.02 * std::sin(18.0 * std::atan2(p.x, q.y)),
              0.08);
}

double bust(const Vec3& point) {
  const Vec3 p{std::abs(point.x), point.y, point.z};  // both halves are alike
  double torso = join(rod(p, {0, -0.02, -0.2}, {0.85, -0.16, -0.22}, 0.34, 0.30),  // shoulders
                      ellipsoid(p, {0, -0.35, -0.05}, {0.80, 0.62, 0.46}), 0.3);
  torso = join(torso, rod(p, {0.08, 0.22, 0.10}, {0.6, 0.25, 0.02}, 0.05, 0.05), 0.12);
  double body = join(rod(p, {0, 1.15, -0.12}, {0, 0.2, -0.16}, 0.33, 0.37), torso, 0.3);  // neck
  body = join(body, rod(p, {0.05, 0.25, 0.14}, {0.34, 1.15, -0.08}, 0.05, 0.06), 0.1);
  double d = join(join(face(p), hair(p), 0.05), body, 0.12);
  d = carve(d, p.y + 0.62, 0.08);  // cut off below
  const double foot =
      std::max(std::hypot(p.x, p.z + 0.1) - 0.28 + 0.06 * std::cos(9.0 * (p.y + 0.7)),
               std::abs(p.y + 0.78) - 0.2);
  const double plinth =
      std::max({p.x - 0.46, std::abs(p.z + 0.1) - 0.46, std::abs(p.y + 1.03) - 0.1}) - 0.02;
  return std::min(join(d, foot, 0.08), plinth);
}

constexpr Vec3 low{-1.3, -1.2, -1.35}, high{1.3, 2.75, 1.15};  // a box around it
constexpr double bottom = -1.15, top = 2.65;

/// Marching tetrahedra [DoiKoide1991]: each cell is cut into six around its diagonal, which meet
/// their neighbours face to face, so that the surface is closed.
/// @param visit  takes the corners of a tetrahedron inside and outside, of neither none
template <class Visit>
void for_cut_tetrahedra(const std::array<std::size_t, 3>& size, const std::vector<float>& distance,
                        const Visit& visit) {
  const std::array<std::size_t, 3> step = {1, size[0], size[0] * size[1]};
  std::array<std::size_t, 3> order = {0, 1, 2};
  do {
    for (std::size_t z = 0; z + 1 < size[2]; ++z)
      for (std::size_t y = 0; y + 1 < size[1]; ++y)
        for (std::size_t x = 0; x + 1 < size[0]; ++x) {
          std::size_t corner = x + y * step[1] + z * step[2];
          std::array<std::size_t, 4> in{}, out{};
          std::size_t ins = 0, outs = 0;
          for (std::size_t k = 0; k < 4; ++k) {
            (distance[corner] < 0.0F ? in[ins++] : out[outs++]) = corner;
            if (k < 3) corner += step[order[k]];
          }
          if (ins > 0 && outs > 0) visit(std::span(in).first(ins), std::span(out).first(outs));
        }
  } while (std::ranges::next_permutation(order).found);
}

}  // namespace

PolygonMesh make_bust(double height, int tessellation) {
  assert(height > 0.0 && 1 <= tessellation && tessellation <= most_tessellation);
  const double cell = (high.y - low.y) / std::max(tessellation, 16);
  const auto count = [&](double from, double to) {
    return static_cast<std::size_t>(std::ceil((to - from) / cell)) + 1;
  };
  const std::array<std::size_t, 3> size = {count(low.x, high.x), count(low.y, high.y),
                                           count(low.z, high.z)};
  const std::array<std::size_t, 3> step = {1, size[0], size[0] * size[1]};
  const auto point = [&](std::size_t index) {
    return low + cell * Vec3{static_cast<double>(index % size[0]),
                             static_cast<double>(index / size[0] % size[1]),
                             static_cast<double>(index / step[2])};
  };
  std::vector<float> distance(step[2] * size[2]);
  for (std::size_t i = 0; i < distance.size(); ++i)
    distance[i] = static_cast<float>(bust(point(i)));

  PolygonMesh mesh;
  mesh.name = "bust";
  mesh.parts = {{}};
  const double scale = height / (top - bottom);
  std::unordered_map<std::uint64_t, std::uint32_t> vertex_of_edge;
  const auto vertex_on = [&](std::size_t inside, std::size_t outside) {
    const std::uint64_t key =
        std::uint64_t{std::min(inside, outside)} * distance.size() + std::max(inside, outside);
    const auto [found, is_new] =
        vertex_of_edge.try_emplace(key, static_cast<std::uint32_t>(mesh.positions.size()));
    if (is_new) {
      const Vec3 a = point(inside), b = point(outside);
      double from = 0.0, to = 1.0;
      for (int halving = 0; halving < 12; ++halving) {
        const double middle = 0.5 * (from + to);
        (bust(a + middle * (b - a)) < 0.0 ? from : to) = middle;
      }
      // Off the ends, so that no triangle is without area.
      const Vec3 p = a + std::clamp(from, 0.002, 0.998) * (b - a);
      mesh.positions.push_back(to_float(scale * (p - Vec3{0, 0.5 * (top + bottom), 0})));
    }
    return found->second;
  };
  const auto add_triangle = [&](std::array<std::uint32_t, 3> corners, const Vec3& outward) {
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& q = mesh.positions[corners[k]];
      p[k] = {static_cast<double>(q.x), static_cast<double>(q.y), static_cast<double>(q.z)};
    }
    if (dot(cross(p[1] - p[0], p[2] - p[0]), outward) < 0.0) std::swap(corners[1], corners[2]);
    std::vector<MeshCorner> face;
    for (const std::uint32_t v : corners) face.push_back({.position = v});
    add_face(mesh, face, 0);
  };

  const auto add_between = [&](std::span<const std::size_t> in, std::span<const std::size_t> out) {
    const Vec3 outward = point(out[0]) - point(in[0]);
    std::vector<std::uint32_t> v;
    if (in.size() == 2)  // around the four edges that are cut
      v = {vertex_on(in[0], out[0]), vertex_on(in[0], out[1]), vertex_on(in[1], out[1]),
           vertex_on(in[1], out[0])};
    else
      for (const std::size_t a : in)
        for (const std::size_t b : out) v.push_back(vertex_on(a, b));
    add_triangle({v[0], v[1], v[2]}, outward);
    if (v.size() == 4) add_triangle({v[0], v[2], v[3]}, outward);
  };
  for_cut_tetrahedra(size, distance, add_between);
  return mesh;
}

}  // namespace lamina
