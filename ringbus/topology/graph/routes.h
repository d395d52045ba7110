#pragma once

#include "core/config/graph/routes.h"

namespace carousel::ringbus {

using config::Routes;

}  // namespace carousel::ringbus
