// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/ray_geometry.h"

#include <algorithm>
#include <new>
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "lamina/core/error.h"

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

/// The context goes first, so that the filter gets back from it to the collection.
struct ProbeQuery {
  QueryContext context;
  const std::vector<Mesh>* meshes;
  std::uint32_t material;
  ProbeHits* found;
};

void collect_hit(const RTCFilterFunctionNArguments* arguments) {
  auto& query = *reinterpret_cast<ProbeQuery*>(arguments->context);
  arguments->valid[0] = 0;  // turned down, so that the traversal goes on behind it
  const auto mesh = RTCHitN_geomID(arguments->hit, 1, 0);
  const auto triangle = RTCHitN_primID(arguments->hit, 1, 0);
  if ((*query.meshes)[mesh].material[triangle] != query.material) return;
  if (query.found->count == ProbeHits::capacity) return;
  query.found->hits[static_cast<std::size_t>(query.found->count++)] = {
      .distance = RTCRayN_tfar(arguments->ray, 1, 0),
      .u = RTCHitN_u(arguments->hit, 1, 0),
      .v = RTCHitN_v(arguments->hit, 1, 0),
      .mesh = mesh,
      .triangle = triangle};
}

}  // namespace

struct RayGeometry::Traversal {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  const std::vector<Mesh>* meshes = nullptr;

  ~Traversal() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

RayGeometry::RayGeometry(const std::vector<Mesh>& meshes)
    : traversal_(std::make_unique<Traversal>()) {
  Traversal& traversal = *traversal_;
  traversal.meshes = &meshes;
  traversal.device = rtcNewDevice(nullptr);
  if (!traversal.device) throw Error("Embree cannot be started");
  traversal.scene = rtcNewScene(traversal.device);
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
  if (rtcGetDeviceError(traversal.device) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (low.x <= high.x) {
    box_low_ = low;
    box_high_ = high;
  }
}

RayGeometry::~RayGeometry() = default;
RayGeometry::RayGeometry(RayGeometry&&) noexcept = default;
RayGeometry& RayGeometry::operator=(RayGeometry&&) noexcept = default;

Hit RayGeometry::first_hit(const Ray& ray, float t_near, float t_far) const {
  QueryContext context;
  RTCRayHit query;
  query.ray = make_ray(ray, t_near, t_far);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersect(traversal_->scene, context, query, nullptr);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return {.distance = query.ray.tfar,
          .u = query.hit.u,
          .v = query.hit.v,
          .mesh = query.hit.geomID,
          .triangle = query.hit.primID};
}

bool RayGeometry::is_blocked(const Ray& ray, float t_near, float t_far) const {
  RTCRay query = make_ray(ray, t_near, t_far);
  occlude(traversal_->scene, query);
  return query.tfar < 0.0f;  // Embree's sign for a hit
}

void RayGeometry::all_hits(const Ray& ray, float length, std::uint32_t material,
                           ProbeHits& found) const {
  found.count = 0;
  ProbeQuery probe{
      .context = {}, .meshes = traversal_->meshes, .material = material, .found = &found};
  RTCRayHit query;
  query.ray = make_ray(ray, 0.0f, length);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersect(traversal_->scene, probe.context, query, collect_hit);
}

}  // namespace lamina
