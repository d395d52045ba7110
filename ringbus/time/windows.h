#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "ringbus/time/agent.h"
#include "ringbus/time/wakeup_table.h"

namespace carousel::ringbus {

/// When all threads run a machine, and not one of them alone: always, or while they are faster together.
enum class Sharing { kAlways, kWhenFaster };

/// Runs agents to the end of time: window after window of `lookahead` cycles, the least latency between any two
/// agents (conservative synchronous windows; R. Fujimoto, Parallel discrete event simulation, CACM 33 (1990)).
/// The result is the same for any number of threads. While fewer than eight agents a thread have something to do in a
/// window, all run on the calling thread: to wait for each other would take longer. With Sharing::kWhenFaster they do
/// so too while that is measured to be faster, as on a host whose cores have other work.
///
/// `parts[t]` are the agents of thread t; parts[0] runs on the calling thread. `keep_running` is called there before
/// every 64th window with its first cycle, while no agent runs, so that it may look at all of them; when it answers
/// false the run ends early. Exceptions of agents pass through. Returns the last window's first cycle, the time
/// reached.
///
/// `look` is called on the calling thread too, while no agent runs, at times that it chooses: first at
/// `first_look`, and then at the time that it returned last, which is later each time. All agents have then done
/// what they do before that time and nothing that they do at it or later. A window in which such a time lies is run in
/// two parts, so that its looks change nothing.
///
/// Agents that are not polled() must have all their channels connected to `wakeups`, which was made for `parts`.
Cycle run_windows(std::span<const std::vector<Agent*>> parts, WakeupTable& wakeups, Cycle lookahead, Sharing sharing,
                  const std::function<bool(Cycle)>& keep_running, const std::function<Cycle(Cycle)>& look = {},
                  Cycle first_look = kNever);

}  // namespace carousel::ringbus
