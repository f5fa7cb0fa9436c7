// Divides what a proxy shows of a group into parts that are simplified separately, because emitted light must
// not spread over neighbouring surfaces and two-sided surfaces need two triangles for one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "baker/transport/group_geometry.hpp"
#include "baker/transport/surface_colors.hpp"

namespace lambent::baker {

struct ProxyPart {
  std::uint32_t light = kNoLight;  // column of the group's light that it emits
  bool two_sided = false;
  std::vector<std::uint32_t> front, back;  // triangles of the group; back only if two-sided

  std::size_t sides() const { return two_sided ? 2 : 1; }
};

// Leaves out surfaces that are cut out or blended with a mean coverage under a half. Returns at most `most`
// parts, counted by sides; to stay within that, the smallest parts that emit light count as dark.
std::vector<ProxyPart> proxyParts(const GroupGeometry& geometry, const SurfaceColors& colors,
                                  std::size_t most);

}  // namespace lambent::baker
