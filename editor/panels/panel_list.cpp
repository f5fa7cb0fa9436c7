#include <array>

#include "editor/panels/panel.hpp"

namespace lambent::editor {

namespace {

constexpr std::array kPanels = {
    Panel{"Scene", Dock::Left, "What is in the world: search, select, rename", &drawSceneTree},
    Panel{"Inspector", Dock::Right, "The components of what is selected", &drawInspector},
    Panel{"Environment", Dock::Right, "The light from outside: environment maps, sun, turn, exposure",
          &drawEnvironment},
    Panel{"Settings", Dock::Right, "How the picture is computed: bands, captures, effects", &drawSettings},
    Panel{"Plan", Dock::Right, "What a scene's bake simulates, what not, and why", &drawPlan},
    Panel{"Bakes", Dock::Bottom, "What is being baked, how far, and what came of it", &drawBakes},
    Panel{"Assets", Dock::Bottom, "Environment maps, scenes, bundles and worlds to use or open", &drawAssets},
    Panel{"Cost", Dock::Bottom, "What ran in the last frame, how long it took, and why", &drawCost},
    Panel{"Accuracy", Dock::Bottom, "What each knob costs in time and in error, measured in this view",
          &drawAccuracy},
    Panel{"Streaming", Dock::Bottom, "What is on the GPU, what is on its way, how even frames are",
          &drawStreaming},
    Panel{"History", Dock::Bottom, "The steps that undo takes back; a click goes there", &drawHistory},
    Panel{"Log", Dock::Bottom, "Notices and errors", &drawLog},
};

}  // namespace

std::span<const Panel> panelList() {
  return kPanels;
}

Dock dockOf(const WindowLayout& layout, const Panel& panel) {
  const auto moved = layout.moved.find(panel.name);
  return moved == layout.moved.end() ? panel.dock : moved->second;
}

}  // namespace lambent::editor
