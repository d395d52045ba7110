#include "core/module/module.h"

namespace carousel {

namespace {

// One text, so that it stands in the file as a whole; core/module/module.cpp looks for its first words and its end.
constexpr char kBuild[] = "carousel module of build " CAROUSEL_MODULE_BUILD "\n";

}  // namespace

const char* module_build() {
  return kBuild;
}

}  // namespace carousel
