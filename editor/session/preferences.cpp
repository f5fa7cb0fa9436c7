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

WindowLayout::WindowLayout() {
  of(Dock::Left).tab = "Scene";
  of(Dock::Right).tab = "Inspector";
  of(Dock::Bottom).tab = "Bakes";
}

namespace {

constexpr std::size_t kMostRecent = 10;

template <typename T>
void read(const nlohmann::json& json, const char* name, T& value) {
  if (const auto found = json.find(name); found != json.end()) value = found->get<T>();
}

nlohmann::json layoutJson(const WindowLayout& layout) {
  nlohmann::json json = {{"viewOnly", layout.view_only}};
  for (const Dock dock : kDocks) {
    const DockLayout& part = layout.of(dock);
    json[dockWord(dock)] = {{"share", part.share}, {"tab", part.tab}, {"shown", part.shown}};
  }
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
  const std::string text =
      nlohmann::json{{"width", p.width}, {"height", p.height}, {"layout", layoutJson(p.layout)},
                     {"scale", p.scale}, {"recent", p.recent}, {"lightUnit", p.light_unit}}
          .dump(2);
  if (out->write(text)) (void)out->commit();
}

}  // namespace lambent::editor
