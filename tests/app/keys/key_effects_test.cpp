// Every value of every key does something on a machine that the table of rows names, or is refused by name. The
// machines are read from files by the program's own loader and run as `carousel run` runs them. A key without a row
// fails.
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/config/not_built.h"
#include "core/config/schema.h"
#include "core/system/error.h"
#include "tests/app/keys/key_rows.h"
#include "tests/app/keys/key_runs.h"

namespace carousel::key_effects_test {
namespace {

using Json = KeyOutcome::Json;

class KeyEffects : public KeyRuns {
 protected:
  void check(const KeyRow& row) {
    SCOPED_TRACE(row.key + " of " + text(row.machine) + testing::PrintToString(row.sets));
    const auto [at, first] = bases_.try_emplace({row.machine, row.sets});
    KeyOutcome& base = at->second;
    if (first) {
      base = run(row.machine, row.sets);
      ASSERT_EQ(base.refusal, "");
      ASSERT_EQ(run(row.machine, row.sets).result, base.result) << "two runs differ";
    }
    const std::string own = value_at(base.config, row.key);
    for (const std::string& value : values_of(row)) {
      if (value == own) {
        EXPECT_TRUE(row.values.empty()) << value << " is the machine's own value";
        continue;
      }
      std::vector<std::string> sets = row.sets;
      sets.push_back(row.key + "=" + value);
      sets.insert(sets.end(), row.with.begin(), row.with.end());
      const KeyOutcome other = run(row.machine, sets);
      if (other.refusal.empty())
        EXPECT_NE(other.result, base.result) << value << " does nothing";
      else
        EXPECT_TRUE(may_be_refused(row, value, base.config, other.refusal)) << other.refusal;
    }
  }

 private:
  static std::string value_at(const Json& config, const std::string& key) {
    const Json::json_pointer at("/" + [&] {
      std::string path = key;
      std::replace(path.begin(), path.end(), '.', '/');
      return path;
    }());
    if (!config.contains(at)) return "";
    return config[at].is_string() ? config[at].get<std::string>() : config[at].dump();
  }

  /// By the table of what the engine does not have; an instruction set that this machine does not have;
  /// ranks, which mpirun starts; less memory than the program has; and fewer hits than a ray has, which only tracing
  /// tells.
  static bool may_be_refused(const KeyRow& row, const std::string& value, const Json& config,
                             const std::string& refusal) {
    if (row.key == "rays.hits_per_ray") return refusal.starts_with(row.key + ": ");
    if (refusal.find("--set " + row.key + "=" + value + ": " + row.key + ": ") == refusal.npos) return false;
    if (row.key == "engine.simd" || row.key == "engine.transport" || row.key == "scene.placement") return true;
    if (row.key == "engine.memory_limit_mib") return true;
    const auto having = config::engines_with(row.key, value);
    const auto engine = enum_value<EngineKind>(config["engine"]["kind"].get<std::string>());
    return having.empty() && engine && refusal.find("is not built yet") != refusal.npos;
  }

  std::map<std::pair<BaseMachine, std::vector<std::string>>, KeyOutcome> bases_;
};

const std::vector<std::string> kScene{"scene.",  "camera.",   "image.", "engine.",  "primary",
                                      "report.", "sampling.", "verify", "workload."};
const std::vector<std::string> kMachine{"topology.", "frames.",      "clocks.", "prefetcher.", "rays.",
                                        "packets.",  "collections.", "memory.", "shading.",    "faults.",
                                        "energy.",   "area.",        "raster."};
const std::vector<std::string> kTests{"bvh.",     "accuracy.",   "cull_planes.", "bundles.",
                                      "testers.", "primitives.", "programs."};

bool is_of(const std::string& key, const std::vector<std::string>& sections) {
  return std::any_of(sections.begin(), sections.end(),
                     [&](const std::string& section) { return key.starts_with(section); });
}

TEST(KeyRows, AreThereForEveryKeyAndNoOther) {
  std::set<std::string> with_row;
  for (const KeyRow& row : key_rows()) {
    with_row.insert(row.key);
    EXPECT_EQ(is_of(row.key, kScene) + is_of(row.key, kMachine) + is_of(row.key, kTests), 1) << row.key;
  }
  for (const std::string& key : keys_without_a_row()) EXPECT_TRUE(with_row.insert(key).second) << key;
  const std::vector<std::string> keys = key_leaves();
  EXPECT_EQ(std::set<std::string>(keys.begin(), keys.end()), with_row);
}

TEST(KeyRows, AreThereForEveryNameOfAnEnumeration) {
  const std::vector<std::string> without = keys_without_a_row();
  for (const std::string& key : key_leaves()) {
    if (std::find(without.begin(), without.end(), key) != without.end()) continue;
    const std::vector<std::string> names = config::enum_values(key);
    std::set<std::string> tried;
    for (const KeyRow& row : key_rows()) {
      if (row.key != key) continue;
      const std::vector<std::string>& values = row.values.empty() ? names : row.values;
      tried.insert(values.begin(), values.end());
      for (const std::string& set : row.sets)
        if (set.starts_with(key + "=")) tried.insert(set.substr(key.size() + 1));
    }
    for (const std::string& name : names) EXPECT_TRUE(tried.contains(name)) << key << ": " << name;
  }
}

TEST_F(KeyEffects, SceneImageAndEngine) {
  for (const KeyRow& row : key_rows())
    if (is_of(row.key, kScene)) check(row);
}

TEST_F(KeyEffects, TheMachine) {
  for (const KeyRow& row : key_rows())
    if (is_of(row.key, kMachine)) check(row);
}

TEST_F(KeyEffects, TheTests) {
  for (const KeyRow& row : key_rows())
    if (is_of(row.key, kTests)) check(row);
}

}  // namespace
}  // namespace carousel::key_effects_test
