// Refuses to compile while a member of a material has no row in the table.
#include "runtime/bundle/material_fields.hpp"

namespace lambent::gltf {

namespace {

// A new member changes how many names these need.
[[maybe_unused]] auto membersOf(const Material& material) {
  const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w] = material;
  return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w);
}
[[maybe_unused]] auto membersOf(const MaterialFactors& factors) {
  const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = factors;
  return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n);
}

template <class T>
constexpr std::size_t kMembers = std::tuple_size_v<decltype(membersOf(std::declval<const T&>()))>;

constexpr std::size_t liveValues() {
  std::size_t count = 0;
  forEachLiveValue([&](const auto&, const auto&) { ++count; });
  return count;
}

static_assert(kMembers<Material> == std::tuple_size_v<decltype(kMaterialFields)>,
              "every member of Material has a row in kMaterialFields");
static_assert(kMembers<MaterialFactors> == liveValues(),
              "every member of MaterialFactors is a live value of a row in kMaterialFields");

}  // namespace

}  // namespace lambent::gltf
