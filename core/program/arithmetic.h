#pragma once

#include <cmath>

#include "core/program/program.h"

namespace carousel {

/// The value that an instruction writes to its register, rounded once. Data that was read is 0: no program sees its
/// values.
inline float value_of(const Instruction& i, float a, float b, float c) {
  switch (i.op) {
    case Op::kLoad:
      return i.value;
    case Op::kMove:
      return a;
    case Op::kAdd:
      return a + b;
    case Op::kSub:
      return a - b;
    case Op::kMul:
      return a * b;
    case Op::kFma:
      return std::fma(a, b, c);
    case Op::kDiv:
      return a / b;
    case Op::kSqrt:
      return std::sqrt(a);
    case Op::kMin:
      return a < b ? a : b;
    case Op::kMax:
      return a > b ? a : b;
    case Op::kAbs:
      return std::fabs(a);
    case Op::kNeg:
      return -a;
    case Op::kFloor:
      return std::floor(a);
    case Op::kLess:
      return a < b ? 1.0f : 0.0f;
    case Op::kLessEqual:
      return a <= b ? 1.0f : 0.0f;
    case Op::kEqual:
      return a == b ? 1.0f : 0.0f;
    case Op::kSelect:
      return a != 0 ? b : c;
    default:
      return 0;
  }
}

}  // namespace carousel
