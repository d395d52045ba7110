#pragma once

#include <string>

namespace carousel::report {

/// The text with the noun behind each number that is 1 in the singular: "1 threads" as "1 thread", "1 inner nodes" as
/// "1 inner node". Units ("1 ms", "1 krays/s") and names before a colon ("1 cars: 4 triangles") stay. For lines whose
/// words are the program's own.
std::string singular(const std::string& text);

}  // namespace carousel::report
