#include "editor/session/setting_study.hpp"

#include <algorithm>
#include <cmath>

#include "editor/session/session.hpp"

namespace lambent::editor {

namespace {

// A sweep has about this many values, in equal steps of an integer or of a logarithm.
constexpr int kMostValues = 6;

std::vector<double> valuesOf(const frame::SettingRow& row) {
  using Kind = frame::SettingRow::Kind;
  std::vector<double> values;
  const double least = std::max(row.least, row.kind == Kind::Real ? 1e-2 : 1.0);
  if (row.kind == Kind::Switch || row.kind == Kind::Choice) {
    for (double value = row.least; value <= row.greatest; value += 1.0) values.push_back(value);
    return values;
  }
  const double most = std::min(row.greatest, 4096.0);
  if (row.kind == Kind::Whole && most - least < kMostValues) {
    for (double value = least; value <= most; value += 1.0) values.push_back(value);
    return values;
  }
  for (int i = 0; i < kMostValues; ++i) {
    const double value = least * std::pow(most / least, i / double{kMostValues - 1});
    values.push_back(row.kind == Kind::Whole ? std::round(value) : value);
  }
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

}  // namespace

void SettingStudy::measureAll() {
  waiting_.clear();
  for (const frame::SettingRow& row : frame::settingRows())
    if (row.finest) waiting_.insert(waiting_.begin(), {std::string(row.name), false});
}

void SettingStudy::sweep(std::string name) {
  waiting_.insert(waiting_.begin(), {std::move(name), true});
}

void SettingStudy::update(Session& session) {
  if (waiting_.empty() || !session.atRest()) return;
  const Task task = std::move(waiting_.back());
  waiting_.pop_back();
  const frame::SettingRow* row = frame::findSetting(task.name);
  if (!row || !row->finest) return;
  const frame::FrameSettings& settings = session.stage.settings();
  const spec::Size size{
      320, std::max(1u, 320 * session.viewing.size.height / std::max(1u, session.viewing.size.width))};
  Stage& stage = session.stage;
  if (task.sweep) {
    auto points = frame::sweepSetting({stage.world(), stage.environment(), session.viewing.shown_view},
                                      settings, *row, valuesOf(*row), {.size = size, .repeats = 3});
    if (points)
      rows_[task.name].sweep = std::move(*points);
    else
      session.log.error(points.error());
  } else {
    auto cost = frame::measureSetting({stage.world(), stage.environment(), session.viewing.shown_view},
                                      settings, *row, {.size = size, .repeats = 3});
    if (cost)
      rows_[task.name].cost = std::move(*cost);
    else
      session.log.error(cost.error());
  }
  session.viewing.changed = true;
}

}  // namespace lambent::editor
