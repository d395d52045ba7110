#include "report/run/report_table.h"

#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/run/verdict_table.h"
#include "report/text/fit_lines.h"
#include "report/text/number_text.h"
#include "report/text/table_lines.h"
#include "tests/report/run/sample_report.h"

namespace carousel::report {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(ReportTable, SaysWhatHappened) {
  const std::string table = report_table(sample_report());
  EXPECT_THAT(table, HasSubstr("scene        cornell: 1,234,567 triangles, 5 instances   64 x 32 pixels, 4 samples\n"));
  EXPECT_THAT(table, HasSubstr("engine       native: 2 resources, ring on 4 threads, 2 shader workers\n"));
  EXPECT_THAT(table, HasSubstr("rays         1,000 emitted   990 completed   10 lost\n"));
  EXPECT_THAT(table,
              HasSubstr("raster       9 triangles seen 8 times by tiles   5 hits   3 left to rays   250.0 ms\n"));
  EXPECT_THAT(table, HasSubstr("tests        per ray: box 8.50   triangle 2.25   transform 1.00\n"));
  EXPECT_THAT(
      table, HasSubstr("cull planes  640 planes, 42.5 bytes a node, found in 125.0 ms   300 of 790 children culled\n"));
  EXPECT_THAT(table, HasSubstr("spared: 85 nodes   180 leaves of 605 triangles   35 transforms   30 boxes\n"));
  EXPECT_THAT(table, HasSubstr("25.0 % of the rays seen are local"));
  EXPECT_THAT(table, HasSubstr("link 7   slots 0"));
  EXPECT_THAT(table, HasSubstr("occupancy 2.0 mean, 11 most   7 refused"));
  EXPECT_THAT(table, HasSubstr("verify       990 rays traced again, 1 mismatches; pixel 3\n"));
  EXPECT_THAT(table, HasSubstr("digest       hits 0123   image 4567\n"));
  EXPECT_THAT(table, Not(HasSubstr("INCOMPLETE")));
}

TEST(ReportTable, HasLinesThatFitAScreen) {
  Report report = sample_report();
  report.bytes.emplace() = {{.what = "requests of ray data",
                             .from = "ray control",
                             .to = "resources",
                             .over = "load ports and wires of IDs",
                             .width = 32,
                             .bytes = 3'062'000}};
  report.heat.emplace().cycles_mean = 240'942;
  for (std::uint64_t i = 0; i < 3; ++i) report.heat->slowest.push_back({181 + i, 51, 6, 1'204'169, 9, 9, 9});
  report.links->front().utilisation = 0.25;
  report.links->back().utilisation = 0.997;
  const std::string table = report_table(report);
  EXPECT_THAT(table, HasSubstr("3092.9 a ray   from ray control to resources, 32 bytes a cycle\n")) << "990 rays";
  EXPECT_THAT(table, HasSubstr("slow pixels  181,51: 1,204,169 cycles of 6 rays   182,51: "));
  EXPECT_THAT(table, HasSubstr("240,942 a pixel\n"));
  EXPECT_THAT(table, HasSubstr("busiest from 1 to 0: 99.7 %\n"));
  for (std::size_t at = 0; at < table.size();) {
    const std::size_t end = table.find('\n', at);
    EXPECT_LE(columns_of(table.substr(at, end - at)), 120u) << table.substr(at, end - at);
    at = end + 1;
  }
}

TEST(ReportTable, SaysNothingOfPacketsWhereThereAreNone) {
  Report report = sample_report();
  report.packets->counts = {};
  report.collections->counts = {};
  for (Resource& r : *report.resources) r.counts.packets_issued = 0;
  const std::string table = report_table(report);
  for (const char* name : {"packets issued", "packets seen", "\npackets  ", "\ncollections  "})
    EXPECT_THAT(table, Not(HasSubstr(name)));
  EXPECT_THAT(table, HasSubstr("box tests"));
}

TEST(ReportTable, BreaksLongListsAtTheirItems) {
  Report report = sample_report();
  report.charges.emplace();
  for (int i = 0; i < 30; ++i) report.charges->push_back({fmt::format("charge_{}", i), "free"});
  Table table;
  wrapped_lines(table, "list", "aaa, bbb", ", ");
  EXPECT_EQ(table.take(), "list         aaa, bbb\n");
  const std::string text = report_table(report);
  const std::size_t at = text.find("not charged  charge_0, charge_1,");
  ASSERT_NE(at, text.npos);
  const std::string first = text.substr(at, text.find('\n', at) - at);
  EXPECT_LE(first.size(), 114u);
  EXPECT_EQ(first.back(), ',');
  for (int i = 0; i < 30; ++i) EXPECT_THAT(text, HasSubstr(fmt::format("charge_{}", i)));
}

TEST(ReportTable, BreaksALongVerdictAtItsClasses) {
  Bottleneck found;
  found.verdict =
      "ray_slots: twice rays.slots_per_resource gains +22.0 % (+1.3 to +42.7 %); not to be told apart from it: "
      "memory_latency with +13.7 % (-1.7 to +13.7 %), fetch_ahead with +13.7 % (-1.7 to +13.7 %), shape_buffer with "
      "+13.7 % (-1.7 to +13.7 %) and 13 more";
  const std::string text = verdict_table(found);
  EXPECT_THAT(text, HasSubstr("bottleneck   ray_slots: twice rays.slots_per_resource gains +22.0 % (+1.3 to +42.7 %)\n"
                              "             not to be told apart from it: memory_latency with "));
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    EXPECT_LE(end - at, 120u) << text.substr(at, end - at);
    at = end + 1;
  }
}

// The last row is a packet process, which issues for the resource that it serves.
TEST(ReportTable, LeavesPacketProcessesOutOfTheResources) {
  Report report = sample_report();
  ASSERT_EQ(report.resources->size(), 2U);
  report.config["topology"] = {{"shape", "graph"},
                               {"nodes", {{{"kind", "resource"}}, {{"kind", "packet_process"}, {"serves", "r"}}}}};
  for (const bool serves : {true, false}) {
    (*report.resources)[0].counts = {.rays_completed = 500, .local_rays = 700};
    (*report.resources)[1].counts = {.packets_issued = 90};
    if (!serves) report.config["topology"]["nodes"][1].erase("serves");
    const std::string table = report_table(report);
    const std::size_t at = table.find("resources    ");
    ASSERT_NE(at, std::string::npos);
    EXPECT_EQ(table.compare(at, 22, serves ? "resources    1 of them" : "resources    2 of them"), 0) << table;
    const auto line = [&](const char* name, const char* least) { return fmt::format("{:<18} {:>14}", name, least); };
    EXPECT_THAT(table.substr(at), HasSubstr(line("rays", serves ? "500" : "0")));
    EXPECT_THAT(table.substr(at), HasSubstr(line("packets issued", serves ? "90" : "0")));
  }
}

TEST(ReportTable, SaysWhatFaultsCost) {
  Report report = sample_report();
  report.rays.restarted = 1234;
  report.rays.paths_restarted = 500;
  report.faults.emplace().stop = Stop{1, 3, 100, 200, 5100};
  report.faults->cycles_without = 90'000;
  report.faults->cycles_lost = 7000;
  report.faults->same_hits = true;
  const std::string table = report_table(report);
  EXPECT_THAT(table, HasSubstr("10 lost   1,234 restarted of 500 paths, 5,000 cycles after a resource stopped\n"));
  EXPECT_THAT(table, HasSubstr("faults       cost 7000 cycles: 90,000 without them, the same hits and picture\n"));
  report.faults->same_hits = false;
  EXPECT_THAT(report_table(report), HasSubstr("OTHER HITS OR ANOTHER PICTURE"));
}

TEST(ReportTable, StandsWithTheLeastThereIs) {
  Report report;
  report.incomplete = true;
  const std::string table = report_table(report);
  EXPECT_THAT(table, HasSubstr("INCOMPLETE"));
  EXPECT_THAT(table, Not(HasSubstr("nan")));
}

TEST(NumberText, ReadsWell) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1000), "1,000");
  EXPECT_EQ(grouped(1234567890), "1,234,567,890");
  EXPECT_EQ(bytes_text(512), "512 B");
  EXPECT_EQ(bytes_text(1536), "1.5 KiB");
  EXPECT_EQ(bytes_text(64ull << 30), "64 GiB");
  EXPECT_EQ(seconds_text(0.0123), "12.3 ms");
  EXPECT_EQ(seconds_text(185), "3 min 5 s");
  EXPECT_EQ(scaled(950), "950");
  EXPECT_EQ(scaled(1234567), "1.23 M");
  EXPECT_EQ(percent(0.125), "12.5 %");
}

TEST(NumberText, FloatsReadBackToTheSameBits) {
  EXPECT_EQ(float_text(0.1f), "0.1");
  EXPECT_EQ(float_text(-0.0f), "-0");
  EXPECT_EQ(float_text(std::numeric_limits<float>::infinity()), "inf");
  EXPECT_EQ(float_text(-std::numeric_limits<float>::quiet_NaN()), "nan");
}

}  // namespace
}  // namespace carousel::report
