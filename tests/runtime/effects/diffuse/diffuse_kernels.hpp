// The kernels of the diffuse effect as C++.
#pragma once

#include "runtime/effects/diffuse/diffuse_shared.h"
#include "tests/support/glsl/transfer.hpp"

namespace lambent::effects::diffuse::glsl {

using namespace lambent::glsl;
using namespace transfer;

struct Vertices : Invocation {
#define LAMBENT_OUTPUTS 1
#include "as_cpp/diffuse_vertices.comp"
#undef LAMBENT_OUTPUTS
};

struct MappedVertices : Invocation {
#define LAMBENT_OUTPUTS 9
#include "as_cpp/diffuse_vertices.comp"
#undef LAMBENT_OUTPUTS
};

struct ShadeTexels : Invocation {
  uvec3 gl_GlobalInvocationID{0};
#include "as_cpp/diffuse_texels.comp"
};

struct ShadeProxies : Invocation {
#include "as_cpp/diffuse_proxies.comp"
};

}  // namespace lambent::effects::diffuse::glsl
