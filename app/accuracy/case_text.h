#pragma once

#include <span>
#include <string>
#include <string_view>

#include "accel/certificate/property.h"
#include "core/system/error.h"

namespace carousel::app {

/// One case of a property at one level.
struct CertificateCase {
  const accel::Property* property = nullptr;
  AccuracyConfig level;
  accel::CaseValues values;
};

/// `PROPERTY LEVEL field=number,number ... field=...`, every field of the property in its order, numbers as C's %a
/// writes them: when read again, they are the same to the bit (except a NaN's payload).
std::string case_text(const accel::Property& property, const AccuracyConfig& level, const accel::CaseValues& values);

/// Numbers in decimal are read as well, and rounded. `place` is the position of the text's start. Throws a ConfigError
/// with the position and the expected text. The result points into `properties`.
CertificateCase parse_case(std::string_view text, std::span<const accel::Property> properties,
                           const SourcePosition& place);

}  // namespace carousel::app
