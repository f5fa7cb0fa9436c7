#include "reference/progressive.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

#include <glm/common.hpp>

#include "baker/jobs/parallel.hpp"
#include "reference/film.hpp"
#include "reference/lights.hpp"

namespace lambent::baker::reference {

spec::RgbaImage enlarged(const spec::RgbaImage& image, const spec::Size& size) {
  // Lies between texels `low` and `high`; `share` is the weight of `high`.
  struct Place {
    std::size_t low, high;
    float share;
  };
  const auto placeOf = [](std::uint32_t i, std::uint32_t from, std::uint32_t to) {
    const double at = std::clamp((i + 0.5) * from / to - 0.5, 0.0, from - 1.0);
    const auto low = static_cast<std::size_t>(at);
    return Place{low, std::min<std::size_t>(low + 1, from - 1), static_cast<float>(at - std::floor(at))};
  };
  spec::RgbaImage out{.width = size.width, .height = size.height, .texels = {}};
  out.texels.reserve(std::size_t{size.width} * size.height);
  for (std::uint32_t row = 0; row < size.height; ++row)
    for (std::uint32_t column = 0; column < size.width; ++column) {
      const Place y = placeOf(row, image.height, size.height), x = placeOf(column, image.width, size.width);
      const auto between = [&](std::size_t at) {
        return glm::mix(image.texels[at * image.width + x.low], image.texels[at * image.width + x.high],
                        x.share);
      };
      out.texels.push_back(glm::mix(between(y.low), between(y.high), y.share));
    }
  return out;
}

namespace {

using Clock = std::chrono::steady_clock;

// Each coarse picture has a block size and a number of samples per block. The first appears at once, also
// while a view is dragged; together they cost 1.14 samples per full pixel.
struct Coarse {
  std::uint32_t by, samples;
};
constexpr std::array<Coarse, 3> kCoarse = {{{8, 1}, {4, 2}, {2, 4}}};
// How often rows are published while the first full pass proceeds from the top.
constexpr auto kPublishEvery = std::chrono::milliseconds(250);

struct Job {
  std::shared_ptr<const Scene> scene;
  Request request;
  std::uint64_t generation = 0;
  std::stop_token stop = {};
};

spec::Size coarser(const spec::Size& size, std::uint32_t by) {
  return {.width = (size.width + by - 1) / by, .height = (size.height + by - 1) / by};
}

Snapshot snapshotOf(const Film& film, std::uint32_t spp) {
  Snapshot out;
  out.image = film.image();
  out.spp = spp;
  out.noise = film.standardError();
  if (spp > 1)
    for (std::size_t replica = 0; replica < 2; ++replica) out.halves[replica] = film.half(replica);
  return out;
}

}  // namespace

class ProgressiveReference::Worker {
 public:
  ~Worker() {
    const std::lock_guard hold(lock_);
    stop_.request_stop();
    thread_.request_stop();
  }

  std::uint64_t restart(std::shared_ptr<const Scene> scene, Request request) {
    const std::lock_guard hold(lock_);
    stop_.request_stop();
    stop_ = std::stop_source();
    if (scene) scene_ = std::move(scene);
    const std::uint64_t generation = status_.generation + 1;
    wanted_ = Job{scene_, std::move(request), generation, stop_.get_token()};
    status_ = {.generation = generation};
    if (!thread_.joinable()) thread_ = std::jthread([this](const std::stop_token& ended) { work(ended); });
    changed_.notify_all();
    return generation;
  }

  std::shared_ptr<const Snapshot> snapshot() const {
    const std::lock_guard hold(lock_);
    return snapshot_;
  }

  ProgressiveStatus status() const {
    const Progress::Stage stage = progress_.now();
    const std::lock_guard hold(lock_);
    ProgressiveStatus out = status_;
    if (out.phase == ProgressivePhase::Tracing && stage.total > 0)
      out.share = std::min(1.0, static_cast<double>(stage.done) / static_cast<double>(stage.total));
    return out;
  }

 private:
  void work(const std::stop_token& ended) {
    for (;;) {
      std::optional<Job> job;
      {
        std::unique_lock hold(lock_);
        if (!changed_.wait(hold, ended, [&] { return wanted_.has_value(); })) return;
        job = std::exchange(wanted_, std::nullopt);
      }
      begin_ = Clock::now();
      Result<void> done;
      try {
        inBackground(job->request.options.threads, [&] { done = trace(*job); });
      } catch (const std::exception& failure) {  // most likely out of memory
        traced_.reset();
        done = fail("reference", failure.what(), "free some memory or make the picture smaller");
      }
      progress_.end();
      if (job->stop.stop_requested()) continue;
      if (done)
        enter(*job, ProgressivePhase::Finished);
      else
        enter(*job, ProgressivePhase::Failed, std::move(done.error()));
    }
  }

  // The rest runs on the worker thread. A job ends early, without an error, when it is stopped.
  Result<void> trace(const Job& job) {
    const Request& request = job.request;
    const Options& options = request.options;
    if (auto checked = checkOptions(options); !checked) return failAgain(std::move(checked.error()));
    auto environment =
        lights_.environment(request.lights, request.light_factors, options, request.more_light);
    if (!environment) return failAgain(std::move(environment.error()));
    if (auto built = build(job.scene); !built) return failAgain(std::move(built.error()));
    const auto view = viewOf(*traced_scene_, traced_->surfaces, request);
    if (!view) return failAgain(view.error());
    const std::vector<spec::LocalLight> shapes = spec::localLights(request.lights, traced_scene_->origin);
    enter(job, ProgressivePhase::Tracing);

    spec::RgbaImage shown;  // a coarse picture, overwritten by the finished rows of the first pass
    for (const auto& [by, samples] : kCoarse) {
      Options coarse = options;
      coarse.size = coarser(options.size, by);
      const World world{*traced_, **environment, shapes, EyeRays(*view, coarse.size), coarse};
      Film film(coarse.size, 0);
      if (!fill(job, world, film, std::min(samples, options.spp))) return {};
      shown = enlarged(film.image(), options.size);
      Snapshot out;
      out.image = shown;
      out.coarseness = by;
      publish(job, std::move(out));
    }

    const World world{*traced_, **environment, shapes, EyeRays(*view, options.size), options};
    Film film(options.size, 0);
    const std::uint32_t together = samplesInPass(world);
    Clock::time_point shown_at = Clock::now();
    const auto showRows = [&](std::uint32_t first, std::uint32_t last) {
      for (std::uint32_t y = first; y < last; ++y) film.putRow(y, shown);
      if (Clock::now() - shown_at < kPublishEvery || last == film.size().height) return;
      Snapshot out;
      out.image = shown;
      out.coarseness = kCoarse.back().by;
      publish(job, std::move(out));
      shown_at = Clock::now();
    };
    for (std::uint32_t done = 0; done < options.spp;) {
      const std::uint32_t next = done + std::min(together, options.spp - done);
      const bool whole = done == 0 ? fill(job, world, film, next, showRows) : fill(job, world, film, next);
      if (!whole) return {};
      done = next;
      publish(job, snapshotOf(film, done));
    }
    return {};
  }

  Result<void> build(const std::shared_ptr<const Scene>& scene) {
    if (traced_ && traced_scene_ == scene) return {};
    traced_.reset();
    traced_scene_ = scene;
    auto traced = TracedScene::build(*scene);
    if (!traced) return failAgain(std::move(traced.error()));
    traced_ = std::move(*traced);
    return {};
  }

  using OnRows = std::function<void(std::uint32_t first, std::uint32_t last)>;
  // Returns false if stopped.
  bool fill(const Job& job, const World& world, Film& film, std::uint32_t samples,
            const OnRows& on_rows = {}) {
    const std::uint32_t height = film.size().height;
    progress_.begin("paths", std::uint64_t{film.size().width} * height * (samples - film.done(0)), "samples");
    for (std::uint32_t first = 0; first < height; first += kRowsAtOnce) {
      const std::uint32_t last = std::min(first + kRowsAtOnce, height);
      if (job.stop.stop_requested()) return false;
      if (!addSamples(world, film, {first, last}, samples, progress_, job.stop)) return false;
      if (on_rows) on_rows(first, last);
    }
    return true;
  }

  void publish(const Job& job, Snapshot snapshot) {
    snapshot.generation = job.generation;
    snapshot.seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
    snapshot.notices = lights_.notices();
    snapshot.notices.insert(snapshot.notices.end(), traced_->notices.begin(), traced_->notices.end());
    auto shared = std::make_shared<const Snapshot>(std::move(snapshot));
    const std::lock_guard hold(lock_);
    if (job.generation == status_.generation) std::swap(snapshot_, shared);
  }

  void enter(const Job& job, ProgressivePhase phase, std::optional<Error> error = {}) {
    const std::lock_guard hold(lock_);
    if (job.generation != status_.generation) return;
    status_.phase = phase;
    status_.error = std::move(error);
  }

  // These are used by the worker thread only. The scene must outlive what was built from it.
  LightCache lights_;
  std::shared_ptr<const Scene> traced_scene_;
  std::unique_ptr<const TracedScene> traced_;
  Clock::time_point begin_;  // start of the job

  Progress progress_;

  mutable std::mutex lock_;  // guards the members below
  std::condition_variable_any changed_;
  std::shared_ptr<const Scene> scene_;
  std::optional<Job> wanted_;
  std::stop_source stop_;  // of the newest job
  ProgressiveStatus status_;
  std::shared_ptr<const Snapshot> snapshot_;

  std::jthread thread_;  // last, so that it is joined before anything else is destroyed
};

ProgressiveReference::ProgressiveReference(std::shared_ptr<const Scene> scene, Request request)
    : worker_(std::make_unique<Worker>()) {
  worker_->restart(std::move(scene), std::move(request));
}

ProgressiveReference::~ProgressiveReference() = default;

std::uint64_t ProgressiveReference::restart(Request request) {
  return worker_->restart(nullptr, std::move(request));
}

std::uint64_t ProgressiveReference::restart(std::shared_ptr<const Scene> scene, Request request) {
  return worker_->restart(std::move(scene), std::move(request));
}

std::shared_ptr<const Snapshot> ProgressiveReference::snapshot() const {
  return worker_->snapshot();
}

ProgressiveStatus ProgressiveReference::status() const {
  return worker_->status();
}

}  // namespace lambent::baker::reference
