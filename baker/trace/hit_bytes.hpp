// Hits of a range of samples as bytes to keep, without what the surfaces reflect: that is looked up again, so
// that what was traced stays good when colours change. Neighbouring rays meet neighbouring triangles;
// differences by planes of bytes leave little but the places on the triangles.
#pragma once

#include "baker/cache/bytes.hpp"
#include "baker/trace/hits.hpp"

namespace lambent::baker {

void writeHits(const RangeHits& hits, ByteWriter& out);
// samples: of the range. triangles: of the group. False where the bytes are not those of such a range.
bool readHits(ByteReader& in, std::size_t samples, std::size_t triangles, RangeHits& hits);

}  // namespace lambent::baker
