#include "baker/cache/bytes.hpp"

#include <gtest/gtest.h>

namespace {

using namespace lambent::baker;

TEST(Bytes, NeverReadPastTheirEnd) {
  ByteWriter out;
  out.add(std::uint32_t{7});
  out.addList(std::vector<float>{1.0f, 2.0f, 3.0f});
  write(std::string("end"), out);
  for (std::size_t cut = 0; cut <= out.size(); ++cut) {
    ByteReader in(out.bytes().first(cut));
    std::uint32_t seven = 0;
    std::vector<float> list;
    std::string text;
    const bool all = in.read(seven) && in.readList(list) && in.readList(text) && in.atEnd();
    EXPECT_EQ(all, cut == out.size());
  }
  ByteWriter lies;  // a length that would not fit into memory
  lies.add(~std::uint64_t{0});
  ByteReader in(lies.bytes());
  std::vector<double> list;
  EXPECT_FALSE(in.readList(list));
  EXPECT_FALSE(in.ok());
}

}  // namespace
