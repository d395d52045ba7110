#include "core/numeric/student.h"

#include <utility>

#include <gtest/gtest.h>

namespace carousel {
namespace {

// The rows of R. A. Fisher, "Statistical methods for research workers", 1925, Table IV, P = 0.05.
TEST(Student, IsThatOfThePrintedTable) {
  for (const auto& [freedom, t] : {std::pair{1.0, 12.706}, {2.0, 4.303}, {4.0, 2.776}, {10.0, 2.228}, {30.0, 2.042}})
    EXPECT_NEAR(student_95(freedom), t, 6e-4) << freedom;
}

}  // namespace
}  // namespace carousel
