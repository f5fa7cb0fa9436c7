// Holds what a Scene of the library owns, for scene.cpp and renderer.cpp.
#pragma once

#include "lambent/scene.hpp"
#include "runtime/gpu/context.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/world/world.hpp"

namespace lambent {

struct Scene::State {
  frame::World world;
  lighting::Environment environment;
};

}  // namespace lambent
