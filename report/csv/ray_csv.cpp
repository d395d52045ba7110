#include "report/csv/ray_csv.h"

#include <algorithm>
#include <array>
#include <tuple>

#include "core/text/list_end.h"
#include "report/csv/ray_csv_columns.h"
#include "report/text/number_text.h"

namespace carousel::report {

namespace {

void append_ray(std::string& line, std::size_t number, const RayResult& result) {
  line += std::to_string(number);
  line += ',';
  line += kRayKindNames[static_cast<std::size_t>(result.tag.kind)];
  const Ray& ray = result.ray;
  for (const float value : {ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z,
                            ray.tmin, ray.tmax}) {
    line += ',';
    line += float_text(value);
  }
}

void append_flags(std::string& line, std::uint8_t flags) {
  char before = ',';
  for (const FlagWord& each : kFlagWords) {
    if ((flags & each.flag) == 0) continue;
    line += before;
    line += each.word;
    before = '+';
  }
  if (before == ',') line += before;
}

void append_hit(std::string& line, const RayResult& result) {
  const Hit& hit = result.hit;
  line += hit.valid() ? ",1" : ",0";
  if (result.tag.kind == RayKind::kShadow) {
    line += ",,,,,";  // which triangle hid the light depends on the order of tests
  } else if (!hit.valid()) {
    line += ",inf,,,,";
  } else {
    line += ',' + float_text(hit.t) + ',' + std::to_string(hit.instance) + ',' + std::to_string(hit.primitive) + ',' +
            float_text(hit.u) + ',' + float_text(hit.v);
  }
}

void write_csv(AtomicFile& file, const std::vector<HitRow>& rows, bool hits, bool complete) {
  std::uint64_t written = 0;
  std::string line;
  const std::size_t columns = hits ? kColumns.size() : kRayColumns;
  for (std::size_t i = 0; i < columns; ++i) line += (i == 0 ? "" : ",") + std::string(kColumns[i]);
  const bool flags =
      std::any_of(rows.begin(), rows.end(), [](const HitRow& row) { return (row.result.tag.flags & kWordFlags) != 0; });
  if (flags) line.append(",").append(kFlagsColumn);
  file.write(line + "\n");
  // A ray of which each hit has a row keeps its number, and so do those between.
  const bool several =
      std::any_of(rows.begin(), rows.end(), [](const HitRow& row) { return (row.result.tag.flags & kRayAll) != 0; });
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool of_all = (rows[i].result.tag.flags & kRayAll) != 0;
    if (of_all && !hits && rows[i].sample > 0) continue;  // one row a hit: the ray itself has been written
    line.clear();
    append_ray(line, several ? rows[i].pixel : i, rows[i].result);
    if (hits) append_hit(line, rows[i].result);
    if (flags) append_flags(line, rows[i].result.tag.flags);
    line += '\n';
    file.write(line);
    ++written;
  }
  // The columns of whole hits are read by programs that know no such line.
  if (!hits || !complete) file.write(list_end(written, complete) + "\n");
}

}  // namespace

void sort_rows(std::vector<HitRow>& rows) {
  const auto key = [](const HitRow& row) {
    const RayTag& tag = row.result.tag;
    return std::tuple(row.pixel, row.sample, tag.bounce, tag.kind, tag.index);
  };
  std::sort(rows.begin(), rows.end(), [&](const HitRow& a, const HitRow& b) { return key(a) < key(b); });
}

void write_hits_csv(AtomicFile& file, const std::vector<HitRow>& rows, bool complete) {
  write_csv(file, rows, true, complete);
}

void write_rays_csv(AtomicFile& file, const std::vector<HitRow>& rows, bool complete) {
  write_csv(file, rows, false, complete);
}

}  // namespace carousel::report
