#pragma once

namespace carousel {

/// The interface of a module for tests.
struct Probe {
  static constexpr const char* kModule = "probe";
  int (*number)() = nullptr;
  void (*fail)(int how) = nullptr;
};

}  // namespace carousel
