#include "reference/ray_tracer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "baker/embree/embree.hpp"

namespace lambent::baker::reference {

namespace {

constexpr std::size_t kWidth = 16;

// A Record is the user data of an Embree geometry.
struct Record {
  const Surfaces* surfaces;
  std::uint32_t surface;
};

const Surface& surfaceOf(const Record& record) {
  return record.surfaces->surfaces()[record.surface];
}

Hit hitOf(const RTCFilterFunctionNArguments* args, unsigned i) {
  const auto& record = *static_cast<const Record*>(args->geometryUserPtr);
  return {.surface = record.surface,
          .triangle = surfaceOf(record).first_triangle + RTCHitN_primID(args->hit, args->N, i),
          .u = RTCHitN_u(args->hit, args->N, i),
          .v = RTCHitN_v(args->hit, args->N, i),
          .t = RTCRayN_tfar(args->ray, args->N, i)};
}

void filterCutOut(const RTCFilterFunctionNArguments* args) {
  const auto& record = *static_cast<const Record*>(args->geometryUserPtr);
  for (unsigned i = 0; i < args->N; ++i)
    if (args->valid[i] == -1 &&
        record.surfaces->alphaAt(hitOf(args, i)) < surfaceOf(record).material.alpha_cutoff)
      args->valid[i] = 0;
}

bool isCulled(const RTCFilterFunctionNArguments* args, unsigned i) {
  const auto& record = *static_cast<const Record*>(args->geometryUserPtr);
  if (surfaceOf(record).material.double_sided) return false;
  const glm::vec3 dir(RTCRayN_dir_x(args->ray, args->N, i), RTCRayN_dir_y(args->ray, args->N, i),
                      RTCRayN_dir_z(args->ray, args->N, i));
  return glm::dot(record.surfaces->areaVector(hitOf(args, i).triangle), glm::dvec3(dir)) > 0.0;
}

void filterBacks(const RTCFilterFunctionNArguments* args) {
  for (unsigned i = 0; i < args->N; ++i)
    if (args->valid[i] == -1 && isCulled(args, i)) args->valid[i] = 0;
}

bool isLayer(const Surface& surface) {
  return surface.material.alpha_mode == gltf::AlphaMode::Blend || surface.material.transmits();
}

bool isBlended(const RTCFilterFunctionNArguments* args) {
  const auto& record = *static_cast<const Record*>(args->geometryUserPtr);
  return surfaceOf(record).material.alpha_mode == gltf::AlphaMode::Blend;
}

// Record every hit in the query's list and let the ray continue: those that the eye sees, or those of panes.
template <bool OfEye>
void filterLayers(const RTCFilterFunctionNArguments* args) {
  auto& layers = *static_cast<std::vector<Hit>*>(RayQuery::userOf(*args));
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    if (!(OfEye ? isCulled(args, i) : isBlended(args))) layers.push_back(hitOf(args, i));
    args->valid[i] = 0;
  }
}

// Sorts layers by distance. A ray may hit both triangles at an edge that they share.
void sortLayers(const Surfaces& surfaces, const glm::vec3& dir, std::vector<Hit>& layers) {
  std::sort(layers.begin(), layers.end(),
            [](const Hit& a, const Hit& b) { return a.t != b.t ? a.t < b.t : a.triangle < b.triangle; });
  const auto behind = [&](const Hit& hit) {
    return glm::dot(surfaces.areaVector(hit.triangle), glm::dvec3(dir)) > 0.0;
  };
  const auto same = [&](const Hit& a, const Hit& b) {
    return a.surface == b.surface && b.t - a.t <= 1e-6f * b.t && behind(a) == behind(b);
  };
  layers.erase(std::unique(layers.begin(), layers.end(), same), layers.end());
}

RTCRayHit traceOne(RTCScene scene, const Ray& ray, float far, RayQuery& query) {
  RTCRayHit hit = rayOf(ray.origin, ray.dir, far);
  query.intersect(scene, hit);
  return hit;
}

bool addGeometry(RTCDevice device, RTCScene scene, const Record& record) {
  const Surface& surface = surfaceOf(record);
  RTCGeometry geometry = newTriangles(
      device, std::span(record.surfaces->positions()).subspan(surface.first_vertex, surface.vertex_count),
      surface.triangle_count, [&](std::uint32_t t) {
        return record.surfaces->triangles()[surface.first_triangle + t] - surface.first_vertex;
      });
  if (!geometry) return false;
  rtcSetGeometryUserData(geometry, const_cast<Record*>(&record));
  if (surface.material.alpha_mode == gltf::AlphaMode::Mask) {
    rtcSetGeometryIntersectFilterFunction(geometry, filterCutOut);
    rtcSetGeometryOccludedFilterFunction(geometry, filterCutOut);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, record.surface);  // geomID becomes the index of the surface
  rtcReleaseGeometry(geometry);                            // the scene holds its own reference
  return true;
}

// Returns whether Embree takes the ray. It asserts that numbers are finite and small enough for products of
// two; a camera or a lamp may be further away, and from there nothing of a scene is seen.
bool traceable(const Ray& ray) {
  constexpr float kLargest = 1.8e18f;
  const auto holds = [](const glm::vec3& v) {
    return std::abs(v.x) <= kLargest && std::abs(v.y) <= kLargest && std::abs(v.z) <= kLargest;
  };
  return holds(ray.origin) && holds(ray.dir) && !std::isnan(ray.far);
}

void fill(RTCRay16& packet, std::span<const Ray> rays, int* valid) {
  for (std::size_t k = 0; k < kWidth; ++k) {
    const Ray& ray = rays[std::min(k, rays.size() - 1)];
    valid[k] = k < rays.size() && traceable(ray) ? -1 : 0;
    packet.org_x[k] = ray.origin.x, packet.org_y[k] = ray.origin.y, packet.org_z[k] = ray.origin.z;
    packet.dir_x[k] = ray.dir.x, packet.dir_y[k] = ray.dir.y, packet.dir_z[k] = ray.dir.z;
    packet.tnear[k] = 0.0f, packet.tfar[k] = ray.far;
    packet.time[k] = 0.0f, packet.mask[k] = ~0u, packet.id[k] = 0, packet.flags[k] = 0;
  }
}

}  // namespace

struct RayTracer::State {
  EmbreeDevice device;
  EmbreeScene solid, layers;  // layers is null if no surface is blended or a pane
  bool any_pane = false;
  std::vector<Record> records;
  const Surfaces* surfaces = nullptr;
};

RayTracer::RayTracer(std::unique_ptr<State> state) : state_(std::move(state)) {}
RayTracer::RayTracer(RayTracer&&) noexcept = default;
RayTracer& RayTracer::operator=(RayTracer&&) noexcept = default;
RayTracer::~RayTracer() = default;

Result<RayTracer> RayTracer::build(const Surfaces& surfaces) {
  auto state = std::make_unique<State>();
  state->surfaces = &surfaces;
  auto device = newEmbreeDevice();
  if (!device) return failAgain(std::move(device.error()));
  state->device = std::move(*device);
  const auto newScene = [&](RTCBuildQuality quality) {
    EmbreeScene scene(rtcNewScene(state->device.get()));
    rtcSetSceneBuildQuality(scene.get(), quality);
    // ROBUST prevents rays from passing through edges that two triangles share.
    rtcSetSceneFlags(scene.get(), static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | kSceneFlagQueryFilter));
    return scene;
  };
  state->solid = newScene(RTC_BUILD_QUALITY_HIGH);
  for (std::uint32_t s = 0; s < surfaces.surfaces().size(); ++s) state->records.push_back({&surfaces, s});
  for (const Record& record : state->records) {
    if (surfaceOf(record).triangle_count == 0) continue;
    const bool layer = isLayer(surfaceOf(record));
    state->any_pane |= surfaceOf(record).material.transmits();
    // Spatial splits (HIGH) would report a triangle's hit more than once.
    if (layer && !state->layers) state->layers = newScene(RTC_BUILD_QUALITY_MEDIUM);
    if (!addGeometry(state->device.get(), layer ? state->layers.get() : state->solid.get(), record))
      return fail("Embree", "has not enough memory for the scene", "make it smaller");
  }
  rtcCommitScene(state->solid.get());
  if (state->layers) rtcCommitScene(state->layers.get());
  if (rtcGetDeviceError(state->device.get()) != RTC_ERROR_NONE)
    return fail("Embree", "could not build its hierarchy over the scene", "check the memory that is free");
  return RayTracer(std::move(state));
}

void RayTracer::intersect(std::span<const Ray> rays, std::span<Hit> hits) const {
  const FlushDenormals flush;
  RayQuery query(RayOrder::Incoherent);
  alignas(64) RTCRayHit16 packet;
  alignas(64) int valid[kWidth];
  for (std::size_t first = 0; first < rays.size(); first += kWidth) {
    const auto some = rays.subspan(first, std::min(kWidth, rays.size() - first));
    fill(packet.ray, some, valid);
    for (std::size_t k = 0; k < kWidth; ++k) packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    query.intersect(state_->solid.get(), valid, packet);
    for (std::size_t k = 0; k < some.size(); ++k) {
      hits[first + k] = {};
      const std::uint32_t surface = packet.hit.geomID[k];
      if (surface == RTC_INVALID_GEOMETRY_ID) continue;
      hits[first + k] = {surface, state_->surfaces->surfaces()[surface].first_triangle + packet.hit.primID[k],
                         packet.hit.u[k], packet.hit.v[k], packet.ray.tfar[k]};
    }
  }
}

void RayTracer::occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const {
  const FlushDenormals flush;
  RayQuery query(RayOrder::Incoherent);
  alignas(64) RTCRay16 packet;
  alignas(64) int valid[kWidth];
  for (std::size_t first = 0; first < rays.size(); first += kWidth) {
    const auto some = rays.subspan(first, std::min(kWidth, rays.size() - first));
    fill(packet, some, valid);
    query.occluded(state_->solid.get(), valid, packet);
    // Embree sets tfar to -inf if the ray is occluded.
    for (std::size_t k = 0; k < some.size(); ++k) blocked[first + k] = packet.tfar[k] < 0.0f;
  }
}

bool RayTracer::hasPanes() const {
  return state_->any_pane;
}

void RayTracer::panesOn(const Ray& ray, std::vector<Hit>& faces) const {
  faces.clear();
  if (!hasPanes() || !traceable(ray)) return;
  const FlushDenormals flush;
  RayQuery query(RayOrder::Incoherent, filterLayers</*OfEye=*/false>, &faces);
  traceOne(state_->layers.get(), ray, ray.far, query);
  sortLayers(*state_->surfaces, ray.dir, faces);
}

void RayTracer::visible(const Ray& ray, std::vector<Hit>& layers) const {
  const FlushDenormals flush;
  layers.clear();
  if (!traceable(ray)) return;
  RayQuery fronts(RayOrder::Incoherent, filterBacks),
      every(RayOrder::Incoherent, filterLayers</*OfEye=*/true>, &layers);
  const RTCRayHit solid = traceOne(state_->solid.get(), ray, ray.far, fronts);
  if (state_->layers) {
    traceOne(state_->layers.get(), ray, solid.ray.tfar, every);
    sortLayers(*state_->surfaces, ray.dir, layers);
  }
  if (solid.hit.geomID != RTC_INVALID_GEOMETRY_ID)
    layers.push_back({solid.hit.geomID,
                      state_->surfaces->surfaces()[solid.hit.geomID].first_triangle + solid.hit.primID,
                      solid.hit.u, solid.hit.v, solid.ray.tfar});
}

}  // namespace lambent::baker::reference
