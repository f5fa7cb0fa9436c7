// Names fields and uses of textures in plain words, for labels. The exact names, by which scripts and files
// know them, stand in tooltips.
#pragma once

#include <string>
#include <string_view>

namespace lambent::editor {

// Returns a label for a component's field, or for a texture of a material: "Inner cone" for inner_cone.
std::string fieldLabel(std::string_view component, std::string_view field);
// Returns a sentence about the field where its label is not enough, or an empty text.
std::string_view fieldHelp(std::string_view component, std::string_view field);

}  // namespace lambent::editor
