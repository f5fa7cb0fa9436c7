// A Scene holds what is shown: bundles, the light at infinity, lights among the surfaces, and where bodies
// stand. It needs an OpenGL 4.5 core context that is current, and is used on the thread of that context;
// worker threads of its own read bundles. It must end before the context does. Nothing here draws
// (renderer.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lambent/export.hpp"
#include "lambent/math.hpp"
#include "lambent/result.hpp"

namespace lambent {

// Describes a light that may move. Colours are linear Rec.709.
struct Light {
  enum class Kind : std::uint8_t { Point, Spot, Directional, Sphere, Disc };
  Kind kind = Kind::Sphere;
  Vec3 position{};                    // m, world
  Vec3 direction{0.0f, -1.0f, 0.0f};  // in which a spot, disc or directional light shines; any length but 0
  Vec3 color{1.0f, 1.0f, 1.0f};
  float strength = 1.0f;  // candela (point, spot), lux (directional), radiance (sphere, disc)
  float radius = 0.1f;    // m, of a sphere or disc
  float range = 0.0f;     // m, where a point or spot has faded out; 0: no limit
  float inner_cone_deg = 0.0f, outer_cone_deg = 45.0f;  // half angles of a spot
};

// Name entities of one scene. Those of what was removed are never used again.
struct LightId {
  std::uint64_t value = 0;
};
struct BodyId {
  std::uint64_t value = 0;
};
struct BundleId {
  std::uint32_t value = 0;
};

// Describes a rigid group as it stands now.
struct Body {
  BodyId id{};
  BundleId bundle{};
  std::string name{};
  Matrix4 world_from_body = kIdentity;  // of the node that it moves with
};

class LAMBENT_API Scene {
 public:
  // Bundles take at most so many bytes of GPU memory together; what looks large comes first.
  static Expected<Scene> create(std::uint64_t max_gpu_bytes = ~std::uint64_t{0});
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  // Opens a bundle, which loads while frames are drawn; its bodies are there at once. Fails if the file is no
  // bundle.
  Expected<BundleId> open(const std::string& path);
  void close(BundleId bundle);
  // Returns whether something is still being loaded.
  bool loading() const;
  // Waits until all that there is room for has been loaded. Fails if a bundle turns out damaged.
  Expected<void> finishLoading();

  // Replaces the light at infinity by the sum of words as --light of lambent's programs takes them
  // (docs/conventions.md): "sky.hdr", "constant:1,1,1", "sun:35,45,0.27,900". On a failure the light stays.
  Expected<void> setEnvironment(const std::vector<std::string>& words);
  // Turns it about +Y; positive angles take +Z to +X.
  void turnEnvironment(float degrees);
  void scaleEnvironment(float factor);  // at least 0

  // Fail if a number is not finite or out of range.
  Expected<LightId> addLight(const Light& light);
  Expected<void> setLight(LightId id, const Light& light);
  void removeLight(LightId id);

  // Returns the bodies of all bundles, those of a bundle in the order of its groups. What does not move in a
  // bundle is one body, too: with it the whole bundle moves.
  std::vector<Body> bodies() const;
  // Moves a body. Scale and shear are taken as they come; light is exact for rotations and translations.
  // Fails if there is no such body, or if the matrix is not finite or not affine.
  Expected<void> place(BodyId id, const Matrix4& world_from_body);

  // Plays all animations of the bundles.
  void play(float seconds);
  void setAnimationTime(float seconds);

  // Returns what all positions here count from, in m in the world of the files (docs/conventions.md).
  std::array<double, 3> origin() const;
  // Returns the bounds of all bodies as they stand now, in world space; equal corners at 0 if there are none.
  // Asks every surface of the scene: keep what it returns.
  Box bounds() const;

 private:
  friend class Renderer;
  struct State;
  explicit Scene(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace lambent
