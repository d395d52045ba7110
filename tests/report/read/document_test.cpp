#include "report/read/document.h"

#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/system/error.h"
#include "report/read/schema_check.h"
#include "report/read/strict_json.h"
#include "tests/report/read/sample_documents.h"
#include "tests/report/read/show_document.h"

namespace carousel::report {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;
using testing::StartsWith;

/// The message that refuses a text; empty if it is read.
std::string refusal(const std::string& text) {
  try {
    parse_document(text, "file.json");
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

/// The message that refuses the run of the cycle engine after a change.
std::string refusal_of_run(const std::function<void(Json&)>& change) {
  Json json = sample_documents()[0].json;
  change(json);
  return refusal(sealed(json).dump());
}

TEST(DocumentReader, TakesEveryKindAsItIsWritten) {
  for (const SampleDocument& sample : sample_documents()) {
    const Document document = parse_document(json_text(sealed(sample.json)), "file.json");
    EXPECT_EQ(document.kind, sample.kind) << sample.name;
    EXPECT_EQ(document.json, sample.json) << sample.name;
    EXPECT_FALSE(show_document(document, sample_documents()[1].json).empty()) << sample.name;
  }
}

TEST(DocumentReader, ChecksEveryKeywordOfItsSchema) {
  EXPECT_TRUE(is_checked_in_full(report_schema()));
  EXPECT_FALSE(is_checked_in_full({{"type", "string"}, {"pattern", "a"}}));
  EXPECT_FALSE(is_checked_in_full({{"type", "array"}, {"items", {{"oneOf", Json::array()}}}}));
}

TEST(DocumentReader, NamesTheFileThePathAndWhatWasFound) {
  const auto links = [](Json value) { return refusal_of_run([&](Json& json) { json["links"] = std::move(value); }); };
  EXPECT_THAT(links({Json::object()}), StartsWith("file.json: links[0].from: expected a whole number, found nothing"));
  EXPECT_THAT(links("many"), StartsWith("file.json: links: expected a list, found 'many'"));
  EXPECT_THAT(refusal_of_run([](Json& json) { json["links"][1]["utilisation"] = "high"; }),
              StartsWith("file.json: links[1].utilisation: expected a number, found 'high'"));
  EXPECT_THAT(refusal_of_run([](Json& json) { json["links"][0]["packets"] = -1; }),
              StartsWith("file.json: links[0].packets: expected at least 0, found -1"));
  EXPECT_THAT(refusal_of_run([](Json& json) { json["links"][0]["packets"] = 1e30; }),
              StartsWith("file.json: links[0].packets: expected a whole number, found 1e+30"));
  EXPECT_THAT(refusal_of_run([](Json& json) { json["links"][0]["packets"] = ~std::uint64_t{0}; }),
              StartsWith("file.json: links[0].packets: expected at"));
  EXPECT_THAT(refusal_of_run([](Json& json) { json["links"][0]["pakets"] = 1; }),
              StartsWith("file.json: links[0].pakets: no such key; did you mean packets?"));
  EXPECT_THAT(refusal_of_run([](Json& json) { json["config"]["topology"]["resources"] = "two"; }),
              StartsWith("file.json: config.topology.resources: "));
}

TEST(DocumentReader, RefusesListsThatDoNotFitTogether) {
  EXPECT_THAT(refusal_of_run([](Json& json) { json["time_series"]["rows"][1]["values"].push_back(1); }),
              HasSubstr("time_series.rows[1].values: expected 4 values, as time_series.samples says, found 5"));
  EXPECT_THAT(refusal_of_run([](Json& json) { json["time_series"]["samples"] = 1 << 30; }),
              HasSubstr("time_series.rows[0].values: expected 1073741824 values"));
  EXPECT_THAT(refusal_of_run([](Json& json) { json["links"][1].erase("utilisation"); }),
              HasSubstr("links[1].utilisation: expected in all of links or in none"));
  EXPECT_THAT(refusal_of_run([](Json& json) { json["resources"][1].erase("units"); }), HasSubstr("resources[1].units"));
  EXPECT_THAT(refusal_of_run([](Json& json) { json["links"][0]["to"] = 1 << 20; }), HasSubstr("links[0].to: expected"));
  EXPECT_THAT(refusal_of_run([](Json& json) { json["config"]["topology"]["resources"] = 64; }),
              HasSubstr("resources: expected 64, as config.topology.resources says, found 2"));
  EXPECT_THAT(refusal_of_run([](Json& json) { json["rank_links"][0]["to"] = 2; }),
              HasSubstr("rank_links[0].to: expected a number below 2, found 2"));
  EXPECT_THAT(refusal_of_run([](Json& json) { json.erase("rank_links"); }), HasSubstr("rank_links: expected"));
  Json sweep = sample_sweep();
  sweep["points"][1]["results"]["watts"] = 1;
  EXPECT_THAT(refusal(sealed(sweep).dump()), HasSubstr("points[1].results.watts: expected one of results"));
}

TEST(DocumentReader, RefusesWhatWasChangedAfterItWasWritten) {
  for (const SampleDocument& sample : sample_documents()) {
    Json json = sealed(sample.json);
    if (sample.kind == DocumentKind::kRayLife) json["latency"] = 1;
    if (sample.kind == DocumentKind::kStress) json["seconds"] = 1;
    if (sample.kind == DocumentKind::kAccuracy) json["seed"] = 1;
    if (sample.kind == DocumentKind::kPoint) json["keys"]["topology.resources"] = 77;
    if (sample.kind == DocumentKind::kSweep) {
      json = sealed(sample.json);
      json["config"] = "b.yaml";
    } else if (sample.kind == DocumentKind::kRun) {
      json = sealed(sample.json);
      json["digest"]["hits"] = "0124";
    }
    EXPECT_THAT(refusal(json.dump()), StartsWith("file.json: checksum: expected ")) << sample.name;
    json.erase("checksum");
    if (sample.kind == DocumentKind::kPoint)
      EXPECT_THAT(refusal(json.dump()), HasSubstr("checksum: expected a text, found nothing"));
    else
      EXPECT_EQ(refusal(json.dump()), "") << sample.name << ", as of a program that wrote no checksum";
  }
}

TEST(DocumentReader, RefusesOtherVersionsByName) {
  for (const SampleDocument& sample : sample_documents()) {
    Json json = sample.json;
    ASSERT_EQ(json.value("schema_version", 0), 2) << sample.name;
    json["schema_version"] = 7;
    EXPECT_THAT(refusal(json.dump()), HasSubstr("schema_version: this program reads version 2, found 7"))
        << sample.name;
  }
  // A shape of another program is told apart from a damaged file.
  EXPECT_THAT(refusal_of_run([](Json& json) { json["engine"].erase("deterministic"); }),
              HasSubstr("(written by Carousel '1.2.3', commit 'abc'; this is "));
}

TEST(DocumentReader, HasBounds) {
  const auto nested = [](int levels) {
    return "{\"config\":" + std::string(static_cast<std::size_t>(levels), '[') +
           std::string(static_cast<std::size_t>(levels), ']') + "}";
  };
  EXPECT_THAT(refusal(nested(1'000'000)), HasSubstr("expected at most 64 levels"));
  EXPECT_THAT(refusal("{\"config\": {\"a\": 1, \"b\": {}, \"a\": 2}}"),
              StartsWith("file.json: config.a: the key stands twice"));
  std::string keys = "{";
  for (int i = 0; i < 20'000; ++i) keys += "\"" + std::to_string(i) + "\":0,";
  EXPECT_THAT(refusal(keys + "\"x\":0}"), HasSubstr("expected at most 10000 keys"));
  EXPECT_THAT(refusal("{\"config\": 1e999}"), HasSubstr("number overflow"));
  EXPECT_THAT(refusal("{\"config\": NaN}"), HasSubstr("line 1, column 12"));
  EXPECT_THAT(refusal("{\"config\": 1} {}"), HasSubstr("line 1"));
  EXPECT_THAT(refusal(""), HasSubstr("file.json: "));
  EXPECT_THAT(refusal("{\"config\": \"\xff\"}"), HasSubstr("UTF-8"));
  EXPECT_THAT(refusal("[1]"), HasSubstr("expected the report.json of carousel run"));
}

}  // namespace
}  // namespace carousel::report
