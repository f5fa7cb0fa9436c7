// Direct transfer of ranges of samples as bytes to keep. Light of the environment has no colour before it is
// reflected, and that of grey lamps none either: what is the same for red, green and blue is kept once, so
// that what was traced stays good when a grey scene becomes a coloured one.
#pragma once

#include "baker/cache/bytes.hpp"
#include "baker/effects/diffuse/transfer_field.hpp"

namespace lambent::baker {

// Samples [begin, end) of the field. grey_lights: the columns after the environment's are the same in all
// channels.
void writeDirect(const TransferField& field, bool grey_lights, std::size_t begin, std::size_t end,
                 ByteWriter& out);
bool readDirect(ByteReader& in, bool grey_lights, std::size_t begin, std::size_t end, TransferField& field);

// A stretch of a list as it is; the list has the length already.
template <PlainBytes T>
void writeStretch(const std::vector<T>& list, std::size_t begin, std::size_t end, ByteWriter& out) {
  out.addList(std::span<const T>(list).subspan(begin, end - begin));
}
template <PlainBytes T>
bool readStretch(ByteReader& in, std::size_t begin, std::size_t end, std::vector<T>& list) {
  return in.readInto(std::span<T>(list).subspan(begin, end - begin));
}

}  // namespace lambent::baker
