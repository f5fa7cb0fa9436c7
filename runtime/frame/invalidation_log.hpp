// Explains why passes run: it says in words what changed since the last step. It compares versions and values
// of the world, the environment, the settings and the view once per step. For a pass that did something it
// returns the causes that concern the pass in one line, such as "light turned, 2 groups moved". It only
// reports; no pass runs because of it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/frame/frame_settings.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

enum class Cause : std::uint32_t {
  Arrived = 1u << 0,      // parts of bundles arrived
  Moved = 1u << 1,        // nodes and groups
  Environment = 1u << 2,  // loaded, turned, faded or dimmed
  Lights = 1u << 3,       // lights in the scene, and emissive materials
  Captured = 1u << 4,     // light between bodies arrived from captures
  Materials = 1u << 5,
  Settings = 1u << 6,  // each by its name
  View = 1u << 7,      // camera and size
  Exposure = 1u << 8,  // only affects the tone mapper
  Asked = 1u << 9      // Frame::forget() was called
};
constexpr std::uint32_t operator|(Cause a, Cause b) {
  return static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b);
}
constexpr std::uint32_t operator|(std::uint32_t a, Cause b) {
  return a | static_cast<std::uint32_t>(b);
}

// These causes change light on surfaces, whatever the camera.
inline constexpr std::uint32_t kLightCauses = Cause::Arrived | Cause::Moved | Cause::Environment |
                                              Cause::Lights | Cause::Captured | Cause::Settings |
                                              Cause::Asked;

// These causes change what a camera sees of it.
inline constexpr std::uint32_t kPictureCauses = kLightCauses | Cause::Materials | Cause::View;

class InvalidationLog {
 public:
  // Clears the log at the start of a step.
  void begin() { notes_.clear(); }
  // Each of these notes what changed since its last call.
  void noticeArrivals(const World& world, std::uint64_t bytes);
  void noticeWorld(const World& world);
  void noticeEnvironment(const lighting::Environment& environment);
  void noticeSettings(const FrameSettings& settings);
  void noticeView(const spec::View& view, const spec::Size& size);
  void note(Cause cause, std::string words);

  // Returns those of the given causes that were noted in this step, joined; if there are none, `otherwise`.
  std::string of(std::uint32_t causes, std::string_view otherwise = {}) const;

 private:
  struct Note {
    Cause cause;
    std::string words;
  };
  std::vector<Note> notes_;
  std::optional<FrameSettings> settings_;
  std::optional<spec::View> view_;
  spec::Size size_;
  std::uint64_t environment_ = 0, lights_ = 0;
  bool world_known_ = false;
  float turn_ = 0.0f, fade_ = 0.0f, intensity_ = 0.0f;
  std::uint64_t transforms_ = 0, groups_ = 0, lamps_ = 0, local_lights_ = 0, materials_ = 0;
};

}  // namespace lambent::frame
