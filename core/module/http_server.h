#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

namespace carousel {

/// A request as it came; the path is decoded and without what follows a question mark.
struct HttpRequest {
  std::string method, path, host;
  std::vector<std::pair<std::string, std::string>> query{};  ///< what follows it, decoded
};

struct HttpAnswer {
  int status = 404;
  std::string type = "text/plain; charset=utf-8";
  std::string body{};
};

/// The interface of the module `http`, a server by cpp-httplib.
struct HttpModule {
  static constexpr const char* kModule = "http";

  /// Answers requests to 127.0.0.1 and to no other address until `stop` is requested. `port` 0 takes a free one;
  /// `ready` is called with the port before the first request. `answer` is called by several threads at once, for every
  /// method and path. Throws FileError if the port cannot be had.
  void (*serve)(int port, const std::function<HttpAnswer(const HttpRequest&)>& answer,
                const std::function<void(int port)>& ready, const std::stop_token& stop);
};

}  // namespace carousel
