#include <gtest/gtest.h>

#include "baker/trace/transfer_field.hpp"

namespace lambent::baker {
namespace {

TransferField fieldOf(std::vector<float> values) {
  TransferField field;
  field.order = 1;
  field.columns = 1;
  field.vectors = std::move(values);
  return field;
}

TEST(FillFromNeighbours, GrowsInwardsLayerByLayer) {
  // 0 - 1 - 2 - 3 - 4 in a row, the ends valid: the middle is reached last, from both sides.
  TransferField field = fieldOf({1.0f, -9.0f, -9.0f, -9.0f, 5.0f});
  EXPECT_EQ(fillFromNeighbours({{0, 1}, {1, 2}, {2, 3}, {3, 4}}, {1, 0, 0, 0, 1}, field), 3u);
  EXPECT_EQ(field.vectors, (std::vector<float>{1.0f, 1.0f, 3.0f, 5.0f, 5.0f}));
}

TEST(FillFromNeighbours, KeepsWhatNothingValidTouches) {
  TransferField field = fieldOf({1.0f, 2.0f, 3.0f});
  EXPECT_EQ(fillFromNeighbours({{1, 2}}, {1, 0, 0}, field), 0u);
  EXPECT_EQ(field.vectors, (std::vector<float>{1.0f, 2.0f, 3.0f}));
}

}  // namespace
}  // namespace lambent::baker
