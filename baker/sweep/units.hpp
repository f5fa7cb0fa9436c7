// Formats quantities for the page: "2.3 %", "41.0 s", "312 kB". Three figures at most.
#pragma once

#include <string>

namespace lambent::baker {

std::string percent(double share);
std::string tickPercent(double share);  // for axes, where values are round
std::string seconds(double value);
std::string milliseconds(double value);
std::string bytes(double value);

}  // namespace lambent::baker
