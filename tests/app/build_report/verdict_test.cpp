#include "app/build_report/verdict.h"

#include <memory>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

namespace carousel::app {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class VerdictTest : public testing::Test {
 protected:
  VerdictTest() : before_(spdlog::default_logger()) {
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("verdict", std::make_shared<spdlog::sinks::ostream_sink_st>(log_)));
  }
  ~VerdictTest() override { spdlog::set_default_logger(before_); }

  static report::Report verified(std::uint64_t compared, std::uint64_t mismatches) {
    report::Report report;
    report.verify = report::Verify{compared, mismatches, ""};
    return report;
  }

  std::ostringstream log_;
  const std::shared_ptr<spdlog::logger> before_;
};

TEST_F(VerdictTest, DoneIsSilent) {
  EXPECT_EQ(verdict(report::Report{}), kDone);
  EXPECT_EQ(verdict(verified(100, 0)), kDone);
  EXPECT_THAT(log_.str(), IsEmpty());
}

TEST_F(VerdictTest, OneMismatchIsStatus1) {
  EXPECT_EQ(verdict(verified(100, 1)), 1);
  EXPECT_THAT(log_.str(), HasSubstr("[error] verification failed: 1 of 100 rays differ"));
}

TEST_F(VerdictTest, EffectsThatChangeSomethingAreStatus1) {
  report::Report report;
  report.shading.proof = report::EffectsProof{true, true, 0, 0, {}};
  EXPECT_EQ(verdict(report), kDone);
  report.shading.proof->same_image = false;
  EXPECT_EQ(verdict(report), 1);
  EXPECT_THAT(log_.str(), HasSubstr("with all effects the pixels differ"));
}

TEST_F(VerdictTest, FaultsThatChangeSomethingAreStatus1) {
  report::Report report;
  report.faults.emplace().same_hits = true;
  EXPECT_EQ(verdict(report), kDone);
  report.faults->same_hits = false;
  EXPECT_EQ(verdict(report), 1);
  EXPECT_THAT(log_.str(), HasSubstr("without faults hits or picture differ"));
}

TEST_F(VerdictTest, AnInterruptIsStatus130AndStillNamesMismatches) {
  report::Report report = verified(100, 3);
  report.incomplete = true;
  EXPECT_EQ(verdict(report), 130);
  EXPECT_THAT(log_.str(), HasSubstr("[warning] interrupted"));
  EXPECT_THAT(log_.str(), HasSubstr("3 of 100 rays differ"));
}

}  // namespace
}  // namespace carousel::app
