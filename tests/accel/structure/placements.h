#pragma once

#include "accel/certificate/placement_cases.h"
#include "accel/certificate/quad_inverse.h"
#include "tests/accel/traverse/test_rays.h"
