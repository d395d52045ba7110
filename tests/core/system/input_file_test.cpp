#include "core/system/input_file.h"

#include <chrono>
#include <filesystem>
#include <iterator>
#include <string>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "core/system/stop_request.h"

namespace carousel::input_file_test {
namespace {

namespace fs = std::filesystem;

class InputFileTest : public testing::Test {
 protected:
  InputFileTest() : pipe_(fs::path(testing::TempDir()) / ("carousel_pipe_" + std::to_string(getpid()))) {
    mkfifo(pipe_.c_str(), 0600);
  }
  ~InputFileTest() override { fs::remove(pipe_); }

  const fs::path pipe_;
};

TEST_F(InputFileTest, ReadsFilesAndPipesToTheirEnd) {
  const std::string text(300'000, 'x');
  std::jthread writer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    write_file(pipe_, text);
  });
  InputFile in(pipe_);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), text);
  writer.join();
  const fs::path file = pipe_.string() + ".txt";
  write_file(file, "one\ntwo");
  InputFile lines(file);
  std::string line;
  EXPECT_TRUE(std::getline(lines, line) && line == "one");
  EXPECT_TRUE(std::getline(lines, line) && line == "two");
  EXPECT_FALSE(std::getline(lines, line));
  fs::remove(file);
}

TEST_F(InputFileTest, SaysWhyItCannotBeRead) {
  InputFile missing(pipe_.string() + ".none");
  EXPECT_EQ(errno, ENOENT);
  EXPECT_FALSE(missing);
  InputFile folder(testing::TempDir());
  std::string line;
  EXPECT_THROW(std::getline(folder, line), FileError);
}

// Nobody writes to the pipe, or reads it.
TEST_F(InputFileTest, StopsWaitingWhenAStopIsRequested) {
  std::stop_source source;
  const StopScope scope(source.get_token());
  std::jthread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    source.request_stop();
  });
  InputFile in(pipe_);
  std::string line;
  EXPECT_THROW(std::getline(in, line), Interrupted);
}

TEST_F(InputFileTest, AWriterStopsWaitingToo) {
  std::stop_source source;
  const StopScope scope(source.get_token());
  std::jthread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    source.request_stop();
  });
  EXPECT_THROW(AtomicFile file(pipe_), Interrupted);
  const int reader = open(pipe_.c_str(), O_RDONLY | O_NONBLOCK);
  AtomicFile file(pipe_);
  EXPECT_THROW(file.write(std::string(1 << 20, 'x')), Interrupted) << "the pipe is full, and its reader sleeps";
  close(reader);
  EXPECT_THROW(file.write("more"), FileError) << "a reader that is gone is an error and no signal";
}

}  // namespace
}  // namespace carousel::input_file_test
