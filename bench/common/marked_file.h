#pragma once

#include <map>
#include <string>
#include <vector>

namespace carousel::bench {

/// The bytes of a file. Throws a FileError if it cannot be read.
std::string read_text(const std::string& file);

/// Replaces tables in documents. A table's text stands between `<!-- bench:NAME -->` and `<!-- /bench:NAME -->`; each
/// body goes to the first of `files` that has the markers of its name. Text outside the markers stays. Throws
/// std::runtime_error if no file has them; then no file has changed.
void replace_marked(const std::vector<std::string>& files, const std::map<std::string, std::string>& bodies);

}  // namespace carousel::bench
