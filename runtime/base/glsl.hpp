// GLSL's types and functions for shaders that are compiled as C++ (lambent_as_cpp): one text for the GPU, the
// CPU and tests. A class includes a shader in its body. What the shader declares without a body, and its
// bindings, are members of the class.
#pragma once

#include <cstdint>
#include <span>

#include <glm/glm.hpp>

namespace lambent::glsl {

using namespace glm;
using uint = std::uint32_t;

// Stands for the letters of v.xyz, which is written v->*xyz in C++.
template <int... Components>
struct Swizzle {};
template <length_t N, typename T, int... Components>
constexpr vec<sizeof...(Components), T> operator->*(const vec<N, T>& v, Swizzle<Components...>) {
  return {v[Components]...};
}
inline constexpr Swizzle<0, 1> xy, rg;
inline constexpr Swizzle<2, 3> zw;
inline constexpr Swizzle<0, 1, 2> xyz, rgb;

}  // namespace lambent::glsl
