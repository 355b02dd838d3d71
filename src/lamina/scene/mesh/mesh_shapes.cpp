// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/mesh_shapes.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "lamina/base/core/vec.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;

PolygonMesh named(const char* name) {
  PolygonMesh mesh;
  mesh.name = name;
  mesh.parts = {{}};
  return mesh;
}

void add_vertex(PolygonMesh& mesh, const Vec3& position, const Vec3& normal, const Vec2& uv) {
  mesh.positions.push_back(to_float(position));
  mesh.normals.push_back(to_float(normal));
  mesh.uvs.push_back(to_float(uv));
}

/// A face whose corners have the same index everywhere.
void add_face_of(PolygonMesh& mesh, std::initializer_list<std::uint32_t> vertices) {
  std::vector<MeshCorner> corners;
  for (const std::uint32_t v : vertices) corners.push_back({v, v, v});
  add_face(mesh, corners, 0);
}

/// n x n quadrilaterals over the unit square; `place(s, t)` adds the vertex at (s, t) in [0, 1]².
template <class Place>
void add_grid(PolygonMesh& mesh, int n, const Place& place) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) place(static_cast<double>(i) / n, static_cast<double>(j) / n);
  const auto row = static_cast<std::uint32_t>(n + 1);
  for (std::uint32_t j = 0; j + 1 < row; ++j)
    for (std::uint32_t i = 0; i + 1 < row; ++i) {
      const std::uint32_t v = first + j * row + i;
      add_face_of(mesh, {v, v + 1, v + row + 1, v + row});
    }
}

/// The sides of a cube, counterclockwise seen from outside: their normal and the direction of s.
constexpr std::array<std::array<Vec3, 2>, 6> cube_sides{{
    {Vec3{1, 0, 0}, Vec3{0, 0, -1}},
    {Vec3{-1, 0, 0}, Vec3{0, 0, 1}},
    {Vec3{0, 1, 0}, Vec3{1, 0, 0}},
    {Vec3{0, -1, 0}, Vec3{1, 0, 0}},
    {Vec3{0, 0, 1}, Vec3{1, 0, 0}},
    {Vec3{0, 0, -1}, Vec3{-1, 0, 0}},
}};

struct Lobe {
  Vec3 axis;
  int degree;
  double height;
};

/// Smooth hills and hollows of several sizes. Legendre polynomials have mean 0 over the sphere.
constexpr std::array<Lobe, 7> lobes{{
    {{0.36, 0.48, 0.80}, 3, 0.10},
    {{-0.60, 0.00, 0.80}, 4, 0.06},
    {{0.00, -0.80, 0.60}, 6, 0.07},
    {{0.80, -0.60, 0.00}, 7, 0.06},
    {{-0.48, -0.60, -0.64}, 9, 0.04},
    {{0.28, -0.96, 0.00}, 11, 0.03},
    {{-0.64, 0.48, 0.60}, 13, 0.025},
}};

/// P_n(x) and its derivative, by the recurrences of Legendre polynomials.
std::array<double, 2> legendre(int n, double x) {
  double p_before = 1.0, p = x, slope_before = 0.0, slope = 1.0;
  for (int k = 2; k <= n; ++k) {
    const double next = ((2 * k - 1) * x * p - (k - 1) * p_before) / k;
    const double next_slope = slope_before + (2 * k - 1) * p;
    p_before = p, p = next;
    slope_before = slope, slope = next_slope;
  }
  return {p, slope};
}

}  // namespace

PolygonMesh make_rectangle(double width, double height, int tessellation) {
  assert(width > 0.0 && height > 0.0 && 1 <= tessellation && tessellation <= most_tessellation);
  PolygonMesh mesh = named("rectangle");
  add_grid(mesh, tessellation, [&](double s, double t) {
    add_vertex(mesh, {(s - 0.5) * width, (t - 0.5) * height, 0.0}, {0, 0, 1}, {s, t});
  });
  return mesh;
}

PolygonMesh make_disk(double radius, int tessellation) {
  assert(radius > 0.0 && 1 <= tessellation && tessellation <= most_tessellation);
  const auto sectors = static_cast<std::uint32_t>(std::max(tessellation, 3));
  const std::uint32_t rings = std::max(sectors / 6, 1U);
  PolygonMesh mesh = named("disk");
  add_vertex(mesh, {}, {0, 0, 1}, {0.5, 0.5});
  for (std::uint32_t ring = 1; ring <= rings; ++ring)
    for (std::uint32_t i = 0; i < sectors; ++i) {
      const double phi = 2.0 * pi * i / sectors, r = static_cast<double>(ring) / rings;
      const double x = r * std::cos(phi), y = r * std::sin(phi);
      add_vertex(mesh, {radius * x, radius * y, 0.0}, {0, 0, 1}, {0.5 + 0.5 * x, 0.5 + 0.5 * y});
    }
  const auto at = [&](std::uint32_t ring, std::uint32_t i) {
    return ring == 0 ? 0 : 1 + (ring - 1) * sectors + i % sectors;
  };
  for (std::uint32_t ring = 0; ring < rings; ++ring)
    for (std::uint32_t i = 0; i < sectors; ++i) {
      if (ring == 0)
        add_face_of(mesh, {0, at(1, i), at(1, i + 1)});
      else
        add_face_of(mesh, {at(ring, i), at(ring + 1, i), at(ring + 1, i + 1), at(ring, i + 1)});
    }
  return mesh;
}

PolygonMesh make_sphere(double radius, int tessellation) {
  assert(radius > 0.0 && 1 <= tessellation && tessellation <= most_tessellation);
  const auto rows = static_cast<std::uint32_t>(std::max(tessellation, 2));
  const std::uint32_t columns = 2 * rows;
  PolygonMesh mesh = named("sphere");
  // One position per pole and meridian, one texture coordinate per column on both sides of the
  // seam.
  for (std::uint32_t row = 0; row <= rows; ++row)
    for (std::uint32_t column = 0; column < columns; ++column) {
      const bool is_pole = row == 0 || row == rows;
      if (is_pole && column > 0) continue;
      const double theta = pi * row / rows, phi = 2.0 * pi * column / columns;  // from the south
      const double ring = is_pole ? 0.0 : std::sin(theta);
      const Vec3 n{-ring * std::sin(phi), row == rows / 2 && rows % 2 == 0 ? 0.0 : -std::cos(theta),
                   -ring * std::cos(phi)};
      mesh.positions.push_back(to_float(radius * n));
      mesh.normals.push_back(to_float(n));
    }
  const auto vertex = [&](std::uint32_t row, std::uint32_t column) {
    return row == 0      ? 0U
           : row == rows ? 1 + (rows - 1) * columns
                         : 1 + (row - 1) * columns + column % columns;
  };
  for (std::uint32_t row = 0; row <= rows; ++row)
    for (std::uint32_t column = 0; column <= columns; ++column)
      mesh.uvs.push_back(
          to_float(Vec2{static_cast<double>(column) / columns, static_cast<double>(row) / rows}));
  const auto first_pole_uv = static_cast<std::uint32_t>(mesh.uvs.size());
  for (const double v : {0.0, 1.0})  // at a pole, the middle of each column
    for (std::uint32_t column = 0; column < columns; ++column)
      mesh.uvs.push_back(to_float(Vec2{(column + 0.5) / columns, v}));
  const auto corner = [&](std::uint32_t row, std::uint32_t column) {
    const std::uint32_t v = vertex(row, column);
    return MeshCorner{v, v, row * (columns + 1) + column};
  };
  for (std::uint32_t row = 0; row < rows; ++row)
    for (std::uint32_t column = 0; column < columns; ++column) {
      std::vector<MeshCorner> corners;
      if (row == 0) {
        corners = {corner(0, column), corner(1, column + 1), corner(1, column)};
        corners[0].uv = first_pole_uv + column;
      } else if (row + 1 == rows) {
        corners = {corner(row, column), corner(row, column + 1), corner(rows, column)};
        corners[2].uv = first_pole_uv + columns + column;
      } else {
        corners = {corner(row, column), corner(row, column + 1), corner(row + 1, column + 1),
                   corner(row + 1, column)};
      }
      add_face(mesh, corners, 0);
    }
  return mesh;
}

PolygonMesh make_box(const Vec3& size, int tessellation) {
  assert(size.x > 0.0 && size.y > 0.0 && size.z > 0.0);
  assert(1 <= tessellation && tessellation <= most_tessellation);
  PolygonMesh mesh = named("box");
  for (const auto& [normal, s_axis] : cube_sides) {
    const Vec3 t_axis = cross(normal, s_axis);
    add_grid(mesh, tessellation, [&](double s, double t) {
      const Vec3 p = normal + (2.0 * s - 1.0) * s_axis + (2.0 * t - 1.0) * t_axis;
      add_vertex(mesh, 0.5 * Vec3{size.x * p.x, size.y * p.y, size.z * p.z}, normal, {s, t});
    });
  }
  return mesh;
}

PolygonMesh make_bumpy_sphere(double radius, int tessellation) {
  assert(radius > 0.0 && 1 <= tessellation && tessellation <= most_tessellation);
  PolygonMesh mesh = named("bumpy_sphere");
  int side = 0;
  for (const auto& [normal, s_axis] : cube_sides) {
    const Vec3 t_axis = cross(normal, s_axis);
    const Vec2 cell{static_cast<double>(side % 3), static_cast<double>(side / 3)};
    ++side;
    add_grid(mesh, tessellation, [&](double s, double t) {
      // Equal angles instead of equal lengths on the cube: faces of about one size.
      const double a = std::tan(pi / 4.0 * (2.0 * s - 1.0)),
                   b = std::tan(pi / 4.0 * (2.0 * t - 1.0));
      const Vec3 d = normalize(normal + a * s_axis + b * t_axis);
      double height = 0.0;
      Vec3 slope;  // of height along the sphere
      for (const Lobe& lobe : lobes) {
        const double x = dot(d, lobe.axis);
        const auto [value, derivative] = legendre(lobe.degree, x);
        height += lobe.height * value;
        slope += lobe.height * derivative * (lobe.axis - x * d);
      }
      const Vec3 outward = normalize(d - slope / (1.0 + height));
      const double margin = 0.01;  // between the islands of the texture
      const Vec2 inner{margin + (1.0 - 2.0 * margin) * s, margin + (1.0 - 2.0 * margin) * t};
      add_vertex(mesh, radius * (1.0 + height) * d, outward,
                 {(cell.x + inner.x) / 3.0, (cell.y + inner.y) / 2.0});
    });
  }
  return mesh;
}

}  // namespace lamina
