// A document of ours with any contents is either refused with a message or read, and what was read can be shown.
#include <iostream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/system/error.h"
#include "tests/report/read/sample_documents.h"
#include "tests/report/read/show_document.h"
#include "tests/support/random_runs.h"

namespace carousel::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kScript = "'\"></script><script>planted()</script>";

/// SplitMix64 (G. Steele, D. Lea, C. Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15) {}
  std::size_t below(std::size_t n) {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return static_cast<std::size_t>((z ^ (z >> 31)) % n);
  }

 private:
  std::uint64_t state_;
};

void collect(Json& value, std::vector<Json*>& all) {
  all.push_back(&value);
  if (value.is_structured())
    for (Json& child : value) collect(child, all);
}

Json random_value(Random& random, const std::vector<Json*>& all) {
  static const Json kOdd[] = {nullptr,
                              true,
                              "",
                              kScript,
                              -1,
                              0,
                              1,
                              2,
                              1000000,
                              4294967296,
                              9007199254740991,
                              18446744073709551615u,
                              -9223372036854775807,
                              -0.5,
                              1e308,
                              -1e308,
                              1e-308,
                              0.5,
                              Json::array(),
                              Json::object(),
                              Json::array({Json::object()}),
                              Json::array({1, 2}),
                              {{"units", {{"box", 1}}}}};
  if (random.below(3) == 0) return *all[random.below(all.size())];
  return kOdd[random.below(std::size(kOdd))];
}

/// A value of the same type, so that the schema takes it more often than not.
Json like(const Json& value, Random& random) {
  static const double kReals[] = {0, 1, -1, 0.5, 1e15, 1e19, 1e300, -1e300, 1e-300, -0.0};
  static const std::uint64_t kCounts[] = {0, 1, 2, 3, 1000, 4294967295, 4294967296, 9007199254740991};
  if (value.is_string()) return random.below(2) == 0 ? Json(kScript) : Json("");
  if (value.is_boolean()) return !value.get<bool>();
  if (value.is_number_integer()) return kCounts[random.below(std::size(kCounts))];
  if (value.is_number()) return kReals[random.below(std::size(kReals))];
  if (value.is_array() && !value.empty()) {
    Json out = value;
    if (random.below(2) == 0)
      out.erase(random.below(out.size()));
    else
      out.push_back(out[random.below(out.size())]);
    return out;
  }
  return value;
}

Json changed(const Json& good, Random& random) {
  Json mutant = good;
  for (std::size_t n = 1 + random.below(3); n > 0; --n) {
    std::vector<Json*> all;
    collect(mutant, all);
    Json& target = *all[random.below(all.size())];
    if (target.is_structured() && !target.empty() && random.below(4) == 0) {
      target.erase(std::next(target.begin(), static_cast<std::ptrdiff_t>(random.below(target.size()))));
    } else {
      Json value = random.below(2) == 0 ? like(target, random) : random_value(random, all);
      target = std::move(value);
    }
  }
  return mutant;
}

std::string changed_text(std::string text, Random& random) {
  for (std::size_t n = 1 + random.below(4); n > 0 && !text.empty(); --n) {
    const std::size_t at = random.below(text.size());
    if (random.below(2) == 0)
      text[at] = static_cast<char>(random.below(256));
    else
      text.erase(at, 1 + random.below(8));
  }
  return text;
}

TEST(DocumentMutation, IsShownOrRefused) {
  const std::vector<SampleDocument> samples = sample_documents();
  const int each = scaled(40, 20);
  int read = 0;
  for (const SampleDocument& sample : samples) {
    for (int i = 0; i < each; ++i) {
      const std::uint64_t seed = run_seed() + static_cast<std::uint64_t>(i);
      SCOPED_TRACE(std::string(sample.name) + ", CAROUSEL_SEED=" + std::to_string(seed));
      Random random(seed);
      // A checksum would refuse every change; without it the shape alone decides.
      Json json = changed(sample.json, random);
      if (sample.kind == DocumentKind::kPoint && json.is_object()) json = sealed(json);
      std::string text = json.dump();
      if (i % 4 == 0) text = changed_text(text, random);
      try {
        const std::string page = show_document(parse_document(text, "mutant.json"), samples[1].json);
        EXPECT_EQ(page.find("<script>planted"), page.npos);
        ++read;
      } catch (const FileError& error) {
        EXPECT_THAT(error.what(), testing::StartsWith("mutant.json: "));
      }
    }
  }
  const int all = each * static_cast<int>(samples.size());
  EXPECT_GT(read, all / 20) << "the mutants test nothing but the reader";
  std::cout << all << " mutants of documents, " << read << " read\n";
}

}  // namespace
}  // namespace carousel::report
