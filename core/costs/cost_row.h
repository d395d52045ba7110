#pragma once

#include <cstdint>
#include <string_view>

namespace carousel {

// The joules of an event and the square millimetres of a part. The keys of `energy` and `area`, the report, its pages
// and the documentation iterate over this one table. The profiles are never mixed: every number of a run is of one
// process, apart from the numbers that the configuration gives itself.

/// A process: 45 nm and 0.9 V with DDR3, or 7 nm with GDDR6.
enum class CostProfile : std::uint8_t { kNone, kN45, kN7 };

enum class Cost : std::uint8_t {
  // Joules of a test, in the order of UnitKind.
  kBoxTest,
  kTriangleTest,
  kPlaneTest,
  kBundleTest,
  kTransform,
  kProceduralTest,
  kAnyHitTest,
  kMicromapTest,
  kHitBufferStep,
  kDecode,
  kReciprocal,
  // Joules of other events.
  kHop,
  kWire,
  kSram8,
  kSram32,
  kSram1024,
  kDram,
  kDramActivation,
  kHbm,
  kHbmActivation,
  kShade,
  kProduct,
  kLookup,
  kSimpleInstruction,
  kProductInstruction,
  kDivideInstruction,
  kBranchInstruction,
  kSilhouetteTest,
  kEdgeTest,
  kPrefetchVote,
  // Areas of a unit, in the order of UnitKind.
  kBoxUnit,
  kTriangleUnit,
  kPlaneUnit,
  kBundleUnit,
  kTransformUnit,
  kProceduralUnit,
  kAnyHitUnit,
  kMicromapUnit,
  kHitBufferUnit,
  kDecoderUnit,
  kReciprocalUnit,
  // Areas of other parts.
  kSramArea,
  kPortArea,
  kShaderArea,
  kWirePitch,
  kSilhouetteUnit,
  kEdgeUnit,
};

/// The support of a number: it stands in the source; it is computed from numbers of the source by the rule that the
/// source's text names; or nothing that was found supports it.
enum class Basis : std::uint8_t { kPublished, kDerived, kAssumed };

struct CostValue {
  float value;
  Basis basis;
  std::string_view source;
};

struct CostRow {
  Cost cost;
  std::string_view section;  ///< section of the configuration: energy or area
  std::string_view key;
  const char* unit;
  const char* meaning;  ///< a sentence
  CostValue n45, n7;
};

namespace cost_sources {
using std::string_view;
inline constexpr string_view kHorowitz = "Horowitz, ISSCC 2014";
inline constexpr string_view kHbm2 = "HBM2: O'Connor et al., MICRO 2017";
}  // namespace cost_sources

}  // namespace carousel
