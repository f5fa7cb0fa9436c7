// Drags suns over the sky: each has a handle where it is seen, or at the picture's border where it stands
// beyond it or behind the eye. The directions in which suns stand, a view and pixels come in; the direction
// in which the one that is dragged is to stand now goes out. Who holds the sun (a light word, a directional
// light) follows. Orthographic views see one direction only: there are no handles.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "editor/gizmo/painting.hpp"
#include "editor/gizmo/projection.hpp"
#include "runtime/base/result.hpp"

namespace lambent::editor {

class SunGizmo {
 public:
  float hit_px = 10.0f;

  // Call both every frame, with unit directions of the world towards each sun. The one that is dragged may
  // have moved by then.
  void setSuns(std::vector<glm::vec3> towards);
  void setView(const spec::View& view, const Viewport& viewport);

  std::optional<std::size_t> hit(glm::vec2 pixel) const;
  void hover(glm::vec2 pixel) { hovered_ = hit(pixel); }
  bool press(glm::vec2 pixel);
  bool dragging() const { return active_.has_value(); }
  std::optional<std::size_t> active() const { return active_; }
  // Returns the direction towards the sun that is dragged, as it is to stand. One that was taken at the
  // border comes to the pointer; another keeps its distance from it, so that nothing jumps at the press.
  glm::vec3 drag(glm::vec2 pixel) const;
  void release() { active_.reset(); }

  struct Place {
    glm::vec2 pixel{0.0f};
    bool seen = false;  // else it is at the border, on the side on which the sun stands
  };
  std::optional<Place> place(std::size_t sun) const;
  std::size_t count() const { return towards_.size(); }
  Painting paint() const;

 private:
  Projection projection_;
  std::vector<glm::vec3> towards_;
  std::optional<std::size_t> hovered_, active_;
  glm::vec2 offset_{0.0f};  // from the pointer to the sun when it was taken
};

// ---- the words of suns

struct SkyDirection {
  float azimuth_deg = 0.0f, elevation_deg = 0.0f;
};
// Converts a direction of the world to that of sun: words, and back. rotation_deg: the environment's; the sun
// of a turned environment has the azimuth of its word plus that.
SkyDirection skyDirection(const glm::vec3& towards, float rotation_deg);
glm::vec3 towardsSun(const SkyDirection& direction, float rotation_deg);
// Returns "sun:AZ,EL,..." with other angles, all else as it was written. Error: the word is no sun.
Result<std::string> withSunDirection(std::string_view word, const SkyDirection& direction);

}  // namespace lambent::editor
