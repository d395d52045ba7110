#include "core/system/atomic_file.h"

#include <csignal>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/system/error.h"
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

}  // namespace
}  // namespace carousel
