#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "core/costs/cost_row.h"
#include "core/costs/operations.h"
#include "core/types/unit_kind.h"

namespace carousel {

namespace cost_detail {

/// A text that is put together when the program is compiled.
class SourceText {
 public:
  constexpr SourceText& add(std::string_view text) {
    for (const char c : text) chars_[size_++] = c;
    return *this;
  }
  constexpr SourceText& add(int number) {
    if (number >= 10) add(number / 10);
    chars_[size_++] = static_cast<char>('0' + number % 10);
    return *this;
  }
  /// A number of operations, behind a comma unless it comes first; none if it is 0.
  constexpr SourceText& count(int number, std::string_view one) {
    if (number == 0) return *this;
    if (size_ > 0) add(", ");
    add(number).add(" ").add(one);
    return number == 1 ? *this : add("s");
  }
  constexpr std::string_view view() const { return {chars_.data(), size_}; }

 private:
  std::array<char, 112> chars_{};
  std::size_t size_ = 0;
};

/// The operations of each method, with a source of their prices.
constexpr auto sources(std::string_view prices) {
  std::array<SourceText, kMethods.size()> out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Operations& o = kMethods[i].operations;
    out[i].count(o.products, "product").count(o.sums, "sum").count(o.comparisons, "comparison");
    out[i].count(o.divisions, "division").add("; ").add(prices);
  }
  return out;
}
inline constexpr auto kSources45 = sources(cost_sources::kHorowitz),
                      kSources7 = sources("Jouppi et al., ISCA 2021, Table 2");

constexpr CostValue joules45(Method method, Basis basis) {
  return {static_cast<float>(energy_of(method, kPicojoules45)), basis,
          kSources45[static_cast<std::size_t>(method)].view()};
}
constexpr CostValue joules7(Method method, Basis basis) {
  return {static_cast<float>(energy_of(method, kPicojoules7)), basis,
          kSources7[static_cast<std::size_t>(method)].view()};
}
/// An area in proportion to that of a box unit, to three digits.
constexpr CostValue beside_box(float box_mm2, Method method) {
  const double mm2 = static_cast<double>(box_mm2) * area_mm2(method) / area_mm2(Method::kSlab);
  const double digits = mm2 < 0.01 ? 1e5 : mm2 < 0.1 ? 1e4 : 1e3;
  return {static_cast<float>(static_cast<double>(static_cast<int>(mm2 * digits + 0.5)) / digits), Basis::kAssumed,
          "a box unit's, by the areas of their operations: Dally, NIPS 2015"};
}

}  // namespace cost_detail

/// The one table. Operations and their prices stand in core/costs/operations.h. A unit of 28 nm (GauTracer, HPCA 2026,
/// Table III) is scaled by (45/28)² to 45 nm, and by 0.15 to 7 nm, which assumes a half from 28 to 16 nm and 0.3 from
/// there.
inline constexpr auto kCostTable = [] {
  using enum Basis;
  using namespace cost_sources;
  constexpr std::string_view kE = "energy", kA = "area";
  using namespace cost_detail;
  constexpr float kBox45 = 0.126f, kBox7 = 0.0073f;
  const CostValue as_box45{kBox45, kAssumed, "as a box unit"}, as_box7{kBox7, kAssumed, "as a box unit"};
  return std::to_array<CostRow>({
      {Cost::kBoxTest, kE, "box", "pJ", "A test of a ray against a box.", joules45(Method::kSlab, kDerived),
       joules7(Method::kSlab, kDerived)},
      {Cost::kTriangleTest, kE, "triangle", "pJ", "A test of a ray against a triangle.",
       joules45(Method::kWatertight, kDerived), joules7(Method::kWatertight, kDerived)},
      {Cost::kPlaneTest, kE, "plane", "pJ", "A test of a ray against a cull plane.", joules45(Method::kPlane, kDerived),
       joules7(Method::kPlane, kDerived)},
      {Cost::kBundleTest, kE, "bundle", "pJ", "A test of a bundle by intervals, without its divisions.",
       joules45(Method::kIntervals, kDerived), joules7(Method::kIntervals, kDerived)},
      {Cost::kTransform, kE, "transform", "pJ", "A ray brought to model space.", joules45(Method::kTwoStep, kDerived),
       joules7(Method::kTwoStep, kDerived)},
      {Cost::kProceduralTest,
       kE,
       "procedural",
       "pJ",
       "A test of a ray against a procedural primitive.",
       {joules45(Method::kWatertight, kAssumed).value, kAssumed, "as a triangle"},
       {joules7(Method::kWatertight, kAssumed).value, kAssumed, "as a triangle"}},
      {Cost::kAnyHitTest,
       kE,
       "any_hit_unit",
       "pJ",
       "A decision if a non-opaque primitive is hit.",
       {45.8f, kAssumed, "6 products, 4 sums and 64 bits of 32 KB; Horowitz, ISSCC 2014"},
       {18, kAssumed, "6 products and 4 sums (Jouppi et al., ISCA 2021, Table 2), and 64 bits of 32 KB"}},
      {Cost::kMicromapTest,
       kE,
       "micromap_unit",
       "pJ",
       "A lookup in an opacity micromap.",
       {12.7f, kAssumed, "3 sums and 64 bits of 8 KB; Horowitz, ISSCC 2014"},
       {8.7f, kAssumed, "3 sums (Jouppi et al., ISCA 2021, Table 2), and 64 bits of 8 KB"}},
      {Cost::kHitBufferStep,
       kE,
       "hit_buffer",
       "pJ",
       "A hit compared with one of a ray's sorted buffer, without the bytes that are read and written.",
       {1.8f, kAssumed, "two comparisons, each as a sum of 32 bits; Horowitz, ISSCC 2014"},
       {0.8f, kAssumed, "two comparisons, each as a sum of 32 bits; Jouppi et al., ISCA 2021, Table 2"}},
      {Cost::kDecode,
       kE,
       "decoder",
       "pJ",
       "A block of compressed triangles decoded.",
       {14.4f, kAssumed, "48 sums of 32-bit integers, a shift as two; Horowitz, ISSCC 2014"},
       {4.3f, kAssumed, "48 sums of 32-bit integers, a shift as two; Jouppi et al., ISCA 2021, Table 2"}},
      {Cost::kReciprocal, kE, "reciprocal", "pJ", "A division: for a bundle, and of the three reciprocals of a ray.",
       joules45(Method::kDivision, kAssumed), joules7(Method::kDivision, kAssumed)},
      {Cost::kHop,
       kE,
       "hop",
       "pJ/byte",
       "A byte through the port of a link, without its wire.",
       {0.45f, kAssumed, "3.58 pJ a hop of 64 bits of which none switches, 32 nm: McKeown et al., HPCA 2018"},
       {0.16f, kAssumed, "the number of 32 nm, by the ratio of products of 45 and 7 nm"}},
      {Cost::kWire,
       kE,
       "wire",
       "pJ/byte/mm",
       "A byte over a millimetre of wire.",
       {0.96f, kDerived, "240 fJ a transition and mm at 40 nm, half of the bits switch: Keckler et al., Micro 2011"},
       {0.46f, kDerived, "115 fJ a transition and mm at 10 nm, half of the bits switch: Keckler et al., Micro 2011"}},
      {Cost::kSram8,
       kE,
       "sram_8_kib",
       "pJ",
       "An access of 64 bits to a store of 8 KiB. Other sizes are interpolated.",
       {10, kPublished, kHorowitz},
       {7.5f, kAssumed, "three quarters of 45 nm's; no source"}},
      {Cost::kSram32,
       kE,
       "sram_32_kib",
       "pJ",
       "An access of 64 bits to a store of 32 KiB.",
       {20, kPublished, kHorowitz},
       {8.5f, kAssumed, "two fifths of 45 nm's; no source"}},
      {Cost::kSram1024,
       kE,
       "sram_1_mib",
       "pJ",
       "An access of 64 bits to a store of 1 MiB.",
       {100, kPublished, kHorowitz},
       {14, kAssumed, "a seventh of 45 nm's; no source"}},
      {Cost::kDram,
       kE,
       "dram",
       "pJ/byte",
       "A byte from or to memory, unless it is HBM2.",
       {244, kDerived, "DDR3, activation included, the middle of 1.3 to 2.6 nJ for 64 bits: Horowitz, ISSCC 2014"},
       {52, kDerived, "GDDR6, activation included, the middle of 5.5 to 7.5 pJ a bit: Jouppi et al., ISCA 2021"}},
      {Cost::kDramActivation,
       kE,
       "dram_activation",
       "pJ",
       "An activation of a row, unless the memory is HBM2.",
       {0, kDerived, "contained in the bytes"},
       {0, kDerived, "contained in the bytes"}},
      {Cost::kHbm,
       kE,
       "hbm",
       "pJ/byte",
       "A byte from or to HBM2.",
       {20.3f, kDerived, "2.24 + 0.30 pJ a bit: O'Connor et al., MICRO 2017"},
       {20.3f, kDerived, "2.24 + 0.30 pJ a bit: O'Connor et al., MICRO 2017"}},
      {Cost::kHbmActivation,
       kE,
       "hbm_activation",
       "pJ",
       "An activation of a row of HBM2.",
       {909, kPublished, kHbm2},
       {909, kPublished, kHbm2}},
      {Cost::kShade,
       kE,
       "shade",
       "pJ",
       "A ray shaded as a plain surface or a miss.",
       {736, kAssumed, "160 products and sums, no instruction counted; Horowitz, ISSCC 2014"},
       {274, kAssumed, "160 products and sums, no instruction counted; Jouppi et al., ISCA 2021, Table 2"}},
      {Cost::kProduct,
       kE,
       "product",
       "pJ",
       "A product and a sum of a surface's effects.",
       {4.6f, kDerived, "a product and a sum; Horowitz, ISSCC 2014"},
       {1.71f, kDerived, "a product and a sum; Jouppi et al., ISCA 2021, Table 2"}},
      {Cost::kLookup,
       kE,
       "lookup",
       "pJ",
       "A filtered texture lookup.",
       {80, kAssumed, "8 texels of 4 bytes from 32 KB; Horowitz, ISSCC 2014"},
       {34, kAssumed, "8 texels of 4 bytes from 32 KB"}},
      {Cost::kSimpleInstruction,
       kE,
       "simple_instruction",
       "pJ",
       "A sum, comparison or move of a program, with its fetch and its registers.",
       {5.9f, kAssumed,
        "a sum (Horowitz, ISSCC 2014), and five accesses to registers and store of 1 pJ, for which no source was "
        "found"},
       {2.4f, kAssumed, "a sum (Jouppi et al., ISCA 2021, Table 2), and five accesses of 0.4 pJ likewise"}},
      {Cost::kProductInstruction,
       kE,
       "product_instruction",
       "pJ",
       "A mul or fma likewise.",
       {9.6f, kAssumed, "a product and a sum (Horowitz, ISSCC 2014), and five accesses of 1 pJ"},
       {3.7f, kAssumed, "a product and a sum (Jouppi et al., ISCA 2021, Table 2), and five accesses of 0.4 pJ"}},
      {Cost::kDivideInstruction,
       kE,
       "divide_instruction",
       "pJ",
       "A div or sqrt likewise.",
       {23.4f, kAssumed, "four products and sums, as of two steps of Newton, and five accesses"},
       {8.8f, kAssumed, "four products and sums, as of two steps of Newton, and five accesses"}},
      {Cost::kBranchInstruction,
       kE,
       "branch_instruction",
       "pJ",
       "A branch likewise.",
       {5.9f, kAssumed, "as a simple instruction"},
       {2.4f, kAssumed, "as a simple instruction"}},
      {Cost::kSilhouetteTest, kE, "silhouette", "pJ",
       "A test of a bundle by the silhouette of a box, without its edges.", joules45(Method::kSilhouette, kDerived),
       joules7(Method::kSilhouette, kDerived)},
      {Cost::kEdgeTest, kE, "edge", "pJ", "A test of a bundle against an edge of a silhouette.",
       joules45(Method::kEdge, kDerived), joules7(Method::kEdge, kDerived)},
      {Cost::kPrefetchVote,
       kE,
       "prefetch_vote",
       "pJ",
       "A vote of a ray for the treelet in which its next node is.",
       {11.8f, kAssumed, "two sums and 64 bits of 8 KB; Horowitz, ISSCC 2014"},
       {8.3f, kAssumed, "two sums (Jouppi et al., ISCA 2021, Table 2), and 64 bits of 8 KB"}},
      {Cost::kBoxUnit,
       kA,
       "box",
       "mm2",
       "A unit that tests boxes.",
       {kBox45, kDerived, "48,630 µm² at 28 nm: GauTracer, HPCA 2026, Table III; scaled"},
       {kBox7, kAssumed, "48,630 µm² at 28 nm: GauTracer, HPCA 2026, Table III; scaled"}},
      {Cost::kTriangleUnit,
       kA,
       "triangle",
       "mm2",
       "A unit that tests triangles.",
       {0.193f, kDerived, "74,577 µm² at 28 nm: GauTracer, HPCA 2026, Table III; scaled"},
       {0.0112f, kAssumed, "74,577 µm² at 28 nm: GauTracer, HPCA 2026, Table III; scaled"}},
      {Cost::kPlaneUnit, kA, "plane", "mm2", "A unit that tests cull planes.", beside_box(kBox45, Method::kPlane),
       beside_box(kBox7, Method::kPlane)},
      {Cost::kBundleUnit, kA, "bundle", "mm2",
       "A unit that tests bundles by intervals. By silhouettes it is one of area.silhouette, with an area.edge for "
       "each edge that it tests at once.",
       beside_box(kBox45, Method::kIntervals), beside_box(kBox7, Method::kIntervals)},
      {Cost::kTransformUnit,
       kA,
       "transform",
       "mm2",
       "A unit that brings rays to model space.",
       {0.0928f, kDerived, "35,942 µm² at 28 nm: GauTracer, HPCA 2026, Table III; scaled"},
       {0.0054f, kAssumed, "35,942 µm² at 28 nm: GauTracer, HPCA 2026, Table III; scaled"}},
      {Cost::kProceduralUnit,
       kA,
       "procedural",
       "mm2",
       "A unit that tests procedural primitives.",
       {0.193f, kAssumed, "as a triangle unit"},
       {0.0112f, kAssumed, "as a triangle unit"}},
      {Cost::kAnyHitUnit, kA, "any_hit_unit", "mm2", "A unit that decides on non-opaque primitives.", as_box45,
       as_box7},
      {Cost::kMicromapUnit,
       kA,
       "micromap_unit",
       "mm2",
       "A unit that looks opacity micromaps up.",
       {0.021f, kAssumed, "a sixth of a box unit, which has six products"},
       {0.0012f, kAssumed, "a sixth of a box unit, which has six products"}},
      {Cost::kHitBufferUnit,
       kA,
       "hit_buffer",
       "mm2",
       "A unit that puts hits into sorted buffers.",
       {0.021f, kAssumed, "a sixth of a box unit, whose products and sums it lacks"},
       {0.0012f, kAssumed, "a sixth of a box unit, whose products and sums it lacks"}},
      {Cost::kDecoderUnit,
       kA,
       "decoder",
       "mm2",
       "A unit that decodes compressed triangles.",
       {0.0126f, kAssumed, "a tenth of a box unit: 12 integer sums and shifts a cycle"},
       {0.00073f, kAssumed, "a tenth of a box unit: 12 integer sums and shifts a cycle"}},
      {Cost::kReciprocalUnit, kA, "reciprocal", "mm2", "A unit that divides for bundles.",
       beside_box(kBox45, Method::kDivision), beside_box(kBox7, Method::kDivision)},
      {Cost::kSramArea,
       kA,
       "sram",
       "mm2/KiB",
       "Storage on the chip.",
       {0.00456f, kDerived, "0.609 mm² for 64 KB at 65 nm: SimTRaX's table of CACTI; scaled by (45/65)²"},
       {0.00034f, kAssumed, "bit cells of 0.027 µm² (Chang et al., ISSCC 2017), of which 65 % of the area consists"}},
      {Cost::kPortArea,
       kA,
       "port",
       "mm2/KiB",
       "What a second port adds to storage on the chip.",
       {0.00456f, kAssumed, "as much as the storage: a cell with two ports has twice the wires along each side"},
       {0.00034f, kAssumed, "as much as the storage: a cell with two ports has twice the wires along each side"}},
      {Cost::kShaderArea,
       kA,
       "shader",
       "mm2",
       "A product a cycle of a shader worker.",
       {0.021f, kAssumed, "a sixth of a box unit, which has six products"},
       {0.0012f, kAssumed, "a sixth of a box unit, which has six products"}},
      {Cost::kWirePitch,
       kA,
       "wire_pitch",
       "um",
       "The place that a wire of a link takes, beside the next one.",
       {0.28f, kAssumed, "twice the least pitch of a metal in the middle"},
       {0.08f, kAssumed, "twice the least pitch of a metal in the middle"}},
      {Cost::kSilhouetteUnit, kA, "silhouette", "mm2",
       "The part of a unit that tests bundles by silhouettes which does not test edges.",
       beside_box(kBox45, Method::kSilhouette), beside_box(kBox7, Method::kSilhouette)},
      {Cost::kEdgeUnit, kA, "edge", "mm2",
       "The part of it that tests an edge: one with bundles.edges: serial, six with parallel.",
       beside_box(kBox45, Method::kEdge), beside_box(kBox7, Method::kEdge)},
  });
}();

constexpr std::size_t cost_index(Cost cost) {
  return static_cast<std::size_t>(cost);
}

static_assert([] {
  for (std::size_t i = 0; i < kCostTable.size(); ++i)
    if (cost_index(kCostTable[i].cost) != i) return false;
  for (std::size_t i = 0; i < kUnitKinds.size(); ++i)  // a kind of unit has its row in both parts
    if (kCostTable[i].key != kUnitKinds[i].key || kCostTable[cost_index(Cost::kBoxUnit) + i].key != kUnitKinds[i].key)
      return false;
  return true;
}());

constexpr Cost energy_of(UnitKind kind) {
  return static_cast<Cost>(unit_index(kind));
}
constexpr Cost area_of(UnitKind kind) {
  return static_cast<Cost>(cost_index(Cost::kBoxUnit) + unit_index(kind));
}

}  // namespace carousel
