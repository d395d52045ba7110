#pragma once

#include <exception>
#include <string>

#include <nlohmann/json.hpp>

#include "app/run/prepare.h"
#include "ringbus/protocol/deadlock.h"

namespace carousel::app {

/// What `carousel check --json` prints of a configuration that can be prepared: its resolved keys, scene, memory in
/// bytes, network and verdict on deadlock, and what is wrong with it. `strict`: warnings and ignored keys make it
/// invalid.
nlohmann::ordered_json check_json(const std::string& file, const Prepared& prepared,
                                  const ringbus::DeadlockVerdict& verdict, bool strict);

/// What it prints of a configuration, scene or file that is refused: each error with its place, as far as it is known.
/// Throws `error` again if it is of another kind.
nlohmann::ordered_json refusal_json(const std::string& file, const std::exception_ptr& error);

}  // namespace carousel::app
