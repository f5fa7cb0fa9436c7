// Drags suns over the sky. A sun's handle is where the sun is seen, or at the picture's border if the sun is
// out of view. The directions towards the suns, a view and pixels come in; the new direction of the dragged
// sun goes out, and the caller sets it (in a light word or a directional light). Orthographic views show one
// direction only and have no handles.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "editor/gizmo/projection.hpp"
#include "runtime/base/result.hpp"

namespace lambent::editor {

class SunGizmo {
 public:
  float hit_px = 10.0f;

  // Call both every frame, with unit directions towards each sun in world space. The dragged sun may have
  // moved.
  void setSuns(std::vector<glm::vec3> towards);
  void setView(const spec::View& view, const Viewport& viewport) { projection_ = {view, viewport}; }

  std::optional<std::size_t> hit(glm::vec2 pixel) const;
  void hover(glm::vec2 pixel) { hovered_ = hit(pixel); }
  bool press(glm::vec2 pixel);
  bool dragging() const { return active_.has_value(); }
  std::optional<std::size_t> active() const { return active_; }
  // Returns the new direction towards the dragged sun. A sun that was grabbed at the border jumps to the
  // pointer; any other keeps its offset from the pointer.
  glm::vec3 drag(glm::vec2 pixel) const;
  void release() { active_.reset(); }

  struct Place {
    glm::vec2 pixel{0.0f};
    bool seen = false;  // false: at the border, on the side where the sun is
  };
  std::optional<Place> place(std::size_t sun) const;
  std::size_t count() const { return towards_.size(); }
  Painting paint() const;

 private:
  Projection projection_;
  std::vector<glm::vec3> towards_;
  std::optional<std::size_t> hovered_, active_;
  glm::vec2 offset_{0.0f};  // from the pointer to the sun at press()
};

// ---- Words of suns.

struct SkyDirection {
  float azimuth_deg = 0.0f, elevation_deg = 0.0f;
};
// Convert a direction in world space to the angles of a sun: word, and back. rotation_deg: the environment's
// rotation, which is added to the azimuth of the word.
SkyDirection skyDirection(const glm::vec3& towards, float rotation_deg);
glm::vec3 towardsSun(const SkyDirection& direction, float rotation_deg);
// Returns the sun: word with other angles and everything else unchanged. Error: the word is no sun.
Result<std::string> withSunDirection(std::string_view word, const SkyDirection& direction);

}  // namespace lambent::editor
