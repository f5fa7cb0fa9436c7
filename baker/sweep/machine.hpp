// Names the machine that times were measured on, because times of another one cannot be compared with them.
#pragma once

#include <string>

namespace lambent::baker {

// Returns the processor's name and its number of threads, as "AMD EPYC 7B13, 8 threads".
std::string machineName();

}  // namespace lambent::baker
