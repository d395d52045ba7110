#include "report/accuracy/accuracy_schema.h"

#include "report/schema/parts.h"

namespace carousel::report {

namespace {

using Json = nlohmann::ordered_json;
using schema::checksum, schema::count, schema::list, schema::map, schema::object, schema::typed;

Json errors(const char* meaning) {
  return object(
      {{"rays", count("rays compared", "rays")},
       {"missed", count("misses where the exact ray hits", "rays")},
       {"extra", count("hits where the exact ray misses", "rays")},
       {"other", count("hits of another primitive, without an exact tie", "rays")},
       {"opacity", count("rays that stop or pass only since opacity is looked up at a rounded point", "rays")},
       {"t_error_ulp_median", typed("number", "median error of t, where both hit the same triangle", "ulp")},
       {"t_error_ulp_p99", typed("number", "99th percentile of it", "ulp")},
       {"t_error_ulp_max", typed("number", "greatest of it", "ulp")}},
      meaning);
}

Json picture_errors() {
  return object({{"pixels", count("pixels of the picture", "pixels")},
                 {"differ", count("pixels that differ from the exact picture", "pixels")},
                 {"rmse", typed("number", "root mean square error over all channels")},
                 {"worst", typed("number", "greatest error of a channel of a pixel")}},
                "the picture of the level beside the exact one");
}

Json by_clock(const Json& of, const char* meaning) {
  return object({{"host", of}, {"hardware", of}}, meaning);
}

Json range(const char* meaning) {
  return object(
      {{"least", typed("number", "least of them", "cycles")}, {"most", typed("number", "greatest of them", "cycles")}},
      meaning);
}

Json ratio_schema() {
  // An end of the interval may be beyond a double.
  const auto end = [](const char* meaning) {
    Json out = typed("number", meaning);
    out["type"] = {"number", "null"};
    return out;
  };
  Json out = object({{"ratio", end("the ratio of the costs")},
                     {"low", end("lower end of its interval of 95 %")},
                     {"high", end("upper end of its interval of 95 %")}},
                    "null without a cost by this clock");
  out["type"] = {"object", "null"};
  return out;
}

Json level() {
  return object(
      {{"triangle", typed("string", "level of the triangle test")},
       {"box", typed("string", "level of the box test")},
       {"transform", typed("string", "level of the transform")},
       {"ns_per_ray", object({{"median", typed("number", "median of the repetitions", "ns")},
                              {"least", typed("number", "least of them", "ns")},
                              {"most", typed("number", "greatest of them", "ns")}},
                             "CPU time of a ray on one thread of the host, depth first")},
       {"modelled_cycles_per_ray", typed("number", "cost on the configured machine", "cycles"), false},
       {"modelled_tester_cycles_per_ray",
        typed("number", "cycles of these in which test units of a kind were busy", "cycles"), false},
       {"tester_limited_cycles_per_ray", typed("number", "cost where all but the test units is relaxed", "cycles"),
        false},
       {"modelled_cycles_range", range("cost on the configured machine over seeds of the picture"), false},
       {"tester_limited_cycles_range", range("cost where the test units limit over seeds of the picture"), false},
       {"tester_limited_by",
        object({{"units", typed("string", "kind of units that was busy most")},
                {"busy_fraction", typed("number", "part of the cycles", "fraction")}},
               "units that limit that machine"),
        false},
       {"energy_pj_per_ray", typed("number", "energy of the products and sums of the tests", "pJ"), false},
       {"exact_volumes_per_ray", typed("number", "volumes that had to be computed exactly"), false},
       {"bundle_tests_per_ray", typed("number", "tests of bundles"), false},
       {"plane_tests_per_ray", typed("number", "tests of cull planes"), false},
       {"unit_area_mm2", typed("number", "area of the test units of a resource", "mm2")},
       {"unit_area_over_default", typed("number", "over that of the default levels")},
       {"cull_planes", typed("boolean", "the configured cull planes were tested")},
       {"scene", errors("answers for the scene beside the exact ones")},
       {"hard", map(errors(""), "answers for each of the hard cases"), false},
       {"leaks", count("misses from inside closed surfaces", "rays")},
       {"picture", picture_errors()},
       {"frontier", by_clock(typed("boolean", ""), "true if no other level is both cheaper and less often wrong")},
       {"over_cheapest", by_clock(ratio_schema(), "the cost over that of the cheapest levels")},
       {"safe", typed("boolean", "nothing was missed or added")},
       {"safe_but_slivers", typed("boolean", "the same but for the hard cases of slivers")}},
      "a combination of levels of the tests");
}

Json spawn() {
  return object({{"spawn", typed("string", "rule of the offset")},
                 {"bounces", count("rays that left a triangle", "rays")},
                 {"self_hits", count("rays of these that hit the same triangle again", "rays")},
                 {"far_bounces", count("the same from instances far from the origin", "rays")},
                 {"far_self_hits", count("rays of these that hit the same triangle again", "rays")},
                 {"picture", picture_errors()}},
                "a rule by which new rays start off their surface");
}

Json chosen() {
  Json out = object({{"triangle", typed("string", "level of the triangle test")},
                     {"box", typed("string", "level of the box test")},
                     {"transform", typed("string", "level of the transform")}},
                    "the cheapest safe levels; null if none is safe");
  out["type"] = {"object", "null"};
  return out;
}

}  // namespace

Json accuracy_schema() {
  return object(
      {{"schema_version", typed("integer", "version of these keys")},
       {"incomplete", typed("boolean", "true if the command was interrupted")},
       {"scene", typed("string", "name of the scene")},
       {"triangles", count("triangles, counted for each instance", "triangles")},
       {"instances", count("instances", "instances")},
       {"rays", count("rays compared", "rays")},
       {"seed", count("seed of the hard cases")},
       {"repetitions", typed("integer", "measurements of each time")},
       {"seeds", typed("integer", "seeds of the picture over which machines are measured")},
       {"picture", object({{"width", count("width", "pixels")},
                           {"height", count("height", "pixels")},
                           {"samples", count("samples of a pixel")}},
                          "size of the pictures")},
       {"levels", list(level(), "each combination of levels")},
       {"spawn", list(spawn(), "each offset of new rays")},
       {"sampling", object({{"slope", typed("number", "slope of log RMSE over log samples")},
                            {"rows", list(object({{"samples", count("samples of a pixel")},
                                                  {"rmse", typed("number",
                                                                 "root mean square error, without the 2 % "
                                                                 "farthest off")},
                                                  {"seconds", typed("number", "CPU time of a picture", "s")}}),
                                          "each number of samples")}},
                           "error of the picture over its samples")},
       {"recommended", by_clock(chosen(), "the cheapest safe levels by either clock")},
       {"verdict", typed("string", "the advice in sentences")},
       {"host", object({{"machine", typed("string", "processor of the host")}}, "the host")},
       checksum()},
      "accuracy.json of carousel accuracy");
}

}  // namespace carousel::report
