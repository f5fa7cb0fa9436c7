// Owns the light at infinity: the sum of environment maps, suns and constants, in one or two sets that can be
// faded between and are turned together about +Y, and the suns of the scene, which are key lights. It takes
// parsed lights and ignores those that stand in the scene. It provides light vectors of order 8 in world
// space (environment maps are projected once when they are loaded, suns in closed form), the suns as discs,
// and what the sky shows; fading and turning only mix what was projected.
//
// If key lights are asked for, the light is divided once when it is loaded (key_lights.hpp): surfaces receive
// the direct light of key lights by shadow maps, and the rest, which few bands can carry, by transfer. Key
// lights that were found in environment maps can be moved, dimmed and coloured: their discs change, and the
// sky shows the discs in place of their texels. Versions are checksums of the contents, so users may switch
// between Environment objects at any time. No GL. create() and setLights() fail if an environment map cannot
// be loaded.
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
#include "runtime/scene/components.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::lighting {

using spec::Disc;

class Environment {
 public:
  static constexpr std::size_t kSets = 2;

  static Result<Environment> create(const std::vector<spec::Light>& lights,
                                    const std::vector<spec::Light>& second_lights = {});
  // Replaces the lights; turn, fade and intensity stay. Environment maps that are already loaded, and whose
  // files did not change since, are neither read nor projected again. On an error nothing is changed.
  Result<void> setLights(const std::vector<spec::Light>& lights,
                         const std::vector<spec::Light>& second_lights = {});

  // Sets how many key lights each set may have at most. 0, the default of this class, means none. A change
  // divides the light again.
  void setMostKeys(std::uint32_t most);
  std::uint32_t mostKeys() const { return most_keys_; }

  // Replaces the suns of the scene, in world axes. They neither turn nor fade with the other lights, and the
  // sky and mirrors do not show them.
  void setSuns(std::vector<Disc> suns);

  // Replaces all edits. Each edit applies to the key light of its set, found in an environment map, that is
  // nearest to edit.found, if it is close enough; the last of several edits of one key light counts. An edit
  // without a matching key light has no effect until the lights are divided differently. Edits stay when
  // other lights are loaded, so the caller must clear those that no longer apply.
  void setKeyEdits(std::vector<spec::KeyEdit> edits);

  // Each of these setters changes the version if it changes a value. Values that are not finite are ignored.
  // Positive turns take +Z to +X.
  void setTurn(float degrees);
  // Sets the share of the second set, clamped to 0..1; the first set has the share 1 - fade.
  void setFade(float fade);
  // Sets a factor on all light, at least 0.
  void setIntensity(float intensity);
  // Sets all three from the scene.
  void follow(const scene::EnvironmentComponent& component);
  float turnDegrees() const { return turn_degrees_; }
  float fade() const { return fade_; }
  float intensity() const { return intensity_; }
  // Returns the rotation from the lights' own frame to world space.
  glm::mat3 worldFromLight() const;

  // These return the current light: in world space, turned, faded and scaled by the intensity.
  const sh::LightVector& light() const { return light_; }           // all light
  const sh::LightVector& skyLight() const { return sky_light_; }    // without any disc
  const sh::LightVector& keyLight() const { return key_light_; }    // key lights only
  const sh::LightVector& restLight() const { return rest_light_; }  // light() without keyLight()
  // Returns the suns of both sets, then their key lights, then the suns of the scene, which are key lights
  // too. Their number and order do not change while the lights fade; dark ones have radiance 0.
  const std::vector<Disc>& discs() const { return discs_; }
  std::span<const Disc> keys() const { return std::span(discs_).subspan(first_key_); }
  bool isKey(std::size_t disc) const { return disc >= first_key_; }
  // Returns a checksum of all values above. Two environments, also different objects, have the same version
  // exactly if they are the same light (but for one chance in 2^64). Never 0.
  std::uint64_t version() const { return version_; }
  // Returns a checksum of the loaded lights and their edits. Turning, fading and dimming do not change it.
  std::uint64_t lightsVersion() const { return lights_version_; }
  // Return checksums of restOf() alone and of the pictures in shownOf() alone. Dragging a key light changes
  // neither, so what was made from the pictures need not be made again.
  std::uint64_t restVersion() const { return rest_version_; }
  std::uint64_t picturesVersion() const { return pictures_version_; }

  // Returns the lights as loaded, without edits, in the lights' own frame at full radiance.
  const spec::DistantLights& set(std::size_t index) const { return sets_[index].lights; }
  struct Part {
    std::vector<const spec::EnvironmentMap*> environment_maps;
    glm::vec3 constant{0.0f};
    std::vector<Disc> discs;
  };
  // Returns the lights of a set without its key lights: environment maps without their peaks, and the
  // remaining discs.
  Part restOf(std::size_t index) const;
  // Returns what the camera sees: the lights as loaded, but edited key lights are removed from the pictures
  // and added as discs.
  Part shownOf(std::size_t index) const;
  const std::vector<Disc>& keysOf(std::size_t index) const { return sets_[index].key_discs; }
  // Describes a key light as found and as edited. foundKeys() returns them in the order of keys(), in
  // which the suns of the scene come after them.
  struct FoundKey {
    std::size_t set = 0;
    KeyOrigin origin;
    Disc found, now;  // without and with the edit; lights' own frame, full radiance
    std::optional<spec::KeyEdit> edit;
  };
  std::vector<FoundKey> foundKeys() const;
  // Returns the factor by which set() is multiplied now: its share of the fade times the intensity.
  float shareOf(std::size_t index) const;
  // Returns a sentence for each thing that was repaired in the environment maps.
  const std::vector<std::string>& notices() const { return notices_; }

 private:
  // Identifies the file that an environment map was loaded from, and its state.
  struct EnvironmentMapSource {
    std::filesystem::path file;
    std::optional<sh::ImageLayout> layout;
    std::filesystem::file_time_type written{};
    std::uintmax_t bytes = 0;
    bool operator==(const EnvironmentMapSource&) const = default;
  };
  static EnvironmentMapSource sourceOf(const spec::EnvironmentMapLight& light);
  // Keeps the results for an environment map that take long to compute.
  struct KnownEnvironmentMap {
    EnvironmentMapSource source;
    sh::LightVector sky;
    std::uint64_t checksum = 0;  // of the texels
  };
  struct Set {
    spec::DistantLights lights;
    std::vector<KnownEnvironmentMap> known;  // in the order of lights.environment_maps
    PartedLights parted;
    std::vector<Disc> key_discs;                      // parted.keys with the edits applied
    std::vector<std::optional<spec::KeyEdit>> edits;  // in the order of parted.keys
    std::vector<std::optional<spec::EnvironmentMap>>
        pictures;  // in the order of lights.environment_maps; without the edited keys
    sh::LightVector sky, discs,
        keys;  // lights' own frame; `sky` is the environment maps and the constant without peaks
  };
  Environment() = default;
  void part(Set& set) const;
  void applyEdits(std::size_t index);
  void change(float& kept, float value, float least, float greatest);
  void mix();
  void seal();  // updates lights_version_

  std::array<Set, kSets> sets_;
  std::vector<std::string> notices_;
  float turn_degrees_ = 0.0f, fade_ = 0.0f, intensity_ = 1.0f;
  std::uint32_t most_keys_ = 0;
  std::vector<spec::KeyEdit> key_edits_;
  std::vector<Disc> suns_;  // of the scene
  sh::LightVector light_, sky_light_, key_light_, rest_light_;
  std::vector<Disc> discs_;
  std::size_t first_key_ = 0;
  std::uint64_t version_ = 0, lights_version_ = 0, rest_version_ = 0, pictures_version_ = 0;
};

}  // namespace lambent::lighting
