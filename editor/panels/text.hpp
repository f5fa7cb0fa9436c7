// Formats numbers for people to read.
#pragma once

#include <string>

namespace lambent::editor {

std::string countText(double count);   // "1.2 M"
std::string bytesText(double bytes);   // "3.4 MiB"
std::string timeText(double seconds);  // "850 ms", "12 s", "1:02"

}  // namespace lambent::editor
