#include "app/commands/certify_command.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <thread>

#include <nlohmann/json.hpp>

#include "accel/traverse/kernels.h"
#include "app/accuracy/case_text.h"
#include "app/accuracy/certificate.h"
#include "app/accuracy/certificate_report.h"
#include "app/host/exit_status.h"
#include "app/host/interrupt.h"
#include "app/host/output.h"
#include "core/config/load/load.h"
#include "core/text/line_reader.h"
#include "report/text/progress_line.h"

namespace carousel::app {

namespace {

/// The configured level; empty without a configuration, which stands for all levels.
std::optional<AccuracyConfig> configured_level(const AccuracyArguments& arguments) {
  if (arguments.config.empty() && arguments.sets.empty()) return std::nullopt;
  const ConfigText source =
      arguments.config.empty() ? ConfigText{kBuiltInConfig, "built-in"} : read_config_file(arguments.config);
  const Config config = load_config(source, arguments.sets).config;
  accel::select_simd_target(config.engine.simd);
  return config.accuracy;
}

/// The cases of a file, one a line, among blank lines and comments; or the one case that the text itself holds.
std::vector<CertificateCase> read_cases(const std::string& text_or_file) {
  const std::vector<accel::Property>& properties = certified_properties();
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(text_or_file, ignored))
    return {parse_case(text_or_file, properties, {"--reproduce", 1, 1})};
  std::vector<CertificateCase> cases;
  std::ifstream file(text_or_file);
  constexpr std::size_t kLongestLine = 1 << 16;
  LineReader lines(file, kLongestLine);
  for (int number = 1; lines.next(); ++number) {
    const std::string& line = lines.line();
    if (lines.too_long())
      throw ConfigError({{{text_or_file, number, 0},
                          "",
                          "expected a case, found a line of more than " + std::to_string(kLongestLine) + " bytes"}});
    if (line.find_first_not_of(' ') == std::string::npos || line.starts_with('#')) continue;
    cases.push_back(parse_case(line, properties, {text_or_file, number, 1}));
  }
  if (cases.empty()) throw ConfigError({{{text_or_file, 0, 0}, "", "expected a case, found none"}});
  return cases;
}

}  // namespace

int certify_command(const AccuracyArguments& arguments) {
  const InterruptScope interrupt;
  const std::optional<AccuracyConfig> level = configured_level(arguments);
  const auto executor = make_executor(std::max(1u, std::thread::hardware_concurrency()));
  std::optional<report::ProgressLine> line;
  if (!arguments.quiet) line.emplace(stderr);
  const auto show = [&](double part, std::uint64_t cases) {
    if (line) line->update(part, cases, "cases", "certificate");
  };
  const Certificate certificate = certify(
      arguments.seed, {arguments.cases, arguments.seconds}, level, *executor, [&] { return interrupt.interrupted(); },
      show);
  line.reset();
  if (arguments.json)
    print_result(certificate_json(certificate).dump(2) + "\n");
  else if (!arguments.quiet || certificate.violations() > 0)
    print_text(certificate_table(certificate));
  if (certificate.violations() > 0) return kBroken;
  return certificate.incomplete ? interrupt.status() : kDone;
}

int reproduce_command(const AccuracyArguments& arguments) {
  const std::vector<CertificateCase> cases = read_cases(arguments.reproduce);
  bool broken = false;
  nlohmann::json list = nlohmann::json::array();
  std::string text;
  for (const CertificateCase& one : cases) {
    const Replay replay(one);
    broken |= replay.judgement.broken;
    list.push_back(replay_json(replay));
    text += replay_text(replay);
  }
  if (arguments.json)
    print_result(nlohmann::json{{"cases", list}, {"broken", broken}}.dump(2) + "\n");
  else if (!arguments.quiet)
    print_text(text);
  return broken ? kBroken : kDone;
}

}  // namespace carousel::app
