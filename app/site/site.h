#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/site/asked_points.h"
#include "core/module/http_server.h"

namespace carousel::app {

/// Folders of results as one site, which is read, and written by AskedPoints alone. Every address of it begins with a
/// token that is drawn anew for each server; whoever does not know the token learns nothing, not even which folders
/// there are. Its pages: a list of all results, the page of each, made anew from its JSON, a sweep while it runs, and
/// the files beside them that commands write.
class Site {
 public:
  /// `roots`: folders that are there. Throws FileError if one is not.
  explicit Site(const std::vector<std::string>& roots);

  const std::string& token() const { return token_; }
  /// From then on requests must name this port as their host, so that no page of another site can pass for it (DNS
  /// rebinding).
  void set_port(int port) { port_ = port; }

  /// 404 for what is not there or not known, 405 for other methods than GET and HEAD but where a sweep is asked for a
  /// point (PATH/ask), 421 for another host. Any thread,
  /// after set_port().
  HttpAnswer answer(const HttpRequest& request) const;

 private:
  HttpAnswer index() const;
  HttpAnswer folder_page(std::size_t root, const std::filesystem::path& folder) const;
  /// POST begins a run of a point of the sweep in `folder`, GET tells how the run of a name is.
  HttpAnswer ask(std::size_t root, const std::filesystem::path& folder, const HttpRequest& request) const;
  HttpAnswer file_of(std::size_t root, const std::filesystem::path& file) const;
  /// The path below a root; absent for names that would leave it, by dots or by links.
  std::optional<std::filesystem::path> inside(std::size_t root, const std::vector<std::string>& names) const;
  /// True for a path that is below a root where its links lead, too.
  bool is_inside(std::size_t root, const std::filesystem::path& path) const;

  std::vector<std::filesystem::path> roots_;  // canonical
  std::vector<std::string> names_;            // as the user gave them
  std::string token_;
  std::unique_ptr<AskedPoints> asked_;
  int port_ = 0;
};

}  // namespace carousel::app
