// Runs shaders that are compiled as C++ (runtime/base/glsl.hpp), so that tests compare the very text that the
// GPU runs with closed forms, and a debugger steps through it. A kernel derives from Invocation and includes
// its text; a test fills its bindings.
#pragma once

#include <utility>
#include <vector>

#include "runtime/base/glsl.hpp"

namespace lambent::glsl {

// An image of up to three dimensions.
struct Texels {
  uvec3 size{1};
  std::vector<vec4> values;

  explicit Texels(const uvec3& of = uvec3(1)) : size(of), values(std::size_t{of.x} * of.y * of.z) {}
  const vec4& at(const uvec3& texel) const {
    return values[texel.x + std::size_t{size.x} * (texel.y + std::size_t{size.y} * texel.z)];
  }
  vec4& at(const uvec3& texel) { return const_cast<vec4&>(std::as_const(*this).at(texel)); }
  // Interpolates linearly between texel centres and clamps beyond the outermost. `place` is 0..1.
  vec4 sample(const vec3& place) const {
    const vec3 last(size - 1u), from = clamp(place * vec3(size) - 0.5f, vec3(0.0f), last);
    const vec3 low = min(floor(from), max(last - 1.0f, vec3(0.0f))), part = from - low;
    vec4 sum(0.0f);
    for (uint corner = 0; corner < 8; ++corner) {
      const vec3 side(corner & 1u, corner >> 1 & 1u, corner >> 2), share = mix(1.0f - part, part, side);
      sum += share.x * share.y * share.z * at(uvec3(min(low + side, last)));
    }
    return sum;
  }
};
using image2D = Texels;
using image3D = Texels;
inline void imageStore(Texels& image, const ivec2& at, const vec4& value) {
  image.at({at, 0}) = value;
}
inline void imageStore(Texels& image, const ivec3& at, const vec4& value) {
  image.at(at) = value;
}

// What a shader sees of the invocation that runs it.
struct Invocation {
  uvec3 gl_WorkGroupID{0}, gl_LocalInvocationID{0};
  bool waits = false;
  void barrier() { waits = true; }
};

struct WorkItem {
  uint record, first;
};

// Runs a kernel for all elements of its first record. A work group that met a barrier runs twice, since
// behind it an invocation reads what later ones write before it; so a kernel with barriers must not read what
// it writes to a buffer.
template <typename Kernel>
void run(Kernel& kernel, uint elements, uint per_group = Kernel::kInvocations) {
  std::vector<std::remove_const_t<typename decltype(kernel.work)::element_type>> work;
  for (uint first = 0; first < elements; first += per_group) work.push_back({0, first});
  kernel.work = work;
  kernel.work_count = static_cast<uint>(work.size());
  uint& group = kernel.gl_WorkGroupID.x;
  for (group = 0; group < kernel.work_count; ++group)
    for (uint i = 0; i < Kernel::kInvocations * (kernel.waits ? 2 : 1); ++i) {
      kernel.gl_LocalInvocationID.x = i % Kernel::kInvocations;
      kernel.main();
    }
}

}  // namespace lambent::glsl
