#pragma once

#include <map>
#include <memory>
#include <tuple>

#include "tests/accel/structure/passing_scenes.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus {

/// The scenes of the factors `scene.builtin`, `scene.levels`, `test.non_opaque` and `test.away`, each built when a
/// machine asks for it.
class Scenes {
 public:
  TestScene& of(const Cell& cell);

 private:
  accel::HashedStop accept_some_{0.4};
  std::map<std::tuple<BuiltinScene, std::int64_t, bool, float>, std::unique_ptr<TestScene>> scenes_;
};

}  // namespace carousel::ringbus
