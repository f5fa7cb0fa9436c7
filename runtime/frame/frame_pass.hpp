// Defines a pass of the frame: an effect, or a stage that effects need. A pass declares what it reads and
// writes, says whether it is due, and updates what it keeps. The frame runs a list of passes (PassList),
// times each, and knows nothing else of them. The passes of a step come first; those of a picture have a
// view.
//
// A resource is a type on the blackboard, or World and PictureTargets, which the context provides itself. Of
// `reads`, a pass sees what earlier passes wrote in this step; of `reads_before`, what the step before left,
// because light between bodies travels once per step.
#pragma once

#include <cassert>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <typeindex>
#include <utility>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/draws/surface_module.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/frame/picture_targets.hpp"
#include "runtime/gpu/pass_timers.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// Explains why passes run: it says in words what changed since the last step. It compares versions and values
// of the world, the environment, the settings and the view once per step. For a pass that did something it
// returns the causes that concern the pass in one line, such as "light turned, 2 groups moved". It only
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

// Lists the types that a pass reads or writes.
using Resources = std::vector<std::type_index>;
template <class... Types>
Resources resources() {
  return {std::type_index(typeid(Types))...};
}

// Holds what the passes of a frame share, found by its type: lights of groups, shaded samples, shadow maps. A
// pass offers its own objects once, when it is made, and they live as long as the frame.
class Blackboard {
 public:
  // Offers an object. There may be only one of each type.
  template <class Type>
  void offer(Type& object) {
    const bool first = objects_.emplace(typeid(Type), &object).second;
    assert(first);
    (void)first;
  }
  // Returns the object of a type. Throws std::out_of_range if nobody offered it, which is a mistake in the
  // list of passes.
  template <class Type>
  Type& get() const {
    return *static_cast<Type*>(objects_.at(typeid(Type)));
  }

 private:
  std::map<std::type_index, void*> objects_;
};

// Counts what one step and the picture after it did, as numbers with names, such as light probes captured or
// cells shaded. Each pass declares its names once, and two passes may share one. For a still scene the work
// counts are 0. Reports print the whole list.
class StepCounts {
 public:
  struct Count {
    std::string_view name;  // a literal
    std::uint64_t value = 0;
  };

  // add() and operator[] throw std::out_of_range for names that were not declared.
  void declare(std::span<const std::string_view> names);
  // Sets every count to 0.
  void clear();
  void add(std::string_view name, std::uint64_t value);
  // Returns the count, or 0 before any is declared.
  std::uint64_t operator[](std::string_view name) const;

  // Iterate in the order in which the names were declared.
  auto begin() const { return counts_.begin(); }
  auto end() const { return counts_.end(); }

 private:
  std::size_t placeOf(std::string_view name) const;

  std::vector<Count> counts_;
};

// Describes the frame that a pass runs in: the world, the light, the options, what other passes keep, and
// where the pass counts and says why it ran. It lives for one step, or one step and a picture.
struct PassInfo;

struct FrameContext {
  World& world;
  lighting::Environment& environment;  // only the pass for transforms changes it: its suns of the scene
  const FrameOptions& options;
  const spec::View* view;  // null if no picture follows
  PictureTargets& targets;
  InvalidationLog& log;
  StepCounts& counts;
  const Blackboard& board;
  // These belong to the pass that is asked or runs.
  const PassInfo* pass = nullptr;
  gpu::PassTimers::Scope* scope = nullptr;

  const FrameSettings& settings() const { return options.settings; }
  // Returns the key lights whose direct light comes by shadow maps, in world axes.
  std::span<const spec::Disc> keys() const {
    return options.keysApart() ? environment.keys() : std::span<const spec::Disc>();
  }
  // Return what the pass declares that it reads, or writes.
  template <class Type>
  const Type& read() const {
    assert(declares(typeid(Type), /*to_write=*/false));
    return board.get<Type>();
  }
  template <class Type>
  Type& write() const {
    assert(declares(typeid(Type), /*to_write=*/true));
    return board.get<Type>();
  }
  gpu::Counters& counters() const { return scope->counters(); }
  void count(std::string_view name, std::uint64_t value) const { counts.add(name, value); }
  // Says why the pass ran: states those of its causes that the log has for this step or, if there are none,
  // `otherwise`.
  void because(std::string_view otherwise = {}) const;

 private:
  bool declares(std::type_index type, bool to_write) const;
};

struct PassInfo {
  std::string_view name;  // name in timings
  Resources reads{};
  Resources reads_before{};
  Resources writes{};
  std::uint32_t causes = 0;                // causes in the invalidation log that make it run
  std::vector<std::string_view> counts{};  // names of what it counts
};

class FramePass {
 public:
  explicit FramePass(PassInfo info) : info_(std::move(info)) {}
  virtual ~FramePass() = default;
  FramePass(const FramePass&) = delete;
  FramePass& operator=(const FramePass&) = delete;

  const PassInfo& info() const { return info_; }
  // Returns whether the pass has anything to update. A pass that is not due may release what it holds.
  virtual bool due(const FrameContext&) { return true; }
  virtual Result<void> update(FrameContext& frame) = 0;
  // Makes the next update compute everything anew.
  virtual void forget() {}
  // Returns whether another step on the same scene would change nothing.
  virtual bool settled() const { return true; }

 private:
  PassInfo info_;
};

// Holds what passes are made from.
struct PassSetup {
  const FrameOptions& options;
  const lighting::Environment& environment;
  Blackboard& board;
};

using MadePass = Result<std::unique_ptr<FramePass>>;

// Each makes a pass; a file under passes/ has those of one kind of work. They fail if a shader does not
// compile.
MadePass makeUploadPass(const PassSetup& setup);
MadePass makeTransformsPass(const PassSetup& setup);
MadePass makeLightPass(const PassSetup& setup);
MadePass makePatchBouncesPass(const PassSetup& setup);
MadePass makeDiffusePass(const PassSetup& setup);
MadePass makeSeenSkyPass(const PassSetup& setup);
MadePass makeGlossyPass(const PassSetup& setup);
MadePass makeVolumePass(const PassSetup& setup);
MadePass makeNeighborhoodPass(const PassSetup& setup);
MadePass makeCapturePass(const PassSetup& setup);

MadePass makeSkyPass(const PassSetup& setup);
MadePass makeLocalShadowsPass(const PassSetup& setup);
MadePass makeKeyShadowsPass(const PassSetup& setup);
MadePass makePrefilteredEnvironmentPass(const PassSetup& setup);
MadePass makeReflectionProbesPass(const PassSetup& setup);
MadePass makeRasterPass(const PassSetup& setup);
MadePass makeMarchPass(const PassSetup& setup);
MadePass makeToneMapPass(const PassSetup& setup);
MadePass makeOverlayPass(const PassSetup& setup);

struct PassList {
  std::unique_ptr<SurfaceModules> surface_modules;  // modules that passes add, in the order of the passes
  std::vector<std::unique_ptr<FramePass>> step, picture;
};

// Makes all passes, which offer what they keep on the board. Fails if a shader does not compile.
Result<PassList> makePassList(const FrameOptions& options, const lighting::Environment& environment,
                              Blackboard& board);

}  // namespace lambent::frame
