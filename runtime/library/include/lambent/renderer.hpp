// Draws a scene into a program's own textures, as linear radiance: Lambent's surfaces are hidden by what has
// been drawn there, and hide what is drawn later. The rules of scene.hpp for contexts and threads hold here.
//
// draw() leaves these as they were: the bound framebuffer, vertex array and program; viewport; depth, blend,
// cull, scissor, stencil and polygon state; masks; pixel storage and its buffers; the active texture unit.
// Bindings of texture units, samplers, images and of storage and uniform buffers are not restored.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lambent/export.hpp"
#include "lambent/math.hpp"
#include "lambent/result.hpp"
#include "lambent/scene.hpp"

namespace lambent {

struct Camera {
  Matrix4 view_from_world = kIdentity;  // a rotation and a translation
  Matrix4 clip_from_view = kIdentity;   // OpenGL's, with z in -1..1
};

// Names two textures of the program's, which have the same size and the same number of samples, storage that
// does not change (glTextureStorage2D, glTextureStorage2DMultisample) and one level. They are drawn into,
// never cleared: clear depth to 1 and colour to 0 first.
struct Target {
  std::uint32_t color = 0;  // GL_RGBA16F or GL_RGBA32F; receives linear radiance, alpha is coverage
  std::uint32_t depth = 0;  // GL_DEPTH_COMPONENT32F, 32, 24 or 16; GL_LESS
};

struct PassTime {
  std::string name{};
  double cpu_ms = 0.0;
  double gpu_ms = -1.0;  // -1 until it is known, a few frames later
};

class LAMBENT_API Renderer {
 public:
  // Compiles what every scene needs; the rest is compiled when it is first shown. Fails if a shader does not
  // compile on this device.
  static Expected<Renderer> create();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  // Sets what lambent-demo has an option for, by its name without dashes: "order" "5", "transfer" "shadowed",
  // "keys" "4", "key-size" "2048". Fails, with the words that there are, if there is no such setting or
  // value.
  Expected<void> set(const std::string& name, const std::string& value);
  // If true (default), the sky is drawn where nothing else is.
  void showSky(bool shown);

  // Loads what has arrived, brings light up to date where something changed, and draws. Nothing waits for the
  // GPU. Fails if the target is not as described, or if memory runs out.
  Expected<void> draw(Scene& scene, const Camera& camera, const Target& target);
  // Repeats light between bodies until it has come to rest, for pictures that must not depend on the frames
  // before. Returns after at most 16 steps.
  Expected<void> settle(Scene& scene);

  // Returns what the passes of the newest frame took that is known.
  std::vector<PassTime> times() const;

 private:
  struct State;
  explicit Renderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace lambent
