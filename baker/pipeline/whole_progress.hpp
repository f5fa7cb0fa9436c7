// Sees a job with many stages as one: the share of the whole that is done, which never falls, and the time
// that is left. The caller says what each stage is expected to take (job_estimate.hpp). One thread uses an
// object.
#pragma once

#include <utility>

#include "baker/jobs/progress.hpp"
#include "baker/pipeline/job_estimate.hpp"
#include "baker/pipeline/progress_record.hpp"

namespace lambent::baker {

// The share of a job that is not done is at most this: what was expected may be over before the job is.
inline constexpr double kMostBeforeTheEnd = 0.99;

class WholeProgress {
 public:
  // `begun` is what earlier runs of the same job recorded.
  explicit WholeProgress(PartSeconds expected, ProgressRecord begun = {})
      : expected_(std::move(expected)), before_(std::move(begun.spent)), share_(begun.share) {}

  struct Seen {
    double share = 0.0;  // 0..1
    double seconds_left = 0.0;
    double units_per_s = 0.0;  // of the running stage
    Progress::Stage stage;     // the running one; without a name if none runs
  };
  Seen look(const Progress& progress);

 private:
  PartSeconds expected_, before_;
  double share_ = 0.0;
};

}  // namespace lambent::baker
