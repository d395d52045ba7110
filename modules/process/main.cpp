#include <cstdlib>

#include "core/module/module_process.h"

/// `process FOLDER NAME`: the process in which a module works on data of strangers (core/module/module_process.h).
int main(int argc, char** argv) {
  if (argc != 3) return 2;
  setenv("CAROUSEL_MODULES", argv[1], 1);
  return carousel::serve_module(argv[2]);
}
