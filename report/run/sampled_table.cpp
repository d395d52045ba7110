#include "report/run/sampled_table.h"

#include <algorithm>

#include <fmt/format.h>

#include "report/text/number_text.h"

namespace carousel::report {

namespace {

std::string line(std::string_view name, const std::string& text) {
  return fmt::format("{:<13}{}\n", name, text);
}

std::string value_line(std::string name, const SampledValue& v) {
  std::replace(name.begin(), name.end(), '_', ' ');
  const int digits = v.estimate >= 1000 ? 0 : 3;
  std::string text =
      fmt::format("{:<23} {:>14.{}f}   {:.{}f} to {:.{}f}", name, v.estimate, digits, v.low, digits, v.high, digits);
  if (v.whole) text += fmt::format("   whole {:.{}f}   error {:+.2f} %", *v.whole, digits, 100 * v.error.value_or(0));
  return line("", text);
}

}  // namespace

std::string sampled_table(const Sampled& s) {
  std::string out =
      line("SAMPLED", fmt::format("{} of {} paths in {} places, drawn over the frame; the picture is partial",
                                  grouped(s.paths), grouped(s.frame_paths), s.strata));
  if (s.too_small)
    out +=
        line("", "TOO SMALL for this machine: the sample is mostly fill and drain; a larger sampling.fraction helps");
  out += line("", fmt::format("{:<23} {:>14}   interval (95 %)", "whole frame", "estimate"));
  Sampled::for_each(s, [&](const char* key, const char*, const SampledValue& value) { out += value_line(key, value); });
  if (s.nj_per_ray) out += value_line("nj_per_ray", *s.nj_per_ray);
  for (const SampledUse& use : s.uses) out += value_line("use of " + use.name, use.use);
  return out + line("", "all lines below are about the sample alone");
}

}  // namespace carousel::report
