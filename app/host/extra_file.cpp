#include "app/host/extra_file.h"

#include <utility>

#include "core/system/error.h"
#include "core/system/unfinished.h"

namespace carousel::app {

ExtraFile::ExtraFile(std::string option, const std::filesystem::path& file) : option_(std::move(option)), name_(file) {
  remove_abandoned_of(file);
  keep_error([&] { file_.emplace(file); });
  if (!error_.empty()) throw FileError(error_);
}

void ExtraFile::keep_error(const std::function<void()>& work) {
  try {
    work();
  } catch (const FileError& error) {
    error_ = option_ + ": " + error.what();
    file_.reset();
  }
}

void ExtraFile::write(const std::function<void(AtomicFile&)>& write) {
  keep_error([&] {
    write(*file_);
    file_->finish();
    written_ = true;
  });
}

void ExtraFile::publish() {
  if (file_ && written_) keep_error([&] { file_->commit(); });
  file_.reset();
}

}  // namespace carousel::app
