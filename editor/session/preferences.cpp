#include "editor/session/preferences.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include <nlohmann/json.hpp>

#include "runtime/base/atomic_file.hpp"

namespace lambent::editor {

namespace {

constexpr std::array<std::string_view, 3> kWords = {"left", "right", "below"};  // in the order of Dock

}  // namespace

std::string_view dockWord(Dock dock) {
  return kWords[static_cast<std::size_t>(dock)];
}

std::optional<Dock> parseDock(std::string_view word) {
  for (const Dock dock : kDocks)
    if (dockWord(dock) == word) return dock;
  return std::nullopt;
}

WindowLayout::WindowLayout() {
  of(Dock::Left).tab = "Scene";
  of(Dock::Right).tab = "Inspector";
  of(Dock::Bottom).tab = "Bakes";
}

std::optional<WindowLayout> layoutNamed(std::string_view name) {
  WindowLayout layout;
  if (name == "default") return layout;
  if (name == "lighting") {
    layout.moved["Environment"] = Dock::Left;
    layout.of(Dock::Left).tab = "Environment";
    layout.of(Dock::Left).share = 0.24f;
    layout.of(Dock::Bottom).shown = false;
    return layout;
  }
  if (name == "baking") {
    layout.of(Dock::Right).tab = "Plan";
    layout.of(Dock::Bottom).share = 0.4f;
    return layout;
  }
  return std::nullopt;
}

namespace {

constexpr std::size_t kMostRecent = 10;

template <typename T>
void read(const nlohmann::json& json, const char* name, T& value) {
  if (const auto found = json.find(name); found != json.end()) value = found->get<T>();
}

nlohmann::json layoutJson(const WindowLayout& layout) {
  nlohmann::json json = {{"viewOnly", layout.view_only}, {"moved", nlohmann::json::object()}};
  for (const Dock dock : kDocks) {
    const DockLayout& part = layout.of(dock);
    json[dockWord(dock)] = {{"share", part.share}, {"tab", part.tab}, {"shown", part.shown}};
  }
  for (const auto& [panel, dock] : layout.moved) json["moved"][panel] = dockWord(dock);
  return json;
}

void readLayout(const nlohmann::json& json, WindowLayout& layout) {
  read(json, "viewOnly", layout.view_only);
  for (const Dock dock : kDocks)
    if (const auto part = json.find(dockWord(dock)); part != json.end()) {
      DockLayout& to = layout.of(dock);
      read(*part, "share", to.share), read(*part, "tab", to.tab), read(*part, "shown", to.shown);
      to.share = std::clamp(to.share, 0.0f, 1.0f);
    }
  if (const auto moved = json.find("moved"); moved != json.end())
    for (const auto& [panel, word] : moved->items())
      if (const auto dock = parseDock(word.get<std::string>())) layout.moved[panel] = *dock;
}

nlohmann::json handlesJson(const GizmoOptions& handles) {
  return {{"mode", static_cast<int>(handles.mode)},
          {"local", handles.space == GizmoSpace::Local},
          {"pivot", static_cast<int>(handles.pivot)},
          {"snap", handles.snap},
          {"metres", handles.snap_m},
          {"degrees", handles.snap_deg},
          {"factor", handles.snap_scale}};
}

void readHandles(const nlohmann::json& json, GizmoOptions& handles) {
  int mode = 0, pivot = 0;
  bool local = false;
  read(json, "mode", mode), read(json, "pivot", pivot), read(json, "local", local);
  handles.mode = static_cast<GizmoMode>(std::clamp(mode, 0, 2));
  handles.pivot = static_cast<GizmoPivot>(std::clamp(pivot, 0, 2));
  handles.space = local ? GizmoSpace::Local : GizmoSpace::World;
  read(json, "snap", handles.snap);
  const auto step = [&](const char* name, float& value) {
    float given = value;
    read(json, name, given);
    if (given > 0.0f) value = given;
  };
  step("metres", handles.snap_m), step("degrees", handles.snap_deg), step("factor", handles.snap_scale);
}

}  // namespace

void Preferences::addRecent(const std::filesystem::path& file) {
  std::error_code ignored;
  const std::string name = std::filesystem::absolute(file, ignored).string();
  std::erase(recent, name);
  recent.insert(recent.begin(), name);
  if (recent.size() > kMostRecent) recent.resize(kMostRecent);
}

std::filesystem::path preferencesFile() {
  if (const char* config = std::getenv("XDG_CONFIG_HOME"); config && *config)
    return std::filesystem::path(config) / "lambent" / "editor.json";
  if (const char* home = std::getenv("HOME"); home && *home)
    return std::filesystem::path(home) / ".config" / "lambent" / "editor.json";
  return {};
}

Preferences loadPreferences(const std::filesystem::path& file) {
  Preferences p;
  std::ifstream in(file);
  if (!in) return p;
  const nlohmann::json json = nlohmann::json::parse(in, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return p;
  try {
    read(json, "width", p.width), read(json, "height", p.height);
    if (const auto layout = json.find("layout"); layout != json.end()) readLayout(*layout, p.layout);
    if (const auto layouts = json.find("layouts"); layouts != json.end())
      for (const auto& [name, layout] : layouts->items()) readLayout(layout, p.layouts[name]);
    if (const auto handles = json.find("handles"); handles != json.end()) readHandles(*handles, p.handles);
    read(json, "cameraPreview", p.camera_preview);
    read(json, "desktopDialogs", p.desktop_dialogs);
    read(json, "scale", p.scale), read(json, "recent", p.recent);
    read(json, "lightUnit", p.light_unit);
  } catch (const nlohmann::json::exception&) {
    return {};
  }
  p.width = std::clamp(p.width, 640, 16384), p.height = std::clamp(p.height, 400, 16384);
  p.scale = std::clamp(p.scale, 0.5f, 4.0f);
  return p;
}

void savePreferences(const std::filesystem::path& file, const Preferences& p) {
  if (file.empty()) return;
  std::error_code ignored;
  std::filesystem::create_directories(file.parent_path(), ignored);
  auto out = AtomicFile::open(file);
  if (!out) return;
  nlohmann::json layouts = nlohmann::json::object();
  for (const auto& [name, layout] : p.layouts) layouts[name] = layoutJson(layout);
  const std::string text = nlohmann::json{
      {"width", p.width},
      {"height", p.height},
      {"layout", layoutJson(p.layout)},
      {"layouts", layouts},
      {"handles", handlesJson(p.handles)},
      {"cameraPreview", p.camera_preview},
      {"desktopDialogs", p.desktop_dialogs},
      {"scale", p.scale},
      {"recent", p.recent},
      {"lightUnit",
       p.light_unit}}.dump(2);
  if (out->write(text)) (void)out->commit();
}

}  // namespace lambent::editor
