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

/// A plugin of a run.
struct Plugin {
  std::string file, name, version, digest;
  std::vector<std::string> brings;
};

template <class V>
void describe(V& v, const Plugin& r) {
  v.field("file", r.file, "", "path of the shared library");
  v.field("name", r.name, "", "its own name");
  v.field("version", r.version, "", "its own version");
  v.field("digest", r.digest, "", "digest of the contents of the file");
  v.field("brings", r.brings, "", "values of keys that it brings: what it is, and its name");
}

}  // namespace carousel::report
