#include "runtime/gpu/plain_text.hpp"

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <epoxy/gl.h>
#include <stb/stb_easy_font.h>

namespace lambent::gpu {

namespace {

// A vertex as stb_easy_font writes it. Four make an upright rectangle, from its top left corner on.
struct Vertex {
  float x, y, z;
  std::array<unsigned char, 4> color;
};
constexpr std::size_t kBytesPerLetter = 600;  // twice what the header expects on average

struct Rectangle {
  float x, y, width, height;  // from the top left corner
};

// Fills the rectangle by clearing it, which needs neither a program nor buffers.
void fill(const Rectangle& area, std::uint32_t height, const std::array<float, 4>& color) {
  const auto pixel = [](float value) { return static_cast<GLint>(std::lround(value)); };
  glScissor(pixel(area.x), static_cast<GLint>(height) - pixel(area.y + area.height), pixel(area.width),
            pixel(area.height));
  glClearBufferfv(GL_COLOR, 0, color.data());
}

}  // namespace

void drawPlainText(std::string_view text, std::uint32_t height, const PlainTextStyle& style) {
  std::string letters(text);
  std::vector<Vertex> vertices(letters.size() * kBytesPerLetter / sizeof(Vertex));
  const int quads = stb_easy_font_print(0.0f, 0.0f, letters.data(), nullptr, vertices.data(),
                                        static_cast<int>(vertices.size() * sizeof(Vertex)));
  const auto width_px = style.scale * static_cast<float>(stb_easy_font_width(letters.data()));
  const auto height_px = style.scale * static_cast<float>(stb_easy_font_height(letters.data()));
  glEnable(GL_SCISSOR_TEST);
  fill({style.margin_px, style.margin_px, width_px + 2.0f * style.margin_px,
        height_px + 2.0f * style.margin_px},
       height, {0.06f, 0.06f, 0.07f, 1.0f});
  const float begin = 2.0f * style.margin_px;
  for (std::size_t quad = 0; quad < static_cast<std::size_t>(quads); ++quad) {
    const Vertex &low = vertices[4 * quad], &high = vertices[4 * quad + 2];
    fill({begin + style.scale * low.x, begin + style.scale * low.y, style.scale * (high.x - low.x),
          style.scale * (high.y - low.y)},
         height, {0.95f, 0.95f, 0.95f, 1.0f});
  }
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace lambent::gpu
