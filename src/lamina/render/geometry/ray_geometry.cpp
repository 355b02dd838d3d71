// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/geometry/ray_geometry.h"

#include <algorithm>
#include <new>
#include <stdexcept>
#include <string>
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

// What differs between Embree 3 and 4.
#if RTC_VERSION_MAJOR >= 4
using QueryContext = RTCRayQueryContext;
void intersect(RTCScene scene, QueryContext& context, RTCRayHit& ray, RTCFilterFunctionN filter) {
  rtcInitRayQueryContext(&context);
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &context;
  arguments.filter = filter;
  if (filter) arguments.flags = RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;
  rtcIntersect1(scene, &ray, &arguments);
}
void occlude(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &ray); }
constexpr RTCSceneFlags filter_flag = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;
#else
using QueryContext = RTCIntersectContext;
void intersect(RTCScene scene, QueryContext& context, RTCRayHit& ray, RTCFilterFunctionN filter) {
  rtcInitIntersectContext(&context);
  context.filter = filter;
  rtcIntersect1(scene, &context, &ray);
}
void occlude(RTCScene scene, RTCRay& ray) {
  QueryContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
}
constexpr RTCSceneFlags filter_flag = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;
#endif

RTCRay make_ray(const Ray& ray, float t_near, float t_far) {
  RTCRay result = {};
  result.org_x = ray.origin.x;
  result.org_y = ray.origin.y;
  result.org_z = ray.origin.z;
  result.dir_x = ray.direction.x;
  result.dir_y = ray.direction.y;
  result.dir_z = ray.direction.z;
  result.tnear = t_near;
  result.tfar = t_far;
  result.mask = ~0u;
  return result;
}

RTCRayHit make_query(const Ray& ray, float t_near, float t_far) {
  RTCRayHit query;
  query.ray = make_ray(ray, t_near, t_far);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return query;
}

Hit hit_of(const RTCRayHit& query) {
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return {.distance = query.ray.tfar,
          .u = query.hit.u,
          .v = query.hit.v,
          .mesh = query.hit.geomID,
          .triangle = query.hit.primID};
}

/// The context goes first, so that the filter gets back from it to the collection.
struct ProbeQuery {
  QueryContext context;
  const std::vector<Mesh>* meshes;
  std::optional<std::uint32_t> material;
  ProbeHits* found;
};

void collect_hit(const RTCFilterFunctionNArguments* arguments) {
  auto& query = *reinterpret_cast<ProbeQuery*>(arguments->context);
  arguments->valid[0] = 0;  // turned down, so that the traversal goes on behind it
  const auto mesh = RTCHitN_geomID(arguments->hit, 1, 0);
  const auto triangle = RTCHitN_primID(arguments->hit, 1, 0);
  if (query.material && (*query.meshes)[mesh].material[triangle] != *query.material) return;
  if (query.found->count == ProbeHits::capacity) return;
  query.found->hits[static_cast<std::size_t>(query.found->count++)] = {
      .distance = RTCRayN_tfar(arguments->ray, 1, 0),
      .u = RTCHitN_u(arguments->hit, 1, 0),
      .v = RTCHitN_v(arguments->hit, 1, 0),
      .mesh = mesh,
      .triangle = triangle};
}

/// Turns down triangles of other materials.
struct MaterialQuery {
  QueryContext context;
  const std::vector<Mesh>* meshes;
  std::uint32_t material;
};

void keep_material(const RTCFilterFunctionNArguments* arguments) {
  const auto& query = *reinterpret_cast<const MaterialQuery*>(arguments->context);
  const auto mesh = RTCHitN_geomID(arguments->hit, 1, 0);
  const auto triangle = RTCHitN_primID(arguments->hit, 1, 0);
  if ((*query.meshes)[mesh].material[triangle] != query.material) arguments->valid[0] = 0;
}

struct NearestQuery {
  const std::vector<Mesh>* meshes;
  std::optional<std::uint32_t> material;
  float slack;
  Hit nearest;
};

bool keep_nearer(RTCPointQueryFunctionArguments* arguments) {
  auto& query = *static_cast<NearestQuery*>(arguments->userPtr);
  const Mesh& mesh = (*query.meshes)[arguments->geomID];
  if (mesh.triangles.empty()) return false;
  if (query.material && mesh.material[arguments->primID] != *query.material) return false;
  const auto& [i0, i1, i2] = mesh.triangles[arguments->primID];
  const Vec3f p{arguments->query->x, arguments->query->y, arguments->query->z};
  const Vec3f &p0 = mesh.positions[i0], &p1 = mesh.positions[i1], &p2 = mesh.positions[i2];
  // Nothing is nearer than the plane of the triangle, which turns most of them down.
  const Vec3f normal = cross(p1 - p0, p2 - p0);
  const float height = dot(normal, p - p0), radius = arguments->query->radius;
  if (height * height > radius * radius * dot(normal, normal)) return false;
  const Vec2f at = nearest_on_triangle(p, p0, p1, p2);
  const float distance = length((1.0f - at.x - at.y) * p0 + at.x * p1 + at.y * p2 - p);
  if (!(distance < radius)) return false;
  arguments->query->radius = distance * (1.0f - query.slack);
  query.nearest = {.distance = distance,
                   .u = at.x,
                   .v = at.y,
                   .mesh = arguments->geomID,
                   .triangle = arguments->primID};
  return true;
}

}  // namespace

Vec2f nearest_on_triangle(const Vec3f& p, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3f e1 = b - a, e2 = c - a, d = p - a;
  const float e11 = dot(e1, e1), e12 = dot(e1, e2), e22 = dot(e2, e2);
  const float d1 = dot(d, e1), d2 = dot(d, e2);
  const float determinant = e11 * e22 - e12 * e12;
  // Above the triangle the foot of the perpendicular is the nearest point.
  if (determinant > 0.0f) {
    const float u = (d1 * e22 - d2 * e12) / determinant, v = (d2 * e11 - d1 * e12) / determinant;
    if (u >= 0.0f && v >= 0.0f && u + v <= 1.0f) return {u, v};
  }
  // Else the nearest is on an edge.
  const auto along = [](float projection, float squared) {
    return squared > 0.0f ? std::clamp(projection / squared, 0.0f, 1.0f) : 0.0f;
  };
  const float s1 = along(d1, e11), s2 = along(d2, e22);
  const Vec3f e3 = c - b;
  const float s3 = along(dot(p - b, e3), dot(e3, e3));
  const std::array<Vec2f, 3> candidates = {Vec2f{s1, 0.0f}, {0.0f, s2}, {1.0f - s3, s3}};
  const auto distance2 = [&](const Vec2f& at) {
    const Vec3f offset = at.x * e1 + at.y * e2 - d;
    return dot(offset, offset);
  };
  return *std::ranges::min_element(candidates, {}, distance2);
}

struct RayGeometry::Traversal {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  const std::vector<Mesh>* meshes = nullptr;

  ~Traversal() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

namespace {

/// @param device  the one that the work was for, or null: it could not be made
/// @throws std::bad_alloc, or std::runtime_error if it is not memory that Embree lacks
void require_success(bool is_made, RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (!is_made || error != RTC_ERROR_NONE)
    throw std::runtime_error("Embree cannot build the scene: its error " +
                             std::to_string(static_cast<int>(error)));
}

}  // namespace

RayGeometry::RayGeometry(const std::vector<Mesh>& meshes) {
  const auto made = std::make_shared<Traversal>();
  traversal_ = made;
  Traversal& traversal = *made;
  traversal.meshes = &meshes;
  traversal.device = rtcNewDevice(nullptr);
  require_success(traversal.device != nullptr, traversal.device);
  traversal.scene = rtcNewScene(traversal.device);
  require_success(traversal.scene != nullptr, traversal.device);
  rtcSetSceneFlags(traversal.scene, filter_flag);
  rtcSetSceneBuildQuality(traversal.scene, RTC_BUILD_QUALITY_MEDIUM);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Vec3f low{infinity, infinity, infinity}, high = -low;
  for (std::size_t id = 0; id < meshes.size(); ++id) {
    const Mesh& mesh = meshes[id];
    const RTCGeometry geometry = rtcNewGeometry(traversal.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Copies: Embree reads 16 bytes at the last vertex, beyond the end of a packed array.
    auto* vertices = static_cast<Vec3f*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(Vec3f), std::max<std::size_t>(mesh.positions.size(), 1)));
    auto* corners = static_cast<std::array<std::uint32_t, 3>*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t),
        std::max<std::size_t>(mesh.triangles.size(), 1)));
    if (!vertices || !corners) {
      rtcReleaseGeometry(geometry);
      throw std::bad_alloc();
    }
    if (mesh.triangles.empty()) corners[0] = {0, 0, 0};
    std::copy(mesh.positions.begin(), mesh.positions.end(), vertices);
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), corners);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(traversal.scene, geometry, static_cast<unsigned>(id));
    rtcReleaseGeometry(geometry);
    for (const Vec3f& p : mesh.positions)
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], p[axis]);
        high[axis] = std::max(high[axis], p[axis]);
      }
  }
  rtcCommitScene(traversal.scene);
  require_success(true, traversal.device);
  if (low.x <= high.x) {
    box_low_ = low;
    box_high_ = high;
  }
}

RayGeometry::~RayGeometry() = default;
RayGeometry::RayGeometry(const RayGeometry&) = default;
RayGeometry& RayGeometry::operator=(const RayGeometry&) = default;
RayGeometry::RayGeometry(RayGeometry&&) noexcept = default;
RayGeometry& RayGeometry::operator=(RayGeometry&&) noexcept = default;

Hit RayGeometry::first_hit(const Ray& ray, float t_near, float t_far) const {
  QueryContext context;
  RTCRayHit query = make_query(ray, t_near, t_far);
  intersect(traversal_->scene, context, query, nullptr);
  return hit_of(query);
}

Hit RayGeometry::first_hit_of(std::uint32_t material, const Ray& ray, float t_near) const {
  MaterialQuery kept{.context = {}, .meshes = traversal_->meshes, .material = material};
  RTCRayHit query = make_query(ray, t_near, std::numeric_limits<float>::infinity());
  intersect(traversal_->scene, kept.context, query, keep_material);
  return hit_of(query);
}

bool RayGeometry::is_blocked(const Ray& ray, float t_near, float t_far) const {
  RTCRay query = make_ray(ray, t_near, t_far);
  occlude(traversal_->scene, query);
  return query.tfar < 0.0f;  // Embree's sign for a hit
}

Hit RayGeometry::closest_point(const Vec3f& position, float radius,
                               std::optional<std::uint32_t> material, float slack) const {
  NearestQuery nearest{traversal_->meshes, material, slack, {}};
  RTCPointQuery query = {
      .x = position.x, .y = position.y, .z = position.z, .time = 0.0f, .radius = radius};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(traversal_->scene, &query, &context, keep_nearer, &nearest);
  return nearest.nearest;
}

void RayGeometry::all_hits(const Ray& ray, float length, std::optional<std::uint32_t> material,
                           ProbeHits& found) const {
  found.count = 0;
  ProbeQuery probe{
      .context = {}, .meshes = traversal_->meshes, .material = material, .found = &found};
  RTCRayHit query = make_query(ray, 0.0f, length);
  intersect(traversal_->scene, probe.context, query, collect_hit);
}

}  // namespace lamina
