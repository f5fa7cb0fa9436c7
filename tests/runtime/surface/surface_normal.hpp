// Normal maps and the light at their normals: the shaders' own text as C++.
#pragma once

#include "tests/support/glsl/glsl.hpp"

namespace lambent::frame::glsl {

using namespace lambent::glsl;

struct SurfaceNormal {
#include "as_cpp/diffuse_light.glsl"
#include "as_cpp/surface_normal.glsl"
};

}  // namespace lambent::frame::glsl
