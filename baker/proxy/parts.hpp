// What of a group its proxy shows, in parts that are simplified apart: light that a surface gives off must
// not spread over its neighbours, and two-sided surfaces need two triangles for one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "baker/transport/group_geometry.hpp"
#include "baker/transport/surface_colors.hpp"

namespace lambent::baker {

struct ProxyPart {
  std::uint32_t light = kNoLight;  // column of the group's lights that it gives off
  bool two_sided = false;
  std::vector<std::uint32_t> front, back;  // triangles of the group; back only where two-sided

  std::size_t sides() const { return two_sided ? 2 : 1; }
};

// Surfaces that are cut out or blended with a mean coverage under a half are left out. At most `most` parts,
// counted by sides: then the smallest ones that give off light count as dark.
std::vector<ProxyPart> proxyParts(const GroupGeometry& geometry, const SurfaceColors& colors,
                                  std::size_t most);

}  // namespace lambent::baker
