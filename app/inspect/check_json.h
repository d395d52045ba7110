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

/// The key to change in a machine whose links can fill up and stop.
const char* stuck_key(const Config& config);

/// The same command's answer where `error` refuses the configuration, its scene or a file: each error with its place,
/// as far as that is known. Throws `error` again if it is neither a ConfigError nor a SceneError nor a FileError.
nlohmann::ordered_json refusal_json(const std::string& file, const std::exception_ptr& error);

}  // namespace carousel::app
