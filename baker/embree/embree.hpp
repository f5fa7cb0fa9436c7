// Includes Embree, version 3 or 4, and hides what differs between them: how a call is told its flags, its
// filter and the caller's data. It owns no geometry and decides nothing about rays, so the baker and the
// reference, which share no ray code, both use it. A RayQuery belongs to one thread.
#pragma once

// The build says which version it links, because the headers of both may be installed.
#if LAMBENT_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

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
  void occluded(RTCScene scene, RTCRay& ray);
  void occluded(RTCScene scene, const int* valid, RTCRay8& rays);
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

}  // namespace lambent::baker
