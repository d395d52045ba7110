#include "core/system/atomic_file.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/system/error.h"
#include "core/system/file_calls.h"
#include "core/system/unfinished.h"
#include "tests/support/full_disk.h"

namespace carousel {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("carousel_atomic_file_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  static std::string content(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  fs::path folder_;
};

TEST_F(AtomicFileTest, AppearsWithCommitOnly) {
  const fs::path path = folder_ / "a.txt";
  AtomicFile file(path);
  file.write("one");
  EXPECT_FALSE(fs::exists(path));
  file.write("two");
  file.commit();
  EXPECT_EQ(content(path), "onetwo");
  EXPECT_EQ(files(), 1u);
}

TEST_F(AtomicFileTest, LeavesTheOldFileWhenItIsNotCommitted) {
  write_file(folder_ / "a.txt", "old");
  {
    AtomicFile file(folder_ / "a.txt");
    file.write(std::string(1 << 20, 'x'));
  }
  EXPECT_EQ(content(folder_ / "a.txt"), "old");
  EXPECT_EQ(files(), 1u);
}

TEST_F(AtomicFileTest, MakesMissingFolders) {
  write_file(folder_ / "b/c/a.txt", "deep");
  EXPECT_EQ(content(folder_ / "b/c/a.txt"), "deep");
}

TEST_F(AtomicFileTest, WritesThroughLinks) {
  write_file(folder_ / "real.txt", "old");
  fs::create_symlink("real.txt", folder_ / "link.txt");
  write_file(folder_ / "link.txt", "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.txt"));
  EXPECT_EQ(content(folder_ / "real.txt"), "new");
}

TEST_F(AtomicFileTest, WritesDevicesDirectly) {
  write_file("/dev/null", "gone");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THROW(write_file("/dev/full", "no room"), FileError);
}

TEST_F(AtomicFileTest, RefusesFoldersAndMissingPermissions) {
  EXPECT_THROW(write_file(folder_, "x"), FileError);
  EXPECT_THROW(write_file("/proc/nothing/a.txt", "x"), FileError);
  write_file(folder_ / "a.txt", "a file");
  EXPECT_THROW(write_file(folder_ / "a.txt" / "b.txt", "x"), FileError);
}

TEST_F(AtomicFileTest, LeavesNothingBehindWhenTheDiskIsFull) {
  write_file(folder_ / "a.txt", "old");
  {
    const FullDisk full(1000);
    EXPECT_THROW(write_file(folder_ / "a.txt", std::string(100'000, 'x')), FileError);
    EXPECT_THROW(write_file(folder_ / "b.txt", std::string(2000, 'x')), FileError);
  }
  EXPECT_EQ(content(folder_ / "a.txt"), "old");
  EXPECT_EQ(files(), 1u);
}

// A process that was killed is a zombie until somebody waits for it, and its number may be another's after that.
TEST_F(AtomicFileTest, WhatKilledWritersLeaveIsRemovedAndNothingElse) {
  write_file(folder_ / "kept.txt", "kept");
  const pid_t child = fork();
  if (child == 0) {
    AtomicFile file(folder_ / "killed.txt");
    raise(SIGKILL);
  }
  siginfo_t ended{};
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT), 0);
  AtomicFile live(folder_ / "live.txt");
  live.write("live");
  ASSERT_EQ(files(), 3u);
  remove_abandoned(folder_);
  EXPECT_EQ(files(), 2u);
  waitpid(child, nullptr, 0);
  live.commit();
  EXPECT_EQ(content(folder_ / "live.txt"), "live");
  EXPECT_EQ(content(folder_ / "kept.txt"), "kept");
}

// Each call of the system fails once, and each from then on where it needs room: the file is new or as it was.
TEST_F(AtomicFileTest, IsWholeOrAsItWasWhateverCallFails) {
  using files::Call;
  const fs::path path = folder_ / "made/a.txt";
  const std::string text(200'000, 'x');
  for (const bool had_old : {false, true})
    for (const bool for_ever : {false, true})
      for (int n = 0;; ++n) {
        fs::remove_all(folder_ / "made");
        if (had_old) write_file(path, "old");
        int calls = 0;
        Call failed = Call::kLock;
        std::string error;
        {
          const files::FaultScope fault([&](Call call, const fs::path&) {
            const bool needs_room = call != Call::kRemove && call != Call::kClose && call != Call::kLock;
            const bool now = calls++ == n;
            if (now) failed = call;
            return now || (for_ever && calls > n && needs_room) ? ENOSPC : 0;
          });
          try {
            write_file(path, text);
          } catch (const FileError& e) {
            error = e.what();
          }
        }
        if (calls <= n) break;
        const std::string found = content(path);
        EXPECT_TRUE(found == text || found == (had_old ? "old" : "")) << "call " << n;
        EXPECT_EQ(fs::exists(path), had_old || !found.empty());
        if (error.empty())
          EXPECT_EQ(found, text) << "call " << n << " failed, and nobody said so";
        else
          EXPECT_NE(error.find(path.string()), std::string::npos) << error;
        if (failed == Call::kRemove) continue;
        for (const auto& entry : fs::directory_iterator(fs::exists(folder_ / "made") ? folder_ / "made" : folder_))
          EXPECT_NE(entry.path().filename().string()[0], '.') << "call " << n << " leaves " << entry.path();
      }
}

TEST_F(AtomicFileTest, AWriterRemovesWhatAKilledOneLeftOfTheSameFile) {
  const auto partial = [&](const std::string& host, pid_t process, const std::string& target = "a.txt") {
    const fs::path out = folder_ / ("." + target + ".carousel-" + host + "." + std::to_string(process) + ".0.partial");
    std::ofstream(out) << "part";
    return out;
  };
  char host[65] = {};
  gethostname(host, sizeof host - 1);
  const pid_t dead = fork();
  if (dead == 0) _exit(0);
  waitpid(dead, nullptr, 0);
  const fs::path ours = partial(host, dead), others = partial("elsewhere", dead), of_b = partial(host, dead, "b.txt"),
                 old = partial("forgotten", dead);
  fs::last_write_time(old, fs::file_time_type::clock::now() - std::chrono::hours(24 * 31));
  write_file(folder_ / "a.txt", "whole");
  EXPECT_FALSE(fs::exists(ours));
  EXPECT_FALSE(fs::exists(old)) << "nobody has touched it for a month";
  EXPECT_TRUE(fs::exists(others)) << "whether a process of another host lives, cannot be known from here";
  EXPECT_TRUE(fs::exists(of_b));

  // Without locks the number of the process decides.
  const files::FaultScope no_locks(
      [](files::Call call, const fs::path&) { return call == files::Call::kLock ? ENOSYS : 0; });
  const fs::path again = partial(host, dead), living = partial(host, getpid());
  write_file(folder_ / "a.txt", "whole");
  EXPECT_FALSE(fs::exists(again));
  EXPECT_TRUE(fs::exists(living));
  EXPECT_EQ(content(folder_ / "a.txt"), "whole");
}

}  // namespace
}  // namespace carousel
