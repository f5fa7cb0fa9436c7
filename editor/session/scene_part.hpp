// Finds the part of the view's picture that shows one scene among others, for its small picture.
#pragma once

#include <cstdint>
#include <optional>

#include "runtime/scene/bounds.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::editor {

struct PicturePart {
  std::uint32_t left = 0, top = 0, width = 0, height = 0;  // in pixels
  bool operator==(const PicturePart&) const = default;
};

// Returns the part around the box, with a margin and in the shape of small pictures, or nothing if a corner
// of the box is not in the picture or the part would be too small to recognise.
std::optional<PicturePart> partWithBox(const spec::View& view, const spec::Size& size, const scene::Box& box);

}  // namespace lambent::editor
