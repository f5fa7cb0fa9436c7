// Says how much memory this program takes.
#pragma once

#include <cstdint>

namespace lambent::baker {

// Bytes in physical memory now, and the most so far. 0 where the system does not tell.
std::uint64_t residentMemory();
std::uint64_t peakMemory();

}  // namespace lambent::baker
