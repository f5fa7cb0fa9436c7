// Draws the small chart of one knob as SVG: error as lines over its values, cost as bars behind them. Pure.
#pragma once

#include <string>
#include <vector>

namespace lambent::baker {

struct ChartColumn {
  std::string value;            // of the knob
  double error = 0.0;           // as light is
  double error_of_bands = 0.0;  // as the bands can show
  double cost = 0.0;
  std::string cost_text, other_text;  // written below the value
  std::string id;                     // by which a page finds its picture
  bool base = false;
};

std::string chartOf(const std::string& title, const std::vector<ChartColumn>& columns);

}  // namespace lambent::baker
