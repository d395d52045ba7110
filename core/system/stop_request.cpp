#include "core/system/stop_request.h"

#include <mutex>
#include <utility>

#include <poll.h>

namespace carousel {

namespace {

constexpr int kLookMs = 50;  // between looks for a request

std::mutex g_mutex;
std::stop_token g_token;

bool stopped() {
  const std::lock_guard lock(g_mutex);
  return g_token.stop_requested();
}

}  // namespace

StopScope::StopScope(std::stop_token token) {
  const std::lock_guard lock(g_mutex);
  g_token = std::move(token);
}

StopScope::~StopScope() {
  const std::lock_guard lock(g_mutex);
  g_token = {};
}

void throw_if_stopped(const std::string& what) {
  if (stopped()) throw Interrupted("waited for " + what);
}

void wait_for(int descriptor, short events, const std::string& what) {
  for (pollfd one{descriptor, events, 0}; poll(&one, 1, kLookMs) <= 0;) throw_if_stopped(what);
}

}  // namespace carousel
