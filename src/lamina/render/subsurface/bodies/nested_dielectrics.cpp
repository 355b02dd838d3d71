// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/bodies/nested_dielectrics.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace lamina {
namespace {

// How far apart faces are one: below that by which rays leave surfaces.
constexpr float coincident = 1.5e-6f;  // over the size of coordinates
constexpr float least_body_cosine = 0.02f;

bool is_medium(const SurfaceMaterial& material) {
  return std::holds_alternative<SubsurfaceSurface>(material.surface) ||
         std::holds_alternative<DielectricSurface>(material.surface);
}

/// [material] whether all surfaces of the mesh that it is on have an inside.
std::vector<bool> closed_materials(const Mesh& mesh, std::size_t count) {
  std::vector<bool> result(count);
  for (std::uint32_t material = 0; material < count; ++material)
    result[material] = is_closed(mesh, material);
  return result;
}

/// Of the surfaces of those materials, by the divergence theorem.
double enclosed_volume(const Mesh& mesh, const std::vector<bool>& is_closed) {
  if (mesh.triangles.empty()) return 0.0;
  const Vec3f middle = mesh.positions[mesh.triangles[0][0]];  // against cancellation
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!is_closed[mesh.material[t]]) continue;
    const auto& [a, b, c] = mesh.triangles[t];
    sum += static_cast<double>(dot(mesh.positions[a] - middle,
                                   cross(mesh.positions[b] - middle, mesh.positions[c] - middle)));
  }
  return std::abs(sum) / 6.0;
}

struct BodyBox {
  Vec3f low, high;
};
BodyBox box_of(const Mesh& mesh) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  BodyBox box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (const Vec3f& p : mesh.positions)
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], p[axis]);
      box.high[axis] = std::max(box.high[axis], p[axis]);
    }
  return box;
}

bool meet(const BodyBox& a, const BodyBox& b) {
  for (int axis = 0; axis < 3; ++axis) {
    const float slack = 1e-5f * std::max(std::abs(a.low[axis]), std::abs(a.high[axis]));
    if (a.low[axis] > b.high[axis] + slack || b.low[axis] > a.high[axis] + slack) return false;
  }
  return true;
}

}  // namespace

void InteriorList::add(std::uint32_t mesh, int times) {
  for (int i = 0; i < count; ++i) {
    Body& body = bodies[static_cast<std::size_t>(i)];
    if (body.mesh != mesh) continue;
    body.times += times;
    if (body.times <= 0) body = bodies[static_cast<std::size_t>(--count)];
    return;
  }
  if (times > 0 && count < static_cast<int>(bodies.size()))
    bodies[static_cast<std::size_t>(count++)] = {mesh, times};
}

NestedDielectrics::NestedDielectrics(const RenderScene& scene)
    : scene_(scene),
      material_(scene.scene->meshes.size(), none),
      volume_(scene.scene->meshes.size(), 0.0) {
  for (std::size_t m = 0; m < material_.size(); ++m) {
    const Mesh& mesh = scene.scene->meshes[m];
    const std::vector<bool> is_closed = closed_materials(mesh, scene.scene->materials.size());
    const auto found = std::ranges::find_if(mesh.material, [&](std::uint32_t i) {
      return is_closed[i] && is_medium(scene.scene->materials[i]);
    });
    if (found == mesh.material.end()) continue;
    material_[m] = *found;
    volume_[m] = enclosed_volume(mesh, is_closed);
  }
}

std::uint32_t NestedDielectrics::highest_priority(const InteriorList& interior) const {
  std::uint32_t best = none;
  for (int i = 0; i < interior.count; ++i) {
    const std::uint32_t mesh = interior.bodies[static_cast<std::size_t>(i)].mesh;
    if (best == none || volume_[mesh] < volume_[best] ||
        (volume_[mesh] == volume_[best] && mesh > best))
      best = mesh;
  }
  return best;
}

ProbeHits NestedDielectrics::coincident_hits(const SurfacePoint& point,
                                             const Vec3f& direction) const {
  const Vec3f& p = point.position;
  const float size = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z), 1e-3f});
  const float half = coincident * size /
                     std::max(std::abs(dot(point.geometric_normal, direction)), least_body_cosine);
  ProbeHits hits;
  scene_.geometry.all_hits({p - half * direction, direction}, 2.0f * half, std::nullopt, hits);
  return hits;
}

NestedDielectrics::Crossing NestedDielectrics::cross(const InteriorList& before,
                                                     const SurfacePoint& point,
                                                     const Vec3f& direction) const {
  const std::vector<Mesh>& meshes = scene_.scene->meshes;
  const ProbeHits hits = coincident_hits(point, direction);
  Crossing crossing{before};
  struct Met {
    std::uint32_t mesh;
    bool is_entry;
  };
  std::array<Met, ProbeHits::capacity + 1> met;
  int count = 0;
  const auto meet = [&](const SurfacePoint& at) {
    if (material_[at.mesh] != at.material) {
      crossing.is_blocked = true;
      return;
    }
    // The two triangles of an edge are one face.
    const Met face{at.mesh, dot(at.geometric_normal, direction) < 0.0f};
    for (int i = 0; i < count; ++i)
      if (met[static_cast<std::size_t>(i)].mesh == face.mesh &&
          met[static_cast<std::size_t>(i)].is_entry == face.is_entry)
        return;
    met[static_cast<std::size_t>(count++)] = face;
  };
  meet(point);
  for (const Hit& hit : hits.all()) meet(make_bare_surface_point(meshes, hit));
  // First what is entered, so that a body that is entered and left stays as it was.
  for (const bool is_entry : {true, false})
    for (int i = 0; i < count; ++i)
      if (met[static_cast<std::size_t>(i)].is_entry == is_entry)
        crossing.beyond.add(met[static_cast<std::size_t>(i)].mesh, is_entry ? 1 : -1);
  return crossing;
}

bool NestedDielectrics::is_near_others(std::uint32_t material) const {
  const std::vector<Mesh>& meshes = scene_.scene->meshes;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    if (material_[m] != material) continue;
    const BodyBox box = box_of(meshes[m]);
    for (std::size_t other = 0; other < meshes.size(); ++other)
      if (other != m && material_[other] != none && meet(box, box_of(meshes[other]))) return true;
  }
  return false;
}

}  // namespace lamina
