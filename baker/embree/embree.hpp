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

#if LAMBENT_EMBREE == 4

inline RayQuery::RayQuery(RayOrder order, RTCFilterFunctionN filter, void* user) {
  rtcInitRayQueryContext(&context_);
  context_.user = user;
  rtcInitIntersectArguments(&intersect_);
  rtcInitOccludedArguments(&occluded_);
  unsigned flags = order == RayOrder::Coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
  if (filter) flags |= RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;
  intersect_.flags = occluded_.flags = static_cast<RTCRayQueryFlags>(flags);
  intersect_.filter = occluded_.filter = filter;
  intersect_.context = occluded_.context = &context_;
}

inline void RayQuery::intersect(RTCScene scene, RTCRayHit& ray) {
  rtcIntersect1(scene, &ray, &intersect_);
}
inline void RayQuery::intersect(RTCScene scene, const int* valid, RTCRayHit16& rays) {
  rtcIntersect16(valid, scene, &rays, &intersect_);
}
inline void RayQuery::occluded(RTCScene scene, RTCRay& ray) {
  rtcOccluded1(scene, &ray, &occluded_);
}
inline void RayQuery::occluded(RTCScene scene, const int* valid, RTCRay8& rays) {
  rtcOccluded8(valid, scene, &rays, &occluded_);
}
inline void RayQuery::occluded(RTCScene scene, const int* valid, RTCRay16& rays) {
  rtcOccluded16(valid, scene, &rays, &occluded_);
}

#else

inline RayQuery::RayQuery(RayOrder order, RTCFilterFunctionN filter, void* user) {
  rtcInitIntersectContext(&context_);
  context_.user = user;
  context_.flags = order == RayOrder::Coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                               : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  context_.filter = filter;
}

inline void RayQuery::intersect(RTCScene scene, RTCRayHit& ray) {
  rtcIntersect1(scene, &context_, &ray);
}
inline void RayQuery::intersect(RTCScene scene, const int* valid, RTCRayHit16& rays) {
  rtcIntersect16(valid, scene, &context_, &rays);
}
inline void RayQuery::occluded(RTCScene scene, RTCRay& ray) {
  rtcOccluded1(scene, &context_, &ray);
}
inline void RayQuery::occluded(RTCScene scene, const int* valid, RTCRay8& rays) {
  rtcOccluded8(valid, scene, &context_, &rays);
}
inline void RayQuery::occluded(RTCScene scene, const int* valid, RTCRay16& rays) {
  rtcOccluded16(valid, scene, &context_, &rays);
}

#endif

}  // namespace lambent::baker
