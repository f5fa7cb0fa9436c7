// The transfer of a group's surfaces in codes: all that the group hands to the bundle of it.
#pragma once

#include <optional>
#include <vector>

#include "baker/bake/surface_transport.hpp"
#include "baker/cache/bytes.hpp"
#include "baker/compress/kept_transfer.hpp"

namespace lambent::baker {

struct SurfaceCells {
  // Per sample cell: light of the environment (of a glossy cell visibility, then bounced light), then, where
  // there are some, of the group's lights.
  std::vector<std::vector<CodedTransfer>> cells;
  SurfaceFigures figures;
};
void write(const SurfaceCells& cells, ByteWriter& out);
bool read(ByteReader& in, SurfaceCells& cells);

// Returns nothing if stopped.
std::optional<SurfaceCells> codeSurfaces(const GroupScene& group, const SurfaceTransport& light,
                                         CachedCoding& coding, Progress& progress);

}  // namespace lambent::baker
