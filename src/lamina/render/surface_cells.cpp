// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/surface_cells.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "lamina/core/parallel.h"
#include "lamina/core/random.h"
#include "lamina/render/surface_point.h"

namespace lamina {
namespace {

constexpr std::uint32_t none = 0xffffffffu;
constexpr float least_agreement = 0.5f;     // of two normals within one cell
constexpr float elements_per_cell = 14.0f;  // about
constexpr float seed_distance = 0.79f;  // over the spacing: as dense as asked for

struct Corners {
  Vec3f p0, p1, p2;
};

Corners corners(const Mesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

float area_of(const Corners& c) { return 0.5f * length(cross(c.p1 - c.p0, c.p2 - c.p0)); }

/// A point drawn on each element, as cells are made of.
struct Place {
  Vec3f position, normal;
};

/// Cuts a triangle into n² congruent ones, with a random point on each.
void cut(const Corners& c, std::uint32_t mesh, std::uint32_t triangle, float spacing,
         std::uint64_t seed, std::vector<SurfaceElement>& elements) {
  const float area = area_of(c);
  if (!(area > 0.0f)) return;
  const float longest = std::max({length(c.p1 - c.p0), length(c.p2 - c.p1), length(c.p0 - c.p2)});
  const float wanted = std::max(std::sqrt(elements_per_cell * area) / spacing,  // small enough,
                                longest / spacing);                             // slivers too
  const int n = static_cast<int>(std::clamp(std::ceil(wanted), 1.0f, 4096.0f));
  const float step = 1.0f / static_cast<float>(n);
  Random random = make_random(seed, (std::uint64_t{mesh} << 32) | triangle);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * (n - i) - 1; ++j) {
      float a = random.uniform_float(), b = random.uniform_float();
      if (a + b > 1.0f) a = 1.0f - a, b = 1.0f - b;
      // Even ones point as the whole does, odd ones the other way.
      const bool is_upright = j % 2 == 0;
      const float u = static_cast<float>(j / 2) + (is_upright ? a : 1.0f - a);
      const float v = static_cast<float>(i) + (is_upright ? b : 1.0f - b);
      elements.push_back({mesh, triangle, u * step, v * step, area * step * step});
    }
}

/// Seeds that are found by place: a grid of cubes as wide as the distance that seeds keep.
class SeedGrid {
 public:
  SeedGrid(std::size_t expected, float distance, const std::vector<Place>& places)
      : distance_(distance), places_(places), heads_(std::bit_ceil(2 * expected + 16), none) {}

  void add(std::uint32_t element) {
    std::uint32_t& head = heads_[slot(cube(places_[element].position))];
    next_.push_back(head);
    element_.push_back(element);
    head = static_cast<std::uint32_t>(element_.size() - 1);
  }

  /// The nearest seed within the distance whose normal agrees, or none.
  [[nodiscard]] std::uint32_t nearest(const Place& place, bool any) const {
    const Cube middle = cube(place.position);
    std::uint32_t found = none;
    float best = distance_ * distance_;
    for (int k = 0; k < 27; ++k) {
      const Cube near{middle[0] + k % 3 - 1, middle[1] + k / 3 % 3 - 1, middle[2] + k / 9 - 1};
      for (std::uint32_t s = heads_[slot(near)]; s != none; s = next_[s]) {
        const Place& other = places_[element_[s]];
        const Vec3f offset = other.position - place.position;
        const float d2 = dot(offset, offset);
        if (d2 > best || (d2 == best && found <= s)) continue;
        if (dot(other.normal, place.normal) < least_agreement) continue;
        found = s;
        best = d2;
        if (any) return found;
      }
    }
    return found;
  }

  [[nodiscard]] std::size_t size() const { return element_.size(); }

 private:
  using Cube = std::array<std::int32_t, 3>;
  [[nodiscard]] Cube cube(const Vec3f& p) const {
    const auto index = [&](float x) {
      return static_cast<std::int32_t>(std::floor(std::clamp(x / distance_, -1e9f, 1e9f)));
    };
    return {index(p.x), index(p.y), index(p.z)};
  }
  [[nodiscard]] std::size_t slot(const Cube& c) const {
    const auto word = [](std::int32_t i) { return static_cast<std::uint32_t>(i); };
    std::uint32_t h =
        word(c[0]) * 0x8da6b343u ^ word(c[1]) * 0xd8163841u ^ word(c[2]) * 0xcb1ab31fu;
    h ^= h >> 15;
    h *= 0x2c1b3c6du;
    h ^= h >> 13;
    return h & (heads_.size() - 1);
  }

  float distance_;
  const std::vector<Place>& places_;
  std::vector<std::uint32_t> heads_, next_, element_;
};

/// The surface seen from nowhere: only its place.
Place place_of(const std::vector<Mesh>& meshes, const SurfaceElement& e) {
  const SurfacePoint point = make_surface_point(
      meshes, {.distance = 0.0f, .u = e.u, .v = e.v, .mesh = e.mesh, .triangle = e.triangle}, 0.0f);
  return {point.position, point.smooth_normal};
}

template <class OnTriangle>
void for_triangles(const std::vector<Mesh>& meshes, std::uint32_t material,
                   const OnTriangle& on_triangle) {
  for (std::size_t m = 0; m < meshes.size(); ++m)
    for (std::size_t t = 0; t < meshes[m].triangles.size(); ++t)
      if (meshes[m].material[t] == material)
        on_triangle(corners(meshes[m], t), static_cast<std::uint32_t>(m),
                    static_cast<std::uint32_t>(t));
}

}  // namespace

double surface_area(const std::vector<Mesh>& meshes, std::uint32_t material) {
  double area = 0.0;
  for_triangles(meshes, material, [&](const Corners& c, std::uint32_t, std::uint32_t) {
    area += static_cast<double>(area_of(c));
  });
  return area;
}

SurfaceCells make_surface_cells(const std::vector<Mesh>& meshes, std::uint32_t material,
                                float spacing, std::uint64_t seed) {
  std::vector<SurfaceElement> elements;
  for_triangles(meshes, material, [&](const Corners& c, std::uint32_t mesh, std::uint32_t t) {
    cut(c, mesh, t, spacing, seed, elements);
  });
  constexpr std::size_t chunk = 4096;
  const std::size_t count = elements.size(), chunks = (count + chunk - 1) / chunk;
  const auto for_elements = [&](const auto& body) {
    parallel_for(chunks, [&](std::size_t c) {
      for (std::size_t i = c * chunk; i < std::min(count, (c + 1) * chunk); ++i) body(i);
    });
  };
  std::vector<Place> places(count);
  for_elements([&](std::size_t i) { places[i] = place_of(meshes, elements[i]); });

  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  Random random = make_random(seed, 0x5eedce11u);
  for (std::size_t i = count; i > 1; --i)
    std::swap(order[i - 1],
              order[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
  SeedGrid seeds(count / static_cast<std::size_t>(elements_per_cell), seed_distance * spacing,
                 places);
  for (const std::uint32_t element : order)
    if (seeds.nearest(places[element], true) == none) seeds.add(element);
  std::vector<std::uint32_t> owner(count);
  for_elements([&](std::size_t i) { owner[i] = seeds.nearest(places[i], false); });

  // Elements side by side by cell: a counting sort.
  SurfaceCells result;
  result.cells.resize(seeds.size());
  for (const std::uint32_t cell : owner) ++result.cells[cell].count;
  for (std::size_t c = 1; c < seeds.size(); ++c)
    result.cells[c].first = result.cells[c - 1].first + result.cells[c - 1].count;
  std::vector<std::uint32_t> filled(seeds.size(), 0);
  result.elements.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    SurfaceCell& cell = result.cells[owner[i]];
    result.elements[cell.first + filled[owner[i]]++] = elements[i];
    const float area = elements[i].area;
    cell.area += area;
    cell.position += area * places[i].position;
    cell.normal += area * places[i].normal;
  }
  for (SurfaceCell& cell : result.cells) {
    cell.position *= 1.0f / cell.area;
    cell.normal = normalize(cell.normal);
    result.area += static_cast<double>(cell.area);
  }
  return result;
}

}  // namespace lamina
