#include "report/text/singular.h"

#include <gtest/gtest.h>

namespace carousel::report {
namespace {

TEST(Singular, IsTheNounBehindAOne) {
  EXPECT_EQ(singular("1 structures, 1 strips deep   1 inner nodes of 8.0 children   1 leaves"),
            "1 structure, 1 strip deep   1 inner node of 8.0 children   1 leaf");
  EXPECT_EQ(singular("scene        (1 misses\n1 meshes"), "scene        (1 miss\n1 mesh");
  EXPECT_EQ(singular("1 caches, 1 memories, 1 branches"), "1 cache, 1 memory, 1 branch");
}

TEST(Singular, LeavesOtherNumbersUnitsAndWordsAlone) {
  for (const char* text : {"11 rays", "0.1 rays", "1.0 rays", "2 rays", "1 ms", "1 krays/s", "1 per ray", "x1 rays",
                           "1", "1 ", "1 at_nodes", "1 cars: 4 triangles", ""})
    EXPECT_EQ(singular(text), text);
}

}  // namespace
}  // namespace carousel::report
