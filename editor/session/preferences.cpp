#include "editor/session/preferences.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include <nlohmann/json.hpp>

#include "runtime/base/atomic_file.hpp"

namespace lambent::editor {

namespace {

constexpr std::size_t kMostRecent = 10;

template <typename T>
void read(const nlohmann::json& json, const char* name, T& value) {
  if (const auto found = json.find(name); found != json.end()) value = found->get<T>();
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
    read(json, "left", p.left), read(json, "right", p.right), read(json, "bottom", p.bottom);
    read(json, "leftTab", p.left_tab), read(json, "rightTab", p.right_tab);
    read(json, "bottomTab", p.bottom_tab);
    read(json, "showLeft", p.show_left), read(json, "showRight", p.show_right);
    read(json, "showBottom", p.show_bottom);
    read(json, "scale", p.scale), read(json, "recent", p.recent);
    read(json, "lightUnit", p.light_unit);
  } catch (const nlohmann::json::exception&) {
    return {};
  }
  const auto share = [](float& value) { value = std::clamp(value, 0.08f, 0.6f); };
  share(p.left), share(p.right), share(p.bottom);
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
      nlohmann::json{{"width", p.width},          {"height", p.height},          {"left", p.left},
                     {"right", p.right},          {"bottom", p.bottom},          {"leftTab", p.left_tab},
                     {"rightTab", p.right_tab},   {"bottomTab", p.bottom_tab},   {"showLeft", p.show_left},
                     {"showRight", p.show_right}, {"showBottom", p.show_bottom}, {"scale", p.scale},
                     {"recent", p.recent},        {"lightUnit", p.light_unit}}
          .dump(2);
  if (out->write(text)) (void)out->commit();
}

}  // namespace lambent::editor
