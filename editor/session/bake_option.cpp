// Options of `lambent bake` by name, for scenes of the editor.
#include <map>

#include <fmt/format.h>

#include "baker/bake/bake.hpp"
#include "editor/session/scenes.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::editor {

namespace {

Result<void> put(baker::BakeOptions& options, std::string_view name, std::string_view word) {
  if (name == "quality") {
    static const std::map<std::string_view, baker::Quality> kWords = {{"draft", baker::Quality::Draft},
                                                                      {"standard", baker::Quality::Standard},
                                                                      {"high", baker::Quality::High}};
    const auto found = kWords.find(word);
    if (found == kWords.end())
      return fail("quality", fmt::format("\"{}\" is not known", word), "give draft, standard or high");
    options.quality = found->second;
    return {};
  }
  if (name == "effects") {
    options.effects = word;
    return {};
  }
  const auto number = spec::parseNumber(word);
  if (!number) return fail(std::string(name), fmt::format("\"{}\" is not a number", word), "give a number");
  const auto whole = static_cast<int>(*number);
  if (name == "order")
    options.order = whole;
  else if (name == "glossy-order")
    options.glossy_order = whole;
  else if (name == "rays")
    options.rays = *number < 0.0f ? 0 : static_cast<decltype(options.rays)>(*number);
  else if (name == "bounces")
    options.bounces = whole;
  else if (name == "light-samples")
    options.light_samples = whole;
  else if (name == "max-edge")
    options.max_edge_m = *number;
  else if (name == "refine")
    options.refine_bound = *number;
  else if (name == "error")
    options.error_bound = *number;
  else
    return fail(std::string(name), "is no option of a bake",
                "give quality, order, glossy-order, rays, bounces, light-samples, max-edge, refine, error or "
                "effects");
  return {};
}

}  // namespace

Result<void> Scenes::setOption(std::size_t index, std::string_view name, std::string_view word) {
  SceneEntry& entry = entries_[index];
  baker::BakeOptions options = entry.options;
  if (auto done = put(options, name, word); !done) return done;
  if (auto checked = baker::checkRequest(options, entry.bundle); !checked) return checked;
  entry.options = options;
  return {};
}

}  // namespace lambent::editor
