#include "baker/pipeline/bake_queue.hpp"

#include <algorithm>
#include <array>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "baker/import/gltf.hpp"
#include "baker/pipeline/whole_progress.hpp"
#include "runtime/bundle/container.hpp"

namespace lambent::baker {

namespace {

namespace fs = std::filesystem;

constexpr const char* kPreviewFolder = "previews";
// Previews that killed programs left behind are removed after this time.
constexpr std::chrono::hours kPreviewsKept{24 * 7};

constexpr std::uint32_t kCoarseRays = 128;
constexpr float kCoarseErrorBound = 0.03f;
constexpr std::uint32_t kCoarseVolumeGrid = 12;
constexpr glm::uvec3 kCoarseNeighborhoodGrid{12, 12, 6};

// Returns the options of a level for a bake that asked for `asked`; they are never finer than those.
BakeOptions previewLevelOptions(PreviewLevel preview_level, const BakeOptions& asked) {
  BakeOptions options = asked;
  if (preview_level != PreviewLevel::Coarse) return options;
  options.quality = Quality::Draft;
  options.rays = kCoarseRays;
  options.bounces = asked.bounces == 0 ? 0 : 1;
  options.picture_bound = 0.0f;
  options.error_bound = std::max(kCoarseErrorBound, asked.effectiveErrorBound());
  options.refine_bound = 0.0f;
  options.fit = false;
  options.volume_grid = glm::min(asked.volume_grid, glm::uvec3(kCoarseVolumeGrid));
  options.neighborhood_grid = asked.neighborhood_grid == glm::uvec3(0u)
                                  ? kCoarseNeighborhoodGrid
                                  : glm::min(asked.neighborhood_grid, kCoarseNeighborhoodGrid);
  return options;
}

// Returns 16 hex digits, for file names, which scene and output decide.
std::string requestKey(const BakeRequest& request) {
  const std::string text = plainPath(request.scene).string() + '\n' + plainPath(request.output).string();
  return fmt::format("{:016x}", bundle::checksum(std::as_bytes(std::span(text))));
}

// Step is the next step of a job. A trial is a final bake with little time.
enum class Step : std::uint8_t { Trial, Unshadowed, Coarse, Final };

PreviewLevel previewLevelOf(Step step) {
  if (step == Step::Unshadowed) return PreviewLevel::Unshadowed;
  return step == Step::Coarse ? PreviewLevel::Coarse : PreviewLevel::Final;
}

struct Job {
  JobState state;
  std::uint64_t asked = 0;  // rises with every request, so that the newest comes first
  Step step = Step::Final;
  bool tried = false;                        // the trial was made
  double coarse_seconds = 0.0;               // what the coarse preview took, once it is done
  std::shared_ptr<const Progress> progress;  // of the step that runs
  std::optional<WholeProgress> whole;        // of that step, once the scene is known

  // Steps that show something sooner come first.
  int rank() const {
    switch (step) {
      case Step::Unshadowed:
        return 0;
      case Step::Trial:
        return tried || !state.reached ? 0 : 1;
      case Step::Coarse:
        return 2;
      case Step::Final:
        return 3;
    }
    return 3;
  }
};

// Requests a stop when its time is over.
class Deadline {
 public:
  Deadline(std::stop_source stop, std::chrono::milliseconds time)
      : thread_([stop, time](const std::stop_token& done) mutable {
          std::mutex lock;
          std::condition_variable_any waiting;
          std::unique_lock hold(lock);
          if (!waiting.wait_for(hold, done, time, [&] { return done.stop_requested(); })) stop.request_stop();
        }) {}

 private:
  std::jthread thread_;
};

void removeOldPreviews(const fs::path& folder) {
  std::error_code failed;
  const auto old = fs::file_time_type::clock::now() - kPreviewsKept;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed)) {
    std::error_code gone;
    if (fs::last_write_time(at->path(), gone) < old && !gone) fs::remove(at->path(), gone);
  }
}

double total(std::span<const Progress::Stage> stages) {
  double seconds = 0.0;
  for (const Progress::Stage& stage : stages) seconds += stage.seconds;
  return seconds;
}

}  // namespace

const char* previewLevelName(PreviewLevel preview_level) {
  static constexpr std::array kNames = {"unshadowed", "coarse", "final"};
  return kNames[static_cast<std::size_t>(preview_level)];
}

fs::path plainPath(const fs::path& path) {
  std::error_code ignored;
  const fs::path absolute = fs::absolute(path, ignored);
  return (ignored ? path : absolute).lexically_normal();
}

const char* phaseName(JobPhase phase) {
  static constexpr std::array kNames = {"waiting", "importing", "baking", "done", "failed", "cancelled"};
  return kNames[static_cast<std::size_t>(phase)];
}

struct BakeQueue::Impl {
  explicit Impl(QueueSettings given) : settings(std::move(given)) {
    if (settings.work_folder.empty()) return;
    std::error_code failed;
    fs::create_directories(settings.work_folder / kPreviewFolder, failed);
    previews = !failed;
    removeOldPreviews(settings.work_folder / kPreviewFolder);
  }

  QueueSettings settings;
  bool previews = false;

  mutable std::mutex lock;
  std::condition_variable_any changed;  // wakes the worker
  std::vector<std::shared_ptr<Job>> jobs;
  std::vector<BakeEvent> events;
  std::uint64_t asked = 0;
  std::uint32_t last_id = 0;
  Job* running = nullptr;
  std::stop_source running_stop;

  // The scene that was used last; only the worker accesses it.
  struct Held {
    std::uint64_t asked = 0;
    std::shared_ptr<const Scene> scene;
  } held;

  std::jthread worker;  // last, so that it stops before the rest is destroyed

  fs::path placeOf(const Job& job, PreviewLevel preview_level) const {
    if (preview_level == PreviewLevel::Final) return job.state.request.output;
    return settings.work_folder / kPreviewFolder /
           (requestKey(job.state.request) + "-" + previewLevelName(preview_level) + ".lmb.glb");
  }

  void removePreviews(const Job& job) const {
    if (!previews) return;
    for (const PreviewLevel preview_level : {PreviewLevel::Unshadowed, PreviewLevel::Coarse}) {
      std::error_code ignored;
      fs::remove(placeOf(job, preview_level), ignored);
    }
  }

  void tell(BakeEvent::Kind kind, const Job& job, PreviewLevel preview_level = PreviewLevel::Final,
            fs::path bundle = {}) {
    events.push_back({kind, job.state.id, preview_level, std::move(bundle)});
  }

  std::shared_ptr<Job> find(JobId id) const {
    const auto found = std::ranges::find_if(jobs, [&](const auto& job) { return job->state.id == id; });
    return found == jobs.end() ? nullptr : *found;
  }

  Step firstStep(const BakeRequest& request) const {
    if (!previews) return Step::Final;
    // If a bundle exists, most of what is needed to bake it again is usually in the cache.
    std::error_code ignored;
    return settings.cache != nullptr && fs::exists(request.output, ignored) ? Step::Trial : Step::Unshadowed;
  }

  void start(Job& job, BakeRequest request) {
    const JobId id = job.state.id;
    job.state = {};
    job.state.id = id;
    job.state.request = std::move(request);
    job.asked = ++asked;
    job.step = firstStep(job.state.request);
    job.tried = false;
    job.whole.reset();
    job.coarse_seconds = 0.0;
    job.state.preview_level = previewLevelOf(job.step);
  }

  std::shared_ptr<Job> next() const {
    std::shared_ptr<Job> best;
    for (const auto& job : jobs) {
      if (job->state.phase != JobPhase::Waiting) continue;
      if (!best || job->rank() < best->rank() || (job->rank() == best->rank() && job->asked > best->asked))
        best = job;
    }
    return best;
  }

  // Returns the state as of now, and remembers the share, so that it never falls.
  JobState snapshot(Job& job) const;
  void work(const std::stop_token& stop);
  void turn(const std::shared_ptr<Job>& job, std::unique_lock<std::mutex>& hold,
            const std::stop_token& closing);
  Result<std::shared_ptr<const Scene>> sceneOf(const BakeRequest& request, std::uint64_t asked_then);
};

JobState BakeQueue::Impl::snapshot(Job& job) const {
  JobState state = job.state;
  if (state.phase == JobPhase::Done) {
    state.fraction = 1.0;
    state.seconds_left = 0.0;
  }
  if (!job.progress) return state;
  state.stage = job.progress->now();
  state.seconds += total(job.progress->finished()) + state.stage.seconds;
  if (!job.whole) return state;
  const WholeProgress::Seen seen = job.whole->look(*job.progress);
  state.units_per_s = seen.units_per_s;
  job.state.seconds_left = state.seconds_left = seen.seconds_left;
  job.state.fraction = state.fraction = std::max(state.fraction, seen.share);
  return state;
}

Result<std::shared_ptr<const Scene>> BakeQueue::Impl::sceneOf(const BakeRequest& request,
                                                              std::uint64_t asked_then) {
  if (held.asked == asked_then && held.scene) return held.scene;
  held = {};
  auto scene = importScene(request.scene, request.import);
  if (!scene) return failAgain(scene.error());
  applyEdits(request.edits, *scene);
  held = {asked_then, std::make_shared<const Scene>(std::move(*scene))};
  return held.scene;
}

void BakeQueue::Impl::turn(const std::shared_ptr<Job>& job, std::unique_lock<std::mutex>& hold,
                           const std::stop_token& closing) {
  const std::uint64_t asked_then = job->asked;
  const BakeRequest request = job->state.request;
  const Step step = job->step;
  const double coarse_seconds = job->coarse_seconds;
  const PreviewLevel preview_level = previewLevelOf(step);
  const auto progress = std::make_shared<Progress>();
  std::stop_source stop;
  running = job.get();
  running_stop = stop;
  job->progress = progress;
  job->state.preview_level = preview_level;
  job->state.phase = JobPhase::Importing;
  const bool first = !job->state.reached;
  const fs::path place = placeOf(*job, preview_level);
  hold.unlock();

  const std::stop_callback stop_too(closing, [stop]() mutable { stop.request_stop(); });
  bool up_to_date = false;
  std::vector<std::string> warnings;
  const Result<BakeReport> result = [&]() -> Result<BakeReport> {
    try {
      if (auto checked = checkRequest(request.options, request.output); !checked)
        return failAgain(checked.error());
      progress->begin("import");
      const auto scene = sceneOf(request, asked_then);
      if (!scene) return failAgain(scene.error());
      warnings = (*scene)->warnings;
      if (first && isUpToDate(**scene, request.options, request.output)) {
        up_to_date = true;
        return BakeReport{};
      }
      const auto plan = planFor(**scene, request.options);
      if (!plan) return failAgain(plan.error());
      const auto guess = [&](PreviewLevel level) {
        return guessBake(**scene, *plan, previewLevelOptions(level, request.options)).seconds;
      };
      PartSeconds expected = guess(PreviewLevel::Final);
      // The coarse preview and the final bake count; the unshadowed preview is short.
      std::optional<WholeProgress> whole;
      if (preview_level == PreviewLevel::Coarse)
        whole.emplace(guess(PreviewLevel::Coarse), 0.0, sumSeconds(expected));
      if (preview_level == PreviewLevel::Final) whole.emplace(std::move(expected), coarse_seconds);
      {
        const std::lock_guard again(lock);
        if (job->asked == asked_then) {
          job->state.phase = JobPhase::Baking;
          job->whole = std::move(whole);
        }
      }
      std::optional<Deadline> deadline;
      if (step == Step::Trial) deadline.emplace(stop, settings.trial);
      const BakeContext context{*progress, stop.get_token(), settings.cache};
      const BakeOptions options = previewLevelOptions(preview_level, request.options);
      return preview_level == PreviewLevel::Unshadowed ? bakeUnshadowed(**scene, options, place, context)
                                                       : bake(**scene, options, place, context);
    } catch (const std::exception& failure) {  // out of memory, most likely
      return fail(request.scene.string(), failure.what(), "free some memory or bake the scene in parts");
    }
  }();
  progress->end();

  hold.lock();
  running = nullptr;
  if (job->asked != asked_then) return;  // added again or cancelled meanwhile
  JobState& state = job->state;
  const std::vector<Progress::Stage> stages = progress->finished();
  snapshot(*job);  // remembers the share
  state.seconds += total(stages);
  job->progress = nullptr;
  job->whole.reset();
  state.warnings = warnings;
  if (!result) {
    if (!stop.stop_requested()) {
      state.phase = JobPhase::Failed;
      state.error = result.error();
      tell(BakeEvent::Kind::Failed, *job, preview_level);
      return;
    }
    // The step was stopped and will be resumed; but after a trial, previews come first.
    state.phase = JobPhase::Waiting;
    if (step == Step::Trial) {
      job->tried = true;
      job->step = state.reached ? Step::Coarse : Step::Unshadowed;
      state.preview_level = previewLevelOf(job->step);
    }
    return;
  }
  state.reached = up_to_date ? PreviewLevel::Final : preview_level;
  state.up_to_date = up_to_date;
  state.bundle = up_to_date ? request.output : place;
  if (!up_to_date) state.report = *result;
  state.warnings.insert(state.warnings.end(), result->notices.begin(), result->notices.end());
  tell(BakeEvent::Kind::Bundle, *job, *state.reached, state.bundle);
  if (state.reached >= request.last) {
    state.phase = JobPhase::Done;
    return;
  }
  if (preview_level == PreviewLevel::Coarse) job->coarse_seconds = total(stages);
  state.phase = JobPhase::Waiting;
  job->step = preview_level == PreviewLevel::Coarse ? Step::Final : job->tried ? Step::Coarse : Step::Trial;
  state.preview_level = previewLevelOf(job->step);
}

void BakeQueue::Impl::work(const std::stop_token& stop) {
  std::unique_lock hold(lock);
  while (changed.wait(hold, stop, [&] { return next() != nullptr; }) && !stop.stop_requested())
    turn(next(), hold, stop);
}

BakeQueue::BakeQueue(QueueSettings settings) : impl_(std::make_unique<Impl>(std::move(settings))) {
  impl_->worker = std::jthread([impl = impl_.get()](const std::stop_token& stop) { impl->work(stop); });
}

BakeQueue::~BakeQueue() {
  impl_->worker.request_stop();
  impl_->worker.join();
  for (const auto& job : impl_->jobs) impl_->removePreviews(*job);
}

JobId BakeQueue::add(BakeRequest request) {
  const std::lock_guard hold(impl_->lock);
  const std::string key = requestKey(request);
  const auto same = std::ranges::find_if(
      impl_->jobs, [&](const auto& job) { return requestKey(job->state.request) == key; });
  std::shared_ptr<Job> job;
  if (same != impl_->jobs.end()) {
    job = *same;
  } else {
    job = impl_->jobs.emplace_back(std::make_shared<Job>());
    job->state.id = {++impl_->last_id};
  }
  impl_->start(*job, std::move(request));
  // A running step with a cache resumes later; it is also stopped if its own scene has changed.
  const Job* const running = impl_->running;
  if (running != nullptr &&
      (running == job.get() || (impl_->settings.cache != nullptr && job->rank() < running->rank())))
    impl_->running_stop.request_stop();
  impl_->changed.notify_all();
  return job->state.id;
}

void BakeQueue::cancel(JobId id) {
  const std::lock_guard hold(impl_->lock);
  const std::shared_ptr<Job> job = impl_->find(id);
  if (!job || job->state.phase == JobPhase::Done || job->state.phase == JobPhase::Failed ||
      job->state.phase == JobPhase::Cancelled)
    return;
  if (impl_->running == job.get()) impl_->running_stop.request_stop();
  job->asked = ++impl_->asked;  // so that the result of a running step is ignored
  job->state.phase = JobPhase::Cancelled;
  job->progress = nullptr;
  impl_->tell(BakeEvent::Kind::Cancelled, *job);
}

std::vector<JobState> BakeQueue::states() const {
  const std::lock_guard hold(impl_->lock);
  std::vector<JobState> states;
  for (const auto& job : impl_->jobs) states.push_back(impl_->snapshot(*job));
  return states;
}

std::vector<BakeEvent> BakeQueue::takeEvents() {
  const std::lock_guard hold(impl_->lock);
  return std::exchange(impl_->events, {});
}

bool BakeQueue::busy() const {
  const std::lock_guard hold(impl_->lock);
  return impl_->running != nullptr || impl_->next() != nullptr;
}

}  // namespace lambent::baker
