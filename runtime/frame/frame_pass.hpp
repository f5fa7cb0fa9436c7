// Defines a pass of the frame: an effect, or a stage that effects need. It is a function over what the frame
// keeps (FrameParts), with a rule when it is due. The frame runs the passes in the order of their lists,
// times each, and knows nothing else of them. The passes of a step come first; those of a picture have a
// view.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/base/result.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/pass_timers.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// Explains why passes run: it says in words what changed since the last step. It compares versions and values
// of the world, the environment, the settings and the view once per step. For a pass that did something it
// returns the causes that concern the pass in one line, such as "light turned, groups moved". It only
// reports; no pass runs because of it.
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
constexpr std::uint32_t causes(Cause cause) {
  return static_cast<std::uint32_t>(cause);
}
constexpr std::uint32_t operator|(std::uint32_t a, Cause b) {
  return a | causes(b);
}
constexpr std::uint32_t operator|(Cause a, Cause b) {
  return causes(a) | b;
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

// Counts what one step and the picture after it did, as numbers with names, such as light probes captured or
// cells shaded. For a still scene the work counts are 0. Reports print the whole list.
class StepCounts {
 public:
  struct Count {
    std::string_view name;  // a literal
    std::uint64_t value = 0;
  };

  StepCounts();
  // Sets every count to 0.
  void clear();
  // These throw std::out_of_range for names that are not in the list (frame.cpp).
  void add(std::string_view name, std::uint64_t value);
  std::uint64_t operator[](std::string_view name) const;

  auto begin() const { return counts_.begin(); }
  auto end() const { return counts_.end(); }

 private:
  std::size_t placeOf(std::string_view name) const;

  std::vector<Count> counts_;
};

// Returns the number of samples per pixel of the textures that are drawn into; 0 stands for plain textures.
std::uint32_t samplesOf(Output output);

// Owns the textures that a frame draws into: linear radiance and depth, and the picture that is made from
// them unless it goes elsewhere. Radiance and depth may be shared with other code. It takes the kind and size
// of the picture, and provides framebuffers for passes and the picture for reading. Render thread only;
// reading waits for the GPU.
class PictureTargets {
 public:
  PictureTargets(Output output, Destination destination) : output_(output), destination_(destination) {}

  // Makes the textures anew if their size differs.
  void resize(const spec::Size& size);
  const spec::Size& size() const { return size_; }
  // Draws into these from now on, which share their storage with other code. Both have the same size and
  // samples.
  void share(gpu::Texture hdr, gpu::Texture depth);
  // Rises when the textures are made anew.
  std::uint64_t version() const { return version_; }

  // Binds radiance and depth. Unless they are shared, radiance is cleared to `grey` with alpha 0, depth to
  // the far end.
  void bindCleared(float grey);
  // Binds the framebuffer of the picture, or the window's.
  void bindPicture() const;

  const gpu::Texture& hdr() const { return hdr_; }
  const gpu::Texture& depth() const { return depth_; }
  // Returns radiance without depth, for passes that read the depth.
  const gpu::Framebuffer& hdrColor() const { return hdr_color_target_; }
  // Returns the picture, with row 0 at the bottom; empty if it goes to the window.
  const gpu::Texture& picture() const { return picture_; }

  // Return the picture, with row 0 at the top. Linear pictures have the depths of what wrote to the depth
  // buffer; clip_from_view is the projection with which they were drawn.
  spec::RgbaImage readLinear(const glm::mat4& clip_from_view) const;
  spec::Rgba8Image readDisplay() const;

 private:
  Output output_;
  Destination destination_;
  spec::Size size_{};
  std::uint64_t version_ = 0;
  gpu::Texture hdr_, depth_, picture_;
  gpu::Framebuffer hdr_target_, hdr_color_target_, picture_target_;
};

struct FrameContext;
struct FrameParts;

struct FramePass {
  std::string_view name;     // in timings
  std::uint32_t causes = 0;  // causes in the invalidation log that make it run
  Result<void> (*update)(FrameContext&);
  // Returns whether the pass has anything to update; null: always. A pass that is not due may release what it
  // holds.
  bool (*due)(const FrameContext&) = nullptr;
};

// List passes in the order in which they run: those of a step, then those of a picture.
std::span<const FramePass> stepPasses();
std::span<const FramePass> surfacePasses();
std::span<const FramePass> picturePasses();

// Describes the frame that a pass runs in: the world, the light, the options, what the frame keeps, and where
// the pass counts and says why it ran. It lives for one step, or one step and a picture.
struct FrameContext {
  World& world;
  lighting::Environment& environment;  // only the pass for transforms changes it: its suns of the scene
  const FrameOptions& options;
  const spec::View* view;  // null if no picture follows
  PictureTargets& targets;
  InvalidationLog& log;
  StepCounts& counts;
  FrameParts& parts;
  // These belong to the pass that is asked or runs.
  const FramePass* pass = nullptr;
  gpu::PassTimers::Scope* scope = nullptr;

  const FrameSettings& settings() const { return options.settings; }
  // Returns the key lights whose direct light comes by shadow maps, in world axes.
  std::span<const spec::Disc> keys() const {
    return options.keysApart() ? environment.keys() : std::span<const spec::Disc>();
  }
  gpu::Counters& counters() const { return scope->counters(); }
  void count(std::string_view name, std::uint64_t value) const { counts.add(name, value); }
  // Says why the pass ran: states those of its causes that the log has for this step or, if there are none,
  // `otherwise`.
  void because(std::string_view otherwise = {}) const { scope->because(log.of(pass->causes, otherwise)); }
};

}  // namespace lambent::frame
