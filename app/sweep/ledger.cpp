#include "app/sweep/ledger.h"

#include <algorithm>
#include <array>

#include <spdlog/spdlog.h>
#include <sqlite3.h>
#include <sys/vfs.h>

#include "core/system/error.h"

namespace carousel::app {

struct Ledger::Statement {
  sqlite3_stmt* statement = nullptr;
  ~Statement() { sqlite3_finalize(statement); }
};

bool on_network(const std::filesystem::path& folder) {
  // statfs(2): NFS, SMB, CIFS, SMB2, AFS, Lustre, GPFS.
  constexpr std::array<unsigned long, 7> kNetworks{0x6969,     0x517b,     0xff534d42, 0xfe534d42,
                                                   0x5346414f, 0x0bd00bd0, 0x47504653};
  struct statfs at {};
  if (statfs(folder.c_str(), &at) != 0) return false;
  const auto type = static_cast<unsigned long>(at.f_type) & 0xffffffffUL;
  return std::find(kNetworks.begin(), kNetworks.end(), type) != kNetworks.end();
}

Ledger::Ledger(const std::filesystem::path& folder) : file_(folder / "sweep.sqlite") {
  const bool network = on_network(folder);
  if (network)
    spdlog::warn(
        "{} lies on a network file system, where SQLite's write-ahead log does not work: the ledger uses a slower "
        "journal; shards (--shard) need no ledger",
        folder.string());
  if (sqlite3_open(file_.c_str(), &database_) != SQLITE_OK) fail();
  sqlite3_busy_timeout(database_, 10'000);
  execute(network ? "PRAGMA journal_mode=DELETE" : "PRAGMA journal_mode=WAL");
  // The files of the points are flushed to the disk; the ledger can be made again.
  execute("PRAGMA synchronous=NORMAL");
  execute(
      "CREATE TABLE IF NOT EXISTS point(digest TEXT PRIMARY KEY, keys TEXT NOT NULL, state TEXT NOT NULL, "
      "seconds REAL, error_kind TEXT, error TEXT, changed TEXT NOT NULL)");
  upsert_ = std::make_unique<Statement>();
  constexpr const char* kUpsert =
      "INSERT OR REPLACE INTO point VALUES(?1, ?2, ?3, ?4, ?5, ?6, strftime('%Y-%m-%dT%H:%M:%fZ', 'now'))";
  if (sqlite3_prepare_v2(database_, kUpsert, -1, &upsert_->statement, nullptr) != SQLITE_OK) fail();
}

Ledger::~Ledger() {
  upsert_.reset();
  sqlite3_close(database_);
}

void Ledger::fail() const {
  const std::string why = database_ != nullptr ? sqlite3_errmsg(database_) : "not enough memory";
  throw FileError("cannot write " + file_.string() + ": " + why);
}

void Ledger::execute(const char* sql) {
  if (sqlite3_exec(database_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

void Ledger::begin() {
  execute("BEGIN");
}

void Ledger::commit() {
  execute("COMMIT");
}

void Ledger::set(const SweepPoint& point, const char* state, double seconds, const PointError* error) {
  sqlite3_stmt* s = upsert_->statement;
  const auto text = [&](int at, const std::string& value) {
    sqlite3_bind_text(s, at, value.c_str(), static_cast<int>(value.size()), SQLITE_TRANSIENT);
  };
  sqlite3_reset(s);
  sqlite3_clear_bindings(s);
  text(1, point.digest);
  text(2, keys_json(point.keys).dump());
  text(3, state);
  if (seconds > 0) sqlite3_bind_double(s, 4, seconds);
  if (error != nullptr) {
    text(5, error->kind);
    text(6, error->text);
  }
  if (sqlite3_step(s) != SQLITE_DONE) fail();
  sqlite3_reset(s);
}

}  // namespace carousel::app
