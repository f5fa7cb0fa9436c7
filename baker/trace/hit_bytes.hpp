// Packs the hits of a range of samples into bytes, without what the surfaces reflect: that is looked up
// again, so that traced results stay valid when colours change. What panes before a hit pass is kept.
// Neighbouring rays hit neighbouring triangles, so differences, stored as byte planes, leave little but the
// places on the triangles.
#pragma once

#include "baker/cache/bytes.hpp"
#include "baker/trace/hits.hpp"

namespace lambent::baker {

void writeHits(const RangeHits& hits, ByteWriter& out);
// `samples` is the number in the range, `triangles` that of the group. Returns false if the bytes are not
// such a range.
bool readHits(ByteReader& in, std::size_t samples, std::size_t triangles, RangeHits& hits);

}  // namespace lambent::baker
