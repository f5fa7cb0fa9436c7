#include "baker/cache/bytes.hpp"

#include <algorithm>

namespace lambent::baker {

void ByteWriter::append(std::span<const std::byte> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

bool ByteReader::copy(std::span<std::byte> to) {
  if (!ok_ || to.size() > left_.size()) return failed();
  std::copy_n(left_.begin(), to.size(), to.begin());
  left_ = left_.subspan(to.size());
  return true;
}

}  // namespace lambent::baker
