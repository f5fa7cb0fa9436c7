// Fits text and widgets into the room that there is, whatever the size of the font and the window. Needs a
// Dear ImGui context. Main thread.
#pragma once

#include <string>
#include <string_view>

namespace lambent::editor {

// Returns so many heights of the font, in pixels. Sizes that hold text are given in these.
float em(float heights);

// Returns the text, or as much of its beginning as fits into the width with an ellipsis behind it.
std::string ellipsized(std::string_view text, float width);

// Draws a line of text that ends in an ellipsis where the room ends. Its tooltip then begins with the whole
// text; `more`, if there is any, follows or is all of the tooltip.
void fittedText(std::string_view text, std::string_view more = {});
// The same in the room that is left beside this width.
void fittedTextBeside(std::string_view text, float width, std::string_view more = {});

// Shows a wrapped tooltip for the last widget while the pointer is over it. Without text there is none.
void tooltip(std::string_view text);

// Goes on in the same line if a button with this text, or a widget of this width in pixels, fits there.
// Returns whether it does.
bool sameLineIfFits(std::string_view button);
bool sameLineIfFits(float width);

// Returns a printf format with as many digits as fit into the width for this value, at most `digits` behind
// the point.
const char* numberFormat(float value, float width, int digits);

}  // namespace lambent::editor
