// Bakes scenes into bundles: glTF files, or meshes that a program has in memory. Works on all threads that it
// is given, without OpenGL; several bakes may run at once, each from a thread of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lambent/export.hpp"
#include "lambent/math.hpp"
#include "lambent/result.hpp"

namespace lambent {

// Describes a mesh of one material. Nothing is kept of the spans once it has been added.
struct BakeMesh {
  std::string name{};
  std::span<const Vec3> positions{};
  std::span<const Vec3> normals{};           // unit, one per position; none: flat, by the triangles
  std::span<const std::uint32_t> indices{};  // three per triangle, counter-clockwise seen from outside
  Vec3 albedo{0.8f, 0.8f, 0.8f};             // linear, 0..1
  Vec3 emission{};                           // radiance; above 0 the mesh is a lamp that can be dimmed
  float metallic = 0.0f, roughness = 1.0f;   // 0 and 1: a diffuse surface
  bool double_sided = false;
  bool movable = false;  // a body of its own, which may move when it is shown
  Matrix4 world_from_mesh = kIdentity;
};

class LAMBENT_API BakeScene {
 public:
  BakeScene();
  // Imports a glTF file. Fails as `lambent bake` does.
  static Expected<BakeScene> open(const std::string& path);
  BakeScene(BakeScene&&) noexcept;
  BakeScene& operator=(BakeScene&&) noexcept;
  ~BakeScene();

  // Fails, and adds nothing, if sizes do not fit, an index is out of range, a value is not finite or out of
  // its range, or no triangle has an area.
  Expected<void> add(const BakeMesh& mesh);
  // Returns sentences about what was left out or mended.
  std::vector<std::string> warnings() const;

 private:
  friend class Baker;
  struct State;
  std::unique_ptr<State> state_;
};

struct BakeProgress {
  std::string stage{};        // that runs now: "direct", "bounce 1", ...
  std::string unit{};         // what it counts: "rays", "samples"; may be empty
  std::uint64_t done = 0;     // units of the stage
  double fraction = 0.0;      // of the whole bake, 0..1; never falls
  double seconds_left = 0.0;  // estimated
};

struct BakeResult {
  std::uint64_t rays = 0, samples = 0;
  std::uint64_t file_bytes = 0;
  double seconds = 0.0;
  std::vector<std::string> notices{};  // where the result differs from what was asked for
};

class LAMBENT_API Baker {
 public:
  // Is asked a few times per second, on another thread than run(); if it returns false, the bake stops.
  using Watcher = std::function<bool(const BakeProgress&)>;

  Baker();
  Baker(Baker&&) noexcept;
  Baker& operator=(Baker&&) noexcept;
  ~Baker();

  // Sets what `lambent bake` has an option for, by its name without dashes: "quality" "draft", "order" "5",
  // "rays" "512", "bounces" "2", "threads" "4", "max-memory" "2GB". Fails if there is no such option or
  // value.
  Expected<void> set(const std::string& name, const std::string& value);
  // Keeps results in this folder, so that the next bake does only what changed. Without one nothing is kept.
  // Fails if the folder cannot be used.
  Expected<void> keepResultsIn(const std::string& folder);

  // Bakes and writes the bundle, or nothing at all if it fails or is stopped.
  Expected<BakeResult> run(const BakeScene& scene, const std::string& output, const Watcher& watcher = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lambent
