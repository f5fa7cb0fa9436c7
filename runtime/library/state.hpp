// What scene.cpp and renderer.cpp share: what a Scene owns, and the OpenGL state of the host.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include <epoxy/gl.h>

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

namespace lambent::library {

// Saves the OpenGL state of the program that hosts the library, gives Lambent's passes the state that they
// count on, and restores the program's at the end of its life. Render thread only.
class HostState {
 public:
  HostState();
  ~HostState();
  HostState(const HostState&) = delete;
  HostState& operator=(const HostState&) = delete;

 private:
  std::vector<std::pair<GLenum, bool>> switches_;
  std::vector<std::pair<GLenum, GLint>> pixel_store_, buffers_;
  GLint draw_framebuffer_ = 0, read_framebuffer_ = 0, vertex_array_ = 0, program_ = 0, active_texture_ = 0;
  GLint depth_func_ = 0, cull_face_ = 0, front_face_ = 0, polygon_mode_ = 0, clip_origin_ = 0,
        clip_depth_ = 0;
  std::array<GLint, 4> viewport_{};
  std::array<GLint, 6> blend_{};  // equations and factors, of colour and alpha
  std::array<GLboolean, 4> color_mask_{};
  GLboolean depth_mask_ = GL_TRUE;
  std::array<GLdouble, 2> depth_range_{};
};

}  // namespace lambent::library
