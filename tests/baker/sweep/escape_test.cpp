#include "baker/sweep/escape.hpp"

#include <gtest/gtest.h>

#include "baker/sweep/jpeg.hpp"
#include "baker/sweep/units.hpp"

namespace lambent::baker {
namespace {

TEST(Escape, HtmlHasNoCharacterThatEndsAnElementOrAnAttribute) {
  EXPECT_EQ(htmlText("<b onclick='x'> & \"y\""), "&lt;b onclick=&#39;x&#39;&gt; &amp; &quot;y&quot;");
  EXPECT_EQ(htmlText("n²"), "n²");
}

TEST(Escape, CsvQuotesOnlyFieldsThatNeedIt) {
  EXPECT_EQ(csvField("rays"), "rays");
  EXPECT_EQ(csvField("a,b"), "\"a,b\"");
  EXPECT_EQ(csvField("a \"b\""), "\"a \"\"b\"\"\"");
  EXPECT_EQ(csvField("a\nb"), "\"a\nb\"");
  EXPECT_EQ(csvField(""), "");
}

TEST(Escape, CsvHasNoFormulas) {
  EXPECT_EQ(csvField("=1+2"), "'=1+2");
  EXPECT_EQ(csvField("@x,y"), "\"'@x,y\"");
}

// The vectors of RFC 4648.
TEST(Base64, EncodesThePublishedVectors) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

TEST(Units, HaveThreeFiguresAtMost) {
  EXPECT_EQ(percent(0.0234), "2.3 %");
  EXPECT_EQ(percent(0.00417), "0.42 %");
  EXPECT_EQ(percent(1.0), "100 %");
  EXPECT_EQ(seconds(0.25), "250 ms");
  EXPECT_EQ(seconds(41.04), "41 s");
  EXPECT_EQ(seconds(600.0), "10 min");
  EXPECT_EQ(bytes(312'400.0), "312 kB");
  EXPECT_EQ(bytes(1.5e6), "1.5 MB");
}

}  // namespace
}  // namespace lambent::baker
