#pragma once

namespace carousel::scene {

/// The module that reads scene files other than glTF (core/module/module.h). It works in a process of its own
/// (core/module/module_process.h), which is asked an ImportQuestion and answers with an Imported, in bytes as
/// scene/import/wire.h writes them.
struct ImportModule {
  static constexpr const char* kModule = "scenes";

  /// The endings of the files that it reads, in lower case, without points, sorted and with a blank between them.
  const char* (*endings)() = nullptr;
};

}  // namespace carousel::scene
