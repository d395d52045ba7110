#pragma once

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

namespace carousel {

/// Prints a table, and appends it to the file that CAROUSEL_TABLES names: script/accuracy-tables makes docs of it.
inline void publish(const std::string& table) {
  std::cout << table;
  if (const char* file = std::getenv("CAROUSEL_TABLES")) std::ofstream(file, std::ios::app) << table;
}

}  // namespace carousel
