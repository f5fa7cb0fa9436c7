#include "baker/transport/panes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lambent::baker {

namespace {

// Holds the rays of a packet as fillPacket writes them.
struct PlainRays {
  std::array<float, kPacketWidth> org_x, org_y, org_z, dir_x, dir_y, dir_z, tnear, tfar, time;
  std::array<std::uint32_t, kPacketWidth> mask, flags;
};

// Calls visit(ray, faces) with the faces of panes on each ray that has any.
template <typename Visit>
void forEachRay(const std::vector<PaneHit>& faces, const Visit& visit) {
  for (std::size_t first = 0, end = 0; first < faces.size(); first = end) {
    while (end < faces.size() && faces[end].ray == faces[first].ray) ++end;
    visit(faces[first].ray, std::span(faces).subspan(first, end - first));
  }
}

}  // namespace

glm::vec3 passedBy(std::span<const PaneHit> faces, const SurfaceColors& colors) {
  glm::vec3 passed(1.0f);
  const PaneHit* entry = nullptr;
  const auto absorb = [&](const PaneHit& face, float length_m) {
    passed *= colors.passedInside(face.triangle, length_m);
    entry = nullptr;
  };
  const auto absorbThickness = [&](const PaneHit& face) { absorb(face, colors.thickness(face.triangle)); };
  for (const PaneHit& face : faces) {
    passed *= colors.passed(face.triangle, face.u, face.v);
    if (!face.entering) {
      if (entry)
        absorb(face, face.distance - entry->distance);
      else
        absorbThickness(face);
      continue;
    }
    if (entry) absorbThickness(*entry);
    entry = &face;
  }
  if (entry) absorbThickness(*entry);
  return passed;
}

void passedAlong(std::span<const RaySegment> segments, const RayScene& rays, const SurfaceColors& colors,
                 std::span<glm::vec3> passed) {
  std::ranges::fill(passed, glm::vec3(1.0f));
  std::vector<PaneHit> faces;
  rays.panesOn(segments, faces);
  forEachRay(faces,
             [&](std::uint32_t ray, std::span<const PaneHit> on) { passed[ray] = passedBy(on, colors); });
}

void lookThroughPanes(const SampleRays& sample, const RayScene& rays, const SurfaceColors& colors,
                      std::span<const std::uint16_t> blocked, std::vector<RayHit>& hits,
                      std::vector<DimmedRay>& dimmed) {
  const OriginDealer dealer(sample.origins);
  PlainRays packet;
  PacketLanes lanes;
  std::vector<RaySegment> segments;
  std::vector<std::uint32_t> rays_of;  // by segment: the ray of the sample
  std::vector<std::size_t> hits_of;    // and its hit, or the number of hits if it reaches the sky
  std::size_t h = 0;
  for (std::size_t p = 0; p < blocked.size(); ++p) {
    fillPacket(p, sample, dealer, packet, lanes);
    for (std::size_t k = 0; k < kPacketWidth; ++k) {
      const auto ray = static_cast<std::uint32_t>(p * kPacketWidth + k);
      const bool open = (blocked[p] >> k & 1u) == 0, met = h < hits.size() && hits[h].ray == ray;
      if (open || met) {
        segments.push_back({{packet.org_x[k], packet.org_y[k], packet.org_z[k]},
                            {packet.dir_x[k], packet.dir_y[k], packet.dir_z[k]},
                            met ? hits[h].distance : std::numeric_limits<float>::infinity()});
        rays_of.push_back(ray);
        hits_of.push_back(met ? h : hits.size());
      }
      h += met ? 1 : 0;
    }
  }
  std::vector<PaneHit> faces;
  rays.panesOn(segments, faces);
  std::vector<RayHit> of_panes;
  const std::size_t count = hits.size();
  forEachRay(faces, [&](std::uint32_t segment, std::span<const PaneHit> on) {
    const glm::vec3 passed = passedBy(on, colors);
    if (hits_of[segment] == count)
      dimmed.push_back({rays_of[segment], passed});
    else
      hits[hits_of[segment]].passed = passed;
    for (std::size_t i = 0; i < on.size(); ++i)
      if (!on[i].back)
        of_panes.push_back({.ray = rays_of[segment],
                            .triangle = on[i].triangle,
                            .u = on[i].u,
                            .v = on[i].v,
                            .distance = on[i].distance,
                            .passed = passedBy(on.first(i), colors)});
  });
  hits.insert(hits.end(), of_panes.begin(), of_panes.end());
  std::inplace_merge(hits.begin(), hits.begin() + static_cast<std::ptrdiff_t>(count), hits.end(),
                     [](const RayHit& a, const RayHit& b) { return a.ray < b.ray; });
}

}  // namespace lambent::baker
