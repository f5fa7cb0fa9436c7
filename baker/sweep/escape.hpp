// Makes texts safe to stand in a page or a table: names of scenes and files may have any characters.
#pragma once

#include <string>
#include <string_view>

namespace lambent::baker {

// Escapes a text for HTML and SVG, inside elements and quoted attributes.
std::string htmlText(std::string_view text);

// Returns a field of a CSV table (RFC 4180): quoted if it has a comma, a quote or a line break. A text that
// begins as a formula of spreadsheets does gets an apostrophe before it.
std::string csvField(std::string_view text);

}  // namespace lambent::baker
