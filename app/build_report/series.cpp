#include "app/build_report/series.h"

namespace carousel::app {

report::TimeSeries series_section(const ringbus::TimeSeries& series) {
  report::TimeSeries out{std::string(series.unit), series.interval, series.samples};
  for (const ringbus::SeriesRow& row : series.rows)
    out.rows.push_back({row.part, row.quantity, std::string(row.unit),
                        row.kind == ringbus::SeriesRow::Kind::kSum ? "sum" : "mean", row.values});
  return out;
}

}  // namespace carousel::app
