// This file is shared by C++ and GLSL. It holds the bindings of data_view.cpp's raster pass, besides
// surface_shared.h.
#ifdef __cplusplus
#pragma once

#include <cstdint>

namespace lambent::frame {
using uint = std::uint32_t;
#define LAMBENT_CONSTANT inline constexpr uint
#else
#define LAMBENT_CONSTANT const uint
#endif

LAMBENT_CONSTANT kBindDataRows = 3u;    // arena page
LAMBENT_CONSTANT kBindDataValues = 4u;  // array of SampleValue of transfer_values_shared.h
LAMBENT_CONSTANT kBindDataDraws = 5u;   // array of DataDraw, indexed by draw of the residency

struct DataDraw {
  uint indices_word;
  uint rows_word;  // laid out as for glossy draws; kAbsent: none
  uint row_entries;
  uint vertex_count;
  uint first_value;  // index of the value of sample 0 of its rows
  uint pad[3];
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(DataDraw) == 32);
}  // namespace lambent::frame
#endif
