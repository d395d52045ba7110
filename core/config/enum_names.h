#pragma once

#include "core/config/config.h"
#include "core/types/enum_names.h"
