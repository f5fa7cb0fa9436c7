// The light at infinity: environment maps, suns and constants added up, in one or two sets to fade between,
// turned together about +Y. Comes in: the lights as parsed; those that stand in the scene are passed over.
// Goes out: light vectors of order 8 in world space (environment maps projected once when loaded, suns in
// closed form), the suns as discs, and what the sky shows. Fading and turning mix what was projected once. If
// key lights are asked for, the light is parted once when it is loaded (key_lights.hpp): surfaces take the
// direct light of key lights by shadow maps, and the rest, which few bands carry, by transfer. Key lights
// that were found in environment maps may be moved, dimmed and coloured: their discs change, and the sky
// shows them in place of their texels. Whoever follows one environment may be given another at any time:
// versions tell what they say, not how often it was changed. No GL. Errors: those of loading a environment
// map.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/lighting/key_lights.hpp"
#include "runtime/sh/light_vector.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "runtime/spec/key_edit.hpp"

namespace lambent::lighting {

using spec::Disc;

class Environment {
 public:
  static constexpr std::size_t kSets = 2;

  static Result<Environment> create(const std::vector<spec::Light>& lights,
                                    const std::vector<spec::Light>& second_lights = {});
  // Shines with these in place of its own; turn, fade and intensity stay. Environment maps that it has, of
  // files that did not change since, are neither read nor projected again. Errors: those of create(); nothing
  // is changed then.
  Result<void> setLights(const std::vector<spec::Light>& lights,
                         const std::vector<spec::Light>& second_lights = {});

  // How many key lights each set may have at most; 0, the default of this class: none. Parts the light anew
  // if it changes.
  void setMostKeys(std::uint32_t most);

  // In place of the edits before. Each is of the key light of its set that was found in a environment map
  // nearest to edit.found, if that is close enough; of several edits of one key light the last counts. One
  // that meets no key light changes nothing, and waits for another parting. They stay when other lights are
  // loaded: whoever loads these says which edits are theirs.
  void setKeyEdits(std::vector<spec::KeyEdit> edits);

  // Each gives another version where it changes something. Values that are not finite change nothing.
  // Positive turns take +Z to +X.
  void setTurn(float degrees);
  // 0: the first set alone, 1: the second; between them (1 - fade) of the one and fade of the other. Clamped.
  void setFade(float fade);
  // Factor on all of it, 0 or more.
  void setIntensity(float intensity);
  float turnDegrees() const { return turn_degrees_; }
  float fade() const { return fade_; }
  float intensity() const { return intensity_; }
  // World directions from the lights' own.
  glm::mat3 worldFromLight() const;

  // Now: world space, turned, faded, times the intensity.
  const sh::LightVector& light() const { return light_; }           // all of it
  const sh::LightVector& skyLight() const { return sky_light_; }    // without any disc
  const sh::LightVector& keyLight() const { return key_light_; }    // of the key lights alone
  const sh::LightVector& restLight() const { return rest_light_; }  // light() without that
  // The suns of both sets, key lights last, always as many and in the same order; dark ones have radiance 0.
  const std::vector<Disc>& discs() const { return discs_; }
  std::span<const Disc> keys() const { return std::span(discs_).subspan(first_key_); }
  bool isKey(std::size_t disc) const { return disc >= first_key_; }
  // Of all that is said above, a checksum: of two environments, also of two objects, the same where they are
  // the same light, and else another (but for one chance in 2^64). Never 0.
  std::uint64_t version() const { return version_; }
  // Of what was loaded and its edits, likewise: turning, fading and dimming leave it as it is.
  std::uint64_t lightsVersion() const { return lights_version_; }
  // Of restOf() alone, and of the pictures of shownOf() alone: a key light that is dragged changes neither,
  // so that what is made from pictures need not be made anew for it.
  std::uint64_t restVersion() const { return rest_version_; }
  std::uint64_t picturesVersion() const { return pictures_version_; }

  // As loaded, without edits: the lights' own frame, whole radiance.
  const spec::DistantLights& set(std::size_t index) const { return sets_[index].lights; }
  // The same without the key lights: environment maps without their peaks, and the discs that are none.
  struct Rest {
    std::vector<const spec::EnvironmentMap*> environment_maps;
    glm::vec3 constant{0.0f};
    std::span<const Disc> discs;
  };
  Rest restOf(std::size_t index) const;
  const std::vector<Disc>& keysOf(std::size_t index) const { return sets_[index].key_discs; }
  // What an eye sees: as loaded, but for key lights that are edited. These are out of the pictures, and
  // discs.
  struct Shown {
    std::vector<const spec::EnvironmentMap*> environment_maps;
    glm::vec3 constant{0.0f};
    std::vector<Disc> discs;
  };
  Shown shownOf(std::size_t index) const;
  // In the order of keys().
  struct FoundKey {
    std::size_t set = 0;
    KeyOrigin origin;
    Disc found, now;  // the lights' own frame, whole radiance; without and with the edit
    std::optional<spec::KeyEdit> edit;
  };
  std::vector<FoundKey> foundKeys() const;
  // By what set() is multiplied now.
  float shareOf(std::size_t index) const;
  // What was repaired in the environment maps; a sentence each.
  const std::vector<std::string>& notices() const { return notices_; }

 private:
  // What a environment map was loaded from.
  struct EnvironmentMapSource {
    std::filesystem::path file;
    std::optional<sh::ImageLayout> layout;
    std::filesystem::file_time_type written{};
    std::uintmax_t bytes = 0;
    bool operator==(const EnvironmentMapSource&) const = default;
  };
  static EnvironmentMapSource sourceOf(const spec::EnvironmentMapLight& light);
  // What takes long to say of a environment map.
  struct KnownEnvironmentMap {
    EnvironmentMapSource source;
    sh::LightVector sky;
    std::uint64_t checksum = 0;  // of its texels
  };
  struct LoadedProbe {
    spec::EnvironmentMap environment_map;
    KnownEnvironmentMap known;
  };
  struct Set {
    spec::DistantLights lights;
    std::vector<KnownEnvironmentMap> known;  // as lights.environment maps
    PartedLights parted;
    std::vector<Disc> key_discs;                      // parted.keys with the edits
    std::vector<std::optional<spec::KeyEdit>> edits;  // as parted.keys
    std::vector<std::optional<spec::EnvironmentMap>>
        pictures;  // as lights.environment maps: without the keys that are edited
    sh::LightVector sky, discs,
        keys;  // in the lights' own frame; sky: environment maps and the constant without peaks
  };
  Environment() = default;
  void part(Set& set) const;
  void applyEdits(std::size_t index);
  void mix();
  void seal();  // says what was loaded

  std::array<Set, kSets> sets_;
  std::vector<std::string> notices_;
  float turn_degrees_ = 0.0f, fade_ = 0.0f, intensity_ = 1.0f;
  std::uint32_t most_keys_ = 0;
  std::vector<spec::KeyEdit> key_edits_;
  sh::LightVector light_, sky_light_, key_light_, rest_light_;
  std::vector<Disc> discs_;
  std::size_t first_key_ = 0;
  std::uint64_t version_ = 0, lights_version_ = 0, rest_version_ = 0, pictures_version_ = 0;
};

}  // namespace lambent::lighting
