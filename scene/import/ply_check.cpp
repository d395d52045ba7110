#include "scene/import/ply_check.h"

#include <fstream>
#include <sstream>
#include <string>

#include "core/system/error.h"
#include "core/system/plain_text.h"

namespace carousel::scene {

void check_ply(const std::filesystem::path& file, std::uint64_t bytes) {
  constexpr std::size_t kLongestHeader = std::size_t{1} << 16;
  std::ifstream in(file, std::ios::binary);
  std::string head(kLongestHeader, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  if (!head.starts_with("ply")) return;
  if (head.size() < kLongestHeader && head.find("end_header") == head.npos)
    throw SceneError(file.string(), "", "the header does not end: there is no end_header");
  std::istringstream lines(head);
  std::string line;
  for (int number = 1; std::getline(lines, line) && !line.starts_with("end_header"); ++number) {
    std::istringstream words(line);
    std::string word, name, count;
    if (!(words >> word >> name >> count) || word != "element") continue;
    if (count.find_first_not_of("0123456789") != count.npos) continue;  // Assimp says what is wrong
    count.erase(0, count.find_first_not_of('0'));
    if (count.empty()) continue;
    constexpr std::size_t kDigits = 19;  // of numbers below 2^63
    if (count.size() <= kDigits && std::stoull(count) <= bytes) continue;
    throw SceneError(file.string(), "",
                     "line " + std::to_string(number) + ": the header announces " + plain_text(count).substr(0, 40) +
                         " elements \"" + plain_text(name).substr(0, 40) + "\", and the file has " +
                         std::to_string(bytes) + " bytes");
  }
}

}  // namespace carousel::scene
