#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "app/sweep/plan/point.h"
#include "app/sweep/process/point_file.h"

struct sqlite3;

namespace carousel::app {

/// `sweep.sqlite`: the state of every point of the folder, for whoever asks while a sweep runs. Only the coordinator of
/// a sweep writes it. The files of the points are the truth: a ledger that is lost or broken is made anew from them.
class Ledger {
 public:
  /// Opens or makes it. Throws FileError. Warns where the folder lies on a network, on which SQLite's write-ahead log
  /// does not work and a slower journal is used.
  explicit Ledger(const std::filesystem::path& folder);
  ~Ledger();
  Ledger(const Ledger&) = delete;
  Ledger& operator=(const Ledger&) = delete;

  /// Changes between these two calls are one transaction.
  void begin();
  void commit();

  /// `state`: waiting, running, done or failed.
  void set(const SweepPoint& point, const char* state, double seconds = 0, const PointError* error = nullptr);

 private:
  struct Statement;
  struct Row {
    std::string digest, keys, state;
    double seconds = 0;
    const PointError* error = nullptr;
  };
  bool open();
  void close();
  void make_anew();
  bool broken() const;
  bool execute(const char* sql);
  /// False if the file is broken.
  bool write(const Row& row);
  [[noreturn]] void fail() const;

  std::filesystem::path folder_, file_;
  sqlite3* database_ = nullptr;
  std::unique_ptr<Statement> upsert_;
};

/// True if the folder lies on a file system of another machine (statfs(2)).
bool on_network(const std::filesystem::path& folder);

}  // namespace carousel::app
