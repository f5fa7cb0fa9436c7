// Includes Embree, version 3 or 4, and hides what differs between them: how a call is told its flags, its
// filter and the caller's data. It also sets up what the baker and the reference need alike. It decides
// nothing about rays, of which the two share no code. A RayQuery belongs to one thread.
#pragma once

// The build says which version it links, because the headers of both may be installed.
#if LAMBENT_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#if defined(__SSE2__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <type_traits>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"

namespace lambent::baker {

// Says which of Embree's paths traces the rays: the one for rays that take similar ways through the
// hierarchy, or the one for any rays.
enum class RayOrder { Coherent, Incoherent };

#if LAMBENT_EMBREE == 4
inline constexpr RTCSceneFlags kSceneFlagQueryFilter = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;
using RayQueryContext = RTCRayQueryContext;
#else
inline constexpr RTCSceneFlags kSceneFlagQueryFilter = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;
using RayQueryContext = RTCIntersectContext;
#endif

// A RayQuery holds what calls to Embree need beside the rays. The filter is called after that of a geometry,
// in scenes with kSceneFlagQueryFilter.
class RayQuery {
 public:
  explicit RayQuery(RayOrder order, RTCFilterFunctionN filter = nullptr, void* user = nullptr);
  RayQuery(const RayQuery&) = delete;  // Embree is given the context's address
  RayQuery& operator=(const RayQuery&) = delete;

  // Finds the first hit of each valid ray.
  void intersect(RTCScene scene, RTCRayHit& ray);
  void intersect(RTCScene scene, const int* valid, RTCRayHit16& rays);
  // Sets tfar to -inf where anything is in the way of a valid ray.
  void occluded(RTCScene scene, const int* valid, RTCRay16& rays);

  // Returns the user data of the query that calls a filter.
  static void* userOf(const RTCFilterFunctionNArguments& args) {
    return static_cast<const Context*>(args.context)->user;
  }

 private:
  struct Context : RayQueryContext {
    void* user = nullptr;
  };
  Context context_;
#if LAMBENT_EMBREE == 4
  RTCIntersectArguments intersect_;
  RTCOccludedArguments occluded_;
#endif
};

struct ReleaseEmbree {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using EmbreeDevice = std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseEmbree>;
using EmbreeScene = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseEmbree>;

// Errors: Embree cannot be set up.
Result<EmbreeDevice> newEmbreeDevice();

// Makes a geometry of so many triangles over a copy of the vertices. `corners` returns those of a triangle.
// Returns null if Embree has no memory for it.
template <typename Corners>
RTCGeometry newTriangles(RTCDevice device, std::span<const glm::vec3> vertices, std::uint32_t count,
                         const Corners& corners) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* positions = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                            sizeof(glm::vec3), vertices.size());
  auto* indices = static_cast<glm::uvec3*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3), count));
  if (!positions || !indices) {
    rtcReleaseGeometry(geometry);
    return nullptr;
  }
  std::memcpy(positions, vertices.data(), vertices.size_bytes());
  for (std::uint32_t t = 0; t < count; ++t) indices[t] = corners(t);
  return geometry;
}

// Returns a ray in Embree's layout, which has hit nothing yet.
RTCRayHit rayOf(const glm::vec3& origin, const glm::vec3& direction, float far);

// Flushes denormals while Embree runs, as Embree asks for. The mode is restored afterwards, so that other
// code on the thread is not affected.
class FlushDenormals {
 public:
#if defined(__SSE2__)
  FlushDenormals() : saved_(_mm_getcsr()) {
    _mm_setcsr(saved_ | _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON);
  }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;
  ~FlushDenormals() {
    _mm_setcsr(saved_);
  }

 private:
  unsigned saved_;
#endif
};

}  // namespace lambent::baker
