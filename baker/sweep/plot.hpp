// Draws scatter plots of error against cost as SVG, both axes logarithmic, with the Pareto front as a line.
// Points come in, a text goes out: either for a page that has plot.css, or whole, with the style in it and
// colours that follow a light or dark screen. Pure.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace lambent::baker {

struct PlotPoint {
  double x = 0.0, y = 0.0;       // both > 0; others are left out
  double y_spread = 0.0;         // drawn as a bar up and down
  std::string id;                // by which a page finds its picture; may be empty
  std::string about;             // shown when the mouse rests on it
  std::string label;             // written beside it; empty: none
  bool always_labelled = false;  // else only where there is room
  bool on_front = false, chosen = false;
};

struct Plot {
  std::string title, x_title, y_title;  // the title is for readers who see no picture, or see it alone
  std::string (*x_text)(double) = nullptr;
  std::string (*y_text)(double) = nullptr;
  std::vector<PlotPoint> points;
  std::vector<std::size_t> front;  // indices in the order of x
};

enum class PlotPlace : unsigned char { InPage, Alone };

std::string svgOf(const Plot& plot, PlotPlace place);

}  // namespace lambent::baker
