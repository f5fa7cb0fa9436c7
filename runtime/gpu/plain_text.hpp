// Draws plain text over a picture, for a few lines of help: no fonts, no blending, one size. Needs a current
// OpenGL context.
#pragma once

#include <cstdint>
#include <string_view>

namespace lambent::gpu {

struct PlainTextStyle {
  float scale = 2.0f;       // letters are 7 of these pixels high
  float margin_px = 12.0f;  // of the dark ground around the text, and from the corner of the picture
};

// Draws the lines of the text onto a dark ground in the top left corner of the framebuffer that is bound for
// drawing, whose height is given. Only ASCII is drawn.
void drawPlainText(std::string_view text, std::uint32_t height, const PlainTextStyle& style = {});

}  // namespace lambent::gpu
