#include "editor/session/picture_scale.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lambent::editor {

void PictureScale::wholeTook(double milliseconds) {
  constexpr double kSlowMs = 150.0, kWantedMs = 80.0;
  constexpr float kLeast = 0.25f;
  moving_ = milliseconds > kSlowMs
                ? std::clamp(static_cast<float>(std::sqrt(kWantedMs / milliseconds)), kLeast, 1.0f)
                : 1.0f;
}

bool PictureScale::settle() {
  return std::exchange(coarse_, false);
}

}  // namespace lambent::editor
