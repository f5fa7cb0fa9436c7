#include "baker/embree/embree.hpp"

namespace lambent::baker {

#if LAMBENT_EMBREE == 4

RayQuery::RayQuery(RayOrder order, RTCFilterFunctionN filter, void* user) {
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

void RayQuery::intersect(RTCScene scene, RTCRayHit& ray) {
  rtcIntersect1(scene, &ray, &intersect_);
}
void RayQuery::intersect(RTCScene scene, const int* valid, RTCRayHit16& rays) {
  rtcIntersect16(valid, scene, &rays, &intersect_);
}
void RayQuery::occluded(RTCScene scene, const int* valid, RTCRay16& rays) {
  rtcOccluded16(valid, scene, &rays, &occluded_);
}

#else

RayQuery::RayQuery(RayOrder order, RTCFilterFunctionN filter, void* user) {
  rtcInitIntersectContext(&context_);
  context_.user = user;
  context_.flags = order == RayOrder::Coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                               : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  context_.filter = filter;
}

void RayQuery::intersect(RTCScene scene, RTCRayHit& ray) {
  rtcIntersect1(scene, &context_, &ray);
}
void RayQuery::intersect(RTCScene scene, const int* valid, RTCRayHit16& rays) {
  rtcIntersect16(valid, scene, &context_, &rays);
}
void RayQuery::occluded(RTCScene scene, const int* valid, RTCRay16& rays) {
  rtcOccluded16(valid, scene, &context_, &rays);
}

#endif

Result<EmbreeDevice> newEmbreeDevice() {
  // Embree's thread count follows TBB's, which withThreads() limits; its result does not depend on it.
  EmbreeDevice device(rtcNewDevice(nullptr));
  if (!device)
    return fail("Embree", "cannot be set up",
                "give it more memory, or check that Embree runs on this processor");
  return device;
}

RTCRayHit rayOf(const glm::vec3& origin, const glm::vec3& direction, float far) {
  RTCRayHit ray{};
  ray.ray.org_x = origin.x, ray.ray.org_y = origin.y, ray.ray.org_z = origin.z;
  ray.ray.dir_x = direction.x, ray.ray.dir_y = direction.y, ray.ray.dir_z = direction.z;
  ray.ray.tfar = far, ray.ray.mask = ~0u;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return ray;
}

}  // namespace lambent::baker
