// Sees a job with many stages as one: the share of the whole that is done, which never falls, and the time
// that is left. The caller says what each stage is expected to take (job_estimate.hpp). One thread uses an
// object.
#pragma once

#include <utility>

#include "baker/jobs/progress.hpp"
#include "baker/pipeline/job_estimate.hpp"

namespace lambent::baker {

class WholeProgress {
 public:
  explicit WholeProgress(StageSeconds expected) : expected_(std::move(expected)) {}

  struct Seen {
    double share = 0.0;  // 0..1
    double seconds_left = 0.0;
    Progress::Stage stage;  // the running one; without a name if none runs
  };
  Seen look(const Progress& progress);

 private:
  StageSeconds expected_;
  double share_ = 0.0;
};

}  // namespace lambent::baker
