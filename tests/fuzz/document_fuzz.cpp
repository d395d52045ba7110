// libFuzzer target: any text is either read as a document of ours, and then shown, or ends in a FileError.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/system/error.h"
#include "report/read/document.h"
#include "tests/report/read/sample_documents.h"
#include "tests/report/read/show_document.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace report = carousel::report;
  static const nlohmann::ordered_json kOther = report::report_json(report::sample_report());
  try {
    const report::Document document = report::parse_document({reinterpret_cast<const char*>(data), size}, "fuzz.json");
    report::show_document(document, kOther);
  } catch (const carousel::FileError&) {
    // The only exception allowed; any other ends the process and is reported.
  }
  return 0;
}
