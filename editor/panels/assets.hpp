// Draws assets as tiles: a picture with the name below it. The Assets panel, the Environment panel and the
// start page have them.
#pragma once

#include "editor/session/session.hpp"

namespace lambent::editor {

inline constexpr float kTileEms = 7.0f, kLargeTileEms = 12.0f;  // widths
inline constexpr const char* kDraggedAsset = "asset";  // the type of what a dragged tile carries: its path

// Draws a tile of this width, in ems, as one widget, which is the last one afterwards. While there is no
// picture, the tile has the word of the asset's kind. Returns whether it was clicked.
bool drawAssetTile(Session& session, const Asset& asset, float width_ems, bool selected);
// Returns path, kind, size and, if the asset cannot be read, why.
std::string describe(Session& session, const Asset& asset);

}  // namespace lambent::editor
