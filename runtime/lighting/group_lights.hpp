// The light of each rigid group on the GPU, in the group's own frame: what effects multiply transfer with.
// Comes in: the environment, and per group its rotation in the world, the order of its transfer, what arrives
// at its light probes and what its own lights give now. Goes out: per group and light probe two blocks of
// 64 coefficients of vec4 (zeros above order²), the light without key lights and that of key lights alone
// (and of lamps whose straight light comes per pixel, too),
// then the group's own lights, and versions that rise when these change. The first block is windowed (the
// environment once per order, a light of the same shape as before not anew); both are rotated per group.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/base/keyed_state.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/sh/cached_window.hpp"

namespace lambent::lighting {

// What arrives at a light probe, world axes.
struct Incident {
  const sh::LightVector* light = nullptr;  // without key lights; null: the environment's, nothing in its way
  const sh::LightVector* key = nullptr;    // of key lights and lamps that stand apart, likewise
  std::uint64_t version = 0;               // of both
};

struct GroupPlace {
  glm::quat world_from_group{1.0f, 0.0f, 0.0f, 0.0f};
  std::uint32_t order = 1;
  // Lights that belong to the group, one per light column of its transfer: colour times strength.
  std::vector<glm::vec3> lamps{};
  std::vector<Incident> incident = {{}};  // per light probe
  std::uint64_t key = 0;                  // by which the group is known again when others come and go
  // Key lights stand apart, for their direct light comes by shadow maps, and so do lamps. Else transfer
  // brings all of them.
  bool parted = true;
};

class GroupLights {
 public:
  static constexpr std::uint32_t kBlock = sh::kMaxCoefficients;  // vec4s of one light
  static constexpr std::uint32_t kStride = 2 * kBlock;           // of a light probe: without keys, keys alone

  GroupLights() : table_("group lights") {}

  // Does nothing if neither the environment, the window, max_order nor any group changed. max_order: bands of
  // the light that count, at most; the window is that of as many, and higher ones are 0.
  void update(const Environment& environment, sh::Window window, std::span<const GroupPlace> groups,
              gpu::Counters& counters, int max_order = sh::kMaxOrder);
  // All counts as new in the next update.
  void forget() {
    groups_.clear();
    environment_windows_ = {};
  }

  std::size_t groupCount() const { return groups_.size(); }
  // Whether there are key lights, or lamps that stand apart; without them their blocks are 0.
  bool hasKeys() const { return has_keys_; }
  // vec4 indices: of a light probe's coefficients (those of its key lights kBlock behind them), of the
  // group's own lights.
  std::uint32_t firstOf(std::size_t group, std::size_t sample = 0) const {
    return groups_[group].first + kStride * static_cast<std::uint32_t>(sample);
  }
  std::uint32_t lampsOf(std::size_t group) const { return firstOf(group, groups_[group].samples.size()); }
  // Of all of it, of one light probe, of its own lights.
  std::uint64_t versionOf(std::size_t group) const { return groups_[group].version; }
  std::uint64_t versionOf(std::size_t group, std::size_t sample) const {
    return groups_[group].samples[sample].version;
  }
  std::uint64_t lampsVersionOf(std::size_t group) const { return groups_[group].lamps_version; }
  // By how much of itself the light that arrives at the group changed in the last update, at the sample where
  // it changed most: 0 where nothing did, at most 1. In world axes: a group that turns under a still light
  // has 0.
  float changeOf(std::size_t group) const { return groups_[group].change; }
  // Light probes whose coefficients the last update wrote.
  std::uint32_t renewedSamples() const { return renewed_; }
  void bindStorage(std::uint32_t binding) const { table_.bindStorage(binding); }
  // As uploaded, for CPU twins.
  std::span<const glm::vec4> coefficients() const { return coefficients_; }

 private:
  struct Sample {
    bool from_environment = false;
    std::uint64_t seen = 0;  // version of the light it was computed from
    std::uint64_t version = 0;
    sh::CachedWindow window;
    sh::LightVector light_ws{1}, key_ws{1};  // the first windowed
  };
  struct Group {
    glm::quat world_from_group{1.0f, 0.0f, 0.0f, 0.0f};
    std::uint32_t order = 0;
    bool parted = true;
    std::vector<glm::vec3> lamps;
    std::vector<Sample> samples;
    std::uint32_t first = 0;
    std::uint64_t version = 0, lamps_version = 0;
    float change = 0.0f;
  };
  // A light probe to be written.
  struct Renewal {
    std::size_t group = 0, sample = 0;
    bool light = false;  // also its light is new, not only the frame it is in
  };
  static bool sameLayout(const GroupPlace& place, const Group& group);
  // Those whose windows are to be searched for, on several threads: each is for itself.
  void followWindows(const Environment& environment, sh::Window window, std::span<const GroupPlace> groups,
                     std::span<const Renewal> renewals);
  // What arrives at a light probe, world axes: without key lights (all of it where they are not apart), and
  // of them.
  static sh::LightVector lightOf(const Environment& environment, const GroupPlace& place, std::size_t sample);
  static sh::LightVector keyLightOf(const Environment& environment, const GroupPlace& place,
                                    std::size_t sample);
  // Which of environment_windows_ a place goes by.
  static std::size_t environmentWindow(const GroupPlace& place) {
    return 2 * std::size_t{place.order} + (place.parted ? 1 : 0);
  }
  sh::CachedWindow& windowOf(const Renewal& renewal, const GroupPlace& place);
  void write(const Environment& environment, std::span<const GroupPlace> groups,
             std::span<const Renewal> renewals);
  void layOut(std::span<const GroupPlace> groups);
  bool updateLamps(Group& group, const GroupPlace& place);

  KeyedState<Group> groups_;
  std::array<sh::CachedWindow, 2 * (sh::kMaxOrder + 1)> environment_windows_;  // see environmentWindow()
  std::vector<glm::vec4> coefficients_;
  std::uint64_t environment_version_ = 0;
  sh::Window window_ = sh::Window::Off;
  int max_order_ = sh::kMaxOrder;
  std::uint64_t version_ = 0;
  std::uint32_t renewed_ = 0;
  bool has_keys_ = false;
  gpu::Table table_;
};

}  // namespace lambent::lighting
