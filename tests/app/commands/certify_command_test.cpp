#include <bit>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/accuracy/case_text.h"
#include "app/accuracy/certificate.h"
#include "core/types/ray.h"
#include "tests/app/support/program.h"
#include "tests/support/random_runs.h"

namespace carousel::certify_command_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::string seed() {
  return std::to_string(run_seed());
}

// Cases that plain boxes, fast triangles, the inverse matrix and a constant offset get wrong, and the next level right.
const char* const kPlainBox =
    "box plain origin=-0x1.38dfap+5,-0x1.458098p+6,-0x1.2bb88cp+7 direction=0x1.dac1b2p+2,0x1.79e40ap+2,0x1.9bc592p+3 "
    "tmin=0x0p+0 tmax=inf lo=0x1.43c37ap+4,-0x1.111e1p+5,-0x1.77570cp+5 hi=0x1.43c424p+4,-0x1.111d26p+5,-0x1.775438p+5";
const char* const kFastTriangle =
    "triangle fast origin=-0x1.8aa1b4p+17,0x1.0ef176p+32,-0x1.303ee2p+25 direction=-0x1.b92efp+89,-0x1.7ec87ap+38,"
    "0x1.de25a6p+87 tmin=0x0p+0 tmax=inf a=-0x1.41af4ap+92,-0x1.fc7732p-96,0x1.5ca2fp+90 b=-0x1.a7acc8p+21,"
    "-0x1.e8eb22p+38,0x1.3ae7cep-6 c=-0x1.a2a60ap+65,-0x1.f84b68p-68,-0x1.4b48c6p-87";
const char* const kInverseMatrix =
    "transform inverse_matrix "
    "linear=0x1.f8f7cap-1,-0x1.42fedep-4,0x1.2938acp-3,0x1.66f188p-4,0x1.fd3fdep-1,-0x1.c35efp-5,"
    "-0x1.1eb9fp-3,0x1.12adaap-4,0x1.f9cb16p-1 translation=0x1.9be346p-4,-0x1.02c11cp+4,0x1.303e64p+3 "
    "point=0x1.9be34cp-4,-0x1.02c12p+4,0x1.303e6p+3 direction=-0x1.ef9ab6p+6,0x1.1cbe82p+7,0x1.95f7cp+9";
const char* const kEpsilonSpawn =
    "spawn epsilon/two_step "
    "linear=-0x1.48e082p+1,-0x1.54337ap-1,0x1.e0ea26p-1,-0x1.0081ccp-1,-0x1.0c4762p+0,-0x1.a5231ap-1,"
    "0x1.155a44p+2,-0x1.07bab2p-1,0x1.d8e24ap-2 translation=-0x1.7fba18p+12,-0x1.cb3c2cp+9,0x1.801302p+15 "
    "a=0x1.8191a6p+1,0x1.221666p+1,-0x1.37b0e2p+2 b=0x1.d86234p+0,0x1.d26f9ep+1,-0x1.26fccp+2 c=-0x1.377cfcp+1,"
    "-0x1.51df44p+2,0x1.0450bp+1 u=0x1.881848p-2 v=0x1.7382cp-3 direction=-0x1.05803ep-2,-0x1.d4793ap-4,0x1.eb8c36p-1";

std::string with_level(std::string text, const std::string& level, const std::string& other) {
  return text.replace(text.find(level), level.size(), other);
}

const json& row(const json& certificate, const std::string& property, const std::string& level) {
  for (const json& r : certificate.at("properties"))
    if (r.at("property") == property && r.at("level") == level) return r;
  throw std::runtime_error(property + " " + level + " is missing");
}

TEST(CertifyCommand, FindsNoViolationAndAsksEveryProperty) {
  const Program program;
  const Outcome outcome = program.run({"accuracy", "--certify", "--cases", "6000", "--seed", seed(), "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.out;
  const json certificate = json::parse(outcome.out);
  EXPECT_EQ(certificate.at("violations"), 0);
  EXPECT_EQ(certificate.at("cases"), 6000);
  EXPECT_EQ(certificate.at("incomplete"), false);
  EXPECT_EQ(certificate.at("properties").size(), 3u + 3 + 4 + 4 + 12 + 4 + 4 + 4 + 12);
  for (const json& r : certificate.at("properties")) EXPECT_GT(r.at("cases").get<int>(), 1000) << r;
  // The corpus is hard: levels that promise nothing do fail.
  for (const auto& [property, level] :
       {std::pair{"box", "plain"}, std::pair{"triangle", "fast"}, std::pair{"distance", "fast"},
        std::pair{"closed_mesh", "fast/conservative"}, std::pair{"placed_mesh", "inverse_matrix"},
        std::pair{"transform", "inverse_matrix"}, std::pair{"spawn", "epsilon/two_step"}}) {
    const json& r = row(certificate, property, level);
    EXPECT_EQ(r.at("promised"), false);
    EXPECT_GT(r.at("broken").get<int>(), 5) << r;
    EXPECT_EQ(program.run({"accuracy", "--reproduce", r.at("reproduce")}).status, 1) << r;
  }
}

TEST(CertifyCommand, AConfigurationChoosesTheLevel) {
  const Program program;
  program.write("c.yaml", "scene: {builtin: cornell}\naccuracy: {triangle: exact, box: double, spawn: ulp}\n");
  const Outcome outcome =
      program.run({"accuracy", "c.yaml", "--certify", "--cases", "200", "--set", "accuracy.transform=two_step_double"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  for (const char* part : {"closed_mesh   exact/double ", "spawn         ulp/two_step_double ", "0 violations"})
    EXPECT_THAT(outcome.out, HasSubstr(part));
  for (const char* part : {"plain", "watertight", "epsilon"}) EXPECT_THAT(outcome.out, Not(HasSubstr(part)));
}

TEST(CertifyCommand, SecondsEndIt) {
  const Outcome outcome = Program().run({"accuracy", "--certify", "--seconds", "0.2", "--json"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_GT(json::parse(outcome.out).at("cases").get<int>(), 100);
}

TEST(Certificate, IsTheSameForAnyNumberOfThreads) {
  const auto counts = [](Executor& executor, std::uint64_t seed) {
    std::vector<double> all;
    for (const app::PropertyResult& result :
         app::certify(seed, {3001, 0}, std::nullopt, executor, [] { return false; }).properties)
      for (const app::LevelResult& level : result.levels)
        all.insert(all.end(), {double(level.cases), double(level.broken), level.worst_error,
                               double(level.first_broken.value_or(0))});
    return all;
  };
  const std::vector<double> one = counts(*make_sequential_executor(), 7);
  EXPECT_EQ(one, counts(*make_jthread_executor(3), 7));
  EXPECT_EQ(one, counts(*make_tbb_executor(2), 7));
  EXPECT_NE(one, counts(*make_sequential_executor(), 8));
}

TEST(ReproduceCommand, SaysWhetherTheCaseIsStillBroken) {
  const Program program;
  struct Known {
    const char *text, *level, *right;
  };
  for (const auto& [text, level, right] :
       {Known{kPlainBox, "plain", "conservative"}, Known{kFastTriangle, "fast", "exact"},
        Known{kInverseMatrix, "inverse_matrix", "two_step"}, Known{kEpsilonSpawn, "epsilon", "bound"}}) {
    const Outcome broken = program.run({"accuracy", "--reproduce", text});
    EXPECT_EQ(broken.status, 1) << text << broken.err;
    for (const char* part : {"level says", "exactly", "\nbroken"}) EXPECT_THAT(broken.out, HasSubstr(part));
    const Outcome holds = program.run({"accuracy", "--reproduce", with_level(text, level, right)});
    EXPECT_EQ(holds.status, 0) << holds.out;
    EXPECT_THAT(holds.out, HasSubstr("\nholds\n"));
  }
  EXPECT_THAT(program.run({"accuracy", "--reproduce", kPlainBox}).out,
              HasSubstr("level says   missed\nexactly      met, entered at 8"));
}

TEST(ReproduceCommand, ReadsFilesAndWritesJson) {
  const Program program;
  const std::string good = with_level(kPlainBox, "plain", "double");
  program.write("good.txt", "# a comment\n\n" + good + "\n");
  EXPECT_EQ(program.run({"accuracy", "--reproduce", "good.txt"}).status, 0);
  program.write("both.txt", good + "\n" + kEpsilonSpawn);
  const Outcome outcome = program.run({"accuracy", "--reproduce", "both.txt", "--json"});
  EXPECT_EQ(outcome.status, 1);
  const json replay = json::parse(outcome.out);
  EXPECT_EQ(replay.at("cases").at(0).at("reproduce"), good);
  EXPECT_EQ(replay.at("cases").at(0).at("broken"), false);
  EXPECT_EQ(replay.at("cases").at(1).at("reproduce"), kEpsilonSpawn);
  EXPECT_EQ(replay.at("cases").at(1).at("broken"), true);
}

TEST(ReproduceCommand, SaysWhatIsWrongWithAText) {
  const Program program;
  program.write("bad.txt", "# first\nbox plain origin=1,2\n");
  program.write("none.txt", "# nothing\n");
  const std::string box = kPlainBox;
  struct Bad {
    std::string text, message;
  };
  for (const Bad& bad : std::vector<Bad>{
           {"bax plain",
            "--reproduce:1:1: expected a property or a file that holds cases (box, nested_boxes, triangle, "
            "distance, closed_mesh, placed_mesh, "
            "transform, world_box, spawn), found \"bax\"; did you mean box?"},
           {"box", "--reproduce:1:4: expected a level (plain, conservative, double), found the end"},
           {"box plian",
            "--reproduce:1:5: expected a level (plain, conservative, double), found \"plian\"; did you mean plain?"},
           {"box plain direction=1,2,3", "--reproduce:1:11: expected origin=NUMBER,..., found \"direction=1,2,3\""},
           {"box plain origin=1,2,,3", "--reproduce:1:22: origin: expected a float such as 0x1.8p+1, found the end"},
           {"box plain origin=1,2,0x1.8q",
            "--reproduce:1:22: origin: expected a float such as 0x1.8p+1, found \"0x1.8q\""},
           {"box plain origin=1,2,1e99", "origin: expected a float such as 0x1.8p+1, found \"1e99\""},
           {"box plain origin=1,2,inff", "found \"inff\""},
           {"box plain origin=1,2,3,4", "--reproduce:1:11: origin: expected 3 numbers, found 4"},
           {box + " more", "expected the end, found \"more\""},
           {box.substr(0, box.find(" hi=")), "expected hi=NUMBER,..., found the end"},
           {"closed_mesh exact/plain origin=0,0,0 direction=1,0,0 tmin=0 tmax=inf apex=0,0,1 nadir=0,0,-1 "
            "ring=1,0,0,0,1,0",
            "ring: expected 9 to 24 numbers, three a point, found 6"},
           {"bad.txt", "bad.txt:2:11: origin: expected 3 numbers, found 2"},
           {"none.txt", "none.txt: expected a case, found none"}}) {
    const Outcome outcome = program.run({"accuracy", "--reproduce", bad.text});
    EXPECT_EQ(outcome.status, 2) << bad.text;
    EXPECT_THAT(outcome.err, HasSubstr(bad.message));
    EXPECT_THAT(outcome.out, IsEmpty());
  }
}

void expect_same_bits(const accel::CaseValues& a, const accel::CaseValues& b, const std::string& text) {
  ASSERT_EQ(a.size(), b.size()) << text;
  for (std::size_t i = 0; i < a.size(); ++i)
    ASSERT_EQ(std::bit_cast<std::uint32_t>(a[i]), std::bit_cast<std::uint32_t>(b[i])) << text << " number " << i;
}

TEST(CaseText, ReadsBackToTheSameBits) {
  const std::vector<accel::Property>& properties = app::certified_properties();
  for (const accel::Property& property : properties) {
    const std::vector<AccuracyConfig> levels = levels_of(property);
    for (std::uint64_t number = 0; number < 500; ++number) {
      const AccuracyConfig& level = levels[number % levels.size()];
      const accel::CaseValues values = app::certificate_case(property, run_seed(), number);
      const std::string text = app::case_text(property, level, values);
      const app::CertificateCase read = app::parse_case(text, properties, {});
      EXPECT_EQ(read.property, &property);
      EXPECT_EQ(level_name(property, read.level), level_name(property, level));
      expect_same_bits(values, read.values, text);
    }
  }
  using Limits = std::numeric_limits<float>;
  const float strange[] = {0.0f,
                           -0.0f,
                           Limits::denorm_min(),
                           -Limits::denorm_min(),
                           Limits::min(),
                           Limits::max(),
                           Limits::lowest(),
                           Limits::infinity(),
                           -Limits::infinity(),
                           std::nextafter(1.0f, 2.0f),
                           -0x1.fffffcp-127f,
                           0.1f};
  accel::CaseValues values(14);
  for (std::size_t i = 0; i < 200; ++i) {
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = strange[(i * 7 + k * (i + 1)) % std::size(strange)];
    const std::string text = app::case_text(properties[0], {}, values);
    expect_same_bits(values, app::parse_case(text, properties, {}).values, text);
  }
}

// Anything that can be written down is judged without a crash, and promises nothing it cannot keep.
TEST(Certificate, JudgesAnyNumbers) {
  const float strange[] = {0.0f,
                           -0.0f,
                           1.0f,
                           -1.0f,
                           kInfinity,
                           -kInfinity,
                           std::numeric_limits<float>::max(),
                           -std::numeric_limits<float>::max(),
                           std::numeric_limits<float>::denorm_min(),
                           0x1p-80f,
                           0x1p80f,
                           3.0f};
  for (const accel::Property& property : app::certified_properties()) {
    const std::vector<AccuracyConfig> levels = levels_of(property);
    for (std::uint64_t number = 0; number < 2000; ++number) {
      accel::CaseRandom random(run_seed(), 1000 + property.number, number);
      accel::CaseValues values = app::certificate_case(property, run_seed(), number);
      for (float& x : values)
        if (random.below(4) == 0) x = strange[random.below(std::size(strange))];
      std::vector<accel::Judgement> out(levels.size());
      accel::CaseStory story;
      property.judge(values, levels, out, &story);
      // The others' bounds hold for numbers that are not near the ends of the floats.
      if (property.name == "closed_mesh" || property.name == "placed_mesh" || property.name == "transform" ||
          property.name == "spawn")
        continue;
      for (std::size_t l = 0; l < levels.size(); ++l)
        EXPECT_FALSE(out[l].broken && property.promised(levels[l])) << app::case_text(property, levels[l], values);
    }
  }
}

}  // namespace
}  // namespace carousel::certify_command_test
