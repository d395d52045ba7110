#include "report/run/ray_life_table.h"

#include <string_view>

#include <fmt/format.h>

#include "report/text/number_text.h"

namespace carousel::report {

namespace {

std::string name_of(const RayName& ray) {
  return fmt::format("{} ray of pixel {},{}, sample {}, bounce {}", ray.kind, ray.x, ray.y, ray.sample, ray.bounce);
}

class LifeTable {
 public:
  explicit LifeTable(const RayLife& life) : life_(life), cycles_(life.unit == "cycles") {}

  std::string text() {
    head();
    row("time", fmt::format("{:>12}  {:>6}  {:>5}", "in all", "share", "times"));
    for (const RayStageSum& stage : life_.stages)
      row("", fmt::format("{:>12}  {:>6}  {:>5}  {}", length(stage.length), percent(stage.share), stage.times,
                          stage.stage));
    row("tests", fmt::format("{:>12}  {:<12}  {:<8}  {:<14}  {}", "at", "resource", "packet", "node", "outcome"));
    for (const RayTest& test : life_.tests)
      row("", fmt::format("{:>12}  resource {:<3}  {:<8}  {:<14}  {}", length(test.at), test.resource,
                          number(test.packet), test.node, outcome(test)));
    row("life",
        fmt::format("{:>12}  {:>10}  {:<12}  {:<8}  {:<14}  {}", "from", "for", "part", "packet", "node", "stage"));
    for (const RaySpan& span : life_.spans)
      row("", fmt::format("{:>12}  {:>10}  {:<12}  {:<8}  {:<14}  {}", length(span.begin), length(span.length),
                          span.part.empty() ? "shading" : span.part, number(span.packet), span.node.value_or(""),
                          span.stage));
    row("caused", life_.caused.empty() ? "nothing" : "");
    for (const RayName& ray : life_.caused) row("", name_of(ray));
    return out_;
  }

 private:
  void row(std::string_view name, const std::string& text) { out_ += fmt::format("{:<13}{}\n", name, text); }
  void head() {
    row("ray", name_of(life_.ray));
    row("", fmt::format("from ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})", life_.origin[0], life_.origin[1],
                        life_.origin[2], life_.direction[0], life_.direction[1], life_.direction[2]));
    if (!life_.complete) row("INCOMPLETE", "the run ended before the ray had been shaded");
    row("latency", fmt::format("{}: made at {}, shaded at {}", latency(), length(life_.begin), length(life_.end)));
    if (life_.resource) row("record", fmt::format("resource {}, slot {}", *life_.resource, life_.slot.value_or(0)));
    row("packets", fmt::format("{} packets over {} links", life_.packets, life_.hops));
    if (life_.hit)
      row("hit", fmt::format("instance {}, primitive {} at t = {:.7g}", life_.hit->instance, life_.hit->primitive,
                             life_.hit->t));
    else
      row("hit", life_.ray.kind == "shadow" ? (life_.occluded ? "occluded" : "visible") : "none");
  }
  std::string length(double value) const {
    return cycles_ ? grouped(static_cast<std::uint64_t>(value)) : fmt::format("{:.3f}", value * 1e6);
  }
  std::string latency() const {
    return cycles_ ? length(life_.latency) + " cycles" : length(life_.latency) + " microseconds";
  }
  static std::string number(const std::optional<std::uint64_t>& value) {
    return value ? fmt::format("{}", *value) : "";
  }
  static std::string outcome(const RayTest& test) {
    std::string text = test.hit ? fmt::format("hits {} of {} children", *test.hit, test.shapes)
                                : fmt::format("{} shapes", test.shapes);
    if (test.found)
      text += fmt::format(", meets primitive {} of instance {} at t = {:.7g}", test.found->primitive,
                          test.found->instance, test.found->t);
    return text;
  }

  const RayLife& life_;
  bool cycles_;
  std::string out_;
};

}  // namespace

std::string ray_life_table(const RayLife& life) {
  return LifeTable(life).text();
}

}  // namespace carousel::report
