#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "core/program/program.h"

namespace carousel {

/// The first thing that is wrong with a program.
struct ProgramFault {
  std::size_t line = 0;    ///< its instruction, from 0
  std::size_t column = 0;  ///< of the word in the instruction's text, from 0
  std::string message;     ///< what is expected, and what is found
};

/// The program of the texts, an instruction each, with the numbers that `load` finds by name. Absent if something is
/// wrong: then `fault` says what.
std::optional<RayProgram> compile_program(std::span<const std::string> texts,
                                          const std::map<std::string, double>& parameters, const OpLatencies& latencies,
                                          ProgramFault& fault, const ProgramUse& use = kPrimitiveUse);

}  // namespace carousel
