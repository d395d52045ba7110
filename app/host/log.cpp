#include "app/host/log.h"

#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <utility>

#include <fcntl.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "app/host/exit_status.h"
#include "core/system/error.h"
#include "core/system/file_calls.h"
#include "core/system/plain_text.h"
#include "report/text/number_text.h"
#include "report/text/singular.h"

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

/// A file that shows each message at once. A message that cannot be written is lost, and the first error is kept.
class LogFile final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  /// Throws FileError.
  explicit LogFile(std::string name) : name_(std::move(name)) {
    const std::filesystem::path folder = std::filesystem::path(name_).parent_path();
    std::vector<std::filesystem::path> made;
    if (files::make_folders(folder, [&](const std::filesystem::path& each) { made.push_back(each); }) == 0)
      descriptor_ = files::open_file(name_, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND);
    const int why = errno;
    for (; descriptor_ < 0 && !made.empty(); made.pop_back()) files::remove_folder(made.back());
    if (descriptor_ < 0) throw FileError(text_of(why));
  }
  ~LogFile() override {
    if (descriptor_ >= 0) files::close_file(descriptor_);
  }
  LogFile(const LogFile&) = delete;
  LogFile& operator=(const LogFile&) = delete;

  /// Empty if there is none. Called when all messages are written.
  const std::string& error() const { return error_; }

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    for (std::string_view rest(line.data(), line.size()); !rest.empty();) {
      const ssize_t count = files::write_bytes(descriptor_, rest);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0 && error_.empty()) error_ = text_of(errno);
      if (count < 0) return;
      rest.remove_prefix(static_cast<std::size_t>(count));
    }
  }
  void flush_() override {}

 private:
  std::string text_of(int error) const { return "--log-file: cannot write " + name_ + ": " + std::strerror(error); }

  std::string name_, error_;
  int descriptor_ = -1;
};

std::shared_ptr<LogFile> g_file;  // the default logger's file; null if messages go to the terminal only

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
  g_file = std::make_shared<LogFile>(arguments.file);
  g_file->set_pattern("%Y-%m-%d %H:%M:%S.%e %l: %v");
  g_file->set_level(level);
  logger->sinks().push_back(g_file);
}

int end_log(int status) {
  if (!g_file) return status;
  g_file->log({"carousel", spdlog::level::info, fmt::format("the program ends with status {}", status)});
  const std::string error = g_file->error();
  auto& sinks = spdlog::default_logger()->sinks();
  std::erase(sinks, g_file);
  g_file.reset();
  if (error.empty()) return status;
  spdlog::error("{}", error);
  return status == kDone ? kUsage : status;
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
               failed ? "" : report::singular(result_));
}

}  // namespace carousel::app
