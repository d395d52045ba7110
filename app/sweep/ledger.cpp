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

Ledger::Ledger(const std::filesystem::path& folder) : folder_(folder), file_(folder / "sweep.sqlite") {
  if (on_network(folder))
    spdlog::warn(
        "{} lies on a network file system, where SQLite's write-ahead log does not work: the ledger uses a slower "
        "journal; shards (--shard) need no ledger",
        folder.string());
  if (!open()) make_anew();
}

Ledger::~Ledger() {
  close();
}

/// False if the file is none that this program can use.
bool Ledger::open() {
  if (sqlite3_open(file_.c_str(), &database_) != SQLITE_OK) fail();
  sqlite3_busy_timeout(database_, 10'000);
  // The files of the points are flushed to the disk; the ledger can be made again.
  const char* const journal = on_network(folder_) ? "PRAGMA journal_mode=DELETE" : "PRAGMA journal_mode=WAL";
  constexpr const char* kTable =
      "CREATE TABLE IF NOT EXISTS point(digest TEXT PRIMARY KEY, keys TEXT NOT NULL, state TEXT NOT NULL, "
      "seconds REAL, error_kind TEXT, error TEXT, changed TEXT NOT NULL)";
  for (const char* sql : {journal, "PRAGMA synchronous=NORMAL", kTable, "SELECT count(*) FROM point"})
    if (!execute(sql)) return false;
  upsert_ = std::make_unique<Statement>();
  constexpr const char* kUpsert =
      "INSERT OR REPLACE INTO point(digest, keys, state, seconds, error_kind, error, changed) "
      "VALUES(?1, ?2, ?3, ?4, ?5, ?6, strftime('%Y-%m-%dT%H:%M:%fZ', 'now'))";
  if (sqlite3_prepare_v2(database_, kUpsert, -1, &upsert_->statement, nullptr) == SQLITE_OK) return true;
  if (!broken()) fail();
  return false;
}

void Ledger::close() {
  upsert_.reset();
  sqlite3_close(database_);
  database_ = nullptr;
}

void Ledger::make_anew() {
  spdlog::warn("{} is broken ({}); it is made anew from the files of the points", file_.string(),
               sqlite3_errmsg(database_));
  close();
  for (const char* ending : {"", "-wal", "-shm", "-journal"}) {
    std::error_code ignored;
    std::filesystem::remove(file_.string() + ending, ignored);
  }
  if (!open()) fail();
  begin();
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "points", none)) {
    if (entry.path().extension() != ".json") continue;
    if (const std::optional<PointFile> file = read_point(entry.path()))
      write({file->digest, file->keys.dump(), file->done() ? "done" : "failed", file->seconds,
             file->error ? &*file->error : nullptr});
  }
  commit();
}

/// True if the last error is that of a file that is no database, or another one's.
bool Ledger::broken() const {
  const int code = sqlite3_errcode(database_);
  return code == SQLITE_CORRUPT || code == SQLITE_NOTADB || code == SQLITE_ERROR;
}

void Ledger::fail() const {
  const std::string why = database_ != nullptr ? sqlite3_errmsg(database_) : "not enough memory";
  throw FileError("cannot write " + file_.string() + ": " + why);
}

/// False if the file is broken; throws for any other error.
bool Ledger::execute(const char* sql) {
  if (sqlite3_exec(database_, sql, nullptr, nullptr, nullptr) == SQLITE_OK) return true;
  if (!broken()) fail();
  return false;
}

void Ledger::begin() {
  if (execute("BEGIN")) return;
  make_anew();
  if (!execute("BEGIN")) fail();
}

void Ledger::commit() {
  if (sqlite3_get_autocommit(database_) == 0 && !execute("COMMIT")) fail();  // a ledger made anew has no transaction
}

bool Ledger::write(const Row& row) {
  sqlite3_stmt* s = upsert_->statement;
  const auto text = [&](int at, const std::string& value) {
    sqlite3_bind_text(s, at, value.c_str(), static_cast<int>(value.size()), SQLITE_TRANSIENT);
  };
  sqlite3_reset(s);
  sqlite3_clear_bindings(s);
  text(1, row.digest);
  text(2, row.keys);
  text(3, row.state);
  if (row.seconds > 0) sqlite3_bind_double(s, 4, row.seconds);
  if (row.error != nullptr) {
    text(5, row.error->kind);
    text(6, row.error->text);
  }
  const bool done = sqlite3_step(s) == SQLITE_DONE;
  if (!done && !broken()) fail();
  sqlite3_reset(s);
  return done;
}

void Ledger::set(const SweepPoint& point, const char* state, double seconds, const PointError* error) {
  const Row row{point.digest, keys_json(point.keys).dump(), state, seconds, error};
  if (write(row)) return;
  make_anew();  // points that were written since the ledger was read are in their files
  if (!write(row)) fail();
}

}  // namespace carousel::app
