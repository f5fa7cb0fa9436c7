#include "baker/pipeline/whole_progress.hpp"

#include <algorithm>

namespace lambent::baker {

WholeProgress::Seen WholeProgress::look(const Progress& progress) {
  Seen seen;
  seen.stage = progress.now();
  const auto finished = progress.finished();
  seen.seconds_left = secondsLeft(expected_, before_, finished, seen.stage);
  if (const double took = secondsOf(seen.stage, before_, finished); took > 0.0)
    seen.units_per_s = static_cast<double>(seen.stage.done) / took;
  double spent = seen.stage.seconds + sumSeconds(before_);
  for (const Progress::Stage& stage : finished) spent += stage.seconds;
  // Estimates change while stages run, and a share that falls would say that work was lost.
  if (spent > 0.0)
    share_ = std::max(share_, std::min(kMostBeforeTheEnd, spent / (spent + seen.seconds_left)));
  seen.share = share_;
  return seen;
}

}  // namespace lambent::baker
