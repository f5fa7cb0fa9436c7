#include "runtime/spec/key_edit.hpp"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/spec/light.hpp"

namespace lambent::spec {

TEST(KeyEdit, SaysWhichKeyLightStandsWhereAndHowItShines) {
  const auto edit = parseKeyEdit("key:90,0,0,90,0.5");
  ASSERT_TRUE(edit) << edit.error().line();
  EXPECT_EQ(edit->set, 0u);
  EXPECT_LT(glm::distance(edit->found, glm::vec3(1, 0, 0)), 1e-6f);
  EXPECT_LT(glm::distance(edit->towards, glm::vec3(0, 1, 0)), 1e-6f);
  EXPECT_EQ(edit->factor, glm::vec3(0.5f)) << "one factor is that of all channels";
  const auto fade = parseKeyEdit("fade-key:0,0,0,0,1,0,0.25");
  ASSERT_TRUE(fade);
  EXPECT_EQ(fade->set, 1u);
  EXPECT_EQ(fade->factor, glm::vec3(1.0f, 0.0f, 0.25f));
}

TEST(KeyEdit, WordsReadBackToTheSameEditWithinAThousandthOfADegree) {
  for (const glm::vec3& direction :
       {glm::vec3(0.3f, 0.8f, -0.5f), glm::vec3(-0.7f, -0.1f, 0.2f), glm::vec3(0, 1, 0), glm::vec3(0, -1, 0)})
    for (const std::size_t set : {0u, 1u}) {
      const KeyEdit edit{.set = set,
                         .found = glm::normalize(direction),
                         .towards = glm::normalize(glm::vec3(direction.z, direction.y, direction.x)),
                         .factor = {0.1f, 2.0f, 1.0f / 3.0f}};
      const auto read = parseKeyEdit(keyEditWord(edit));
      ASSERT_TRUE(read) << keyEditWord(edit);
      EXPECT_EQ(read->set, set);
      EXPECT_LT(glm::distance(read->found, edit.found), 2e-5f) << keyEditWord(edit);
      EXPECT_LT(glm::distance(read->towards, edit.towards), 2e-5f) << keyEditWord(edit);
      EXPECT_EQ(read->factor, edit.factor);
    }
  EXPECT_EQ(keyEditWord({.found = {0, 0, 1}, .towards = {1, 0, 0}}), "key:0,0,90,0,1");
}

TEST(KeyEdit, RefusesOtherWordsAndSaysTheForm) {
  for (const char* word : {"", "sun:1,2,3,4", "key:", "key:1,2,3,4", "key:1,2,3,4,5,6", "key:0,91,0,0,1",
                           "key:0,0,0,-91,1", "key:0,0,0,0,-1", "key:0,0,0,0,2e6", "key:0,0,0,0,x"}) {
    const auto edit = parseKeyEdit(word);
    ASSERT_FALSE(edit) << word;
    EXPECT_NE(edit.error().line().find("key:AZ,EL,TO_AZ,TO_EL,R[,G,B]"), std::string::npos) << word;
  }
}

}  // namespace lambent::spec
