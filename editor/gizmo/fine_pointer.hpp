// Follows the pointer during a drag, at a tenth of its way while the user holds the key for fine movements.
#pragma once

#include <glm/vec2.hpp>

namespace lambent::editor {

class FinePointer {
 public:
  void press(glm::vec2 pixel) { pointer_ = at_ = pixel; }
  // Returns the pixel that counts for the drag when the pointer is at `pixel`.
  glm::vec2 moved(glm::vec2 pixel, bool fine) {
    at_ += (fine ? 0.1f : 1.0f) * (pixel - pointer_);
    pointer_ = pixel;
    return at_;
  }

 private:
  glm::vec2 pointer_{0.0f}, at_{0.0f};
};

}  // namespace lambent::editor
