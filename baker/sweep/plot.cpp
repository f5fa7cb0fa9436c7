#include "baker/sweep/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "baker/sweep/escape.hpp"
#include "lambent_sweep_embedded.hpp"

namespace lambent::baker {

namespace {

constexpr double kPlotWidth = 860.0, kPlotHeight = 440.0, kPlotLeft = 62.0, kPlotRight = 26.0,
                 kPlotBottom = 52.0;
constexpr double kTextWidth = 7.4, kTextHeight = 16.0;  // of a letter, about

// An Axis maps values to places by their logarithm.
struct Axis {
  double least = 1.0, most = 10.0;  // values at its ends
  double start = 0.0, end = 1.0;    // places

  double at(double value) const {
    return start + (end - start) * std::log(value / least) / std::log(most / least);
  }
  // Returns the values on it that are these digits times powers of ten.
  std::vector<double> ticksOf(std::initializer_list<double> digits) const {
    std::vector<double> ticks;
    const int first = static_cast<int>(std::floor(std::log10(least)));
    const int last = static_cast<int>(std::ceil(std::log10(most)));
    for (int power = first; power <= last; ++power)
      for (const double digit : digits)
        if (const double value = digit * std::pow(10.0, power); value >= least && value <= most)
          ticks.push_back(value);
    return ticks;
  }
  // Returns four to nine round values, if there are so many.
  std::vector<double> ticks() const {
    constexpr std::size_t kFew = 4, kMany = 9;
    std::vector<double> ticks = ticksOf({1.0, 2.0, 5.0});
    if (ticks.size() > kMany) return ticksOf({1.0});
    return ticks.size() < kFew ? ticksOf({1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0}) : ticks;
  }
};

bool drawable(const PlotPoint& point) {
  return std::isfinite(point.x) && std::isfinite(point.y) && point.x > 0.0 && point.y > 0.0;
}

// Leaves room around the values, and at least a factor of two between the ends.
Axis axisOf(const std::vector<PlotPoint>& points, double PlotPoint::*value, double start, double end) {
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (const PlotPoint& point : points) {
    if (!drawable(point)) continue;
    least = std::min(least, point.*value);
    most = std::max(most, point.*value);
  }
  if (!(most > 0.0)) return {1.0, 10.0, start, end};
  const double room = std::max(std::pow(most / least, 0.08), std::sqrt(2.0 * least / most));
  const double margin = std::max(room, 1.12);
  return {least / margin, most * margin, start, end};
}

struct Box {
  double left = 0.0, top = 0.0, right = 0.0, bottom = 0.0;

  bool meets(const Box& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
};

// Finds places for labels where they cover neither points nor each other, if there are any.
class Labels {
 public:
  void occupy(double x, double y) { taken_.push_back({x - 6.0, y - 6.0, x + 6.0, y + 6.0}); }

  std::string put(const PlotPoint& point, double x, double y, double top) {
    const double width = kTextWidth * static_cast<double>(point.label.size());
    struct Place {
      double dx, dy;
      const char* anchor;
    };
    static constexpr std::array kPlaces = {
        Place{10, -8, "start"},  Place{-10, -8, "end"},  Place{10, 18, "start"},  Place{-10, 18, "end"},
        Place{0, -16, "middle"}, Place{0, 26, "middle"}, Place{10, -26, "start"}, Place{-10, -26, "end"},
        Place{10, 36, "start"},  Place{-10, 36, "end"}};
    std::optional<Box> found;
    Place place = kPlaces.front();
    for (const Place& tried : kPlaces) {
      const double shift = tried.anchor[0] == 's' ? 0.0 : tried.anchor[0] == 'e' ? 1.0 : 0.5;
      const Box box{x + tried.dx - shift * width, y + tried.dy - kTextHeight + 3.0,
                    x + tried.dx + (1.0 - shift) * width, y + tried.dy + 3.0};
      const bool inside = box.left > kPlotLeft && box.right < kPlotWidth && box.top > top &&
                          box.bottom < kPlotHeight - kPlotBottom;
      if (!inside || std::ranges::any_of(taken_, [&](const Box& other) { return box.meets(other); }))
        continue;
      found = box;
      place = tried;
      break;
    }
    if (!found && !point.always_labelled) return {};
    if (found) taken_.push_back(*found);
    return fmt::format("<text class=\"label{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n",
                       point.chosen            ? " strong"
                       : point.always_labelled ? ""
                                               : " quiet",
                       x + place.dx, y + place.dy, place.anchor, htmlText(point.label));
  }

 private:
  std::vector<Box> taken_;
};

std::string axesText(const Plot& plot, const Axis& x, const Axis& y) {
  std::string out;
  for (const double value : x.ticks())
    out += fmt::format(
        "<line class=\"grid\" x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{0:.1f}\" y2=\"{2:.1f}\"/>"
        "<text class=\"tick\" x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4}</text>\n",
        x.at(value), y.start, y.end, y.start + 18.0, htmlText(plot.x_text(value)));
  for (const double value : y.ticks())
    out += fmt::format(
        "<line class=\"grid\" x1=\"{1:.1f}\" y1=\"{0:.1f}\" x2=\"{2:.1f}\" y2=\"{0:.1f}\"/>"
        "<text class=\"tick\" x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
        y.at(value), x.start, x.end, x.start - 8.0, y.at(value) + 4.0, htmlText(plot.y_text(value)));
  out += fmt::format("<text class=\"axis\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                     0.5 * (x.start + x.end), y.start + 42.0, htmlText(plot.x_title));
  out += fmt::format(
      "<text class=\"axis\" transform=\"translate(15 {:.1f}) rotate(-90)\" "
      "text-anchor=\"middle\">{}</text>\n",
      0.5 * (y.start + y.end), htmlText(plot.y_title));
  return out;
}

std::string pointText(const PlotPoint& point, const Axis& x, const Axis& y) {
  const double at_x = x.at(point.x), at_y = y.at(point.y);
  std::string out;
  if (point.y_spread > 0.0) {
    const double low = std::max(point.y - point.y_spread, y.least),
                 high = std::min(point.y + point.y_spread, y.most);
    out += fmt::format("<line class=\"spread\" x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{0:.1f}\" y2=\"{2:.1f}\"/>",
                       at_x, y.at(low), y.at(high));
  }
  if (point.chosen)
    out += fmt::format("<circle class=\"ring\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"11\"/>", at_x, at_y);
  out += fmt::format(
      "<circle class=\"dot{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\"{}><title>{}</title></circle>\n",
      point.on_front ? " on-front" : "", at_x, at_y,
      point.id.empty() ? "" : fmt::format(" data-picture=\"{}\"", htmlText(point.id)), htmlText(point.about));
  return out;
}

}  // namespace

std::string svgOf(const Plot& plot, PlotPlace place) {
  const double top = place == PlotPlace::Alone ? 46.0 : 14.0;
  const Axis x = axisOf(plot.points, &PlotPoint::x, kPlotLeft, kPlotWidth - kPlotRight);
  const Axis y = axisOf(plot.points, &PlotPoint::y, kPlotHeight - kPlotBottom, top);
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" viewBox=\"0 0 {} {}\" role=\"img\" "
      "aria-label=\"{}\">\n",
      kPlotWidth, kPlotHeight, htmlText(plot.title));
  if (place == PlotPlace::Alone)
    out += fmt::format(
        "<style>{}</style>\n<rect class=\"paper\" width=\"{}\" height=\"{}\" rx=\"10\"/>\n"
        "<text class=\"title\" x=\"{}\" y=\"28\">{}</text>\n",
        embedded::lambent_sweep::find("plot.css"), kPlotWidth, kPlotHeight, kPlotLeft, htmlText(plot.title));
  out += axesText(plot, x, y);
  std::string line;
  for (const std::size_t i : plot.front)
    if (const PlotPoint& point = plot.points[i]; drawable(point))
      line += fmt::format("{}{:.1f},{:.1f}", line.empty() ? "" : " ", x.at(point.x), y.at(point.y));
  if (!line.empty()) out += fmt::format("<polyline class=\"front\" points=\"{}\"/>\n", line);
  Labels labels;
  for (const bool on_front : {false, true})  // the front lies above the others
    for (const PlotPoint& point : plot.points) {
      if (point.on_front != on_front || !drawable(point)) continue;
      labels.occupy(x.at(point.x), y.at(point.y));
      out += pointText(point, x, y);
    }
  // Labels that must stand take their places first, and that of the chosen point before all.
  const auto putLabels = [&](auto&& which) {
    for (const PlotPoint& point : plot.points)
      if (which(point) && !point.label.empty() && drawable(point))
        out += labels.put(point, x.at(point.x), y.at(point.y), top);
  };
  putLabels([](const PlotPoint& p) { return p.chosen; });
  putLabels([](const PlotPoint& p) { return !p.chosen && p.always_labelled; });
  putLabels([](const PlotPoint& p) { return !p.chosen && !p.always_labelled; });
  return out + "</svg>\n";
}

}  // namespace lambent::baker
