// Owns the light of each rigid group on the GPU, in the group's own frame, as effects multiply it with
// transfer. It takes the environment and, per group, its rotation in the world, the order of its transfer,
// the light that arrives at its light probes, and the current strength of its own lights. It provides per
// group and light probe two blocks of 64 vec4 coefficients (zero from order² on): first the light without key
// lights, then key lights alone, with those lamps whose direct light is shaded per pixel. The group's own
// lights follow three times: all of their light, the part that is not shaded per pixel, and the part that is.
// Versions rise when these change. The first block is windowed (the environment once per
// order, and only when the shape of its light changed); both blocks are rotated per group. Render thread
// only.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/base/change_gate.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/sh/window.hpp"

namespace lambent::lighting {

// Names the light that arrives at a light probe, in world axes.
struct Incident {
  const sh::LightVector* light = nullptr;  // without key lights; null: the environment's, unoccluded
  const sh::LightVector* key = nullptr;    // key lights and lamps shaded per pixel; null: as for light
  std::uint64_t version = 0;               // of both
};

struct GroupPlace {
  glm::quat world_from_group{1.0f, 0.0f, 0.0f, 0.0f};
  std::uint32_t order = 1;
  // The strengths of the lights that belong to the group, one per light column of its transfer: colour times
  // strength.
  std::vector<glm::vec3> lamps{};
  // The share of each of these lights whose direct light is shaded per pixel, 0..1, so that only its bounces
  // go by the column. Empty means 0 for all. It counts only if the place is parted.
  std::vector<float> lamps_apart{};
  std::vector<Incident> incident = {{}};  // one per light probe
  std::uint64_t key = 0;                  // identifies the group when others come and go
  // If true, key lights and lamps are kept apart because shadow maps carry their direct light. If false,
  // transfer carries all of it.
  bool parted = true;
};

class GroupLights {
 public:
  static constexpr std::uint32_t kBlock = sh::kMaxCoefficients;  // vec4s per light
  static constexpr std::uint32_t kStride = 2 * kBlock;           // vec4s per light probe: light, then keys

  GroupLights() : table_("group lights") {}

  // Uploads what changed; does nothing if the environment, the window, max_order and all groups are as
  // before. `max_order` limits the bands of the light: the window is made for that many bands, and higher
  // bands are 0.
  void update(const Environment& environment, sh::Window window, std::span<const GroupPlace> groups,
              gpu::Counters& counters, int max_order = sh::kMaxOrder);
  // Makes the next update treat everything as new.
  void forget() {
    groups_.clear();
    environment_windows_ = {};
  }

  std::size_t groupCount() const { return groups_.size(); }
  // Returns whether there are key lights or lamps that are kept apart. If not, their blocks are 0.
  bool hasKeys() const { return has_keys_; }
  // Returns whether any of the groups' own lights is shaded per pixel.
  bool hasPartedLamps() const { return has_parted_lamps_; }
  // Return indices of vec4s: of a light probe's first coefficient (its key lights follow kBlock later), and
  // of the group's own lights.
  std::uint32_t firstOf(std::size_t group, std::size_t sample = 0) const {
    return groups_[group].first + kStride * static_cast<std::uint32_t>(sample);
  }
  std::uint32_t lampsOf(std::size_t group) const { return firstOf(group, groups_[group].samples.size()); }
  // Returns the index of the light that is not shaded per pixel of the group's own lights; what is shaded per
  // pixel follows as many vec4s later as the group has lights.
  std::uint32_t partedLampsOf(std::size_t group) const {
    return lampsOf(group) + static_cast<std::uint32_t>(groups_[group].lamps.size());
  }
  // Return the versions of all light of a group, of one light probe, and of the group's own lights.
  std::uint64_t versionOf(std::size_t group) const { return groups_[group].version; }
  std::uint64_t versionOf(std::size_t group, std::size_t sample) const {
    return groups_[group].samples[sample].version;
  }
  std::uint64_t lampsVersionOf(std::size_t group) const { return groups_[group].lamps_version; }
  // Returns the relative change, 0..1, of the light that arrived at the group in the last update, at the
  // light probe where it changed most. It is measured in world axes, so a group that turns under constant
  // light gives 0.
  float changeOf(std::size_t group) const { return groups_[group].change; }
  // Returns how many light probes the last update wrote.
  std::uint32_t renewedSamples() const { return renewed_; }
  void bindStorage(std::uint32_t binding) const { table_.bindStorage(binding); }
  // Returns the coefficients as uploaded, for tests that run kernels on the CPU.
  std::span<const glm::vec4> coefficients() const { return coefficients_; }

 private:
  struct Sample {
    bool from_environment = false;
    std::uint64_t seen = 0;  // version of the light that it was computed from
    std::uint64_t version = 0;
    sh::CachedWindow window;
    sh::LightVector light_ws{1}, key_ws{1};  // light_ws is windowed
  };
  struct Group {
    glm::quat world_from_group{1.0f, 0.0f, 0.0f, 0.0f};
    std::uint32_t order = 0;
    bool parted = true;
    std::vector<glm::vec3> lamps;
    std::vector<float> lamps_apart;
    std::vector<Sample> samples;
    std::uint32_t first = 0;
    std::uint64_t version = 0, lamps_version = 0;
    float change = 0.0f;
  };
  // Names a light probe that must be written.
  struct Renewal {
    std::size_t group = 0, sample = 0;
    bool light = false;  // its light is new, not only the frame of its group
  };
  static bool sameLayout(const GroupPlace& place, const Group& group);
  // Searches for the windows of those probes that need one. Each search is independent, so several threads
  // share the work.
  void followWindows(const Environment& environment, sh::Window window, std::span<const GroupPlace> groups,
                     std::span<const Renewal> renewals);
  // Returns the index into environment_windows_ that applies to a place.
  static std::size_t environmentWindow(const GroupPlace& place) {
    return 2 * std::size_t{place.order} + (place.parted ? 1 : 0);
  }
  sh::CachedWindow& windowOf(const Renewal& renewal, const GroupPlace& place);
  void write(const Environment& environment, std::span<const GroupPlace> groups,
             std::span<const Renewal> renewals);
  void layOut(std::span<const GroupPlace> groups);
  bool updateLamps(Group& group, const GroupPlace& place);

  KeyedState<Group> groups_;
  // Indexed by environmentWindow().
  std::array<sh::CachedWindow, 2 * (sh::kMaxOrder + 1)> environment_windows_;
  std::vector<glm::vec4> coefficients_;
  std::uint64_t environment_version_ = 0;
  sh::Window window_ = sh::Window::Off;
  int max_order_ = sh::kMaxOrder;
  std::uint64_t version_ = 0;
  std::uint32_t renewed_ = 0;
  bool has_keys_ = false, has_parted_lamps_ = false;
  gpu::Table table_;
};

}  // namespace lambent::lighting
