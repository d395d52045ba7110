#include "report/sweep/sweep_schema.h"

#include "report/schema/parts.h"

namespace carousel::report {

namespace {

using Json = nlohmann::ordered_json;
using schema::checksum, schema::count, schema::list, schema::map, schema::object, schema::scalar, schema::typed;

Json texts(const char* meaning) {
  return list(typed("string", ""), meaning);
}

Json status(bool may_be_missing) {
  Json out = typed("string", may_be_missing ? "done, failed, or missing: not run yet" : "done or failed");
  out["enum"] = may_be_missing ? Json{"done", "failed", "missing"} : Json{"done", "failed"};
  return out;
}

Json error() {
  return object({{"kind", typed("string", "config, scene, file, memory, simulation, verification, signal or exit")},
                 {"text", typed("string", "the message")}},
                "the reason why a point failed");
}

/// A statistic of numbers whose spread may be beyond a double.
Json statistic(const char* meaning) {
  Json out = typed("number", meaning);
  out["type"] = {"number", "null"};
  return out;
}

Json point_row() {
  return object({{"point", typed("string", "digest of configuration, program and files")},
                 {"status", status(true)},
                 {"keys", map(scalar(""), "values of the varied keys")},
                 {"results", map(scalar("", true), "its results; null where its report has none")},
                 {"error", error(), false},
                 {"host_seconds", typed("number", "time of the point's process", "s")}},
                "a point");
}

Json effect() {
  return object({{"key", typed("string", "a varied key")},
                 {"result", typed("string", "a result")},
                 {"mean", statistic("mean of the result over all points")},
                 {"levels", list(object({{"level", scalar("value of the key, or a range of values")},
                                         {"points", count("points with it", "points")},
                                         {"effect", statistic("difference of their mean from that of all points")},
                                         {"low", statistic("lower end of its interval of 95 %"), false},
                                         {"high", statistic("upper end of its interval of 95 %"), false}}),
                                 "each value")}},
                "effect of a key on a result");
}

Json pareto() {
  return object(
      {{"goals",
        list(object({{"result", typed("string", "a result")}, {"maximise", typed("boolean", "more of it is better")}}),
             "the two results")},
       {"points", texts("digests of the points on the front")}},
      "points that no other point betters in both results");
}

}  // namespace

Json sweep_schema() {
  return object({{"schema_version", typed("integer", "version of these keys")},
                 {"carousel", object({{"version", typed("string", "version of the program")},
                                      {"commit", typed("string", "commit from which it was built")}},
                                     "program that wrote the file")},
                 {"config", typed("string", "file of the configuration")},
                 {"keys", texts("keys that vary")},
                 {"results", texts("names of the results")},
                 {"greater_is_better", texts("results of which more is better")},
                 {"points", list(point_row(), "each point")},
                 {"pareto", pareto(), false},
                 {"main_effects", list(effect(), "effects of the keys on the results")},
                 checksum()},
                "sweep.json of carousel sweep");
}

Json point_schema(Json run) {
  return object({{"schema_version", typed("integer", "version of these keys")},
                 {"point", typed("string", "digest of configuration, program and files, and name of the file")},
                 {"status", status(false)},
                 {"keys", map(scalar(""), "values of the varied keys")},
                 {"sets", texts("assignments that make the point's configuration")},
                 {"error", error(), false},
                 {"host", object({{"seconds", typed("number", "time of the point's process", "s")}}, "the host")},
                 {"report", std::move(run), false},
                 checksum(true)},
                "points/DIGEST.json of carousel sweep");
}

}  // namespace carousel::report
