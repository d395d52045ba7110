#pragma once

#include <string>

#include "report/compare/comparison.h"
#include "report/html/run_page.h"
#include "report/html/studies/compare_page.h"
#include "report/html/studies/study_pages.h"
#include "report/html/studies/sweep_page.h"
#include "report/read/document.h"
#include "report/run/report_difference.h"

namespace carousel::report {

/// Has everything read a document that is checked: all pages, and a comparison with another run. Gives the pages.
inline std::string show_document(const Document& document, const nlohmann::ordered_json& other_run) {
  const nlohmann::ordered_json& json = document.json;
  const auto run = [&](const nlohmann::ordered_json& report) {
    std::string out = html::run_page(report, {});
    for (const bool first : {true, false}) {
      const ComparedRun one{"one", report}, other{"other", other_run};
      const Comparison comparison = compare_runs(first ? std::vector{one, other} : std::vector{other, one});
      out += html::compare_page(comparison, true);
      // These are no pages.
      comparison_table(comparison, true);
      comparison_json(comparison, true);
      first_differing_epoch(report, other_run);
    }
    return out;
  };
  switch (document.kind) {
    case DocumentKind::kRun:
      return run(json);
    case DocumentKind::kPoint:
      return json.contains("report") ? run(json["report"]) : "";
    case DocumentKind::kSweep:
      return html::sweep_page(json, "out");
    case DocumentKind::kAccuracy:
      return html::accuracy_page(json);
    case DocumentKind::kStress:
      return html::stress_page(json);
    default:
      return html::ray_life_page(json);
  }
}

}  // namespace carousel::report
