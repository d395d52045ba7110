// libFuzzer target: any bytes either load as a glTF scene or end in a SceneError.
//   clang++ -fsanitize=fuzzer,address,undefined ... tests/fuzz/gltf_fuzz.cpp
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/system/error.h"
#include "scene/gltf/bounded_import.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    carousel::scene::load_gltf_within(std::uint64_t{512} << 20, std::as_bytes(std::span(data, size)), "fuzz");
  } catch (const carousel::SceneError&) {
    // The only exception allowed; any other ends the process and is reported.
  }
  return 0;
}
