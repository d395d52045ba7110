// Every configuration of configs/ and its folders is the same machine when its network is drawn, to the last number.
#include <filesystem>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/app/support/example_configs.h"
#include "tests/app/support/program.h"
#include "tests/app/support/same_machine.h"

namespace carousel::drawn_configs_test {
namespace {

/// The text with another section `topology`.
std::string with_topology(const std::string& text, const std::string& topology) {
  std::istringstream in(text);
  std::string out;
  bool inside = false;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty() && line.front() != ' ') inside = line.starts_with("topology:");
    if (!inside) out += line + "\n";
  }
  return out + topology;
}

class DrawnConfigs : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(DrawnConfigs, AreTheSameMachines) {
  const Program program;
  const std::string file = GetParam().string();
  const auto run = [&](std::vector<std::string> arguments) {
    add_sets(arguments, small_picture());
    arguments.insert(arguments.end(), {"--set", "scene.triangles=300"});
    if (has_traffic(GetParam())) arguments.insert(arguments.end(), {"--set", "workload.traffic.packets=1000"});
    return program.run(arguments);
  };
  const Outcome drawn = run({"check", file, "--graph"});
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  const Outcome shape = run({"run", file, "--quiet", "--no-html", "--out", "shape"});
  ASSERT_EQ(shape.status, 0) << shape.err;
  program.write("graph.yaml", with_topology(program.read("shape/config.resolved.yaml"), drawn.out));
  const Outcome graph = program.run({"run", "graph.yaml", "--quiet", "--no-html", "--out", "graph"});
  ASSERT_EQ(graph.status, 0) << graph.err << drawn.out;
  const auto one = results_of(program, "shape"), two = results_of(program, "graph");
  if (one["engine"]["kind"] == "native")  // whose times are the host's
    EXPECT_EQ(one["digest"], two["digest"]);
  else
    EXPECT_EQ(one, two) << drawn.out;
}

INSTANTIATE_TEST_SUITE_P(All, DrawnConfigs, testing::ValuesIn(example_configs()), example_name);

}  // namespace
}  // namespace carousel::drawn_configs_test
