#include "app/sweep/ask_tell.h"

#include <algorithm>
#include <cerrno>
#include <map>
#include <string_view>

#include <poll.h>
#include <unistd.h>

#include "app/host/output.h"
#include "app/sweep/sweep_files.h"
#include "core/system/error.h"
#include "report/read/strict_json.h"

namespace carousel::app {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kAskWaitMs = 200;
constexpr std::size_t kLongestAsk = 1 << 16, kShownOfLine = 1000;

/// The lines of standard input, without waiting for them. One of more than kLongestAsk bytes is cut to one byte more.
class Lines {
 public:
  bool open() const { return open_; }
  std::vector<std::string> read_some() {
    std::vector<std::string> out;
    constexpr std::size_t kMostAtOnce = 16 * kLongestAsk;  // input without an end must not keep the points waiting
    std::size_t taken = 0;
    for (pollfd in{STDIN_FILENO, POLLIN, 0}; open_ && taken < kMostAtOnce && poll(&in, 1, 0) > 0;) {
      char buffer[4096];
      const ssize_t count = ::read(STDIN_FILENO, buffer, sizeof buffer);
      if (count < 0 && errno == EINTR) continue;
      open_ = count > 0;
      if (open_) taken += static_cast<std::size_t>(count);
      if (open_) add({buffer, static_cast<std::size_t>(count)}, out);
    }
    if (!open_) end_line(out);
    return out;
  }

 private:
  void add(std::string_view text, std::vector<std::string>& out) {
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      rest_.append(text.substr(0, std::min(end, kLongestAsk + 1 - rest_.size())));
      if (end < text.size()) end_line(out);
      text.remove_prefix(std::min(end + 1, text.size()));
    }
  }
  void end_line(std::vector<std::string>& out) {
    if (rest_.find_first_not_of(" \t\r") != std::string::npos) out.push_back(std::move(rest_));
    rest_.clear();
  }

  std::string rest_;
  bool open_ = true;
};

void tell(const Json& json) {
  print_result(json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
}

/// The keys and values of a line. Throws ConfigError.
Json parsed(const std::string& line) {
  if (line.size() > kLongestAsk)
    throw ConfigError({{{"--ask", 0, 0}, "", "expected a line of at most " + std::to_string(kLongestAsk) + " bytes"}});
  try {
    Json json = report::strict_json(line);
    if (json.is_object()) return json;
  } catch (const report::JsonFault& fault) {
    throw ConfigError({{{"--ask", 0, 0}, fault.path(), fault.message()}});
  }
  throw ConfigError({{{"--ask", 0, 0}, "", "expected a JSON object of keys and values in a line"}});
}

/// The point of a line. Throws ConfigError, or FileError for a file that it names.
SweepPoint asked(const Json& json, PointMaker& maker, SweepRows& rows) {
  const auto fail = [&](const std::string& message, const std::string& key = "") {
    throw ConfigError({{{"--ask", 0, 0}, key, message}});
  };
  Choice choice;
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) {
    if (key == "scene" && !value.is_string())
      fail("expected a file or builtin:NAME, found " + report::found_text(value), key);
    choice.emplace_back(key, value.is_string() ? value.get<std::string>() : value.dump());
    keys.push_back(key);
  }
  if (rows.rows.empty()) rows.keys = keys;
  if (!std::is_permutation(keys.begin(), keys.end(), rows.keys.begin(), rows.keys.end()))
    fail("expected the same keys in every line");
  std::sort(choice.begin(), choice.end(), [&](const KeyValue& a, const KeyValue& b) {
    const auto place = [&](const KeyValue& k) { return std::find(rows.keys.begin(), rows.keys.end(), k.first); };
    return place(a) < place(b);
  });
  return maker.make(choice);
}

}  // namespace

void ask_and_tell(const SweepSetup& setup, const SweepOptions& options, PointMaker& maker, SweepRows& rows,
                  Ledger& ledger, const InterruptScope& interrupt) {
  WorkerPool pool(setup, options.jobs);
  Lines lines;
  std::map<std::string, std::size_t> by_digest;
  const auto ask = [&](const std::string& line) {
    SweepPoint point;
    Json keys = line.substr(0, kShownOfLine);
    try {
      keys = parsed(line);
      point = asked(keys, maker, rows);
    } catch (const std::exception&) {  // whatever a line asks for, the next one is answered
      const PointError error = current_error();
      return tell({{"status", "invalid"}, {"keys", keys}, {"error", {{"kind", error.kind}, {"text", error.text}}}});
    }
    const auto [at, is_new] = by_digest.emplace(point.digest, rows.rows.size());
    if (is_new) {
      SweepRows one{rows.keys, rows.columns, {{point, false, {}, 0, {}}}};
      read_finished(setup, one, options.retry_failed);
      rows.rows.push_back(std::move(one.rows[0]));
    }
    SweepRow& row = rows.rows[at->second];
    if (row.finished) return tell(row_json(rows, row));
    if (is_new) pool.add(std::move(point));  // one that runs already is told once
  };
  while ((lines.open() || pool.busy()) && !interrupt.interrupted()) {
    for (const std::string& line : lines.read_some()) ask(line);
    const auto started = [&](const SweepPoint& point) { ledger.set(point, "running"); };
    for (const WorkerPool::Finished& finished : pool.step(kAskWaitMs, lines.open() ? STDIN_FILENO : -1, started)) {
      SweepRow& row = rows.rows[by_digest.at(finished.point.digest)];
      settle(setup, finished, row, rows.columns);
      ledger.set(row.point, row.error ? "failed" : "done", row.seconds, row.error ? &*row.error : nullptr);
      tell(row_json(rows, row));
    }
  }
}

}  // namespace carousel::app
