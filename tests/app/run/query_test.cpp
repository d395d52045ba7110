// The hits that rays of a file look for, on both engines, as a user asks for them.
#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/support/program.h"

namespace carousel::query_test {
namespace {

/// By row of hits.csv: kind, hit, and t.
std::vector<std::vector<std::string>> hit_rows(const std::string& csv) {
  std::istringstream in(csv);
  std::vector<std::vector<std::string>> out;
  std::vector<std::size_t> wanted;
  for (std::string line; std::getline(in, line);) {
    std::vector<std::string> cells;
    std::istringstream columns(line);
    for (std::string cell; std::getline(columns, cell, ',');) cells.push_back(cell);
    if (wanted.empty()) {
      for (const char* name : {"kind", "hit", "t"})
        wanted.push_back(static_cast<std::size_t>(std::find(cells.begin(), cells.end(), name) - cells.begin()));
      continue;
    }
    auto& row = out.emplace_back();
    for (const std::size_t column : wanted) row.push_back(column < cells.size() ? cells[column] : "");
  }
  return out;
}

TEST(Query, AnyFindsAHitWhereThereIsAClosestOne) {
  Program program;
  std::string rays = "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n";
  for (int i = 0; i < 60; ++i)  // from before the box: half of them pass it by
    rays += fmt::format("{},camera,{},1,5,{},0,-1,0,inf\n", i, 0.02 * i - 0.6, 0.02 * (i - 30));
  program.write("rays.csv", rays);
  const auto hits = [&](const std::string& engine, const std::string& query) {
    const Outcome outcome = program.run({"run", "rays.yaml", "--hits", "--out", "out", "--force", "--quiet", "--set",
                                         "engine.kind=" + engine, "--set", "rays.query=" + query});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return hit_rows(program.read("out/hits.csv"));
  };
  program.write(
      "rays.yaml",
      "scene: {builtin: cornell}\nworkload: {rays_from: rays.csv}\ntopology: {resources: 3}\nverify: reference\n");
  const auto closest = hits("cycle", "closest");
  ASSERT_EQ(closest.size(), 60u);
  for (const std::string engine : {"cycle", "native"}) {
    const auto any = hits(engine, "any");
    ASSERT_EQ(any.size(), closest.size());
    int found = 0;
    for (std::size_t i = 0; i < any.size(); ++i) {
      EXPECT_EQ(any[i][0], "shadow");
      EXPECT_EQ(any[i][1], closest[i][1]) << "ray " << i;
      found += any[i][1] == "1";
    }
    EXPECT_GT(found, 5);
    EXPECT_LT(found, 60);
  }
  program.write("picture.yaml", "scene: {builtin: cornell}\n");
  const Outcome refused = program.run({"run", "picture.yaml", "--set", "rays.query=any"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, testing::HasSubstr("expected closest, or workload: {rays_from: FILE}"));
}

}  // namespace
}  // namespace carousel::query_test
