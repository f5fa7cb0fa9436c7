// What arrives at every light probe, step by step. A sample that sees no body of another group and no local
// light has the environment's own light. Others have it from a capture (sky and bodies) plus the suns and
// local lights in closed form, each times the share of it that no body hides; what of these comes per pixel
// is handed on with the key lights. Captures are drawn for samples
// whose surroundings changed: the sky turned, a light moved, or bodies moved or shine differently by so much
// that the light may have changed by kMovingChange of itself; what amounts to less is caught up with when
// everything stands still. The light of a sample is handed on only if it changed by more than kLeastChange of
// itself, so that bodies which light each other come to rest. update() hands on what is known now, capture()
// asks for what the next step needs.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/keyed_state.hpp"
#include "runtime/base/result.hpp"
#include "runtime/lighting/capture.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/lighting/incident_change.hpp"
#include "runtime/lighting/local_light.hpp"

namespace lambent::lighting {

inline constexpr float kLeastChange = 1e-3f;
inline constexpr float kMovingChange = 0.02f;  // while things move
// Where a body begins or ceases to be left out of a group's captures, the light changes over so many steps.
inline constexpr std::uint32_t kCarrierSteps = 8;
inline constexpr float kRestingChange = 0.25f * kLeastChange;  // when nothing moves any more

// A body, and how its radiance changes.
struct IncidentBody {
  CaptureBody body;
  glm::vec3 center_ws{0.0f};  // of a sphere around it
  float radius_m = 0.0f;
  // Sum of all changes of its radiance so far, each as a share of what it was.
  double radiance_drift = 0.0;
  std::uint64_t key = 0;  // by which it is known again when others come and go
};

// A rigid group as a receiver.
struct IncidentGroup {
  std::uint32_t body = CapturePoint::kNoBody;  // its own, among the bodies
  std::vector<glm::vec3> samples_ws;
  std::vector<std::uint8_t> lit_by;  // per local light, 1: by harmonics; 0: it has that light otherwise
  // Per local light of these: how much of its straight light comes per pixel, 0..1. As much of it stands
  // with the key lights, of which transfer brings what bounces alone. Empty: nothing of any.
  std::vector<float> apart{};
  // Of such light the share that bodies of left_out let through, by sample, then light. Empty: all of it.
  std::vector<float> open{};
  // Bodies, rising, whose light and shadow reach it otherwise: they are drawn for none of its samples.
  std::vector<std::uint32_t> left_out{};
  bool fades = false;         // where left_out changed: over kCarrierSteps; else at once
  std::uint64_t key = 0;      // by which it is known again when others come and go
  std::uint64_t samples = 0;  // another number: its samples are others than before, not the same that moved
};

struct IncidentCounts {
  std::uint32_t samples = 0;   // light probes there are
  std::uint32_t captured = 0;  // drawn in this step
  std::uint32_t arrived = 0;   // whose captures arrived in this step
  // Surroundings changed, but by less than is drawn while things move, or there was no more room in the step;
  // or a body is out of sight now, which needs no drawing.
  std::uint32_t waiting = 0;
  std::uint32_t risen = 0;   // handed on new light in this step
  std::uint32_t fading = 0;  // between one carrier and another
};

class IncidentLight {
 public:
  static Result<IncidentLight> create(const CaptureOptions& options, const Environment& environment);

  // Captures of other options from now on: what is on its way is dropped, and all samples that see a body are
  // drawn anew; until then they keep the light that they have. Proxies must be given anew. Errors: options
  // out of range.
  Result<void> renew(const CaptureOptions& options, const Environment& environment);

  // All samples that see a body are drawn anew.
  void forget();

  Capture& captures() { return capture_; }
  const Capture& captures() const { return capture_; }

  // Brings the light of all samples up to date with the last captures (`wait`: even if the GPU is not done)
  // and with lights that need none.
  void update(const Environment& environment, std::span<const IncidentGroup> groups,
              std::span<const LocalLight> lights, bool wait);
  // Draws what has changed around the samples, at most so many of them: those that changed most. Errors: a
  // shader that does not compile.
  Result<void> capture(const Environment& environment, std::span<const IncidentGroup> groups,
                       std::span<const IncidentBody> bodies, std::span<const LocalLight> lights,
                       const gpu::Buffer& triangle_radiance, std::size_t max_samples,
                       gpu::Counters& counters);
  // Nothing is on its way, nothing was left for later and the last update handed on nothing new.
  bool atRest() const;

  // Of a group's light probes, for GroupLights.
  std::vector<Incident> incidentOf(std::size_t group) const;
  const IncidentCounts& counts() const { return counts_; }

 private:
  struct SeenBody {
    std::uint32_t body = 0;
    BodyPose pose;  // when the sample's surroundings were drawn
  };
  struct Body {
    BodyPose pose;
    capture::BodySphere sphere;
    float radius_m = 0.0f, brightness = 1.0f;
  };
  // What a sample's surroundings were drawn from, and what came out.
  struct Drawn {
    glm::vec3 position_ws{0.0f};
    std::uint64_t environment = 0, lights = 0;  // versions
    std::uint32_t renewal = 0;                  // of the captures
    std::vector<SeenBody> seen;
    std::vector<std::uint32_t> left_out;
    bool fades = false;
    std::vector<std::int32_t> query_of_disc, query_of_light;  // into result.visible; -1: not asked
    CapturedLight result;
  };
  struct Sample {
    std::optional<Drawn> drawn;  // none: it sees no body
    bool drawn_anew = false;     // and that is not in `light` yet
    bool renewed = false;        // by captures of other options: however little it changes
    // What was handed on last, and of which inputs it was made.
    std::uint64_t version = 0;  // 0: nothing yet; no two samples ever have the same
    bool plain = true;          // the environment's own light
    // Without key lights and lamps that stand apart, and of these as far as no body hides them.
    sh::LightVector light{1}, key{1};
    glm::vec3 position_ws{0.0f};
    std::uint64_t environment = 0, lights = 0;
    std::vector<float> open;
    // Which bodies were left out of it, and how it goes over to that.
    std::vector<std::uint32_t> left_out;
    bool fade_begins = false;
    std::uint32_t fade_steps = 0;  // still to come
    sh::LightVector fade_from{1}, fade_from_key{1};
  };
  struct Group {
    std::vector<Sample> samples;
    std::uint64_t samples_seen = 0;    // IncidentGroup::samples
    std::vector<glm::vec3> places_ws;  // of the samples
    std::vector<std::uint8_t> lit_by;
    std::vector<float> apart;
    std::uint64_t lights = 0;  // rises when a light that lights it changed, or which ones do
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
  static void leaveOut(Sample& sample, const std::vector<std::uint32_t>& left_out, bool fades);
  void takeDrawn(bool wait);
  void followGroups(std::span<const IncidentGroup> groups);
  static void renewSamples(Group& group, const IncidentGroup& now);
  void followBodies(std::span<const IncidentBody> bodies);
  void noticeLights(std::span<const IncidentGroup> groups, std::span<const LocalLight> lights);
  void updateSample(Sample& sample, const Group& group, const Environment& environment,
                    const glm::vec3& position_ws, std::span<const LocalLight> lights,
                    std::span<const float> open);
  static void askForLights(const Environment& environment, const IncidentGroup& group,
                           std::span<const LocalLight> lights, CapturePoint& point, Drawn& drawn);
  // Since the last call: the sky, a light, a body's radiance; a body, a sample, or which bodies are left out.
  bool somethingShines(const Environment& environment, std::span<const IncidentBody> bodies);
  bool somethingMoves(std::span<const IncidentGroup> groups, std::span<const IncidentBody> bodies);
  void noticeBodies(std::span<const IncidentBody> bodies);
  static std::vector<bool> ignoredBy(const IncidentGroup& group, std::size_t bodies);
  // Bodies that are drawn for a point there, rising.
  void seeFrom(const glm::vec3& position_ws, const std::vector<bool>& ignored,
               std::vector<std::uint32_t>& seen) const;
  std::vector<Wanted> lookAround(const Environment& environment, std::span<const IncidentGroup> groups,
                                 std::span<const LocalLight> lights) const;
  float changeAround(const Drawn& drawn, const Environment& environment, std::size_t g,
                     const IncidentGroup& group, std::size_t sample, std::span<const std::uint32_t> seen,
                     std::span<const LocalLight> lights) const;

  Capture capture_;
  int order_;
  KeyedState<Group> groups_;
  std::vector<std::uint64_t> body_keys_;  // what indices of bodies mean in all that is kept
  KeyedState<Body> bodies_;               // as they stood when it was last looked for changes
  std::uint64_t body_version_ = 0;        // the last that a pose was given
  std::vector<Request> requests_;         // on their way
  std::uint64_t version_ = 0;             // the last that a sample was given
  std::uint32_t renewal_ = 0;
  std::vector<LocalLight> lights_before_;
  std::vector<glm::mat4> bodies_before_;
  std::vector<glm::vec3> places_before_;
  std::vector<std::vector<std::uint32_t>> left_out_before_;
  std::vector<double> shine_before_;
  bool nothing_to_draw_ = false;  // when it was last looked for
  IncidentCounts counts_;
};

}  // namespace lambent::lighting
