#pragma once

#include <string>

#include "ringbus/verdict/foretell.h"

namespace carousel::ringbus {

/// By what the frame that a pilot foretells differs from the run: its cycles, or the busy time of a class of parts, by
/// more than its uncertainty and what two schedules differ by for no reason that a pilot could know. Empty if they are
/// alike.
std::string unlikeness(const Foretelling& foretold, const cycle::CycleResult& run);

}  // namespace carousel::ringbus
