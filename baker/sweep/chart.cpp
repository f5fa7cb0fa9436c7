#include "baker/sweep/chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "baker/sweep/escape.hpp"
#include "baker/sweep/units.hpp"

namespace lambent::baker {

namespace {

constexpr double kChartWidth = 380.0, kChartHeight = 230.0, kChartLeft = 46.0, kChartRight = 12.0,
                 kChartTop = 12.0, kChartFloor = 168.0;

// Returns a round step with which about four lines fill the height.
double roundStep(double most) {
  const double rough = most / 4.0, power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (rough <= digit * power) return digit * power;
  return 10.0 * power;
}

std::string lineOf(const std::vector<std::array<double, 2>>& points, const char* name) {
  std::string line;
  for (const auto& [x, y] : points) line += fmt::format("{}{:.1f},{:.1f}", line.empty() ? "" : " ", x, y);
  return fmt::format("<polyline class=\"{}\" points=\"{}\"/>\n", name, line);
}

}  // namespace

std::string chartOf(const std::string& title, const std::vector<ChartColumn>& columns) {
  double most = 1e-6, most_cost = 1e-9;
  for (const ChartColumn& column : columns) {
    most = std::max({most, column.error, column.error_of_bands});
    most_cost = std::max(most_cost, column.cost);
  }
  const double step = roundStep(most), ceiling = step * std::ceil(1.02 * most / step);
  const double wide = (kChartWidth - kChartLeft - kChartRight) /
                      static_cast<double>(std::max<std::size_t>(columns.size(), 1));
  const auto height = [&](double error) { return kChartFloor - (kChartFloor - kChartTop) * error / ceiling; };
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot chart\" viewBox=\"0 0 {} {}\" role=\"img\" "
      "aria-label=\"{}\">\n",
      kChartWidth, kChartHeight, htmlText(title));
  for (double value = 0.0; value <= ceiling * 1.001; value += step)
    out += fmt::format(
        "<line class=\"grid\" x1=\"{0}\" y1=\"{1:.1f}\" x2=\"{2}\" y2=\"{1:.1f}\"/>"
        "<text class=\"tick\" x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
        kChartLeft, height(value), kChartWidth - kChartRight, kChartLeft - 6.0, height(value) + 4.0,
        htmlText(tickPercent(value)));
  std::vector<std::array<double, 2>> lit, banded;
  std::string dots;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const ChartColumn& column = columns[i];
    const double x = kChartLeft + wide * (static_cast<double>(i) + 0.5),
                 bar = 0.86 * (kChartFloor - kChartTop) * column.cost / most_cost;
    out +=
        fmt::format("<rect class=\"cost\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n",
                    x - 0.3 * wide, kChartFloor - bar, 0.6 * wide, bar);
    out += fmt::format(
        "<text class=\"value{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>"
        "<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>"
        "<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
        column.base ? " base" : "", x, kChartFloor + 19.0, htmlText(column.value), x, kChartFloor + 37.0,
        htmlText(column.cost_text), x, kChartFloor + 53.0, htmlText(column.other_text));
    lit.push_back({x, height(column.error)});
    banded.push_back({x, height(column.error_of_bands)});
    dots += fmt::format(
        "<circle class=\"dot banded\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"><title>{}</title></circle>\n", x,
        height(column.error_of_bands), htmlText(percent(column.error_of_bands)));
    dots += fmt::format(
        "<circle class=\"dot on-front\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.5\" "
        "data-picture=\"{}\"><title>{}</title></circle>\n",
        x, height(column.error), htmlText(column.id), htmlText(column.value + ": " + percent(column.error)));
  }
  return out + lineOf(banded, "banded") + lineOf(lit, "lit") + dots + "</svg>\n";
}

}  // namespace lambent::baker
