#pragma once

#include <cstdint>
#include <string>

namespace carousel::report {

/// 1234567 as "1,234,567", whatever the locale.
std::string grouped(std::uint64_t value);

/// Bytes in the unit a person would choose: "512 B", "1.5 MiB".
std::string bytes_text(std::uint64_t bytes);

/// Seconds likewise: "12.3 ms", "4.56 s", "3 min 5 s".
std::string seconds_text(double seconds);

/// A count or a rate with its thousands named: "950", "1.23 M", "4.56 G".
std::string scaled(double value);

/// A fraction as "12.3 %".
std::string percent(double fraction);

/// Shortest decimal form that reads back to the same float; "inf", "-inf" and "nan" as such.
std::string float_text(float value);

}  // namespace carousel::report
