#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <sys/types.h>

#include "app/sweep/process/point_run.h"

namespace carousel::app {

/// A process that holds a scene with its acceleration structure, and forks a process a point. It has no threads when it
/// forks: those of the build end with it. It ends, with its points, when the coordinator closes the socket or dies.
///
/// Messages are JSON, one a packet of the socket (unix(7), SOCK_SEQPACKET).
///   to the host:   {"id", "keys", "sets", "digest"}
///   from it:       {"ready": true}                              the scene is built
///                  {"broken": {"kind", "text"}}                 it cannot be built; the host ends
///                  {"id", "seconds", "error": null | {"kind", "text"}, "written"}
struct SceneHost {
  pid_t pid = -1;
  int socket = -1;
};

/// Forks a host for the group of `first`. `close_these` are the coordinator's descriptors that it must not hold. Throws
/// FileError if the system has no more processes or descriptors.
SceneHost start_scene_host(const SweepSetup& setup, const SweepPoint& first, std::size_t build_threads,
                           const std::vector<int>& close_these);

/// Sends or receives one message; false, or empty text, if the other side is gone.
bool send_message(int socket, const std::string& text);
std::string receive_message(int socket);

}  // namespace carousel::app
