#pragma once

#include "accel/certificate/property.h"

namespace carousel::app {

/// A ray that leaves a triangle of an instance does not meet it, up to a million units from the world's origin.
accel::Property spawn_property();

}  // namespace carousel::app
