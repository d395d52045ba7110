#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

#include "core/system/atomic_file.h"
#include "core/types/workload.h"

namespace carousel::report {

/// A completed ray and the place in the picture it belongs to.
struct HitRow {
  std::uint32_t pixel = 0, sample = 0;
  RayResult result;
};

/// Sorts by pixel, sample, bounce, kind and index within the kind: an order that no engine can change.
void sort_rows(std::vector<HitRow>& rows);

/// One row a ray, in the order given; `ray` is the row's number. Columns of docs/reference/report, world space,
/// floats with the fewest digits that read back to the same bits. A miss has t = inf and no instance,
/// primitive, u and v; of a shadow ray only `hit` is known. If a ray has flags (ray_csv_columns.h) there is a last
/// column of them. The hits of a run that was interrupted (not `complete`) end in a line that says so
/// (core/text/list_end.h). Throws FileError.
void write_hits_csv(AtomicFile& file, const std::vector<HitRow>& rows, bool complete);

/// The first ten of these columns, and that of the flags: the rays without their hits, and always that last line.
/// Throws FileError.
void write_rays_csv(AtomicFile& file, const std::vector<HitRow>& rows, bool complete);

/// Rays to trace, in file order: a header and at least the first ten columns; of further ones only `flags` is
/// read, so that a hits.csv can be read too. A last line that counts the rays has to be right; an empty list, and one
/// of an interrupted run, is refused. The tag's path is the row's number. Throws a ConfigError with the positions of
/// the first problems, of which more than `most` rays is one, and FileError when the file cannot be read.
inline constexpr std::size_t kMostRays = 100'000'000;
RayBatch read_rays_csv(const std::filesystem::path& path);
RayBatch read_rays_csv(std::istream& in, const std::string& name, std::size_t most = kMostRays);

}  // namespace carousel::report
