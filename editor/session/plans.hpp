// Makes the plans of scenes (`lambent plan`) on a thread beside the editor's: what a bake simulates, what
// not, and why. The panel that shows a plan asks for it; it is kept until the scene's file or options change.
#pragma once

#include <filesystem>
#include <future>
#include <map>
#include <optional>

#include "baker/bake/options.hpp"
#include "baker/plan/effect_plan.hpp"
#include "runtime/base/result.hpp"

namespace lambent::editor {

struct ScenePlan {
  baker::EffectPlan plan;
  std::vector<std::string> warnings;  // of the import
};

class Plans {
 public:
  // Returns the plan, or null while it is being made.
  const Result<ScenePlan>* find(const std::filesystem::path& scene, const baker::BakeOptions& options);

 private:
  struct Entry {
    std::filesystem::file_time_type time;
    std::map<std::string, std::string> settings;
    std::future<Result<ScenePlan>> coming;
    std::optional<Result<ScenePlan>> plan;
  };
  std::map<std::filesystem::path, Entry> entries_;
};

}  // namespace lambent::editor
