#pragma once

#include "accel/certificate/placement_cases.h"
#include "accel/certificate/quad_inverse.h"
#include "tests/accel/test_rays.h"
