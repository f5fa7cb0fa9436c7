#include "baker/pipeline/whole_progress.hpp"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <utility>

namespace lambent::baker {

namespace {

// The share of a job that is not done is at most this: what was expected may be over before the job is.
constexpr double kMostBeforeTheEnd = 0.99;

double shareOf(const Progress::Stage& stage) {
  return stage.total > 0 ? std::min(1.0, static_cast<double>(stage.done) / static_cast<double>(stage.total))
                         : 0.0;
}

}  // namespace

double sumSeconds(const PartSeconds& parts) {
  double sum = 0.0;
  for (const StageSeconds& part : parts)
    for (const auto& [stage, seconds] : part) sum += seconds;
  return sum;
}

JobSeconds jobSeconds(const PartSeconds& expected, std::vector<Progress::Stage> stages) {
  // Measured times count against this share of all that was expected, so that the first short stages say
  // little.
  constexpr double kPaceBegins = 0.05;
  const Progress::Stage& now = stages.back();
  JobSeconds job;
  double took = 0.0, expected_of_these = 0.0;
  for (std::size_t part = 0; part < expected.size(); ++part)
    for (const auto& [name, seconds] : expected[part]) {
      // Bounces that turn out not to be needed are over with their part.
      double share = part < now.part ? 1.0 : 0.0, spent = 0.0;
      bool computed = false;
      for (const Progress::Stage& stage : stages) {
        if (stage.part != part || stage.name != name) continue;
        share = std::max(share, &stage == &now ? shareOf(now) : 1.0);
        if (stage.found) continue;  // says nothing of the machine
        computed = true;
        spent += stage.seconds;
      }
      job.done += share * seconds;
      job.left += (1.0 - share) * seconds;
      if (!computed) continue;
      took += spent;
      expected_of_these += share * seconds;
    }
  const double begins = kPaceBegins * (job.done + job.left);
  if (begins > 0.0) job.pace = (took + begins) / (expected_of_these + begins);
  return job;
}

WholeProgress::Seen WholeProgress::look(const Progress& progress) {
  Seen seen;
  seen.stage = progress.now();
  std::vector<Progress::Stage> stages = progress.finished();
  stages.push_back(seen.stage);
  const JobSeconds job = jobSeconds(expected_, std::move(stages));
  if (seen.stage.seconds > 0.0)
    seen.units_per_s =
        static_cast<double>(seen.stage.done - std::min(seen.stage.done, seen.stage.found_units)) /
        seen.stage.seconds;
  // A share that falls would say that work was lost.
  const double done = before_s_ + job.done, left = job.left + after_s_;
  if (done > 0.0) share_ = std::max(share_, std::min(kMostBeforeTheEnd, done / (done + left)));
  seen.share = share_;
  seen.seconds_left = job.pace * left;
  return seen;
}

ProgressWatch::ProgressWatch(const Progress& progress, WholeProgress whole,
                             std::chrono::duration<double> every,
                             std::function<void(const WholeProgress::Seen&)> say, bool at_end)
    : thread_([&progress, whole = std::move(whole), every, say = std::move(say),
               at_end](std::stop_token stop) mutable {
        std::mutex lock;
        std::condition_variable_any ended;  // lets the end come before the next turn
        std::unique_lock hold(lock);
        while (!ended.wait_for(hold, stop, every, [&] { return stop.stop_requested(); }))
          say(whole.look(progress));
        if (at_end) say(whole.look(progress));
      }) {}

}  // namespace lambent::baker
