// Computes the plans of scenes (as `lambent plan` does) on another thread: what a bake simulates, what not,
// and why. A plan is computed when a panel asks for it and kept until the scene's file or options change.
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
  std::vector<std::string> warnings;  // of the importer
};

class Plans {
 public:
  // Returns the plan, or null while it is being computed.
  const Result<ScenePlan>* find(const std::filesystem::path& scene, const baker::BakeOptions& options);

  // Returns whether one is being computed.
  bool busy() const;

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
