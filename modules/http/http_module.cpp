#include <httplib.h>

#include "core/module/http_server.h"
#include "core/module/module.h"
#include "core/system/error.h"

namespace carousel {

namespace {

constexpr const char* kAddress = "127.0.0.1";

void serve(int port, const std::function<HttpAnswer(const HttpRequest&)>& answer, const std::function<void(int)>& ready,
           const std::stop_token& stop) {
  httplib::Server server;
  // Each request has a connection of its own: its body is never read, and would be taken for the next request.
  server.set_keep_alive_max_count(1);
  // An idle connection holds one of the threads, and the end of the program, for as long.
  server.set_read_timeout(2, 0);
  constexpr std::size_t kAtOnce = 64;
  server.new_task_queue = [] { return new httplib::ThreadPool(kAtOnce); };  // the server deletes it
  // In place of SO_REUSEPORT, which would let another process of this user share the port.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server.set_pre_routing_handler([&](const httplib::Request& request, httplib::Response& response) {
    HttpAnswer out;
    try {
      out = answer({request.method,
                    request.path,
                    request.get_header_value("Host"),
                    {request.params.begin(), request.params.end()}});
    } catch (const std::exception& error) {
      out = {500, "text/plain; charset=utf-8", std::string(error.what()) + "\n"};
    }
    response.status = out.status;
    response.set_header("Cache-Control", "no-store");
    response.set_header("Referrer-Policy", "no-referrer");
    response.set_header("X-Content-Type-Options", "nosniff");
    response.set_header("X-Frame-Options", "DENY");
    response.set_header("Cross-Origin-Resource-Policy", "same-origin");
    response.set_content(std::move(out.body), out.type);
    return httplib::Server::HandlerResponse::Handled;
  });
  const int bound = port == 0 ? server.bind_to_any_port(kAddress) : server.bind_to_port(kAddress, port) ? port : -1;
  if (bound <= 0) throw FileError("cannot listen on 127.0.0.1: the port " + std::to_string(port) + " is not to be had");
  const std::stop_callback on_stop(stop, [&] { server.stop(); });
  ready(bound);
  if (!stop.stop_requested()) server.listen_after_bind();
}

std::string library() {
  return std::string("cpp-httplib ") + CPPHTTPLIB_VERSION;
}

}  // namespace
}  // namespace carousel

const carousel::ModuleInfo* carousel_module() {
  using namespace carousel;
  static const HttpModule functions{serve};
  static const ModuleInfo info{.build = module_build(),
                               .name = HttpModule::kModule,
                               .brings = "a site of results on this machine (carousel serve)",
                               .library = library,
                               .functions = &functions};
  return &info;
}
