// Checks that every member of a material has a row in the table; otherwise this file does not compile.
#include "runtime/bundle/material_fields.hpp"

namespace lambent::gltf {

namespace {

// Stands for a value of any type where a type only counts how many values it takes.
struct AnyValue {
  template <class T>
  operator T() const;
};

// Returns how many members an aggregate has: it takes so many values, and not one more.
template <class T, class... Values>
consteval std::size_t memberCount() {
  if constexpr (requires { T{Values()..., AnyValue()}; })
    return memberCount<T, Values..., AnyValue>();
  else
    return sizeof...(Values);
}

constexpr std::size_t liveValues() {
  std::size_t count = 0;
  forEachLiveValue([&](const auto&, const auto&) { ++count; });
  return count;
}

static_assert(memberCount<Material>() == std::tuple_size_v<decltype(kMaterialFields)>,
              "every member of Material has a row in kMaterialFields");
static_assert(memberCount<MaterialFactors>() == liveValues(),
              "every member of MaterialFactors is a live value of a row in kMaterialFields");

}  // namespace

}  // namespace lambent::gltf
