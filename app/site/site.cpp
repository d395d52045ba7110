#include "app/site/site.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <random>

#include <fmt/format.h>

#include "app/site/live_sweep.h"
#include "app/site/result_page.h"
#include "core/system/error.h"
#include "report/html/page.h"

namespace carousel::app {

namespace fs = std::filesystem;
using report::html::Html;
using report::html::markup;

namespace {

constexpr std::size_t kMostFolders = 2000;
constexpr std::uintmax_t kMostBytes = 256u << 20;

std::string draw_token() {
  std::random_device device;  // /dev/urandom
  std::string out;
  for (int i = 0; i < 4; ++i) out += fmt::format("{:08x}", device());
  return out;
}

/// Takes as long for every guess.
bool same_token(const std::string& a, const std::string& b) {
  unsigned differs = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    differs |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return differs == 0;
}

std::vector<std::string> parts_of_path(const std::string& path) {
  std::vector<std::string> out;
  for (std::size_t begin = 0; begin < path.size();) {
    if (path[begin] == '/') {
      ++begin;
      continue;
    }
    const std::size_t end = std::min(path.find('/', begin), path.size());
    out.push_back(path.substr(begin, end - begin));
    begin = end;
  }
  return out;
}

HttpAnswer refusal(int status, const char* text) {
  return {status, "text/plain; charset=utf-8", std::string(text) + "\n"};
}

HttpAnswer page(std::string html) {
  return {200, "text/html; charset=utf-8", std::move(html)};
}

/// The types of files that are handed out; others are not.
const char* type_of(const fs::path& file) {
  static constexpr std::array<std::pair<std::string_view, const char*>, 6> kTypes{{
      {".json", "application/json"},
      {".csv", "text/csv; charset=utf-8"},
      {".png", "image/png"},
      {".webp", "image/webp"},
      {".yaml", "text/plain; charset=utf-8"},
      {".exr", "application/octet-stream"},
  }};
  const std::string ending = file.extension().string();
  for (const auto& [known, type] : kTypes)
    if (ending == known) return type;
  return nullptr;
}

/// As a link within the site has it.
std::string encoded(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool plain =
        std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view("-._~/").find(c) != std::string_view::npos;
    out += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

bool is_unfinished_sweep(const fs::path& folder) {
  std::error_code ignored;
  return is_sweep(folder) && !fs::exists(folder / "sweep.json", ignored);
}

bool holds_results(const fs::path& folder) {
  return !results_in(folder).empty() || is_sweep(folder);
}

/// The folders with results in and below a root, by name: kMostFolders at most, and those to a depth of four.
std::vector<fs::path> folders_with_results(const fs::path& root) {
  std::vector<fs::path> out;
  if (holds_results(root)) out.push_back(root);
  std::error_code error;
  for (auto at = fs::recursive_directory_iterator(root, fs::directory_options::skip_permission_denied, error);
       !error && at != fs::recursive_directory_iterator() && out.size() < kMostFolders; at.increment(error)) {
    std::error_code ignored;
    if (!at->is_directory(ignored) || at->is_symlink(ignored)) continue;
    const std::string name = at->path().filename().string();
    if (name == "points" || name.starts_with('.') || at.depth() > 3) {
      at.disable_recursion_pending();
      continue;
    }
    if (holds_results(at->path())) out.push_back(at->path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// The kinds of the results in a folder, as the list of the site names them, such as "run, sweep, unfinished".
std::string kinds_in(const fs::path& folder) {
  std::string out;
  for (const fs::path& file : results_in(folder))
    out += (out.empty() ? "" : ", ") + (file.stem() == "report" ? std::string("run") : file.stem().string());
  if (is_unfinished_sweep(folder)) out += out.empty() ? "sweep, unfinished" : ", sweep, unfinished";
  return out;
}

}  // namespace

Site::Site(const std::vector<std::string>& roots)
    : names_(roots), token_(draw_token()), asked_(std::make_unique<AskedPoints>()) {
  for (const std::string& root : roots) {
    std::error_code error;
    const fs::path real = fs::canonical(root, error);
    if (error || !fs::is_directory(real, error))
      throw FileError(fmt::format("{}: expected a folder of results, found none", root));
    roots_.push_back(real);
  }
}

std::optional<fs::path> Site::inside(std::size_t root, const std::vector<std::string>& names) const {
  fs::path out = roots_[root];
  for (const std::string& name : names) {
    if (name.empty() || name[0] == '.' || name.find_first_of(std::string_view("\\\0", 2)) != name.npos) return {};
    out /= name;
  }
  if (!is_inside(root, out)) return {};
  std::error_code error;
  const fs::path real = fs::weakly_canonical(out, error);
  if (error) return {};
  return real;
}

bool Site::is_inside(std::size_t root, const fs::path& path) const {
  std::error_code error;
  const fs::path real = fs::weakly_canonical(path, error);
  const auto [left, right] = std::mismatch(roots_[root].begin(), roots_[root].end(), real.begin(), real.end());
  return !error && left == roots_[root].end();
}

HttpAnswer Site::index() const {
  std::vector<report::html::Section> sections;
  for (std::size_t r = 0; r < roots_.size(); ++r) {
    Html list;
    const std::vector<fs::path> folders = folders_with_results(roots_[r]);
    for (const fs::path& folder : folders) {
      const std::string below = folder == roots_[r] ? "" : folder.lexically_relative(roots_[r]).string() + "/";
      list += markup("<li><a href=\"{}/{}\">{}</a>: {}</li>\n", r, encoded(below), below.empty() ? names_[r] : below,
                     kinds_in(folder));
    }
    sections.push_back(
        {fmt::format("folder-{}", r), names_[r],
         list.empty() ? markup("<p>This folder holds no results yet.</p>\n") : markup("<ul>\n{}</ul>\n", list)});
    if (folders.size() == kMostFolders)
      sections.back().body +=
          markup("<p>This folder may hold more results: the list ends at {} folders.</p>\n", kMostFolders);
  }
  return page(report::html::page_of("Carousel: results", "carousel serve, on this machine only", sections,
                                    nlohmann::ordered_json::object(), {}));
}

HttpAnswer Site::file_of(std::size_t root, const fs::path& file) const {
  std::error_code error;
  if (file.extension() == ".html") {
    // Made anew, so that it is of this version and of the results as they are.
    fs::path json = file;
    json.replace_extension(".json");
    if (!is_inside(root, json) || !fs::is_regular_file(json, error)) return refusal(404, "not found");
    return page(page_of_file(report::read_document(json), json, true));
  }
  const char* type = type_of(file);
  if (type == nullptr || !fs::is_regular_file(file, error)) return refusal(404, "not found");
  if (fs::file_size(file, error) > kMostBytes || error) return refusal(413, "the file is too large for this site");
  std::ifstream in(file, std::ios::binary);
  return {200, type, std::string(std::istreambuf_iterator<char>(in), {})};
}

HttpAnswer Site::folder_page(std::size_t root, const fs::path& folder) const {
  std::vector<fs::path> results = results_in(folder);
  std::erase_if(results, [&](const fs::path& file) { return !is_inside(root, file); });
  if (is_unfinished_sweep(folder) && is_inside(root, folder / "points")) return page(live_sweep_page(folder));
  if (results.size() == 1) return page(page_of_file(report::read_document(results.front()), results.front(), true));
  if (results.empty()) return refusal(404, "not found");
  Html list;
  for (const fs::path& file : results) list += markup("<li><a href=\"{0}.html\">{0}</a></li>\n", file.stem().string());
  return page(report::html::page_of("Carousel: " + names_[root], folder.filename().string(),
                                    {{"results", "Results of this folder", markup("<ul>\n{}</ul>\n", list)}},
                                    nlohmann::ordered_json::object(), {}));
}

HttpAnswer Site::ask(std::size_t root, const fs::path& folder, const HttpRequest& request) const {
  std::error_code ignored;
  if (!is_inside(root, folder / "sweep.json") || !fs::exists(folder / "sweep.json", ignored) ||
      !is_inside(root, folder / "points") || !is_inside(root, folder / "asked"))
    return refusal(404, "not found");
  if (request.method == "POST") return asked_->start(folder, request.query);
  const bool named = request.query.size() == 1 && request.query[0].first == "name";
  return asked_->state(folder, named ? request.query[0].second : "");
}

HttpAnswer Site::answer(const HttpRequest& request) const {
  if (request.host != fmt::format("127.0.0.1:{}", port_) && request.host != fmt::format("localhost:{}", port_))
    return refusal(421, "this site is at 127.0.0.1 alone");
  std::vector<std::string> names = parts_of_path(request.path);
  if (names.empty() || !same_token(names.front(), token_)) return refusal(404, "not found");
  const bool asks = request.path.ends_with("/ask");
  if (request.method != "GET" && request.method != "HEAD" && !(asks && request.method == "POST"))
    return refusal(405, "this site is read; only a sweep is asked for a point");
  names.erase(names.begin());
  const bool folder = request.path.ends_with('/');
  if (names.empty()) return folder ? index() : refusal(404, "not found; the address ends with a slash");
  std::size_t root = 0;
  if (names.front().size() > 4 || names.front().find_first_not_of("0123456789") != std::string::npos)
    return refusal(404, "not found");
  root = static_cast<std::size_t>(std::stoul(names.front()));
  names.erase(names.begin());
  if (root >= roots_.size()) return refusal(404, "not found");
  const std::optional<fs::path> path = inside(root, names);
  if (!path) return refusal(404, "not found");
  if (asks) return ask(root, path->parent_path(), request);
  return folder ? folder_page(root, *path) : file_of(root, *path);
}

}  // namespace carousel::app
