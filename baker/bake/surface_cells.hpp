// Codes the transfer of a group's surfaces: all that the group hands to the bundle of it.
#pragma once

#include <optional>
#include <vector>

#include "baker/bake/surface_transport.hpp"
#include "baker/cache/bytes.hpp"
#include "baker/compress/kept_transfer.hpp"

namespace lambent::baker {

struct SurfaceCells {
  // Transfers of each sample cell: that of the environment (for a glossy cell visibility, then bounced
  // light), followed by that of the group's lights if it has any.
  std::vector<std::vector<CodedTransfer>> cells;
  std::vector<std::uint8_t> importance;  // of each sample (description.hpp)
  SurfaceFigures figures;
};
void write(const SurfaceCells& cells, ByteWriter& out);
bool read(ByteReader& in, SurfaceCells& cells);

// Returns nothing if stopped.
std::optional<SurfaceCells> codeSurfaces(const GroupScene& group, const SurfaceTransport& light,
                                         CachedCoding& coding, Progress& progress);

}  // namespace lambent::baker
