// Says how much memory this program takes, in bytes; 0 where the system does not tell.
#pragma once

#include <cstdint>

namespace lambent {

std::uint64_t addressSpaceBytes();  // what is reserved now
std::uint64_t residentBytes();      // what is in physical memory now
std::uint64_t peakBytes();          // the most that has been in physical memory so far
void returnFreedMemory();      // gives memory that the program has freed back to the system, where it can
std::uint64_t machineBytes();  // the physical memory of the machine, whoever uses it

}  // namespace lambent
