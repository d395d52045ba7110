#include "app/accuracy/certificate_report.h"

#include <fmt/format.h>

#include "report/text/singular.h"

namespace carousel::app {

namespace {

/// Describes the first case that broke the property; empty if none did.
std::string reproducer(const Certificate& certificate, const PropertyResult& result, const LevelResult& level) {
  if (!level.first_broken) return "";
  return case_text(*result.property, level.level,
                   certificate_case(*result.property, certificate.seed, *level.first_broken));
}

std::string verdict(const Replay& replay) {
  if (!replay.judgement.applies) return "the property does not apply to this case";
  if (!replay.judgement.broken) return "holds";
  return replay.tried.property->promised(replay.tried.level) ? "BROKEN, and this level promises it"
                                                             : "broken, which this level does not promise";
}

/// The inputs again, in hexadecimal and in decimal.
std::string inputs(const CertificateCase& one) {
  std::string text;
  std::size_t at = 0;
  for (const accel::CaseField& field : one.property->fields) {
    const std::size_t count = &field == &one.property->fields.back() ? one.values.size() - at : field.count;
    for (std::size_t i = 0; i < count; ++i) {
      const std::string_view gap = i % 3 != 0 ? "," : i > 0 ? ",\n" : "";  // a point, or a column, a line
      text += fmt::format("{}{:<{}}{:a} ({:.9g})", gap, i == 0 ? field.name : "", i % 3 == 0 ? 13 : 1,
                          one.values[at + i], one.values[at + i]);
    }
    text += "\n";
    at += count;
  }
  return text;
}

}  // namespace

std::string certificate_table(const Certificate& certificate) {
  std::string text =
      fmt::format("{} cases of each property, seed {}, {:.1f} s{}\n\n{:<13} {:<33} {:>10} {:>10}  {}\n",
                  certificate.cases, certificate.seed, certificate.seconds,
                  certificate.incomplete ? ", interrupted" : "", "property", "level", "cases", "broken", "");
  std::string broken;
  for (const PropertyResult& result : certificate.properties) {
    for (const LevelResult& level : result.levels) {
      const std::string name = level_name(*result.property, level.level);
      const bool violated = level.promised && level.broken > 0;
      const char* const kind = violated ? "VIOLATED" : level.promised ? "promised" : "counted";
      text +=
          fmt::format("{:<13} {:<33} {:>10} {:>10}  {}", result.property->name, name, level.cases, level.broken, kind);
      if (!result.property->error_unit.empty())
        text += fmt::format("; at most {:.3g} {}", level.worst_error, result.property->error_unit);
      text += "\n";
      if (violated)
        broken += fmt::format("\n{} at {} is broken: {}\n  carousel accuracy --reproduce '{}'\n", result.property->name,
                              name, result.property->says, reproducer(certificate, result, level));
    }
  }
  return text + report::singular(fmt::format("\n{} violations of promised properties\n", certificate.violations())) +
         broken;
}

nlohmann::json certificate_json(const Certificate& certificate) {
  nlohmann::json properties = nlohmann::json::array();
  for (const PropertyResult& result : certificate.properties) {
    for (const LevelResult& level : result.levels) {
      nlohmann::json row{{"property", result.property->name},
                         {"level", level_name(*result.property, level.level)},
                         {"says", result.property->says},
                         {"promised", level.promised},
                         {"cases", level.cases},
                         {"broken", level.broken}};
      if (!result.property->error_unit.empty()) {
        row["worst_error"] = level.worst_error;
        row["error_unit"] = result.property->error_unit;
      }
      if (level.first_broken) row["reproduce"] = reproducer(certificate, result, level);
      properties.push_back(std::move(row));
    }
  }
  return {{"seed", certificate.seed},
          {"cases", certificate.cases},
          {"seconds", certificate.seconds},
          {"properties", properties},
          {"violations", certificate.violations()},
          {"incomplete", certificate.incomplete}};
}

Replay::Replay(const CertificateCase& one) : tried(one) {
  one.property->judge(one.values, {&one.level, 1}, {&judgement, 1}, &story);
}

std::string replay_text(const Replay& replay) {
  const CertificateCase& one = replay.tried;
  std::string text = fmt::format("{} at {}: {}\n{}", one.property->name, level_name(*one.property, one.level),
                                 one.property->says, inputs(one));
  if (!replay.story.kernel.empty())
    text += fmt::format("level says   {}\nexactly      {}\n", replay.story.kernel, replay.story.exact);
  return text + verdict(replay) + "\n";
}

nlohmann::json replay_json(const Replay& replay) {
  const CertificateCase& one = replay.tried;
  return {{"reproduce", case_text(*one.property, one.level, one.values)},
          {"promised", one.property->promised(one.level)},
          {"asked", replay.judgement.applies},
          {"broken", replay.judgement.broken},
          {"kernel", replay.story.kernel},
          {"exact", replay.story.exact}};
}

}  // namespace carousel::app
