// Finds out on request what the present view costs with other settings, and what a bake of a scene would
// simulate. SettingStudy measures one setting a frame, so that the editor stays responsive; its update()
// needs a current OpenGL context, and the renderer calls it. Main thread.
#pragma once

#include <filesystem>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "baker/bake/options.hpp"
#include "baker/plan/effect_plan.hpp"
#include "runtime/base/result.hpp"
#include "runtime/measure/measured_frame.hpp"

namespace lambent::editor {

class Session;

// Measures what each setting of the frame costs in time and in error.
class SettingStudy {
 public:
  // Starts measuring every setting at its present value.
  void measureAll();
  void update(Session& session);
  bool busy() const { return !waiting_.empty(); }

  const std::map<std::string, frame::SettingCost, std::less<>>& costs() const { return costs_; }

 private:
  std::vector<std::string> waiting_;  // the last is the next
  std::map<std::string, frame::SettingCost, std::less<>> costs_;
};

struct ScenePlan {
  baker::EffectPlan plan;
  std::vector<std::string> warnings;  // of the importer
};

// Computes the plans of scenes (as `lambent plan` does) on another thread: what a bake simulates, what not,
// and why. A plan is computed when a panel asks for it and kept until the scene's file or options change.
class Plans {
 public:
  // Returns the plan, or null while it is being computed.
  const Result<ScenePlan>* find(const std::filesystem::path& scene, const baker::BakeOptions& options);

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
