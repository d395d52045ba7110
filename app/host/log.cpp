#include "app/host/log.h"

#include <exception>
#include <memory>
#include <utility>

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "core/system/error.h"
#include "core/system/plain_text.h"
#include "report/text/number_text.h"

namespace carousel::app {

namespace {

class PlainLogger final : public spdlog::logger {
 public:
  using spdlog::logger::logger;

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string text = plain_text({message.payload.data(), message.payload.size()}, "\n");
    spdlog::details::log_msg plain = message;
    plain.payload = text;
    spdlog::logger::sink_it_(plain);
  }
};

}  // namespace

const std::vector<std::string>& log_levels() {
  static const std::vector<std::string> levels{"debug", "info", "warning", "error"};
  return levels;
}

void start_log(const LogArguments& arguments, bool quiet) {
  const bool to_file = !arguments.file.empty();
  auto terminal = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  terminal->set_pattern("%^%l%$: %v");
  const spdlog::level::level_enum level = spdlog::level::from_str(arguments.level.empty() ? "info" : arguments.level);
  terminal->set_level(quiet ? spdlog::level::err : to_file || arguments.level.empty() ? spdlog::level::warn : level);
  auto logger = std::make_shared<PlainLogger>("carousel", std::move(terminal));
  logger->set_level(spdlog::level::debug);
  logger->flush_on(spdlog::level::info);
  logger->set_error_handler([](const std::string&) {});  // a full disk must not end a run, nor print at every message
  spdlog::set_default_logger(logger);
  if (!to_file) return;
  // After the terminal's, which tells that the file cannot be written.
  try {
    auto file = std::make_shared<spdlog::sinks::basic_file_sink_mt>(arguments.file, true);
    file->set_pattern("%Y-%m-%d %H:%M:%S.%e %l: %v");
    file->set_level(level);
    logger->sinks().push_back(std::move(file));
  } catch (const spdlog::spdlog_ex&) {
    throw FileError("--log-file: cannot write " + arguments.file);
  }
}

Phase::Phase(std::string name) : name_(std::move(name)), exceptions_(std::uncaught_exceptions()) {
  spdlog::debug("{} begins", name_);
}

double Phase::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

Phase::~Phase() {
  const bool failed = std::uncaught_exceptions() > exceptions_;
  spdlog::info("{}: {}{}{}", name_, report::seconds_text(seconds()),
               failed            ? ", failed"
               : result_.empty() ? ""
                                 : ", ",
               failed ? "" : result_);
}

}  // namespace carousel::app
