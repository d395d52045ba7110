#pragma once

#include "report/sections/visitor.h"

namespace carousel::report {

struct Program {
  std::string version, commit, compiler, build_type;
  bool checked = false;
};

template <class V>
void describe(V& v, const Program& r) {
  v.field("version", r.version, "", "version of the program");
  v.field("commit", r.commit, "", "commit from which the program was built");
  v.field("compiler", r.compiler, "", "compiler and its version");
  v.field("build_type", r.build_type, "", "build type given to CMake");
  v.field("checked", r.checked, "", "true if every invariant was checked during the run");
}

}  // namespace carousel::report
