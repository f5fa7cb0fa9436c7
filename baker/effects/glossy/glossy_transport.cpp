#include "baker/effects/glossy/glossy_transport.hpp"

#include <algorithm>
#include <cassert>

namespace lambent::baker {

namespace {

// Keeps the first `to` of each `from` values in a row, in place.
void keepFirst(std::size_t from, std::size_t to, std::vector<float>& values) {
  assert(to <= from);
  if (values.empty() || from == to) return;
  const std::size_t rows = values.size() / from;
  for (std::size_t row = 0; row < rows; ++row)
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(row * from), to,
                values.begin() + static_cast<std::ptrdiff_t>(row * to));
  values.resize(rows * to);
  values.shrink_to_fit();
}

}  // namespace

void GlossyField::keepBands(int order) {
  const std::size_t seen = visibilitySize(),
                    outputs = static_cast<std::size_t>(order_out) * static_cast<std::size_t>(order_out),
                    kept = static_cast<std::size_t>(order) * static_cast<std::size_t>(order);
  order_out = order;
  keepFirst(seen, visibilitySize(), visibility);
  keepFirst(outputs * light_columns, kept * light_columns, lights_shadowed);
}

}  // namespace lambent::baker
