#pragma once

#include <string>

namespace carousel::bench {

/// `text` with what stands between `<!-- bench:NAME -->` and `<!-- /bench:NAME -->` replaced by `body`, on
/// lines of its own. Text outside the markers is not touched. Throws std::runtime_error when a marker is
/// missing.
std::string replace_marked(const std::string& text, const std::string& name, const std::string& body);

}  // namespace carousel::bench
