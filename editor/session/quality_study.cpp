#include "editor/session/quality_study.hpp"

#include <algorithm>
#include <utility>

#include "editor/session/session.hpp"
#include "runtime/frame/frame_settings.hpp"

namespace lambent::editor {

namespace {

constexpr std::uint32_t kMostWidth = 640;

}  // namespace

void QualityStudy::measure() {
  const auto names = frame::qualityNames();
  waiting_.assign(names.begin(), names.end());
}

void QualityStudy::update(Session& session) {
  if (waiting_.empty() || !session.atRest()) return;
  Stage& stage = session.stage;
  if (waiting_.size() == frame::qualityNames().size()) {
    rows_.clear();
    view_ = session.viewing.shown_view;
    const spec::Size whole = session.viewing.size;
    size_.width = std::min(whole.width, kMostWidth);
    size_.height = std::max(1u, size_.width * whole.height / whole.width);
  }
  const std::string name = std::move(waiting_.back());
  waiting_.pop_back();
  frame::FrameSettings settings = stage.settings();
  // The environment decides the number of key lights, so it must follow.
  lighting::Environment environment = stage.environment();
  const auto measured = [&]() -> Result<Row> {
    if (auto put = frame::putQuality(settings, name); !put) return failAgain(put.error());
    environment.setMostKeys(settings.mostKeys());
    auto frame =
        frame::measureFrame({stage.world(), environment, view_}, settings, {.size = size_, .repeats = 3});
    if (!frame) return failAgain(frame.error());
    Row row{.quality = name, .error = 0.0, .cost = std::move(frame->cost)};
    if (rows_.empty()) {
      highest_ = std::move(frame->picture);
      return row;
    }
    const auto error = frame::relativeRms(frame->picture, highest_);
    if (!error) return failAgain(error.error());
    row.error = *error;
    return row;
  }();
  session.viewing.changed = true;
  if (!measured) {
    waiting_.clear();
    return session.log.error(measured.error());
  }
  rows_.insert(rows_.begin(), *measured);
}

}  // namespace lambent::editor
