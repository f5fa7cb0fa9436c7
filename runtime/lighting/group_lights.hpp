// The light of each rigid group on the GPU, in the group's own frame: what effects multiply transfer with.
// Comes in: the environment, and per group its rotation in the world, the order of its transfer and what its
// own lights give now. Goes out: a block of vec4 per group (64 coefficients, zeros above order², then the
// group's own lights) and a version that rises when that block changed. Windowed once per order, then rotated
// per group.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/gpu/objects.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/sh/window.hpp"

namespace lambent::lighting {

struct GroupPlace {
  glm::quat world_from_group{1.0f, 0.0f, 0.0f, 0.0f};
  std::uint32_t order = 1;
  // Lights that belong to the group, one per light column of its transfer: colour times strength.
  std::vector<glm::vec3> lamps{};
  bool operator==(const GroupPlace&) const = default;
};

class GroupLights {
 public:
  static constexpr std::uint32_t kStride = sh::kMaxCoefficients;  // vec4s of a block before its light columns

  GroupLights() : table_("group lights") {}

  // Does nothing if neither the environment, the window nor any group changed.
  void update(const Environment& environment, sh::Window window, std::span<const GroupPlace> groups,
              gpu::Counters& counters);

  std::size_t groupCount() const { return groups_.size(); }
  std::uint32_t firstOf(std::size_t group) const { return groups_[group].first; }  // vec4 index
  std::uint64_t versionOf(std::size_t group) const { return groups_[group].version; }
  void bindStorage(std::uint32_t binding) const { table_.bindStorage(binding); }
  // As uploaded, for CPU twins.
  std::span<const glm::vec4> coefficients() const { return coefficients_; }

 private:
  struct Group {
    GroupPlace place;
    std::uint32_t first = 0;
    std::uint64_t version = 0;
  };
  std::vector<Group> groups_;
  std::vector<glm::vec4> coefficients_;
  std::uint64_t environment_version_ = 0;
  sh::Window window_ = sh::Window::Off;
  std::uint64_t version_ = 0;
  gpu::Table table_;
};

}  // namespace lambent::lighting
