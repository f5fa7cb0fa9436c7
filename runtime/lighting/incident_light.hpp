// Owns the light that arrives at every light probe, step by step. A probe that sees no body of another group
// and no local light receives the environment's own light. Others receive a capture (sky and bodies) plus the
// suns and local lights in closed form, each times its share that no body hides; the part of these that is
// shaded per pixel is handed on together with the key lights. update() hands on what is known now, and
// capture() requests what the next step needs.
//
// Captures are drawn for probes whose surroundings changed: the sky turned, a light moved, or bodies moved or
// shine differently by so much that the light may have changed by kMovingChange. Smaller changes are caught
// up with when everything stands still. The light of a probe is handed on only if it changed by more than
// kLeastChange, so that bodies which light each other come to rest. Render thread only. create() fails if a
// shader does not compile, capture() if Capture::run() does.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/lighting/capture.hpp"
#include "runtime/lighting/capture_plan.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/lighting/local_light.hpp"

namespace lambent::lighting {

// Estimates by how much the light that arrives at a place may have changed since bodies had their earlier
// poses. These estimates decide which captures are drawn again. No GL.

// This value means that the light must be captured again.
inline constexpr float kWhollyChanged = std::numeric_limits<float>::infinity();

// Describes a body, and how its radiance changes.
struct IncidentBody {
  CaptureBody body;
  glm::vec3 center_ws{0.0f};  // of a bounding sphere
  float radius_m = 0.0f;
  // Sums all relative changes of its radiance so far.
  double radiance_drift = 0.0;
  std::uint64_t key = 0;  // identifies it when others come and go
};

// Describes the change of a body's bounding sphere as seen from a place.
struct BodyChange {
  float half_angle = 0.0f, angle = 0.0f;  // radians: apparent radius, and the angle by which it moved
  float drift = 0.0f;                     // relative change of its radiance
};

// Returns the change of a body between two times; all but the half angle is zero if both are the same.
BodyChange changeOf(const IncidentBody& before, const glm::vec3& place_before, const IncidentBody& after,
                    const glm::vec3& place_after);

// Returns the change relative to the light's mean, in `order` bands. `other` tells that the body appeared or
// disappeared.
float shareOfLight(const BodyChange& change, bool other, int order);

// Returns whether a body in this direction may hide part of a light in `queries`.
bool passesLight(std::span<const LightQuery> queries, const glm::vec3& towards, float half_angle);

inline constexpr float kLeastChange = 1e-3f;
inline constexpr float kMovingChange = 0.02f;  // relative change while things move
// When a body starts or stops being left out of a group's captures, the light fades over this many steps.
inline constexpr std::uint32_t kCarrierSteps = 8;
inline constexpr float kRestingChange = 0.25f * kLeastChange;  // relative change when nothing moves

// Holds the light without key lights and without lamps that are shaded per pixel, and the part of those that
// no body hides.
struct DividedLight {
  sh::LightVector rest{1}, key{1};
};

// Describes a rigid group that receives light.
struct IncidentGroup {
  std::uint32_t body = CapturePoint::kNoBody;  // index of its own body
  std::vector<glm::vec3> samples_ws;
  std::vector<LightCarrier> carriers{};  // per local light
  // Lists the bodies (rising indices) whose light and shadow reach the group by another carrier. They are not
  // drawn for its samples.
  std::vector<std::uint32_t> left_out{};
  bool fades = false;         // a change of left_out fades over kCarrierSteps; else it is immediate
  std::uint64_t key = 0;      // identifies it when others come and go
  std::uint64_t samples = 0;  // changes when the samples are replaced, but not when they move
};

// Describes what captures show besides the environment.
struct IncidentScene {
  std::span<const IncidentGroup> groups;
  std::span<const IncidentBody> bodies;
  std::span<const LocalLight> lights;
};

struct IncidentCounts {
  std::uint32_t samples = 0;   // number of light probes
  std::uint32_t captured = 0;  // captures drawn in this step
  std::uint32_t arrived = 0;   // captures that arrived in this step
  // Counts samples whose surroundings changed, but by less than is drawn while things move, or that did not
  // fit into the step; also samples that only lost sight of a body, which needs no drawing.
  std::uint32_t waiting = 0;
  std::uint32_t risen = 0;   // samples that handed on new light in this step
  std::uint32_t fading = 0;  // samples that fade between one carrier and another
};

class IncidentLight {
 public:
  static Result<IncidentLight> create(const CaptureOptions& options, const Environment& environment);

  // Uses captures with other options from now on. Captures on their way are dropped, and all samples that see
  // a body are drawn again; until then they keep their light. Proxies must be set again. Fails if a shader
  // does not compile.
  Result<void> renew(const CaptureOptions& options, const Environment& environment);

  // Makes all samples that see a body be drawn again.
  void forget();

  Capture& captures() { return capture_; }
  const Capture& captures() const { return capture_; }

  // Updates the light of all samples with the last captures and with lights that need none. If `wait` is set,
  // waits for the GPU to finish the captures.
  void update(const Environment& environment, std::span<const IncidentGroup> groups,
              std::span<const LocalLight> lights, bool wait);
  // Draws what has changed around the samples, for at most max_samples of them: those that changed most.
  // Fails if a shader does not compile.
  Result<void> capture(const Environment& environment, const IncidentScene& scene,
                       const gpu::Buffer& triangle_radiance, std::size_t max_samples,
                       gpu::Counters& counters);
  // Returns whether no capture is on its way, nothing was left for later and the last update handed on
  // nothing new.
  bool atRest() const;

  // Returns the light at a group's light probes, for GroupLights.
  std::vector<Incident> incidentOf(std::size_t group) const;
  const IncidentCounts& counts() const { return counts_; }

 private:
  struct Body {
    IncidentBody now;
    std::uint32_t index = 0;  // in the scene
    capture::BodySphere sphere;
  };
  // Lists what is not drawn for a group.
  struct LeftOut {
    std::vector<bool> ignored;        // indexed as bodies_; its own body too
    std::vector<std::uint64_t> keys;  // of the bodies in IncidentGroup::left_out, sorted
  };
  // Records from what a sample's surroundings were drawn, and the result.
  struct Drawn {
    glm::vec3 position_ws{0.0f};
    std::uint64_t environment = 0, lights = 0;  // versions
    std::uint32_t renewal = 0;                  // value of renewal_
    std::vector<IncidentBody> seen;             // as they were then, by their keys
    std::vector<std::uint64_t> left_out;
    bool fades = false;
    std::vector<std::int32_t> query_of_disc, query_of_light;  // index into result.visible; -1: not asked
    CapturedLight result;
  };
  struct Sample {
    std::optional<Drawn> drawn;  // nothing if the sample sees no body
    bool drawn_anew = false;     // `light` does not contain it yet
    bool renewed = false;        // captured with other options: handed on however little it changes
    // The light that was handed on last follows, with the inputs that it was made from.
    std::uint64_t version = 0;  // 0: nothing yet; unique among all samples
    bool plain = true;          // it is the environment's own light
    DividedLight light;
    glm::vec3 position_ws{0.0f};
    std::uint64_t environment = 0, lights = 0;
    // The bodies that were left out of the light, and the fade from the light before.
    std::vector<std::uint64_t> left_out;
    bool fade_begins = false;
    std::uint32_t fade_steps = 0;  // steps that remain
    DividedLight fade_from;
  };
  struct Group {
    std::vector<Sample> samples;
    std::uint64_t samples_seen = 0;    // copy of IncidentGroup::samples
    std::vector<glm::vec3> places_ws;  // of the samples
    std::vector<LightCarrier> carriers;
    std::uint64_t lights = 0;  // rises when one of its lights changes, or which lights these are
  };
  struct Request {
    std::size_t group = 0, sample = 0;
    Drawn drawn;
  };
  struct Wanted {
    float change = 0.0f;
    std::size_t group = 0, sample = 0;
  };

  IncidentLight(Capture capture, int order) : capture_(std::move(capture)), order_(order) {}
  static void leaveOut(Sample& sample, const std::vector<std::uint64_t>& left_out, bool fades);
  void takeDrawn(bool wait);
  void followGroups(std::span<const IncidentGroup> groups);
  static void renewSamples(Group& group, const IncidentGroup& now);
  void noticeLights(std::span<const IncidentGroup> groups, std::span<const LocalLight> lights);
  void updateSample(Sample& sample, const Group& group, const Environment& environment,
                    const glm::vec3& position_ws, std::span<const LocalLight> lights);
  static void askForLights(const Environment& environment, const IncidentGroup& group,
                           std::span<const LocalLight> lights, CapturePoint& point, Drawn& drawn);
  // somethingShines() tells whether, since the last call, the sky, a light or a body's radiance changed;
  // somethingMoves() tells whether a body or sample moved, or other bodies are left out.
  bool somethingShines(const Environment& environment, std::span<const IncidentBody> bodies);
  bool somethingMoves(std::span<const IncidentGroup> groups, std::span<const IncidentBody> bodies);
  void noticeBodies(std::span<const IncidentBody> bodies);
  LeftOut leftOutOf(const IncidentGroup& group) const;
  // Lists the bodies that are drawn for a point there, as rising indices into bodies_.
  void seeFrom(const glm::vec3& position_ws, const std::vector<bool>& ignored,
               std::vector<std::uint32_t>& seen) const;
  std::vector<Wanted> lookAround(const Environment& environment, std::span<const IncidentGroup> groups,
                                 std::span<const LeftOut> left_out, std::span<const LocalLight> lights) const;
  float changeAround(const Wanted& look, const Environment& environment, const IncidentGroup& group,
                     const LeftOut& left_out, std::span<const std::uint32_t> seen,
                     std::span<const LocalLight> lights) const;

  Capture capture_;
  int order_;
  KeyedState<Group> groups_;
  std::vector<Body> bodies_;       // as they were at the last search for changes, by their keys
  std::vector<Request> requests_;  // captures on their way
  std::uint64_t version_ = 0;      // the last version given to a sample
  std::uint32_t renewal_ = 0;
  std::vector<LocalLight> lights_before_;
  // Poses of bodies, places of samples and what is left out; and what somethingShines() lists.
  ChangeGate<std::vector<glm::mat4>, std::vector<glm::vec3>, std::vector<std::vector<std::uint32_t>>> moves_;
  ChangeGate<std::vector<double>> shines_;
  bool nothing_to_draw_ = false;  // at the last search for changes
  IncidentCounts counts_;
};

}  // namespace lambent::lighting
